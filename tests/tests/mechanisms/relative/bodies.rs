//! From where bodies are to the coordinates of joints and back, by the functions of generated models.

use mbd_runtime::{Options, Simulation};
use mbd_scene::Model;

use super::generated::{Arm, ArmInputs, ArmParams, ArmState, Flat, FlatParams, FlatState};
use super::generated::{Walker, WalkerParams, WalkerState};

/// By how much two states differ at most, a quaternion and its opposite the same.
fn apart(one: &[f64], other: &[f64], quaternions: &[usize]) -> f64 {
    let mut other = other.to_vec();
    for &at in quaternions {
        let dot: f64 = (at..at + 4).map(|k| one[k] * other[k]).sum();
        other[at..at + 4]
            .iter_mut()
            .for_each(|x| *x *= dot.signum());
    }
    let each = one.iter().zip(&other).map(|(a, b)| (a - b).abs());
    each.fold(0.0, f64::max)
}

/// A state of a model after some time, its joints set.
fn moved(model: &impl Model<f64>, joints: &[(&str, f64)]) -> Vec<f64> {
    let mut run = Simulation::new(model, Options::tsit5(1e-9)).expect("a run");
    run.set_joints(joints).expect("joints");
    run.run(0.4).expect("a motion");
    run.state().to_vec()
}

#[test]
fn joints_are_where_bodies_say_that_the_state_has_put_there() {
    let arm = Arm::new(ArmParams { length: 1.3 }).expect("a model");
    let state = moved(
        &arm,
        &[
            ("shoulder.angle1", 0.4),
            ("shoulder.angle2", -0.3),
            ("turntable.angle_rate", 2.0),
        ],
    );
    let state = ArmState::from_slice(&state).expect("a state");
    let mut found = ArmState::at_origin();
    arm.set_bodies(&mut found, &ArmInputs::default(), &arm.bodies(&state));
    assert!(
        apart(&found.to_vec(), &state.to_vec(), &[]) < 1e-13,
        "{found:?}\n{state:?}"
    );

    let walker = Walker::new(WalkerParams::default()).expect("a model");
    let state = moved(&walker, &[("slide.slide", 0.1), ("slide.angle_rate", 3.0)]);
    let state = WalkerState::from_slice(&state).expect("a state");
    // What is no body stays as it is.
    let mut found = WalkerState::at_origin();
    found.set_weight(state.weight());
    walker.set_bodies(&mut found, &walker.bodies(&state));
    let layout = walker.layout();
    let quaternions: Vec<usize> = layout.quaternions().collect();
    assert_eq!(quaternions.len(), 2);
    assert!(
        apart(&found.to_vec(), &state.to_vec(), &quaternions) < 1e-13,
        "{found:?}\n{state:?}"
    );

    let flat = Flat::new(FlatParams { arm: 0.3 }).expect("a model");
    let state = moved(&flat, &[("pin.angle", 0.7)]);
    let state = FlatState::from_slice(&state).expect("a state");
    let mut found = FlatState::at_origin();
    found.set_weight(state.weight());
    flat.set_bodies(&mut found, &flat.bodies(&state));
    assert!(
        apart(&found.to_vec(), &state.to_vec(), &[]) < 1e-13,
        "{found:?}\n{state:?}"
    );
}

#[test]
fn what_a_joint_forbids_is_left_out_of_where_bodies_are_put() {
    let arm = Arm::<f32>::new(ArmParams { length: 1.0 }).expect("a model");
    let mut bodies = arm.bodies(&ArmState::at_origin());
    // The base turned by 0.5 rad about z, which its hinge allows, and lifted, which it does not.
    let half = 0.25_f32;
    (bodies[3], bodies[6]) = (half.cos(), half.sin());
    bodies[2] += 0.1;
    let mut found = ArmState::at_origin();
    arm.set_bodies(&mut found, &ArmInputs::default(), &bodies);
    assert!(
        (found.turntable().coordinates[0] - 0.5).abs() < 1e-6,
        "{found:?}"
    );
    let placed = arm.bodies(&found);
    assert!((placed[2] + 0.1 - bodies[2]).abs() < 1e-6);
}
