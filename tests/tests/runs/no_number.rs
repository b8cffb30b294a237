//! What is no number stays none, whatever is chosen by it or between it and another: a root of less than zero is not the zero beside it.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::scene::Scene;
use mbd_runtime::{
    Content, Generic, Model, Options, Sampling, Simulation, Source, StepError, Trajectory,
};
use tests::declared::read;

/// A point on which acts what stands in `force`, with one output.
fn scene(force: &str, output: &str) -> Scene {
    let text = format!(
        "model Root {{
            gravity: none;
            point p {{ mass: 1 kg }}
            let root = sqrt(0.5 - time / (1 s));
            load push on p = [{force}, 0 N, 0 N];
            output found = {output};
            output used = root;
        }}"
    );
    let read = read_text(&text);
    read.scene
        .unwrap_or_else(|| panic!("{output}: {:?}", read.errors))
}

/// The output at 0, 0.25, … 1 s: the root is a number in the first three rows.
fn rows(model: &dyn Model<f64>) -> Vec<f64> {
    let mut history = Trajectory::new(model, Sampling::Every(0.25), Content::ALL);
    let mut run = Simulation::new(model, Options::rk4(0.01)).expect("a model that runs");
    run.record(1.0, &mut history).expect("nothing acts");
    history.column("found").expect("an output").to_vec()
}

#[test]
fn what_is_chosen_by_no_number_is_none() {
    let half = 0.5_f64.sqrt();
    let cases = [
        ("max(0, root)", [half, 0.5, 0.0]),
        ("max(root, 0)", [half, 0.5, 0.0]),
        ("max(root, root - 1)", [half, 0.5, 0.0]),
        ("min(2, root)", [half, 0.5, 0.0]),
        ("min(root, root + 1, 2)", [half, 0.5, 0.0]),
        ("clamp(0.6, root, 1)", [half, 0.6, 0.6]),
        ("sign(root)", [1.0, 1.0, 0.0]),
        ("max(1, ln(root))", [1.0, 1.0, 1.0]),
        ("if(root > 0.6, 1, 2)", [1.0, 2.0, 2.0]),
        ("if(root <= 0.6, 1, 2)", [2.0, 1.0, 1.0]),
        (
            "norm(if(root > 0.6, [1, 0, 0], [0, 2, 0]))",
            [1.0, 2.0, 2.0],
        ),
        ("if(root > 0.6 && root < 3, 1, 2)", [1.0, 2.0, 2.0]),
        ("if(time < 2 s && root > 0.6, 1, 2)", [1.0, 2.0, 2.0]),
        ("if(root > 0.6 || time < 2 s, 1, 2)", [1.0, 1.0, 1.0]),
    ];
    for (output, expected) in cases {
        let scene = scene("0 N", output);
        let compiled = Interpreted::<f64>::new(scene.clone(), &[]).expect("no params");
        let generic = Generic::<f64>::with_defaults(scene).expect("no params");
        for found in [rows(&compiled), rows(&generic)] {
            let before = found.iter().zip(expected);
            for (found, expected) in before.take(3) {
                assert!(
                    (found - expected).abs() < 1e-7,
                    "{output}: {found} {expected}"
                );
            }
            assert!(found[3..].iter().all(|x| x.is_nan()), "{output}: {found:?}");
        }
    }
}

#[test]
fn the_left_condition_guards_the_right_one() {
    for (output, expected) in [
        (
            "if(time < 0.4 s && root > 0.6, 1, 2)",
            [1.0, 2.0, 2.0, 2.0, 2.0],
        ),
        (
            "if(time > 0.4 s || root > 0.6, 1, 2)",
            [1.0, 2.0, 1.0, 1.0, 1.0],
        ),
        (
            "if(time < 0.4 s, root, 3)",
            [0.5_f64.sqrt(), 0.5, 3.0, 3.0, 3.0],
        ),
    ] {
        let model = Interpreted::<f64>::new(scene("0 N", output), &[]).expect("no params");
        assert_eq!(rows(&model), expected, "{output}");
    }
}

#[test]
fn a_force_chosen_by_no_number_ends_the_run() {
    for force in [
        "max(0 N, 1 N * root)",
        "if(root > -1, 1 N, 2 N)",
        "1 N * sign(1 + root)",
    ] {
        for options in [
            Options::rk4(0.01),
            Options::tsit5(1e-8),
            Options::rodas5p(1e-8),
        ] {
            let model = Interpreted::<f64>::new(scene(force, "0"), &[]).expect("no params");
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            let ended = run.run(1.0);
            let why = ended.expect_err("no number acts").to_string();
            assert!(
                why.contains("`push` is not a finite number"),
                "{force}: {why}"
            );
            assert!((run.time() - 0.5).abs() < 0.02, "{force}: {}", run.time());
        }
    }
}

#[test]
fn a_force_that_jumps_on_its_way_to_where_it_has_no_value_is_named_and_no_step_is_too_long() {
    // The root of a place that a constant speed, and a push that begins inside a step, lead beyond zero.
    for (push, steps) in [
        ("-100 N", [0.2, 0.1, 0.05]),
        ("-1e3 N", [0.1, 0.05, 0.02]),
        ("-1e5 N", [0.1, 0.05, 0.01]),
    ] {
        for step in steps {
            let model = Generic::<f64>::with_defaults(read(&format!(
                "model Pushed {{
                    gravity: none;
                    point p {{ mass: 1 kg, start at [0.55, 0, 0] m velocity [-1, 0, 0] m/s }}
                    load push on p = [if(p.position.x < 0.3 m, {push}, 0 N) + 1 N * sqrt(p.position.x / 1 m), 0 N, 0 N];
                }}"
            )))
            .expect("defaults");
            let mut run = Simulation::new(&model, Options::rk4(step)).expect("options");
            let cause = run.run(3.0).expect_err("beyond zero").cause;
            let is_named = matches!(
                &cause,
                StepError::NonFinite { source: Source::Declared(name), .. } if name == "the load `push`"
            );
            assert!(is_named, "{push} {step}: {cause:?}");
        }
    }
    // A stiff spring whose swing grows with every step until the root has no value: that step is too long.
    let model = Generic::<f64>::with_defaults(read(
        "model Swung {
            gravity: none;
            point p { mass: 1 kg, start at [0.1, 0, 0] m }
            load pull on p = [-1e4 N/m * p.position.x, 1 N * sqrt(2 - abs(p.position.x) / 1 m), 0 N];
        }",
    ))
    .expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(0.031)).expect("options");
    let cause = run.run(3.0).expect_err("too long").cause;
    assert!(matches!(cause, StepError::UnstableStep { .. }), "{cause:?}");
}
