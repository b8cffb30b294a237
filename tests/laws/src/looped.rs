//! Random mechanisms: trees of any joints, some of them closed to loops where they stand, and linkages whose rows repeat each other.

use dense::unseen;
use mbd_scene::joints::{Axis, Hinge, JointForces, JointLaw, PointOnPlane, Spherical};
use mbd_scene::{AngularVelocity, Layout, Quantity, Scene};
use nalgebra::{DMatrix, DVector, Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::linkage::{bricard, cranks};
use crate::mechanism::{
    Seat, add_external_loads, add_frame, add_joint, all_joints, empty, evaluate, hang,
};
use crate::obeying::obeying;
use crate::random::Random;

/// Bodies, joints and external loads, and a state that obeys the joints.
#[must_use]
pub fn mechanism(seed: u64) -> (Scene, Vec<f64>) {
    let mut random = Random::new(seed + 7000);
    let components = match seed % 2 {
        0 => AngularVelocity::Body,
        _ => AngularVelocity::World,
    };
    let (mut scene, mut state) = match seed % 10 {
        // Cranks in parallel, whose bars repeat rows; a closed chain of six hinges.
        8 => {
            let bars: [&[usize]; 2] = [&[3, 4], &[4, 5]];
            let linkage = cranks(3, &bars, random.uniform(0.4, 1.2), 0.0, 9.81);
            (linkage.scene.clone(), linkage.state())
        }
        9 => {
            let linkage = bricard([0.3, 0.2, -9.81], components);
            (linkage.scene.clone(), linkage.state())
        }
        _ => tree(components, &mut random),
    };
    if seed % 10 < 5 {
        close(&mut scene, &state, &mut random);
    }
    add_external_loads(&mut scene);
    move_freely(&scene, &mut state, &mut random);
    (scene, state)
}

fn tree(components: AngularVelocity, random: &mut Random) -> (Scene, Vec<f64>) {
    let laws: Vec<JointLaw> = all_joints().into_iter().map(|(law, _)| law).collect();
    let mut scene = empty([0.4, -0.3, -9.81], components);
    for _ in 0..2 + random.below(4) {
        let (law, [parent, child]) = hang(&mut scene, &laws, random);
        let sprung = law.measured().next().is_some();
        add_joint(&mut scene, law, parent, child);
        if let (true, Some(joint)) = (sprung, scene.joints.last_mut()) {
            joint.forces.push(JointForces {
                stiffness: Some(7.0.into()),
                damping: Some(0.6.into()),
                ..JointForces::default()
            });
        }
    }
    let state = obeying(&scene, random);
    (scene, state)
}

/// Joins the last body to the world or to the first one where they stand, by a joint that leaves something to move.
fn close(scene: &mut Scene, state: &[f64], random: &mut Random) {
    let layout = Layout::new(scene);
    let pose = |body: usize| {
        let at = layout.bodies[body].expect("slots").q;
        let q = Quaternion::new(state[at + 3], state[at + 4], state[at + 5], state[at + 6]);
        let turn = UnitQuaternion::from_quaternion(q).to_rotation_matrix();
        (
            Vector3::from_column_slice(&state[at..at + 3]),
            turn.into_inner(),
        )
    };
    let last = scene.bodies.len() - 1;
    let other = Some(0).filter(|&first| first < last && random.below(2) == 0);
    let free = layout.freedoms();
    let law = match random.below(3) {
        0 if free > 5 => JointLaw::Hinge(Hinge::default()),
        1 if free > 3 => JointLaw::Spherical(Spherical::default()),
        _ if free > 1 => JointLaw::PointOnPlane(PointOnPlane { axis: Axis::Z }),
        _ => return,
    };
    let (origin, _) = pose(last);
    let place = origin + Vector3::from(random.vector(0.6));
    let turn = Seat::random(random).frame;
    let mut seat = |body: Option<usize>| {
        let (at, rotation) = body.map_or((Vector3::zeros(), Matrix3::identity()), pose);
        let seat = Seat {
            point: rotation.transpose() * (place - at),
            frame: rotation.transpose() * turn,
        };
        add_frame(scene, body, seat.declared("closing"))
    };
    let (parent, child) = (seat(other), seat(Some(last)));
    add_joint(scene, law, parent, child);
}

/// Replaces the speeds by random ones that the joints allow.
fn move_freely(scene: &Scene, state: &mut [f64], random: &mut Random) {
    let layout = Layout::new(scene);
    let rows = evaluate(scene, Quantity::ConstraintJacobian, state, &[], &[]);
    let rows = DMatrix::from_row_slice(layout.nc, layout.nv, &rows);
    let any = DVector::from_fn(layout.nv, |_, _| random.uniform(-1.0, 1.0));
    state[layout.nq..].copy_from_slice(unseen(&rows, any).as_slice());
}
