//! A scene, its settings, the run and its files.

use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::check_units;
use mbd_runtime::scene::{
    Dimension, Formula, Frame, Gravity, Input, Line, LineKind, Load, LoadKind, NodeModel, Output,
    Parameter, Place, Point, PointKind, Scene, State, Unit,
};
use mbd_runtime::{Method, Options};

use super::*;

fn unit(text: &str, factor: f64, mass: i8, length: i8, time: i8) -> Unit {
    let dimension = Dimension {
        mass: 2 * mass,
        length: 2 * length,
        time: 2 * time,
        current: 0,
    };
    Unit {
        text: text.into(),
        factor,
        dimension,
    }
}

fn point(name: &str, kind: PointKind) -> Point {
    Point {
        name: name.into(),
        doc: String::new(),
        kind,
    }
}

fn line(name: &str, from: Place, to: Place) -> Line {
    Line {
        name: name.into(),
        doc: String::new(),
        kind: LineKind::Line,
        from,
        to,
        free_length: Formula::Number(1.0),
        stiffness: Formula::Param(0),
        damping: Formula::Number(0.0),
    }
}

/// A bob of 2 kg on a line, a knot, and two lines to the ceiling; 9.81 m/s².
fn swing() -> Scene {
    let ceiling = |name: &str, x: f64| Frame {
        name: name.into(),
        position: [x, 0.0, 0.0].map(Formula::Number),
        rotation: None,
    };
    Scene {
        name: "Swing".into(),
        gravity: Gravity::Uniform {
            acceleration: [0.0, 0.0, -9.81].map(Formula::Number),
        },
        params: vec![Parameter {
            name: "k".into(),
            doc: "Stiffness of the lines.".into(),
            default: 5e3,
            range: Some([1e3, 1e5]),
            unit: unit("kN/m", 1e3, 1, 0, -2),
        }],
        world_frames: vec![
            ceiling("world", 0.0),
            ceiling("left", -0.5),
            ceiling("right", 0.5),
        ],
        points: vec![
            point("knot", PointKind::Node(NodeModel::Static)),
            point("bob", PointKind::Mass(Formula::Number(2.0))),
        ],
        lines: vec![
            line("rope[0]", Place::World(1), Place::Point(0)),
            line("rope[1]", Place::World(2), Place::Point(0)),
            line("fall", Place::Point(1), Place::Point(0)),
        ],
        outputs: vec![Output {
            name: "height".into(),
            doc: String::new(),
            value: Formula::Component(vec![Formula::Position(Place::Point(1))], 2),
            components: 1,
            unit: unit("m", 1.0, 0, 1, 0),
        }],
        ..Scene::default()
    }
}

fn settings(text: &str) -> Settings {
    Settings::read(text).unwrap()
}

const SETTINGS: &str = "[run]\nuntil = \"500 ms\"\nstep = \"2 ms\"\nevery = 0.01\n[run.start]\nbob.z = \"-1.9 m\"\nbob.vx = \"1 m/s\"\nknot.z = \"-0.8 m\"\n[run.params]\nk = \"8 kN/m\"\n";

#[test]
fn settings_become_si_numbers_in_the_places_of_the_state() {
    let plan = RunPlan::new(&swing(), &settings(SETTINGS)).unwrap();
    assert_eq!((plan.until, plan.every), (0.5, Some(0.01)));
    assert_eq!(plan.options.method, Method::Rk4 { step: 0.002 });
    assert_eq!(plan.params, [8e3]);
    assert_eq!(plan.state, [0.0, 0.0, -1.9, 1.0, 0.0, 0.0]);
    assert_eq!(plan.nodes, Some(vec![0.0, 0.0, -0.8]));
}

#[test]
fn a_start_may_be_given_by_the_quantities_that_an_expression_has() {
    let start = |text: &str| {
        let text = format!("[run]\nuntil = 1\n[run.start]\n{text}");
        let plan = RunPlan::new(&swing(), &settings(&text));
        plan.map(|plan| plan.state)
            .map_err(|error| error.to_string())
    };
    let moving = Ok(vec![0.1, 0.0, -1.9, 1.0, 2.0, 3.0]);
    let position = "\"bob.position\" = \"[0.1, 0, -1.9] m\"\n";
    for velocity in [
        "\"bob.velocity\" = \"[1, 2, 3] m/s\"",
        "bob.velocity = [\"1 m/s\", \"2 m/s\", \"3 m/s\"]",
        "bob.velocity.x = \"1 m/s\"\nbob.velocity.y = \"2 m/s\"\nbob.vz = \"3 m/s\"",
    ] {
        assert_eq!(
            start(&format!("{position}{velocity}")),
            moving,
            "{velocity}"
        );
    }
    let twice = start("bob.velocity.x = \"1 m/s\"\nbob.vx = \"1 m/s\"");
    assert_eq!(twice, Err("`start.bob.vx`: is given twice".into()));
    let speed = start("bob.velocity = \"3 m/s\"").unwrap_err();
    assert!(speed.contains("expected 3 numbers"), "{speed}");
}

#[test]
fn a_number_without_a_unit_is_refused_where_it_is_seldom_meant_in_si() {
    let plan = |scene: &Scene, table: &str| {
        let text = format!("[run]\nuntil = 1\n{table}");
        let plan = check_units(scene, &settings(&text));
        plan.map_err(|error| error.to_string())
    };
    let swing = swing();
    assert_eq!(
        plan(&swing, "[run.params]\nk = 8\n"),
        Err("`params.k`: 8 has no unit, and what it is given for is declared in kN/m: write `\"8 kN/m\"`".into())
    );
    assert_eq!(plan(&swing, "[run.start]\nbob.z = -1.9\n"), Ok(()));
    let read = mbd_compiler::read_text(
        "model Pendulum { gravity: none; body rod { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
         joint pin: hinge from world to rod.com { axis: y } }",
    );
    let pendulum = read.scene.expect("a pendulum");
    let angle = |number: &str| plan(&pendulum, &format!("[run.start]\npin.angle = {number}\n"));
    assert_eq!(angle("0.5"), Ok(()));
    assert_eq!(angle("\"30 rad\""), Ok(()));
    assert_eq!(
        angle("30"),
        Err("`start.pin.angle`: 30 has no unit and would be more than a full turn in radians: write `\"30 deg\"`, or `\"30 rad\"` if that is meant".into())
    );
}

#[test]
fn what_is_not_said_is_zero_and_adaptive() {
    let plan = RunPlan::new(&swing(), &settings("[run]\nuntil = 1\n")).unwrap();
    assert_eq!(plan.options, Options::tsit5(1e-8));
    assert_eq!((plan.nodes, plan.every), (None, None));
    assert_eq!(plan.state, [0.0; 6]);
}

#[test]
fn the_method_is_chosen_by_its_word() {
    let plan = |text: &str| {
        let text = format!("[run]\nuntil = 1\n{text}");
        RunPlan::new(&swing(), &settings(&text)).unwrap().options
    };
    for word in Method::ADAPTIVE {
        let options = plan(&format!("method = \"{word}\"\ntolerance = 1e-9\n"));
        assert_eq!(options.method.word(), word);
        assert_eq!(options.method.tolerance(), Some([1e-9, f64::INFINITY]));
    }
    assert_eq!(plan("method = \"vern7\""), Options::vern7(1e-8));
    assert_eq!(plan("method = \"rk4\""), Options::rk4(1e-3));
    assert_eq!(plan("method = \"rk4\"\nstep = 0.1"), Options::rk4(0.1));
    assert_eq!(plan("method = \"rattle\""), Options::rattle(1e-3));
    assert_eq!(
        plan("method = \"rattle\"\nstep = \"5 ms\""),
        Options::rattle(5e-3)
    );
}

#[test]
fn a_declared_state_starts_where_it_says_or_where_the_settings_do() {
    let mut scene = swing();
    scene.states.push(State {
        name: "heat".into(),
        doc: String::new(),
        start: Formula::Param(0),
        unit: unit("J", 1.0, 1, 2, -2),
        rate: Formula::Number(1.0),
    });
    let start = |text: &str| {
        let text = format!("[run]\nuntil = 1\n{text}");
        let plan = RunPlan::new(&scene, &settings(&text)).unwrap();
        plan.state.last().copied()
    };
    assert_eq!(start(""), Some(scene.params[0].default));
    assert_eq!(start("[run.start]\nheat = \"2 kJ\""), Some(2000.0));
}

#[test]
fn a_setting_that_cannot_be_used_is_named_with_the_remedy() {
    let mut scene = swing();
    scene.inputs.push(Input {
        name: "wind".into(),
        doc: String::new(),
        components: 3,
        unit: unit("m/s", 1.0, 0, 1, -1),
        default: [0.0, 5.0, 0.0],
    });
    scene.loads.push(Load {
        name: "thruster".into(),
        doc: String::new(),
        at: Place::Point(0),
        kind: LoadKind::External,
    });
    let winded = "[run.inputs]\nwind = [1, 2.0, \"3 m/s\"]\nthruster = [0, 0, 0]\n";
    let fails = |text: &str, what: &str| {
        let error = RunPlan::new(&scene, &settings(text))
            .unwrap_err()
            .to_string();
        assert!(error.contains(what), "{text}: {error}");
    };
    fails("", "`until`: say when the run ends");
    fails(
        "[run]\nuntil = \"2 m\"",
        "`until`: `2 m` has the wrong unit: expected s",
    );
    fails("[run]\nuntil = \"2\"", "needs a unit, such as s");
    fails("[run]\nuntil = -1", "must not be negative");
    fails("[run]\nuntil = true", "expected a number, found boolean");
    fails("[run]\nuntil = nan", "finite");
    fails("[run]\nuntil = 1\nstep = 1\ntolerance = 1", "either a step");
    fails(
        "[run]\nuntil = 1\nmethod = \"ver7\"",
        "`method`: there is no method `ver7`; did you mean `vern7`? There are: rk4, rattle, tsit5, vern7, rodas5p, auto",
    );
    fails(
        "[run]\nuntil = 1\nmethod = \"vern7\"\nstep = 1",
        "`step`: `vern7` chooses its steps: give `tolerance`",
    );
    fails(
        "[run]\nuntil = 1\nmethod = \"rk4\"\ntolerance = 1",
        "`tolerance`: `rk4` has a fixed step: give `step`",
    );
    fails(
        "[run]\nuntil = 1\nmethod = \"rattle\"\ntolerance = 1e-6",
        "`tolerance`: `rattle` has a fixed step: give `step`",
    );
    fails(
        "[run]\nuntil = 1\nmethod = \"ratle\"",
        "did you mean `rattle`?",
    );
    fails(
        "[run]\nuntil = 1\n[run.start]\nbob.vz = \"1 m\"",
        "`start.bob.vz`: `1 m` has the wrong unit: expected m/s",
    );
    fails(
        "[run]\nuntil = 1\n[run.start]\nbop.z = 1",
        "this scene has no `bop.z`; did you mean `bob.",
    );
    fails("[run]\nuntil = 1\n[run.params]\nkk = 1", "it has k");
    fails(
        "[run]\nuntil = 1",
        "`inputs.thruster`: this scene takes `thruster` from its caller: give 3 number(s)",
    );
    fails(
        "[run]\nuntil = 1\n[run.inputs]\nwind = 3",
        "expected 3 numbers, found one",
    );
    fails(
        &format!("[run]\nuntil = 1\n{winded}rain = 1\n"),
        "`inputs.rain`",
    );
    let figures = |list: &str| format!("[run]\nuntil = 1\n{winded}[run.figures]\nA = {list}\n");
    fails(&figures("3"), "give the columns it shows");
    fails(
        &figures("[\"hieght\"]"),
        "`figures.A`: the history has no column `hieght`; did you mean `height`?",
    );
    let plan = RunPlan::new(
        &scene,
        &settings(&format!("[run]\nuntil = 1\nmethod = \"RK4\"\n{winded}")),
    );
    assert_eq!(plan.unwrap().options.method, Method::Rk4 { step: 1e-3 });
    // A figure has one unit; columns of another are a figure of their own.
    let both = settings(&figures(
        "[\"height\", \"fall.tension\", \"bob.position.z\"]",
    ));
    let plan = RunPlan::new(&scene, &both).unwrap();
    let shown: Vec<(&str, Vec<&str>)> = plan
        .figures
        .iter()
        .map(|(title, columns)| (&**title, columns.iter().map(|it| &**it).collect()))
        .collect();
    let wanted = [
        ("A", vec!["height", "bob.z"]),
        ("A 2", vec!["fall.tension"]),
    ];
    assert_eq!(shown, wanted);
    fails(
        &format!("[run]\nuntil = 1\ninstants = [\"1 m\"]\n{winded}"),
        "`instants`: `1 m` has the wrong unit: expected s",
    );
    let plan = RunPlan::new(&scene, &settings(&format!("[run]\nuntil = 1\n{winded}"))).unwrap();
    assert_eq!(plan.inputs, [1.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
    // An input that is left out keeps its default.
    let calm = "[run]\nuntil = 1\n[run.inputs]\nthruster = [0, 1, 0]\n";
    let plan = RunPlan::new(&scene, &settings(calm)).unwrap();
    assert_eq!(plan.inputs, [0.0, 5.0, 0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn a_swing_is_flown_and_leaves_its_files() {
    let scene = swing();
    let plan = RunPlan::new(&scene, &settings(SETTINGS)).unwrap();
    let outcome = fly(&scene, &plan, &mut ProgressLine::silent()).unwrap();
    assert_eq!(outcome.error, None);
    assert_eq!(outcome.trajectory.len(), 51);
    let folder = std::env::temp_dir().join(format!("mbd_swing_{}", std::process::id()));
    let tables = publish(&scene, &plan, &outcome, &folder).unwrap();
    assert!(tables[0].text().contains("RK4, fixed step 0.002 s"));
    for file in [
        "history.csv",
        "report.html",
        "summary.json",
        "height.svg",
        "mechanism.svg",
        "Energy_balance.svg",
        "rope_tension.svg",
        "fall_tension.svg",
    ] {
        assert!(folder.join(file).is_file(), "{file}");
    }
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    assert!(
        summary.contains("\"status\": \"ok\"") && summary.contains("\"k\": 8000.0"),
        "{summary}"
    );
    let rope = std::fs::read_to_string(folder.join("rope_tension.svg")).unwrap();
    assert!(rope.contains("rope[0].tension") && rope.contains("rope[1].tension"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_energy_balance_counts_everything_that_acts_along_a_joint() {
    // What a slack stop has still stored when it lets go goes into its damper until it is at rest length: the power has a corner there
    // that is no event, so its integral is of second order.
    for (field, bound) in [
        ("damping: 0.1 N*m*s", 1e-8),
        ("friction: 0.5 N*m, friction_rate: 0.1 rad/s", 1e-8),
        (
            "stops: [-1.0, 1.0] rad, stop_stiffness: 100 N*m, stop_damping: 1 N*m*s",
            2e-5,
        ),
        ("force: 2 N*m * sin(3 rad/s * time)", 1e-8),
        ("motor: 1 rad * sin(3 rad/s * time)", 1e-8),
    ] {
        let text = format!(
            "model Arm {{
                gravity: [9.81, 0.0, 0.0] m/s^2;
                body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m }}
                joint pin: hinge from world to arm.top {{ axis: y, {field} }}
            }}"
        );
        let scene = mbd_compiler::read_text(&text).scene.unwrap();
        let plan = RunPlan::new(
            &scene,
            &settings("[run]\nuntil = 2\nstep = \"1 ms\"\n[run.start]\narm.z = \"-0.5 m\""),
        )
        .unwrap();
        let outcome = fly(&scene, &plan, &mut ProgressLine::silent()).unwrap();
        assert_eq!(outcome.error, None, "{field}");
        let missed = outcome.imbalance.map(|it| it.relative());
        assert!(
            missed.is_some_and(|missed| missed < bound),
            "{field}: {missed:?}"
        );
    }
}

#[test]
fn params_outside_their_range_are_refused_and_a_failed_run_keeps_its_history() {
    let scene = swing();
    let mut plan = RunPlan::new(&scene, &settings(SETTINGS)).unwrap();
    plan.params = vec![1.0];
    let refused = fly(&scene, &plan, &mut ProgressLine::silent())
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("`k`") && refused.contains("range"),
        "{refused}"
    );
    plan.params = vec![1e5];
    plan.options = Options::rk4(0.1);
    plan.until = 50.0;
    let outcome = fly(&scene, &plan, &mut ProgressLine::silent()).unwrap();
    let error = outcome.error.as_ref().unwrap();
    assert_eq!(error.cause.status(), "unstable_step");
    assert!(!outcome.trajectory.is_empty());
    assert!(summary_status(&scene, &plan, &outcome).contains("unstable_step"));
}

fn summary_status(scene: &Scene, plan: &RunPlan, outcome: &RunOutcome) -> String {
    summary_json(scene, plan, outcome).unwrap()
}

#[test]
fn energy_that_no_step_explains_is_not_answered_with_a_shorter_one() {
    let text = "model Swing { gravity: [0, 0, -9.81] m/s^2;
        body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
        joint p: hinge from world to a.top { axis: y, start: 0.5 rad }
        output bend = p.angle; }";
    let scene = mbd_compiler::read_text(text).scene.expect("a pendulum");
    let settings = Settings::read("[run]\nuntil = 1\ntolerance = 1e-9\n").expect("settings");
    let plan = RunPlan::new(&scene, &settings).expect("a plan");
    let mut outcome = fly(&scene, &plan, &mut ProgressLine::silent()).expect("a run");
    assert_eq!(doubt(&scene, &plan, &outcome), None);
    let lost = mbd_runtime::Imbalance {
        energy: 0.5,
        moved: 1.0,
        rounding: 0.0,
    };
    outcome.imbalance = Some(lost);
    let told = doubt(&scene, &plan, &outcome).expect("a doubt");
    assert!(
        told.contains("50.0 %") && told.contains("disagree") && !told.contains("tighter"),
        "{told}"
    );
    // Without a second run nothing tells the steps from the forces.
    outcome.estimate = Err(Unestimated::NotAsked);
    let told = doubt(&scene, &plan, &outcome).expect("a doubt");
    assert!(told.contains("tighter tolerance"), "{told}");
}
