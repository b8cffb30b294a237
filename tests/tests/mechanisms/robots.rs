//! A robot that a declaration takes in from URDF, generated: what the interpreter and the laws say of the same scene. An arm that motors carry.

use mbd_runtime::{Generic, Options, Simulation, model};
use mbd_scene::{Model, Quantity};
use tests::agreement::agrees;
use tests::declared::read;

model! {
    /// The arm with a drive in its shoulder and a cord at its forearm.
    pub model Arm<T> {
        urdf: "../mbd-macros/compiler/tests/urdf/arm.urdf" { slide: { stop_stiffness: 5 kN/m } }
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame peg at [1.0, 0.0, 1.0] m }
        input drive: torque;
        extend shoulder { force: drive, start: 20 deg }
        extend fore { frame hook at [0.0, 0.0, 0.1] m }
        spring cord from world.peg to fore.hook { free_length: 0.5 m, stiffness: 100 N/m }
        output reach = wrist.camera.position;
    }
}

#[test]
fn the_generated_model_of_a_robot_is_that_of_the_laws() {
    let arm = Arm::<f64>::new(ArmParams::default()).expect("no params");
    assert_eq!(arm.layout().freedoms(), 4);
    agrees(&arm);
    let single = Arm::<f32>::new(ArmParams::default()).expect("no params");
    assert_eq!(single.layout().nv, arm.layout().nv);
}

#[test]
fn motors_that_carry_the_weight_of_an_arm_hold_it_until_their_power_is_cut() {
    let text = include_str!("../../../models/scenes/arm.mbd");
    let (declaration, _) = text.split_once("\n[run]").expect("settings of a run");
    let hand_after = |jog: &str, until: f64| {
        let scene = read(&declaration.replace("= 6 N*m", jog));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options");
        run.run(until).expect("a motion");
        let mut outputs = vec![0.0; model.layout().len(Quantity::Outputs)];
        run.evaluate(Quantity::Outputs, &mut outputs)
            .expect("outputs");
        <[f64; 3]>::try_from(&outputs[..3]).expect("the place of the hand")
    };
    let start = hand_after("= 0 N*m", 1e-6);
    let held = hand_after("= 0 N*m", 0.999);
    for (held, start) in held.iter().zip(start) {
        assert!((held - start).abs() < 1e-9, "{held} {start}");
    }
    let moved = hand_after("= 6 N*m", 0.999);
    assert!(
        moved[2] > start[2] + 0.01,
        "the input lifts it: {moved:?} {start:?}"
    );
    let fallen = hand_after("= 0 N*m", 1.5);
    assert!(fallen[2] < start[2] - 0.1, "it falls: {fallen:?} {start:?}");
}
