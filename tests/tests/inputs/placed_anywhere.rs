//! Starts hold whatever the size of a mechanism, wherever it is, and whatever its inputs are.

use mbd_compiler::read_text;
use mbd_runtime::scene::Scene;
use mbd_runtime::{Generic, Options, Quantity, Simulation};

const FAMILIES: [&str; 2] = ["absolute", "relative"];

fn scene(text: &str) -> Scene {
    let read = read_text(text);
    read.scene.unwrap_or_else(|| panic!("{:?}", read.errors))
}

/// The outputs at the start, with these inputs.
fn outputs(scene: &Scene, inputs: &[f64]) -> Vec<f64> {
    let model = Generic::with_defaults(scene.clone()).expect("defaults");
    let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a model that runs");
    run.set_inputs(&inputs.to_vec()).expect("inputs");
    run.start().expect("a start");
    let mut outputs = vec![0.0; run.model().layout().columns];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    outputs
}

/// A four-bar of a size, its crank at −1 rad and 2 rad/s.
fn four_bar(family: &str, size: f64) -> Scene {
    let [a, b, c, d] = [0.25, 0.7, 0.5, 1.5].map(|x| x * size);
    let moments = |x: f64| x * size * size;
    scene(&format!(
        "model F {{ coordinates: {family}; gravity: [0, 0, {g:e}] m/s^2;
            world {{ frame g at [{d:e}, 0, 0] m }}
            body c {{ mass: 1 kg, inertia: diag({i:e}, {i:e}, {i:e}) kg*m^2, frame r at [-{a:e}, 0, 0] m, frame t at [{a:e}, 0, 0] m }}
            body k {{ mass: 2 kg, inertia: diag({j:e}, {j:e}, {j:e}) kg*m^2, frame r at [-{b:e}, 0, 0] m, frame t at [{b:e}, 0, 0] m }}
            body o {{ mass: 1 kg, inertia: diag({j:e}, {j:e}, {j:e}) kg*m^2, frame r at [-{c:e}, 0, 0] m, frame t at [{c:e}, 0, 0] m }}
            joint a: hinge from world to c.r {{ axis: y, start: -1 rad, start_rate: 2 rad/s }}
            joint b: hinge from c.t to k.r {{ axis: y, start: about 60 deg }}
            joint d: hinge from world.g to o.r {{ axis: y }}
            joint e: hinge from k.t to o.t {{ axis: y }}
            output crank = a.angle;
            output rate = a.angle_rate;
            output rocker = d.angle;
            output rocker_rate = d.angle_rate; }}",
        g = -9.81 * size,
        i = moments(0.02),
        j = moments(0.3),
    ))
}

#[test]
fn a_loop_closes_at_the_start_that_is_said_whatever_its_size() {
    let exact = outputs(&four_bar("absolute", 1.0), &[]);
    assert!(
        (exact[0] + 1.0).abs() < 1e-10 && (exact[1] - 2.0).abs() < 1e-10,
        "{exact:?}"
    );
    for family in FAMILIES {
        for size in [1e-9, 1e-6, 1e-3, 1e3, 1e6] {
            let found = outputs(&four_bar(family, size), &[]);
            for (found, exact) in found.iter().zip(&exact) {
                assert!(
                    (found - exact).abs() < 1e-9,
                    "{family} {size}: {found} {exact}"
                );
            }
        }
    }
}

#[test]
fn a_joint_starts_as_said_far_from_the_origin() {
    for family in FAMILIES {
        for (far, origin) in [("7e6", "origin: follows a;"), ("7e6", ""), ("2e3", "")] {
            let found = outputs(
                &scene(&format!(
                    "model Sat {{ coordinates: {family}; gravity: none; {origin}
                        body a {{ mass: 2 kg, inertia: diag(0.2, 0.3, 0.25) kg*m^2, frame r at [0.1, 0.2, 0.5] m,
                            start at [{far}, 300, 700] m rotated rpy(0.1, 0.2, 0.3) }}
                        body b {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame r at [0.05, 0, 0.4] m }}
                        joint f: free from world to a.com
                        joint u: hinge from a.r to b.r {{ axis: y, start: 0.4 rad, start_rate: 0.3 rad/s }}
                        output angle = u.angle;
                        output rate = u.angle_rate; }}"
                )),
                &[],
            );
            assert!((found[0] - 0.4).abs() < 1e-8, "{family} {far} {found:?}");
            assert!((found[1] - 0.3).abs() < 1e-8, "{family} {far} {found:?}");
        }
    }
}

#[test]
fn what_hangs_on_a_motor_starts_as_said_wherever_its_input_has_it() {
    for family in FAMILIES {
        let scene = scene(&format!(
            "model F {{ coordinates: {family}; gravity: none;
                input hold: angle = 0 rad;
                body c {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame t at [0, 0, -1] m }}
                body k {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame r at [0, 0, 1] m }}
                joint a: hinge from world to c.com {{ axis: y, motor: [hold, 0 rad/s, 0 rad/s^2] }}
                joint d: hinge from c.t to k.r {{ axis: y, start: 0.4 rad }}
                output held = a.angle;
                output hangs = d.angle; }}"
        ));
        for hold in [0.0, 1.0, -2.5] {
            let found = outputs(&scene, &[hold]);
            assert!((found[0] - hold).abs() < 1e-12, "{family} {found:?}");
            assert!((found[1] - 0.4).abs() < 1e-12, "{family} {found:?}");
        }
        // Where joint coordinates are set, they hold, too.
        let model = Generic::with_defaults(scene).expect("defaults");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a model");
        run.set_joints(&[("d.angle", 0.7)]).expect("a coordinate");
        run.set_inputs(&[1.0]).expect("an input");
        let mut found = [0.0; 2];
        run.evaluate(Quantity::Outputs, &mut found)
            .expect("outputs");
        assert!(
            (found[0] - 1.0).abs() < 1e-12 && (found[1] - 0.7).abs() < 1e-12,
            "{found:?}"
        );
    }
}

#[test]
fn stops_that_a_start_is_beyond_are_told_with_what_they_push() {
    for family in FAMILIES {
        let scene = scene(&format!(
            "model Arm {{ coordinates: {family}; gravity: none;
                body arm {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame top at [0, 0, 1] m }}
                joint pin: hinge from world to arm.top {{ axis: y, start: 1 rad, stops: [-0.5, 0.7] rad, stop_stiffness: 200 N*m/rad }} }}"
        ));
        let model = Generic::with_defaults(scene).expect("defaults");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a model");
        run.start().expect("a start");
        let [passed] = run.starts_beyond_stops() else {
            panic!("{:?}", run.starts_beyond_stops());
        };
        assert_eq!(passed.name, "pin.angle high stop");
        assert!(
            (passed.depth - 0.3).abs() < 1e-12 && passed.is_angle,
            "{passed:?}"
        );
        assert!((passed.push - 60.0).abs() < 1e-9, "{passed:?}");
        assert!(
            passed.travel.is_some_and(|it| (it - 1.2).abs() < 1e-12),
            "{passed:?}"
        );
        run.set_joints(&[("pin.angle", 0.2)]).expect("a coordinate");
        run.start().expect("a start");
        assert!(run.starts_beyond_stops().is_empty());
    }
}

#[test]
fn a_joint_in_a_plane_begins_with_the_turns_that_its_bodies_are_said_to_have() {
    // The axis along the normal, and against it; between two bodies.
    let scene = scene(
        "model Rods { planar: xz; gravity: none;
            world { frame back at [0, 0, 0] m rotated about(z, 180 deg) }
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame back at [0, 0, 0] m rotated about(z, 180 deg) }
            body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
            joint pin: hinge from world.back to a.back { axis: y }
            joint next: hinge from a.com to b.com { axis: y }
            output of_pin = pin.angle;
            output of_next = next.angle; }",
    );
    let model = Generic::with_defaults(scene).expect("defaults");
    let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a model");
    let turn = std::f64::consts::TAU;
    let mut state = run.state().to_vec();
    (state[2], state[5]) = (2.0 * turn + 0.5, -turn + 0.1);
    run.set_state(0.0, &state).expect("a state");
    let mut found = [0.0; 2];
    run.evaluate(Quantity::Outputs, &mut found)
        .expect("outputs");
    // Half a turn about z turns y around: the angle counts the other way.
    let wanted = [-(2.0 * turn + 0.5), -3.0 * turn - 0.4];
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    }
}

/// Attitudes of 170° and −170° are 20° apart. In a plane the hinge between them began at −340°, and its spring held 176 J in place of 0.6 J.
#[test]
fn a_joint_between_attitudes_on_either_side_of_half_a_turn_begins_alike_in_a_plane_and_in_space() {
    let apart = |plane: &str, attitude: [i32; 2]| {
        let scene = scene(&format!(
            "model Rods {{ {plane} gravity: none;
                body a {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [0, 0, 0] m rotated about(z, {} deg) }}
                body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [0, 0, 0] m rotated about(z, {} deg) }}
                joint floats: free from world to a.com;
                joint next: hinge from a.com to b.com {{ axis: z, stiffness: 10 N*m/rad }}
                output of_next = next.angle; }}",
            attitude[0], attitude[1]
        ));
        let model = Generic::with_defaults(scene).expect("defaults");
        let mut run = Simulation::<f64>::new(&model, Options::rk4(1e-3)).expect("a model");
        run.start().expect("a start");
        let mut found = [0.0];
        run.evaluate(Quantity::Outputs, &mut found)
            .expect("outputs");
        found[0].to_degrees()
    };
    for plane in ["planar: xy;", ""] {
        for (attitude, wanted) in [
            ([170, -170], 20.0),
            ([-170, 170], -20.0),
            ([100, -20], -120.0),
        ] {
            let found = apart(plane, attitude);
            assert!(
                (found - wanted).abs() < 1e-9,
                "{plane} {attitude:?}: {found}"
            );
        }
    }
}
