//! The instant at which an event acts has two sides. A row and what is measured of a side hold what is on that side, all of it: what the event
//! sets, and what a formula makes of time or of the guard itself.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::scene::Scene;
use mbd_runtime::{Content, Options, Sampling, Simulation, Trajectory};

fn methods() -> [Options; 5] {
    [
        // Steps that end where the events are, and steps that do not.
        Options::rk4(1e-3),
        Options::rk4(0.03),
        Options::tsit5(1e-8),
        Options::vern7(1e-9),
        Options::rodas5p(1e-8),
    ]
}

fn recorded(scene: &Scene, options: Options, (until, sampling): (f64, Sampling)) -> Trajectory {
    let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
    let model = Interpreted::<f64>::new(scene.clone(), &defaults).expect("defaults");
    let mut history = Trajectory::new(&model, sampling, Content::ALL);
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.record(until, &mut history).expect("a run that ends");
    history
}

fn scene(text: &str) -> Scene {
    let read = read_text(text);
    read.scene.unwrap_or_else(|| panic!("{:?}", read.errors))
}

fn value(history: &Trajectory, scene: &Scene, name: &str) -> f64 {
    let mut all = history.metrics(scene).into_iter();
    let found = all.find(|metric| metric.name == name).expect("a metric");
    found.value.unwrap_or_else(|why| panic!("{name}: {why}"))
}

/// A stone that falls from rest: z = −g t²/2. At the event a formula ends that gave 10 N, and the event sets k from 100 N to 300 N.
fn falling(guard: &str, holds: &str) -> Scene {
    scene(&format!(
        "model Sides {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            param k = 100 N in 0 N ..= 1000 N;
            point p {{ mass: 1 kg }}
            output both = if({holds}, 10 N, 0 N) + k;
            output felt = if({holds}, 10 N, 0 N) + norm(p.acceleration)*1 kg;
            load push on p = [1, 0, 0] * (if({holds}, 10 N, 0 N) + k - 100 N);
            event turned = {guard} {{ set: k = 300 N }}
            metric least = min both;
            metric most = max both;
            metric there = value both {{ at: turned }};
        }}"
    ))
}

#[test]
fn what_a_formula_and_what_an_event_changes_change_at_one_instant() {
    let by = [
        ("time rises 2 s", "time < 2 s"),
        ("p.position.z falls -19.62 m", "p.position.z > -19.62 m"),
        ("p.velocity.z falls -19.62 m/s", "p.velocity.z > -19.62 m/s"),
        ("(time - 2 s)*(time + 1 s) crosses 0 s^2", "time < 2 s"),
    ];
    for (guard, holds) in by {
        let scene = falling(guard, holds);
        for options in methods() {
            let word = format!("{guard}, {}", options.method.name());
            let history = recorded(&scene, options, (3.0, Sampling::Steps));
            assert_eq!(value(&history, &scene, "least"), 110.0, "{word}");
            assert_eq!(value(&history, &scene, "most"), 300.0, "{word}");
            assert_eq!(value(&history, &scene, "there"), 110.0, "{word}");
            let both = history.column("both").expect("an output");
            assert!(both.iter().all(|x| [110.0, 300.0].contains(x)), "{word}");
            let felt = history.column("felt").expect("an output");
            let [before, after] = [10.0, 200.0].map(|push: f64| push.hypot(9.81));
            let sides = [10.0 + before, after];
            let is_a_side = |x: &f64| sides.iter().any(|side| (x - side).abs() < 1e-9);
            assert!(felt.iter().all(is_a_side), "{word}: {felt:?}");
            // Both sides are told, at the time of the event.
            let (time, _) = history.events[0];
            let rows = history.times().iter().zip(both);
            let rows: Vec<f64> = rows
                .filter(|(at, _)| **at == time)
                .map(|it| *it.1)
                .collect();
            assert_eq!(rows, [110.0, 300.0], "{word}");
        }
    }
}

#[test]
fn a_row_of_a_grid_that_falls_on_an_event_is_of_one_side() {
    let scene = falling("time rises 2 s", "time < 2 s");
    for options in methods() {
        let word = options.method.name();
        for until in [2.0, 3.0] {
            let history = recorded(&scene, options, (until, Sampling::Every(0.5)));
            assert_eq!(history.times()[4], 2.0, "{word}");
            let both = &history.column("both").expect("an output")[..5];
            assert!(both.iter().all(|x| *x == 110.0), "{word}: {both:?}");
        }
    }
}

#[test]
fn a_node_is_on_one_side_with_its_load() {
    // Two springs of 100 N/m pull the node to the middle; the load moves it by F / 200 N/m.
    let scene = scene(
        "model Node {
            gravity: none;
            param k = 10 N in 0 N ..= 1000 N;
            world { frame a at [-2, 0, 0] m, frame b at [2, 0, 0] m }
            point p { mass: 1 kg }
            point n { equilibrium: static }
            line left from world.a to n { free_length: 1 m, stiffness: 100 N/m }
            line right from world.b to n { free_length: 1 m, stiffness: 100 N/m }
            load push on n = [1, 0, 0]*(if(time < 2 s, 4 N, 0 N) + k);
            output x = n.position.x;
            event e = time rises 2 s { set: k = 30 N }
            metric least = min x;
            metric most = max x;
        }",
    );
    for options in methods() {
        let word = options.method.name();
        let history = recorded(&scene, options, (3.0, Sampling::Steps));
        let is_near = |x: f64, place: f64| (x - place).abs() < 1e-9;
        let least = value(&history, &scene, "least");
        assert!(is_near(least, 0.07), "{word}: {least}");
        let most = value(&history, &scene, "most");
        assert!(is_near(most, 0.15), "{word}: {most}");
        let x = history.column("x").expect("an output");
        let is_a_side = |x: &f64| is_near(*x, 0.07) || is_near(*x, 0.15);
        assert!(x.iter().all(is_a_side), "{word}: {x:?}");
    }
}

#[test]
fn the_load_of_a_static_node_that_jumps_is_no_energy_made_or_lost() {
    // x = F / 200 N/m: the springs hold 100 J + 100 N/m x², 0.49 J of which become 0.25 J where 14 N become 10 N.
    let text = |load: &str| {
        format!(
            "model Node {{
                gravity: none;
                world {{ frame a at [-2, 0, 0] m, frame b at [2, 0, 0] m }}
                point p {{ mass: 1 kg }}
                point n {{ equilibrium: static }}
                line left from world.a to n {{ free_length: 1 m, stiffness: 100 N/m }}
                line right from world.b to n {{ free_length: 1 m, stiffness: 100 N/m }}
                load push on n = [1, 0, 0]*({load});
            }}"
        )
    };
    let by = [
        "if(time < 2 s, 14 N, 10 N)",
        "if(time > 2 s, 10 N, 14 N)",
        "if(time < 1.234 s, 14 N, 10 N)",
        "if(time < 1 s, 14 N, if(time < 1.001 s, -5 N, 10 N))",
    ];
    for load in by {
        let scene = scene(&text(load));
        for options in methods() {
            let word = format!("{load}, {}", options.method.name());
            let model = Interpreted::<f64>::new(scene.clone(), &[]).expect("a model");
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            run.run(3.0)
                .unwrap_or_else(|error| panic!("{word}: {error}"));
            let imbalance = run.imbalance();
            let is_small = imbalance.is_none_or(|it| it.relative() < 1e-8);
            assert!(is_small, "{word}: {imbalance:?}");
        }
    }
}

#[test]
fn a_window_that_begins_or_ends_with_an_event_ends_on_its_side() {
    let scene = scene(
        "model Windows {
            gravity: none;
            param k = 100 N in 0 N ..= 1000 N;
            point p { mass: 1 kg }
            output x = k;
            event first = time rises 0.25 s { set: k = 5 N }
            event second = time rises 0.3 s { set: k = 7 N }
            metric least = min x { from: 0.25 s, to: 0.3 s };
            metric most = max x { from: 0.25 s, to: 0.3 s };
            metric mean = mean x { from: 0.25 s, to: 0.3 s };
            metric begun = min x { to: 0.25 s };
            metric left = max x { from: 0.3 s };
            metric last = final x { to: 0.3 s };
            metric seen = time_of second { to: 0.3 s };
            metric there = value x { at: second, to: 0.3 s };
        }",
    );
    for options in methods() {
        let word = options.method.name();
        let history = recorded(&scene, options, (1.0, Sampling::Every(0.1)));
        let value = |name| value(&history, &scene, name);
        assert_eq!(value("least"), 5.0, "{word}");
        assert_eq!(value("most"), 5.0, "{word}");
        assert!((value("mean") - 5.0).abs() < 1e-11, "{word}");
        assert_eq!(value("begun"), 100.0, "{word}");
        assert_eq!(value("left"), 7.0, "{word}");
        assert_eq!(value("last"), 5.0, "{word}");
        // The clock says 0.3 s, and no rounding behind it.
        assert_eq!(value("seen"), 0.3, "{word}");
        assert_eq!(value("there"), 5.0, "{word}");
    }
}
