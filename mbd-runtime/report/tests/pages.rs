//! Pages of runs of a user's own models: what they show, what they say they do not, what cannot leave its place in them.

use mbd_report::{RecordedMotion, Report, Run, Views, report};
use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Generic, MissingMetric, Model, Options, Sampling, Simulation, Trajectory, model,
};

model! {
    /// A bob under a knot that two lines hold, and a door.
    model Toy {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame left at [-1.0, 0.0, 2.0] m,
            frame right at [1.0, 0.0, 2.0] m,
            frame post at [3.0, 0.0, 1.0] m,
        }
        body door {
            mass: 3 kg,
            inertia: diag(1.0, 1.2, 0.3) kg*m^2,
            frame edge at [-0.4, 0.0, 0.0] m,
        }
        point bob { mass: 2 kg, start at [0.3, 0.2, 0.2] m }
        point knot;
        joint hinge: hinge from world.post to door.edge { axis: y }
        line a from world.left to knot { free_length: 1.2 m, stiffness: 5 kN/m }
        line b from world.right to knot { free_length: 1.2 m, stiffness: 5 kN/m }
        line cord from knot to bob { free_length: 1.0 m, stiffness: 5 kN/m }
        output height = bob.position.z;
        output swing = hinge.angle;
    }
}

fn toy() -> Toy {
    Toy::new(ToyParams::default()).expect("the params that are declared")
}

fn flown(until: f64, sampling: Sampling, content: Content) -> Trajectory {
    let (toy, options) = (toy(), Options::tsit5(1e-6));
    let mut history = Trajectory::new(&toy, sampling, content);
    let mut simulation = Simulation::new(&toy, options).expect("a model that runs");
    simulation
        .record(until, &mut history)
        .expect("a run that ends");
    history
}

fn page(history: &Trajectory) -> String {
    report(&toy(), &Options::tsit5(1e-6), history).html()
}

#[test]
fn a_page_names_model_hash_and_options_and_needs_nothing_but_itself() {
    let html = page(&flown(0.5, Sampling::Every(0.01), Content::ALL));
    for text in [
        "Toy",
        "hash of its declaration",
        "relative tolerance 1e-6",
        "64 bits",
    ] {
        assert!(html.contains(text), "{text}");
    }
    for word in ["http:", "https:", " src=", "url(", "@import"] {
        let html = html.replace("http://www.w3.org/2000/svg", "");
        assert!(!html.contains(word), "{word}");
    }
    // The same run gives the same bytes.
    assert_eq!(html, page(&flown(0.5, Sampling::Every(0.01), Content::ALL)));
}

model! {
    /// A stone that is thrown up.
    model Throw {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        point stone { mass: 1 kg, start at [0.0, 0.0, 0.0] m velocity [3.0, 0.0, 10.0] m/s }
        event far = stone.position.x rises 100 m;
        event top = stone.velocity.z falls 0 m/s;
        /// How high it flies.
        metric highest = max stone.position.z in cm;
        metric flown_far = time_of far;
        metric above = value stone.position.z { at: top };
    }
}

#[test]
fn metrics_of_a_run_stand_on_its_page_and_say_why_they_have_no_value() {
    let (throw, options) = (
        Throw::new(ThrowParams::default()).expect("the params that are declared"),
        Options::rk4(0.1),
    );
    let told = |content: Content| {
        let mut history = Trajectory::new(&throw, Sampling::Every(0.1), content);
        let mut run = Simulation::new(&throw, options).expect("a model that runs");
        run.record(2.0, &mut history).expect("a run that ends");
        let values = history.metrics(throw.scene());
        (values, report(&throw, &options, &history).html())
    };
    let (values, html) = told(Content::ALL);
    // v²/2g.
    assert!((values[0].value.expect("a value") - 500.0).abs() < 1e-9);
    assert_eq!(values[0].unit, "cm");
    assert_eq!(values[1].value, Err(MissingMetric::NoEvent));
    // At the event, whatever rows there are.
    assert!((values[2].value.expect("a value") - 5.0).abs() < 1e-12);
    for text in [
        "Metrics",
        "How high it flies.",
        "<code>flown_far</code> has no value: its event did not happen",
    ] {
        assert!(html.contains(text), "{text}");
    }
    let (values, html) = told(Content {
        outputs: false,
        ..Content::ALL
    });
    assert_eq!(values[0].value, Err(MissingMetric::NotRecorded));
    assert!(html.contains("<code>highest</code> has no value: the history does not hold"));
}

#[test]
fn metrics_of_a_page_say_of_which_rows_they_are() {
    let (throw, options) = (
        Throw::new(ThrowParams::default()).expect("the params that are declared"),
        Options::rk4(0.1),
    );
    let mut history = Trajectory::new(&throw, Sampling::Every(0.1), Content::ALL);
    let mut run = Simulation::new(&throw, options).expect("a model that runs");
    let told = |history: &Trajectory| report(&throw, &options, history).html();
    assert!(told(&history).contains("The history holds no row."));
    run.record(0.5, &mut history).expect("a run that ends");
    assert!(told(&history).contains("Of the rows that the history holds, 0 s to 0.5 s."));
}

#[test]
fn runs_one_after_the_other_play_one_after_the_other() {
    let toy = toy();
    let mut run = Simulation::new(&toy, Options::rk4(0.01)).expect("a model that runs");
    let mut part = |until: f64| {
        let mut history = Trajectory::new(&toy, Sampling::Every(0.01), Content::ALL);
        run.record(until, &mut history).expect("a run that ends");
        history
    };
    let parts = [part(0.3), part(1.0)];
    assert!(parts[1].times()[0] >= 0.3, "{}", parts[1].times()[0]);
    let scene = Toy::scene();
    let runs = parts.each_ref().map(|part| Run::new(&scene, &[], part));
    let html = RecordedMotion::of_several(&[("1", runs[0]), ("2", runs[1])])
        .on(Report::new("Both"))
        .html();
    for text in [
        "1 is drawn from 0 s to 0.3 s, while it runs.",
        "2 is drawn from 0.3 s to 1 s, while it runs.",
        "1: Toy: the mechanism",
        "2: Toy: the mechanism",
    ] {
        assert!(html.contains(text), "{text}");
    }
}

#[test]
fn ten_minutes_stay_below_five_megabytes() {
    let history = flown(600.0, Sampling::Every(0.01), Content::ALL);
    assert_eq!(history.times().len(), 60_001);
    let html = page(&history);
    assert!(html.len() < 5_000_000, "{}", html.len());
    assert!(html.contains(" of 60001 rows are shown"));
}

#[test]
fn what_a_history_does_not_hold_is_said() {
    let html = page(&flown(0.5, Sampling::Every(0.01), Content::RESULTS));
    assert!(html.contains(
        "Not shown: <code>door</code> and 2 others, whose motion the history does not hold"
    ));
}

#[test]
fn a_run_of_no_time_is_one_instant_and_no_run_at_all_is_said_so() {
    let html = page(&flown(0.0, Sampling::Every(0.01), Content::ALL));
    assert!(html.contains("The history is one instant, 0 s"));
    let empty = Trajectory::new(&toy(), Sampling::Steps, Content::ALL);
    assert!(page(&empty).contains("The history has no rows: nothing is shown."));
}

/// Names and words that try to become markup, script, or text that reads backwards.
const TRICK: &str = "</script><script>caught()</script><img src=x onerror=caught()>\u{202e}\"'&`b";

#[test]
fn no_name_and_no_word_of_a_scene_becomes_markup_or_turns_the_direction_of_writing() {
    let mut scene: Scene = Toy::scene();
    scene.name = TRICK.into();
    scene.doc = TRICK.into();
    scene.bodies[0].name = TRICK.into();
    scene.bodies[0].frames[1].name = TRICK.into();
    scene.points[0].name = format!("bob{TRICK}");
    scene.lines[0].name = format!("a{TRICK}");
    scene.joints[0].name = format!("hinge{TRICK}");
    scene.outputs[0].name = format!("height{TRICK}");
    scene.world_frames[1].name = format!("left{TRICK}");
    let model = Generic::<f64>::with_defaults(scene).expect("the same numbers");
    let options = Options::tsit5(1e-6);
    let mut history = Trajectory::new(&model, Sampling::Every(0.1), Content::ALL);
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.record(0.3, &mut history).expect("a run that ends");
    history.events.push((0.1, TRICK.into()));
    let figures = [(TRICK.to_string(), vec![format!("height{TRICK}")])];
    let views = Views::new(&Run {
        figures: &figures,
        ..Run::new(model.scene(), &[], &history)
    });
    let pages = [
        report(&model, &options, &history).html(),
        views
            .with_motion(views.with_histories(Report::new(TRICK)))
            .html(),
    ];
    for html in pages {
        assert!(!html.contains("caught()</script>") && !html.contains("<img"));
        assert!(!html.contains('\u{202e}'));
        // What tells that scripts run, the numbers and the script itself are the only scripts of the page.
        assert_eq!(
            (
                html.matches("<script").count(),
                html.matches("</script").count()
            ),
            (3, 3)
        );
    }
}

#[test]
fn five_hundred_bodies_make_a_page() {
    let mut scene: Scene = Toy::scene();
    let door = scene.bodies[0].clone();
    for k in 1..500 {
        let mut body = door.clone();
        body.name = format!("door[{k}]");
        scene.bodies.push(body);
    }
    let model = Generic::<f64>::with_defaults(scene).expect("free bodies");
    let options = Options::rk4(0.01);
    let mut history = Trajectory::new(
        &model,
        Sampling::Every(0.02),
        Content {
            reactions: false,
            energy: false,
            ..Content::ALL
        },
    );
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.record(0.1, &mut history).expect("a run that ends");
    let html = report(&model, &options, &history).html();
    assert!(
        html.contains("door[499]") && html.len() < 5_000_000,
        "{}",
        html.len()
    );
}
