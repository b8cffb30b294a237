//! Forces and torques of joints on their children, where springs, stops, motors and threads carry what they carry by hand.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Coordinates, Quantity, Scene};
use tests::assert_close;
use tests::declared::read;

const BOTH: [Coordinates; 2] = [Coordinates::Absolute, Coordinates::Relative];
/// Weight of a kilogram [N].
const G: f64 = 9.81;

/// The last outputs of a scene as it stands at the start.
fn at_rest(scene: &Scene) -> Vec<f64> {
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("a valid scene");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    run.start().expect("a start");
    let mut outputs = vec![0.0; run.model().layout().columns];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("outputs");
    outputs
}

#[test]
fn a_hinge_puts_on_its_arm_what_holds_it_up_whatever_that_is() {
    // 1 kg, its centre of mass 1 m beside the hinge about −y: 9.81 N up and a torque of −9.81 N m about y, whoever gives it.
    for held in [
        "stiffness: 1000 N*m, rest: 0.00981 rad",
        "force: 9.81 N*m",
        "motor: 0 rad",
        "stops: [0.00981 rad, none], stop_stiffness: 1000 N*m",
        "damping: 9.81 N*m*s, force: 19.62 N*m, start_rate: 1 rad/s",
    ] {
        for coordinates in BOTH {
            let scene = read(&format!(
                "model Arm {{ gravity: [0, 0, -9.81] m/s^2;
                   body arm {{ mass: 1 kg, inertia: diag(0.5, 0.5, 0.4) kg*m^2, frame root at [-1, 0, 0] m }}
                   joint pin: hinge from world to arm.root {{ axis: -y, {held} }}
                   output f = pin.force; output t = pin.torque; }}"
            ));
            // What turns at 1 rad/s is pulled inwards.
            let inwards = if held.contains("start_rate") {
                -1.0
            } else {
                0.0
            };
            let want = [inwards, 0.0, G, 0.0, -G, 0.0];
            let found = at_rest(&scene.in_coordinates(coordinates));
            assert_close(&found, &want, 1e-12, 0.0, held);
        }
    }
}

#[test]
fn a_strut_that_rests_on_its_stop_shows_its_load() {
    for coordinates in BOTH {
        let scene = read(
            "model Strut { gravity: [0, 0, -9.81] m/s^2;
               body leg { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
               joint strut: prismatic from world to leg.com {
                 axis: z, stops: [0.01962 m, none], stop_stiffness: 1000 N/m
               }
               output f = strut.force; output t = strut.torque; }",
        );
        let found = at_rest(&scene.in_coordinates(coordinates));
        assert_close(
            &found,
            &[0.0, 0.0, 2.0 * G, 0.0, 0.0, 0.0],
            1e-12,
            0.0,
            "strut",
        );
    }
}

#[test]
fn a_joint_that_holds_nothing_puts_its_springs_on_its_child() {
    let scene = read(
        "model Held { gravity: none;
           body box { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, start at [0.1, 0, 0] m }
           joint soft: cylindrical from world to box.com {
             axis: x, slide: { stiffness: 100 N/m }, angle: { stiffness: 5 N*m, rest: 0.2 rad }
           }
           output f = soft.force; output t = soft.torque; }",
    );
    for coordinates in BOTH {
        let found = at_rest(&scene.clone().in_coordinates(coordinates));
        assert_close(
            &found,
            &[-10.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            1e-12,
            0.0,
            "soft",
        );
    }
}

#[test]
fn a_thread_carries_the_weight_and_the_torque_that_holds_it() {
    // 50 kg on a thread of 20 mm a turn: m g P/2π holds it. The nut pushes up with the weight and turns with the opposite of that torque.
    let torque = 50.0 * G * 0.02 / std::f64::consts::TAU;
    for coordinates in BOTH {
        for (held, own) in [
            (format!("force: {torque} N*m"), true),
            (
                format!("stiffness: 1e3 N*m, rest: {} rad", torque / 1e3),
                true,
            ),
            ("motor: 0 rad".to_owned(), false),
        ] {
            let effort = if own {
                ""
            } else {
                "output m = turn.motor_torque;"
            };
            let scene = read(&format!(
                "model Press {{ gravity: [0, 0, -9.81] m/s^2;
                   body ram {{ mass: 50 kg, inertia: diag(0.5, 0.5, 0.4) kg*m^2 }}
                   joint turn: screw from world to ram.com {{ axis: z, pitch: 20 mm, {held} }}
                   output f = turn.force; output t = turn.torque; {effort} }}"
            ));
            let found = at_rest(&scene.in_coordinates(coordinates));
            // With what turns it the ram is in balance.
            let want = [0.0, 0.0, 50.0 * G, 0.0, 0.0, 0.0, torque];
            assert_close(&found, &want[..found.len()], 1e-12, 1e-9, &held);
        }
    }
}

#[test]
fn a_gear_between_angles_of_threads_tells_a_torque() {
    // The gear turns the ram of the thread above by half the torque of the wheel that nothing else holds.
    let torque = 50.0 * G * 0.02 / std::f64::consts::TAU;
    for coordinates in BOTH {
        let scene = read(
            "model Jack { gravity: [0, 0, -9.81] m/s^2;
               body ram { mass: 50 kg, inertia: diag(0.5, 0.5, 0.4) kg*m^2 }
               body wheel { mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }
               joint turn: screw from world to ram.com { axis: z, pitch: 20 mm }
               joint axle: hinge from world to wheel.com { axis: z, motor: 0 rad }
               joint gears: gear from axle.angle to turn.angle { ratio: 0.5 }
               output f = turn.force; output t = turn.torque;
               output push = gears.force; output couple = gears.torque;
               output m = axle.motor_torque; }",
        );
        let found = at_rest(&scene.in_coordinates(coordinates));
        let want = [
            0.0,
            0.0,
            50.0 * G,
            0.0,
            0.0,
            -torque,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
            torque,
            0.5 * torque,
        ];
        assert_close(&found, &want, 1e-12, 1e-9, "jack");
    }
}
