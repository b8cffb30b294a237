//! A robot that a declaration takes in from URDF, generated: what the interpreter and the laws say of the same scene.

use mbd_runtime::model;
use mbd_scene::Model;
use tests::agreement::agrees;

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
