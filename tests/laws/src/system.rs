//! Mechanisms of the reference data: their bodies and joints as a scene, their states.

use mbd_scene::joints::JointLaw;
use mbd_scene::{AngularVelocity, Place, Scene};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

use crate::mechanism::{Instance, add_body, add_frame, add_joint, empty, frame};
use crate::reference::{field, numbers};

/// The law of a joint type, its axes as the data have them.
///
/// # Panics
/// On a type that the data do not have.
#[must_use]
pub fn law(keyword: &str) -> JointLaw {
    match keyword {
        "rigid" => JointLaw::Rigid(Default::default()),
        "hinge" => JointLaw::Hinge(Default::default()),
        "spherical" => JointLaw::Spherical(Default::default()),
        "universal" => JointLaw::Universal(Default::default()),
        "prismatic" => JointLaw::Prismatic(Default::default()),
        "cylindrical" => JointLaw::Cylindrical(Default::default()),
        "free" => JointLaw::Free(Default::default()),
        other => panic!("no joint {other}"),
    }
}

/// Three numbers.
///
/// # Panics
/// If there are not three.
#[must_use]
pub fn three(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

/// The items of a list.
///
/// # Panics
/// If it is none.
#[must_use]
pub fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

/// The scene of a `system`: bodies, joints, gravity.
///
/// # Panics
/// On data that are incomplete.
#[must_use]
pub fn scene(system: &Value, components: AngularVelocity) -> Scene {
    let mut scene = empty(three(&system["gravity"]), components);
    for body in list(&system["bodies"]) {
        let mass = body["mass"].as_f64().expect("a mass");
        let inertia = Matrix3::from_row_slice(&field(body, "inertia"));
        add_body(&mut scene, mass, &inertia);
    }
    for joint in list(&system["joints"]) {
        let mut place = |body: &str, p: &str, r: &str| -> Place {
            let body = usize::try_from(joint[body].as_i64().expect("an index")).ok();
            let axes = Matrix3::from_row_slice(&field(joint, r));
            add_frame(&mut scene, body, frame(p, three(&joint[p]), Some(axes)))
        };
        let (parent, child) = (place("parent", "p1", "R1"), place("child", "p2", "R2"));
        let law = law(joint["type"].as_str().expect("a type"));
        add_joint(&mut scene, law, parent, child);
    }
    scene
}

/// Three numbers as a vector.
#[must_use]
pub fn vector(value: &Value) -> Vector3<f64> {
    three(value).into()
}

/// The attitude of a quaternion w x y z.
///
/// # Panics
/// If there are not four numbers.
#[must_use]
pub fn attitude(value: &Value) -> UnitQuaternion<f64> {
    let q = numbers(value);
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// A body from its position, attitude, velocity and angular velocity in world axes.
#[must_use]
pub fn instance(r: &Value, quat: &Value, rdot: &Value, omega: &Value) -> Instance {
    Instance {
        position: vector(r),
        attitude: attitude(quat),
        velocity: vector(rdot),
        omega: vector(omega),
        ..Instance::rest()
    }
}

/// Bodies of a list of positions, attitudes and velocities, one item a body.
#[must_use]
pub fn bodies(r: &Value, quat: &Value, rdot: &Value, omega: &Value) -> Vec<Instance> {
    let count = list(r).len();
    let all = (0..count).map(|i| instance(&r[i], &quat[i], &rdot[i], &omega[i]));
    all.collect()
}

/// Bodies of a stored state.
#[must_use]
pub fn instances(state: &Value) -> Vec<Instance> {
    bodies(
        &state["r"],
        &state["quat"],
        &state["rdot"],
        &state["omega_world"],
    )
}
