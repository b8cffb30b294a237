//! What follows from multipliers that were found elsewhere: where rows lose rank the system of the joints has no solution, but some of
//! its multipliers are still determined.
//!
//! ```text
//! F = Σ λ (linear columns of the child) + what acts along coordinates,  T = Σ λ (couples on the child) + the same,  P = −Σ λ Φ_t          (1)
//! ```

use super::Scratch;
use crate::elimination::reaction;
use crate::laws::evaluation::Evaluation;
use crate::laws::joint_forces::add_on_children;
use crate::laws::{Numbers, energy, forces, measured};
use crate::rows::{Ends, Rows};
use crate::scalar::algebra::write;

use crate::{AngularVelocity, At, Layout, Quantity, Scene};

/// Writes [`Quantity::Reactions`], [`Quantity::Energy`] or [`Quantity::Outputs`] for given multipliers, n_c numbers in the order of the rows.
/// Outputs take v̇ from `accelerations`, n_v numbers. A multiplier that is not a number makes what depends on it so. Other quantities, and slices of a wrong length, leave `out` untouched.
pub fn evaluate_with_multipliers(
    what: Quantity,
    scene: &Scene,
    layout: &Layout,
    numbers: &Numbers<f64>,
    (at, [multipliers, accelerations]): (&At<'_, f64>, [&[f64]; 2]),
    scratch: &mut Scratch<f64>,
    out: &mut [f64],
) {
    if out.len() != layout.len(what) || multipliers.len() != layout.nc {
        return;
    }
    let Scratch {
        kinematics,
        reactions: list,
        bodies,
        assembly,
        solver,
        ..
    } = scratch;
    let evaluation = Evaluation {
        multipliers,
        accelerations,
        ..kinematics.read(scene, layout, numbers, at)
    };
    assembly.collect(&evaluation);
    let mut tree = solver.tree().filter(|_| accelerations.len() == layout.nv);
    let mut find_reactions = |evaluation: &Evaluation<'_, f64>, out: &mut [f64]| match &mut tree {
        Some(tree) => tree.reactions_for(evaluation, assembly, out),
        None => reactions(evaluation, out),
    };
    match what {
        Quantity::Reactions => find_reactions(&evaluation, out),
        Quantity::Energy => {
            let mut power = forces::drive_power(&evaluation);
            match tree {
                Some(tree) => power += tree.drive_power_for(&evaluation, assembly),
                None => each(&evaluation, |_, rows, own, _| {
                    for (row, &multiplier) in rows.rows().iter().zip(own) {
                        power -= multiplier * row.time;
                    }
                }),
            }
            energy::energy(&evaluation, power, out);
        }
        Quantity::Outputs => {
            list.clear();
            if layout.asked(what).reactions {
                list.resize(6 * layout.joints.len(), 0.0);
                find_reactions(&evaluation, list);
            }
            bodies.clear();
            if let Some(tree) = tree {
                tree.body_accelerations(&evaluation, accelerations, bodies);
            }
            let evaluation = Evaluation {
                reactions: list,
                body_accelerations: bodies,
                ..evaluation
            };
            measured::outputs(&evaluation, out);
        }
        _ => {}
    }
}

/// Writes force and torque of every joint, (1).
fn reactions(evaluation: &Evaluation<'_, f64>, out: &mut [f64]) {
    out.fill(0.0);
    each(evaluation, |joint, rows, own, ends| {
        let rows = rows
            .rows()
            .iter()
            .zip(own.iter().map(|&multiplier| -multiplier));
        let [force, torque] = reaction(evaluation, &ends.child.outward, rows);
        write(out, 6 * joint, &force);
        write(out, 6 * joint + 3, &torque);
    });
    add_on_children(evaluation, |_| true, out);
}

/// Hands out every joint with its rows, their multipliers and its ends, body components.
fn each(
    evaluation: &Evaluation<'_, f64>,
    mut look: impl FnMut(usize, &Rows<f64>, &[f64], &Ends<'_, f64>),
) {
    let mut rows = Rows::default();
    let joints = evaluation.scene.joints.iter();
    for (index, (joint, slots)) in joints.zip(&evaluation.layout.joints).enumerate() {
        let own = evaluation.multipliers.get(slots.row..slots.row + slots.len);
        let ends_of = |joint: usize| evaluation.ends(joint, AngularVelocity::Body);
        let (Some(own), Some(ends), true) = (own, ends_of(index), slots.len > 0) else {
            continue;
        };
        evaluation.law_rows((index, &ends), &ends_of, slots.law, &mut rows);
        for (coordinate, course) in evaluation.motors(joint) {
            rows.motor(&ends, &coordinate, &course);
        }
        if let Some(joined) = evaluation.joined(index) {
            rows.scale(joined);
        }
        look(index, &rows, own, &ends);
    }
}
