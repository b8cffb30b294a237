//! What a system of joints costs: the order of elimination is found, growth is linear, nothing absent is paid for.

use mbd_compiler::Equations;
use mbd_scene::joints::{Axis, Hinge, JointLaw, Spherical};
use mbd_scene::{AngularVelocity, Layout, Place, Quantity, Scene};
use nalgebra::{Matrix3, Vector3};
use tests::mechanism::{add_body, add_frame, add_joint, empty, frame};

/// A slender rod of 1 m along z.
fn rod(scene: &mut Scene) -> (usize, Place, Place) {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.085, 0.085, 0.001));
    let body = add_body(scene, 1.0, &inertia);
    let top = add_frame(scene, Some(body), frame("top", [0.0, 0.0, 0.5], None));
    let end = add_frame(scene, Some(body), frame("end", [0.0, 0.0, -0.5], None));
    (body, top, end)
}

fn hinge(axis: Axis) -> JointLaw {
    JointLaw::Hinge(Hinge { axis })
}

/// Rods hinged one below the other about y, x, y, x, …; closed to the world at the end if asked.
fn chain(n: usize, closed: bool) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut from = Place::World(0);
    for index in 0..n {
        let (_, top, end) = rod(&mut scene);
        let axis = if index % 2 == 0 { Axis::Y } else { Axis::X };
        add_joint(&mut scene, hinge(axis), from, top);
        from = end;
    }
    if closed {
        let spherical = JointLaw::Spherical(Spherical::default());
        add_joint(&mut scene, spherical, from, Place::World(0));
    }
    scene
}

/// A free hub with arms around it.
fn hub(arms: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let hub = add_body(&mut scene, 5.0, &Matrix3::identity());
    for arm in 0..arms {
        let angle = arm as f64 * std::f64::consts::TAU / arms as f64;
        let at = [angle.cos(), angle.sin(), 0.0];
        let place = add_frame(&mut scene, Some(hub), frame(&format!("arm{arm}"), at, None));
        let (_, top, _) = rod(&mut scene);
        add_joint(&mut scene, hinge(Axis::Y), place, top);
    }
    scene
}

/// A binary tree of rods hanging from the world.
fn tree(n: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut ends = vec![Place::World(0)];
    for index in 0..n {
        let (_, top, end) = rod(&mut scene);
        let axis = if index % 2 == 0 { Axis::Y } else { Axis::X };
        add_joint(&mut scene, hinge(axis), ends[index.div_ceil(2)], top);
        ends.push(end);
    }
    scene
}

fn cost(scene: &Scene, what: Quantity) -> usize {
    let equations = Equations::trace_only(scene, &[what]);
    equations.program(what).expect("traced").cost().total()
}

#[test]
#[ignore = "prints operation counts"]
fn counts() {
    let scenes = [
        ("chain 2", chain(2, false)),
        ("chain 8", chain(8, false)),
        ("chain 16", chain(16, false)),
        ("ring 8", chain(8, true)),
        ("hub 11", hub(11)),
        ("tree 15", tree(15)),
    ];
    for (name, scene) in scenes {
        let layout = Layout::new(&scene);
        println!("{name}: estimates {:?}", layout.elimination.candidates);
        for what in [
            Quantity::Constraint,
            Quantity::ConstraintJacobian,
            Quantity::ConstraintBias,
            Quantity::Derivative,
            Quantity::Multipliers,
            Quantity::Correction,
        ] {
            let total = cost(&scene, what);
            println!("  {what:?} {total}, {} a body", total / scene.bodies.len());
        }
    }
}
