//! Runs that another model takes over.

use std::f64::consts::PI;

use mbd_runtime::{
    Generic, Handover, Model, Options, PointState, Simulation, StepError, Stop, model,
};
use mbd_scene::Scene;
use tests::declared::read;
use tests::largest_difference;

use super::methods;

model! {
    /// Two stages that are one body until the clamp opens.
    model Stack {
        gravity: none;
        input thrust: force = 5 N;
        body lower {
            mass: 30 kg,
            inertia: diag(5, 5, 1) kg*m^2,
            frame head at [0.0, 0.0, 1.0] m,
            start at [1.0, 2.0, 3.0] m rotated rpy(0.1, 0.2, 0.3) velocity [2.0, 0.0, 50.0] m/s
                angular_velocity [0.2, 0.1, 1.0] rad/s,
        }
        body upper {
            mass: 10 kg,
            inertia: diag(2, 2, 0.5) kg*m^2,
            frame foot at [0.0, 0.0, -1.0] m,
        }
        joint lower_free: free from world to lower.com;
        joint clamp: rigid from lower.head to upper.foot;
        state burnt = 0 s { rate: 1 }
        load push on lower = [thrust, 0.0, 0.0];
        event separated = time rises 1 s { then: stop }
    }
}

model! {
    /// Both stages apart, and a cover of its own that comes off.
    model Apart {
        gravity: none;
        input thrust: force = 1 N;
        body lower { mass: 30 kg, inertia: diag(5, 5, 1) kg*m^2 }
        joint lower_free: free from world to lower.com;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
        point cover { mass: 1 kg }
        state burnt = 0 s { rate: 1 }
        state since = 0 s { rate: 1 }
        load push on lower = [thrust, 0.0, 0.0];
    }
}

model! {
    /// The upper stage alone.
    model Upper {
        gravity: none;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
    }
}

model! {
    /// The same in a plane.
    model Flat {
        planar: xz;
        gravity: none;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
    }
}

#[test]
fn stages_that_separate_into_another_model_keep_their_momentum() {
    let stack = Stack::new(StackParams::default()).expect("defaults");
    let apart = Apart::new(ApartParams::default()).expect("defaults");
    let upper = Upper::new(UpperParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut first = Simulation::new(&stack, options).expect("options that fit");
        assert_eq!(first.run(5.0).expect("a flight"), Stop::Event(0));
        let mut second = Simulation::new(&apart, options).expect("options that fit");
        let cover = [0.0, 0.0, 0.0, 7.0, 8.0, 9.0];
        let handover = second
            .take_over(&mut first, &[("cover", &cover)])
            .expect("a start");
        assert_eq!(handover.carried, ["lower", "upper", "burnt"], "{word}");
        assert_eq!(handover.started, ["cover", "since"], "{word}");
        assert!(handover.dropped.is_empty(), "{word}");
        assert_eq!(second.time(), first.time());
        let [before, after] = handover.momentum;
        for k in 0..3 {
            // The cover is new.
            assert!(
                (after[k] - before[k] - cover[3 + k]).abs() < 1e-13 * 2000.0,
                "{word}"
            );
            assert!(
                (after[3 + k] - before[3 + k]).abs() < 1e-13 * 2000.0,
                "{word}"
            );
        }
        let state = ApartState::from_slice(second.state()).expect("a state");
        assert!(
            (state.burnt() - 1.0).abs() < 1e-12 && state.since() == 0.0,
            "{word}"
        );
        assert_eq!(second.held_inputs(), [5.0], "{word}");
        assert_eq!(
            state.cover(),
            PointState {
                position: [0.0; 3],
                velocity: [7.0, 8.0, 9.0]
            }
        );
        second.run(2.0).expect("a flight");
        let mut third = Simulation::new(&upper, options).expect("options that fit");
        let handover = third.take_over(&mut second, &[]).expect("a start");
        assert_eq!(
            handover.dropped,
            ["lower", "cover", "burnt", "since"],
            "{word}"
        );
        third.run(3.0).expect("a flight");
    }
}

#[test]
fn what_starts_nowhere_or_lies_in_another_plane_is_refused_by_name() {
    let stack = Stack::new(StackParams::default()).expect("defaults");
    let mut first = Simulation::new(&stack, Options::rk4(1e-2)).expect("options that fit");
    first.run(5.0).expect("a flight");
    let apart = Apart::new(ApartParams::default()).expect("defaults");
    let mut second = Simulation::new(&apart, Options::rk4(1e-2)).expect("options that fit");
    let told = |error: mbd_runtime::RunError| error.to_string();
    let error = second
        .take_over(&mut first, &[])
        .expect_err("the cover is nowhere");
    assert!(
        matches!(&error.cause, StepError::StartsNowhere { name, .. } if name == "cover"),
        "{error}"
    );
    let error = told(
        second
            .take_over(&mut first, &[("cover", &[0.0])])
            .expect_err("six numbers"),
    );
    assert!(
        error.contains("`cover`") && error.contains("it has 6"),
        "{error}"
    );
    let error = told(
        second
            .take_over(&mut first, &[("covr", &[0.0])])
            .expect_err("no such thing"),
    );
    assert!(error.contains("did you mean `cover`?"), "{error}");
    let flat = Flat::new(FlatParams::default()).expect("defaults");
    let mut second = Simulation::new(&flat, Options::rk4(1e-2)).expect("options that fit");
    let error = told(
        second
            .take_over(&mut first, &[])
            .expect_err("another plane"),
    );
    assert!(error.contains("plane"), "{error}");
}

model! {
    /// An arm on a mast, in relative coordinates; the wheel turns many times.
    model Arm {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body mast { mass: 4 kg, inertia: diag(1, 1, 0.5) kg*m^2, frame top at [0.0, 0.0, 0.8] m }
        body arm {
            mass: 2 kg,
            inertia: diag(0.1, 0.2, 0.2) kg*m^2,
            frame root at [-0.4, 0.0, 0.0] m,
        }
        joint pin: hinge from world to mast.com { axis: z, start: 10 deg, start_rate: 25 rad/s }
        joint elbow: hinge from mast.top to arm.root { axis: y, start: 20 deg, start_rate: 2 rad/s }
        event reached = time rises 0.4 s { then: stop }
    }
}

model! {
    /// The same bodies; the elbow is a joint of two freedoms.
    model Loose {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body mast { mass: 4 kg, inertia: diag(1, 1, 0.5) kg*m^2, frame top at [0.0, 0.0, 0.8] m }
        body arm {
            mass: 2 kg,
            inertia: diag(0.1, 0.2, 0.2) kg*m^2,
            frame root at [-0.4, 0.0, 0.0] m,
        }
        joint pin: hinge from world to mast.com { axis: z }
        joint elbow: universal from mast.top to arm.root { axes: [y, z] }
    }
}

model! {
    /// The same bodies, the elbow turns about the opposite axis.
    model Reversed {
        coordinates: relative;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body mast { mass: 4 kg, inertia: diag(1, 1, 0.5) kg*m^2, frame top at [0.0, 0.0, 0.8] m }
        body arm {
            mass: 2 kg,
            inertia: diag(0.1, 0.2, 0.2) kg*m^2,
            frame root at [-0.4, 0.0, 0.0] m,
        }
        joint pin: hinge from world to mast.com { axis: z }
        joint elbow: hinge from mast.top to arm.root { axis: [0.0, -1.0, 0.0] }
    }
}

model! {
    /// The same bodies in absolute coordinates.
    model Absolute {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body mast { mass: 4 kg, inertia: diag(1, 1, 0.5) kg*m^2, frame top at [0.0, 0.0, 0.8] m }
        body arm {
            mass: 2 kg,
            inertia: diag(0.1, 0.2, 0.2) kg*m^2,
            frame root at [-0.4, 0.0, 0.0] m,
        }
        joint pin: hinge from world to mast.com { axis: z }
        joint elbow: hinge from mast.top to arm.root { axis: y }
    }
}

model! {
    /// What was burnt is a mass here.
    model Burning {
        gravity: none;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
        state burnt = 0 kg { rate: 1 kg/s }
    }
}

model! {
    /// What pushed is a torque here.
    model Pushed {
        gravity: none;
        input thrust: torque = 1 N*m;
        body upper { mass: 10 kg, inertia: diag(2, 2, 0.5) kg*m^2 }
        joint upper_free: free from world to upper.com;
        load push on upper = [thrust / 1 m, 0.0, 0.0];
    }
}

#[test]
fn states_and_inputs_that_measure_something_else_are_refused_by_name() {
    let stack = Stack::new(StackParams::default()).expect("defaults");
    let mut first = Simulation::new(&stack, Options::rk4(1e-2)).expect("options that fit");
    first.run(5.0).expect("a flight");
    let unlike = |error: mbd_runtime::RunError, wanted: &str| {
        assert!(
            matches!(&error.cause, StepError::Unplaced { name, why } if name == wanted && why.contains("is measured in")),
            "{error}"
        );
    };
    let burning = Burning::new(BurningParams::default()).expect("defaults");
    let mut second = Simulation::new(&burning, Options::rk4(1e-2)).expect("options that fit");
    let error = second.take_over(&mut first, &[]);
    unlike(error.expect_err("seconds are no kilograms"), "burnt");
    // A state that is given does not go on under its name.
    let given = second.take_over(&mut first, &[("burnt", &[3.0])]);
    assert_eq!(given.expect("a start").started, ["burnt"]);
    let state = BurningState::from_slice(second.state()).expect("a state");
    assert!(state.burnt() == 3.0);
    let pushed = Pushed::new(PushedParams::default()).expect("defaults");
    let mut second = Simulation::new(&pushed, Options::rk4(1e-2)).expect("options that fit");
    let error = second.take_over(&mut first, &[]);
    unlike(error.expect_err("newtons are no torques"), "thrust");
}

#[test]
fn joints_of_a_tree_go_on_where_their_bodies_are_whatever_their_law() {
    let arm = Arm::new(ArmParams::default()).expect("defaults");
    let loose = Loose::new(LooseParams::default()).expect("defaults");
    let reversed = Reversed::new(ReversedParams::default()).expect("defaults");
    let absolute = Absolute::new(AbsoluteParams::default()).expect("defaults");
    for options in [Options::rk4(1e-3), Options::tsit5(1e-12)] {
        let start = |model: &dyn Model<f64>| Simulation::new(model, options).expect("options");
        let mut first = start(&arm);
        assert_eq!(first.run(5.0).expect("a flight"), Stop::Event(0));
        let was = ArmState::from_slice(first.state()).expect("a state");
        let (pin, elbow) = (was.pin(), was.elbow());
        assert!(
            pin.coordinates[0] > 2.0 * PI && elbow.coordinates[0].abs() > 0.01,
            "{pin:?} {elbow:?}"
        );
        let same = |[before, after]: [f64; 2]| {
            assert!(
                (before - after).abs() < 1e-10 * (1.0 + before.abs()),
                "{before} {after}"
            );
        };
        let unchanged = |handover: &Handover| {
            let [before, after] = handover.momentum;
            before.iter().zip(after).for_each(|(a, b)| same([*a, b]));
            let [before, after] = handover.energies.map(|own| own.expect("uniform gravity"));
            before.iter().zip(after).for_each(|(a, b)| same([*a, b]));
        };
        // The same joints: the same numbers, turns among them.
        let mut again = start(&arm);
        let handover = again.take_over(&mut first, &[]).expect("a start");
        unchanged(&handover);
        assert_eq!(handover.carried, ["mast", "arm"]);
        assert!(handover.dropped.is_empty() && handover.started.is_empty());
        assert_eq!(again.state(), first.state());
        // A joint of the same name with another law: its bodies are where they were, its numbers are others.
        let mut second = start(&loose);
        unchanged(&second.take_over(&mut first, &[]).expect("a start"));
        let state = LooseState::from_slice(second.state()).expect("a state");
        let (positions, speeds) = (state.elbow().coordinates, state.elbow().speeds);
        same([positions[0], elbow.coordinates[0]]);
        same([speeds[0], elbow.speeds[0]]);
        assert!(positions[1].abs() < 1e-10 && speeds[1].abs() < 1e-10);
        assert_eq!(state.pin().coordinates, pin.coordinates);
        let mut second = start(&reversed);
        unchanged(&second.take_over(&mut first, &[]).expect("a start"));
        let state = ReversedState::from_slice(second.state()).expect("a state");
        same([state.elbow().coordinates[0], -elbow.coordinates[0]]);
        same([state.elbow().speeds[0], -elbow.speeds[0]]);
        // To absolute coordinates and back.
        let mut second = start(&absolute);
        unchanged(&second.take_over(&mut first, &[]).expect("a start"));
        let mut third = start(&arm);
        unchanged(&third.take_over(&mut second, &[]).expect("a start"));
        let state = ArmState::from_slice(third.state()).expect("a state");
        same([state.elbow().coordinates[0], elbow.coordinates[0]]);
        same([state.elbow().speeds[0], elbow.speeds[0]]);
        same([state.pin().speeds[0], pin.speeds[0]]);
    }
}

const FAMILIES: [[&str; 2]; 4] = [
    ["absolute", "absolute"],
    ["relative", "relative"],
    ["absolute", "relative"],
    ["relative", "absolute"],
];

/// Two bodies with what joins them, how the first starts, and what more is said of the second.
fn two_bodies(family: &str, [start, comes]: [&str; 2], joints: &str) -> Scene {
    read(&format!(
        "model Two {{ gravity: none; coordinates: {family};
            body a {{ mass: 5 kg, inertia: diag(1, 2, 3) kg*m^2, frame tip at [0.5, 0, 0] m, start at {start} }}
            body b {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame root at [-0.3, 0, 0] m {comes} }}
            joint a_free: free from world to a.com;
            {joints}
            output a_v = a.velocity; output a_w = a.omega_world; output b_v = b.velocity; output b_w = b.omega_world; }}"
    ))
}

/// A run of a scene that has not begun.
fn begin(scene: &Scene) -> Simulation<f64> {
    let model = Generic::new(scene.clone(), &[]).expect("a scene");
    Simulation::new(&model, Options::tsit5(1e-9)).expect("options")
}

/// A run of the second scene that takes over from one of the first at once.
fn goes_on(first: &Scene, second: &Scene, given: &[(&str, &[f64])]) -> (Simulation<f64>, Handover) {
    let (mut first, mut second) = (begin(first), begin(second));
    let handover = second.take_over(&mut first, given).expect("a start");
    (second, handover)
}

/// Velocities and angular velocities of both bodies.
fn velocities(run: &mut Simulation<f64>) -> Vec<f64> {
    let names = ["a_v", "a_w", "b_v", "b_w"];
    let each = names
        .iter()
        .flat_map(|name| ["x", "y", "z"].map(|k| format!("{name}.{k}")));
    each.map(|name| run.output(&name).expect("a component"))
        .collect()
}

#[test]
fn bodies_that_meet_on_a_hinge_of_the_next_scene_share_their_momentum_in_both_families() {
    // b comes with 1 m/s across: impulse J at the hinge, 5 v = J, 3 w = J/2, u + 1 = −J, 0.3 s = −0.3 J, v + w/2 = u − 0.3 s.
    let impulse = -1.0 / (1.0 / 5.0 + 0.25 / 3.0 + 1.0 + 0.3);
    let exact = [impulse / 5.0, 0.5 * impulse / 3.0, -1.0 - impulse, impulse];
    for [family, next] in FAMILIES {
        let flying = "joint b_free: free from world to b.com; ";
        let comes = ", start at [0.8, 0, 0] m velocity [0, -1, 0] m/s";
        let first = two_bodies(family, ["[0, 0, 0] m", comes], flying);
        let hinge = "joint pin: hinge from a.tip to b.root { axis: z }";
        let second = two_bodies(next, ["[9, 9, 9] m", ""], hinge);
        let (mut run, handover) = goes_on(&first, &second, &[]);
        let found = velocities(&mut run);
        for (found, exact) in [1, 5, 7, 11].map(|k| found[k]).into_iter().zip(exact) {
            assert!(
                (found - exact).abs() < 1e-12,
                "{family} {next}: {found} {exact}"
            );
        }
        let [before, after] = handover.momentum;
        for k in 0..6 {
            assert!((before[k] - after[k]).abs() < 1e-12, "{family} {next} {k}");
        }
    }
}

#[test]
fn a_joint_that_loses_a_freedom_in_the_next_scene_takes_its_motion_by_an_impulse_in_both_families()
{
    let start = "[1, 2, 3] m rotated rpy(0.3, 0.2, 0.1) velocity [0.4, 0.5, 0.6] m/s angular_velocity [0.1, 0.2, 0.3] rad/s";
    let universal = "joint pin: universal from a.tip to b.root { axes: [x, z], angle1: { start_rate: 0.7 rad/s }, angle2: { start: 40 deg, start_rate: -0.4 rad/s } }";
    let hinge = "joint pin: hinge from a.tip to b.root { axis: z }";
    let mut all = Vec::new();
    for [family, next] in FAMILIES {
        let first = two_bodies(family, [start, ""], universal);
        let second = two_bodies(next, [start, ""], hinge);
        let (mut run, handover) = goes_on(&first, &second, &[]);
        let [before, after] = handover.momentum;
        for k in 0..6 {
            assert!((before[k] - after[k]).abs() < 1e-11, "{family} {next} {k}");
        }
        let [before, after] = handover.energies.map(|own| own.expect("no gravity")[0]);
        assert!(after < before - 1e-3, "{family} {next}: {before} {after}");
        all.push(velocities(&mut run));
    }
    for found in &all[1..] {
        assert!(
            largest_difference(found, &all[0]) < 1e-11,
            "{found:?} {:?}",
            all[0]
        );
    }
}

#[test]
fn a_body_that_the_caller_gives_begins_there_where_a_joint_of_a_tree_carries_it() {
    let hinge = "joint pin: hinge from a.tip to b.root { axis: z } output angle = pin.angle; output rate = pin.angle_rate;";
    let first = two_bodies("absolute", ["[0, 0, 0] m", ""], hinge);
    for family in ["absolute", "relative"] {
        let second = two_bodies(family, ["[0, 0, 0] m", ""], hinge);
        let (s, c) = 0.7_f64.sin_cos();
        let (half_s, half_c) = 0.35_f64.sin_cos();
        // At 0.7 rad, with 2 rad/s.
        let given = [
            0.5 + 0.3 * c,
            0.3 * s,
            0.0,
            half_c,
            0.0,
            0.0,
            half_s,
            -0.6 * s,
            0.6 * c,
            0.0,
            0.0,
            0.0,
            2.0,
        ];
        let (mut run, handover) = goes_on(&first, &second, &[("b", &given)]);
        assert_eq!(handover.started, ["b"], "{family}");
        assert_eq!(handover.carried, ["a"], "{family}");
        for (name, exact) in [("angle", 0.7), ("rate", 2.0)] {
            let found = run.output(name).expect("an output");
            assert!((found - exact).abs() < 1e-12, "{family} {name}: {found}");
        }
    }
}

#[test]
fn a_new_body_begins_where_its_joint_does_on_one_that_goes_on_in_both_families() {
    let start = "[1, 2, 3] m rotated rpy(0.3, 0.2, 0.1) velocity [0.4, 0.5, 0.6] m/s angular_velocity [0.1, 0.2, 0.3] rad/s";
    // b hangs on a, which goes on, and c on b, which is new as well.
    let joints = "body c { mass: 2 kg, inertia: diag(0.3, 0.2, 0.1) kg*m^2, frame root at [0, 0.2, 0] m }
        joint pin: universal from a.tip to b.root { axes: [x, z], angle2: { start: 40 deg, start_rate: -0.4 rad/s } }
        joint slider: prismatic from b.com to c.root { axis: y, start: 0.3 m, start_rate: 0.2 m/s }
        output angle1 = pin.angle1; output angle = pin.angle2; output rate = pin.angle2_rate;
        output slide = slider.slide; output slide_rate = slider.slide_rate;";
    let first = read(&format!(
        "model One {{ gravity: none; body a {{ mass: 5 kg, inertia: diag(1, 2, 3) kg*m^2, start at {start} }} joint a_free: free from world to a.com; }}"
    ));
    let said = [
        ("angle1", 0.0),
        ("angle", 40_f64.to_radians()),
        ("rate", -0.4),
        ("slide", 0.3),
        ("slide_rate", 0.2),
    ];
    let mut all = Vec::new();
    for family in ["absolute", "relative"] {
        let second = two_bodies(family, ["[9, 9, 9] m", ""], joints);
        let (mut run, handover) = goes_on(&first, &second, &[]);
        assert_eq!(handover.carried, ["a"], "{family}");
        assert_eq!(handover.started, ["b", "c"], "{family}");
        let moved = run.start_moved().iter();
        let moved: f64 = moved.map(|it| it.distance + it.angle + it.velocity).sum();
        assert!(moved < 1e-12, "{family} {moved}");
        for (name, exact) in said {
            let found = run.output(name).expect("an output");
            assert!((found - exact).abs() < 1e-12, "{family} {name}: {found}");
        }
        // What goes on is not moved by what comes.
        let found = run.output("a_v.y").expect("a component");
        assert!((found - 0.5).abs() < 1e-12, "{family}: {found}");
        run.run(1.0).expect("a flight");
        all.push(velocities(&mut run));
    }
    assert!(largest_difference(&all[0], &all[1]) < 1e-7, "{all:?}");
    // A joint that says nothing of its coordinate holds it anywhere.
    let joint = "joint pin: hinge from a.tip to b.root { axis: z }";
    let second = two_bodies("absolute", ["[9, 9, 9] m", ""], joint);
    let error = begin(&second).take_over(&mut begin(&first), &[]);
    let error = error.expect_err("b is nowhere");
    let nowhere = matches!(&error.cause, StepError::StartsNowhere { name, .. } if name == "b");
    assert!(nowhere, "{error}");
}

#[test]
fn what_joints_of_the_next_scene_move_is_told_in_both_families() {
    let flying = "joint b_free: free from world to b.com; ";
    let hinge = "joint pin: hinge from a.tip to b.root { axis: z }";
    for [family, next] in FAMILIES {
        // b is at the origin; the hinge holds it 0.8 m from there.
        let first = two_bodies(family, ["[0, 0, 0] m", ""], flying);
        let second = two_bodies(next, ["[0, 0, 0] m", ""], hinge);
        let (run, _) = goes_on(&first, &second, &[]);
        let moved: f64 = run.start_moved().iter().map(|it| it.distance).sum();
        assert!((moved - 0.8).abs() < 0.1, "{family} {next}: {moved}");
        // And nothing where they hold already.
        let (run, _) = goes_on(&second, &second, &[]);
        assert!(run.start_moved().is_empty(), "{family} {next}");
    }
}
