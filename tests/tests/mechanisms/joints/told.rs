//! What a run tells beside its numbers: reactions that are not unique or have no value.

use mbd_runtime::{Content, External, Generic, NoLoads, Options, Sampling, Simulation, Trajectory};
use mbd_scene::joints::JointForces;
use mbd_scene::{Formula, Function};
use nalgebra::Vector3;
use tests::declared::read;
use tests::linkage::{Linkage, cranks};
use tests::{assert_close, largest_difference};

fn record<E: External<f64> + Send + 'static>(
    model: &Generic<f64>,
    (options, loads): (Options, E),
    state: &[f64],
    until: f64,
) -> Trajectory {
    let mut run = Simulation::with_loads(model, options, loads).expect("options that fit");
    run.set_state(0.0, state).expect("a valid state");
    let mut history = Trajectory::new(model, Sampling::Steps, Content::ALL);
    run.record(until, &mut history)
        .unwrap_or_else(|error| panic!("{error}"));
    history
}

/// Two cranks and a bar at an angle, a pendulum beside them.
fn beside(angle: f64) -> Linkage {
    let mut linkage = cranks(2, &[&[2, 3]], angle, 2.0, 9.81);
    let at = Vector3::new(7.0, 0.0, 0.0);
    let bob = linkage.body(1.3, [0.1, 0.2, 0.15], at);
    linkage.pin(
        [None, Some(bob)],
        at + Vector3::new(0.4, 0.3, 0.0),
        Vector3::z(),
    );
    linkage
}

#[test]
fn reactions_in_passing_a_singular_position_have_the_value_they_tend_to() {
    let linkage = beside(0.0);
    let model = Generic::<f64>::with_defaults(linkage.scene.clone()).expect("a valid scene");
    let options = Options::rk4(1e-3);
    let history = record(&model, (options, NoLoads), &linkage.state(), 5e-3);
    assert_eq!(
        (history.undetermined, history.statistics.rows_strategy),
        (0, 2)
    );
    // Each crank carries itself and half of the bar around: 1 kg · 4/s² · (0.5 m + 0.5 · 1 m) at its root, the bar's half at its tip. And
    // weight turns them by −2 · 9.81 N m / (5/3 kg m²): the bar falls by more than its weight, −1.962 N on two tips.
    for (joint, along, across) in [
        (0, -4.0, 2.943),
        (1, -4.0, 2.943),
        (2, -2.0, -0.981),
        (3, -2.0, -0.981),
    ] {
        for (part, want) in [("force.x", along), ("force.y", across), ("force.z", 0.0)] {
            let name = format!("hinge{joint}.{part}");
            let found = history.column(&name).expect("a column")[0];
            println!("{name}: {found}, off {:e}", found - want);
            assert!((found - want).abs() < 1e-5, "{name}: {found}");
        }
    }
}

#[test]
fn reactions_without_a_value_are_empty_and_those_beside_them_are_not() {
    let options = Options::rk4(1e-3);
    // Flat and at rest, but for the pendulum; then weight bends it.
    let mut rest = beside(0.0);
    for body in &mut rest.bodies {
        (body.velocity, body.omega) = (Vector3::zeros(), Vector3::zeros());
    }
    let flat = Generic::<f64>::with_defaults(rest.scene.clone()).expect("a valid scene");
    let history = record(&flat, (options, NoLoads), &rest.state(), 5e-3);
    assert_eq!((history.len(), history.undetermined > 0), (6, true));
    let column = |name: &str| history.column(name).expect("a column").to_vec();
    for joint in ["hinge0", "hinge1", "hinge2", "hinge3"] {
        let force = column(&format!("{joint}.force.y"));
        println!("{force:?}");
        assert!(force[0].is_nan(), "{force:?}");
    }
    // The pendulum feels nothing of it.
    let bent = Generic::<f64>::with_defaults(beside(0.5).scene).expect("a valid scene");
    let other = record(&bent, (options, NoLoads), &beside(0.5).state(), 5e-3);
    assert_eq!(other.undetermined, 0);
    for part in [
        "force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z",
    ] {
        let name = format!("hinge4.{part}");
        let want = other.column(&name).expect("a column");
        assert_close(&column(&name), want, 1e-12, 1e-12, &name);
    }
    assert!(largest_difference(&column("hinge4.force.x"), &[0.0; 6]) > 1.0);
    let mut csv = Vec::new();
    history.to_csv(&mut csv).expect("a vector takes everything");
    let csv = String::from_utf8(csv).expect("text");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let head = csv.lines().next().expect("a header");
    for column in [
        "hinge0.force.z [N; not unique]",
        "hinge0.force.x [N]",
        "hinge4.force.z [N]",
    ] {
        assert!(head.contains(column), "{column}: {head}");
    }
    assert!(lines[1].contains(&"") && !csv.contains("NaN"));
}

/// rate · time.
fn steady(rate: f64) -> Formula {
    Formula::Apply(Function::Mul, vec![Formula::Number(rate), Formula::Time])
}

#[test]
fn a_motor_drives_through_positions_at_which_rows_lose_rank_and_its_power_is_known_there() {
    // Half round from the flat position, driven at the first crank; and from half a step before it, with a stage on it.
    for start in [0.0, -2.0 * (0.5 * 0.5 * 2.0 * 5e-3f64).atan()] {
        let mut linkage = cranks(2, &[&[2, 3]], start, 2.0, 9.81);
        linkage.scene.joints[0].forces = vec![JointForces {
            motor: Some(steady(2.0)),
            ..JointForces::default()
        }];
        let scene = linkage.scene.clone();
        let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
        let options = Options {
            work: true,
            ..Options::rk4(5e-3)
        };
        let history = record(&model, (options, NoLoads), &linkage.state(), 3.2);
        let column = |name: &str| history.column(name).expect("a column").to_vec();
        let (energy, power) = (column("energy.total"), column("power.drives"));
        let mut most = [0.0f64; 2];
        for (k, time) in history.times().iter().enumerate() {
            // Two cranks with their weight half way out, a bar all the way: 2 kg m in all.
            let angle = start + 2.0 * time;
            let lifted = 2.0 * 9.81 * (angle.sin() - start.sin());
            most[0] = most[0].max((energy[k] - energy[0] - lifted).abs());
            most[1] = most[1].max((power[k] - 4.0 * 9.81 * angle.cos()).abs());
        }
        println!(
            "{start}: energy {:e}, power {:e}, strategy {}",
            most[0], most[1], history.statistics.rows_strategy
        );
        assert!(most[0] < 1e-9 && most[1] < 1e-4, "{most:?}");
        assert_eq!(
            (history.undetermined, history.statistics.rows_strategy > 1),
            (0, true)
        );
    }
}

#[test]
fn outputs_and_metrics_of_reactions_without_a_value_are_told_why() {
    // Two equal cranks and a bar in one line, at rest: nothing says which of the hinges carry.
    let arm = |name: &str| {
        format!(
            "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame one at [0, 0, -0.5] m, frame two at [0, 0, 0.5] m }}"
        )
    };
    let scene = read(&format!(
        "model Flat {{ gravity: none; world {{ frame far at [2, 0, 0] m }} {} {}
         body bar {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame one at [-1, 0, 0] m, frame two at [1, 0, 0] m }}
         joint a: hinge from world to left.one {{ axis: y, start: 90 deg }}
         joint b: hinge from left.two to bar.one {{ axis: y, start: -90 deg }}
         joint c: hinge from bar.two to right.two {{ axis: y }}
         joint d: hinge from world.far to right.one {{ axis: y }}
         output pull = a.force.x; output over = (1 rad/s) / a.angle_rate; metric top = max pull; }}",
        arm("left"),
        arm("right")
    ));
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options that fit");
    let mut history = Trajectory::new(&model, Sampling::Steps, Content::RESULTS);
    run.record(0.1, &mut history).expect("a run");
    let told: Vec<(&str, bool)> = history
        .not_finite()
        .iter()
        .map(|it| (it.name, it.undetermined))
        .collect();
    assert_eq!(told, [("pull", true), ("over", false)]);
    let error = history.metric("top").expect_err("no value").to_string();
    assert!(
        error.contains("what joints carry has no value at 0 s"),
        "{error}"
    );
    assert!(
        error.contains("rows of joints lose rank in this position"),
        "{error}"
    );
}
