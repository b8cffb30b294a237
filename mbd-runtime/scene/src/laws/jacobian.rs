//! Jacobians over the speeds: of a frame, of the centre of mass.
//!
//! ```text
//! ṗ = J v,  ω = J_ω v                       a frame at p, world axes                                                       (1)
//! J = R (m x + k × h),  J_ω = m R k         column of a coordinate that moves its link by [x; k] at its origin             (2)
//! J = [m 1, R h̃ᵀ],      J_ω = [0, m R]      columns of a body by itself, its angular velocity in its own axes              (3)
//! ```
//!
//! R: axes of the link, h from its origin. A frame at s of its link is m = 1, h = s there and nothing elsewhere; Σ m_i J_i over all bodies, with
//! mass and first moment of each, is the momentum over the speeds, and over Σ m_i the Jacobian of the centre of mass. Links hand m and h on as
//! composite bodies do.
//! Source: Siciliano, Sciavicco, Villani and Oriolo, Robotics, section 3.1.

use nalgebra::Vector3;

use crate::laws::evaluation::Evaluation;
use crate::layout::Slots;
use crate::tree::SpatialInertia;
use crate::{AngularVelocity, PointSlots, Real};

/// Writes velocity and angular velocity of a frame of a body over the speeds (6 × n_v).
pub(crate) fn frame<S: Real>(
    evaluation: &Evaluation<'_, S>,
    [body, frame]: [usize; 2],
    moments: &mut Vec<SpatialInertia<S>>,
    out: &mut [S],
) {
    let numbers = evaluation.numbers.bodies.get(body);
    let Some(place) = numbers.and_then(|body| body.frames.get(frame)) else {
        return out.fill(S::from_f64(f64::NAN));
    };
    start(evaluation, moments);
    moments[body] = SpatialInertia {
        mass: S::one(),
        moment: in_link(evaluation, body, &place.position),
        ..SpatialInertia::none()
    };
    hand_on(evaluation, moments);
    let (moving, turning) = out.split_at_mut(3 * evaluation.layout.nv);
    write(evaluation, moments, moving, Some(turning));
}

/// Writes the velocity of the centre of mass over the speeds (3 × n_v).
pub(crate) fn centre_of_mass<S: Real>(
    evaluation: &Evaluation<'_, S>,
    moments: &mut Vec<SpatialInertia<S>>,
    out: &mut [S],
) {
    start(evaluation, moments);
    let mut whole = S::zero();
    for (index, body) in evaluation.numbers.bodies.iter().enumerate() {
        let centre = in_link(evaluation, index, &Vector3::zeros());
        moments[index] = SpatialInertia {
            mass: body.mass,
            moment: centre.map(|x| body.mass * x),
            ..SpatialInertia::none()
        };
        whole += body.mass;
    }
    hand_on(evaluation, moments);
    write(evaluation, moments, out, None);
    let layout = evaluation.layout;
    for (index, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            let (mass, _) = evaluation.numbers.points[index];
            whole += mass;
            for (axis, line) in out.chunks_exact_mut(layout.nv.max(1)).enumerate() {
                let along = unit::<S>(axis).map(|x| mass * x);
                layout.directions.write_linear(line, slots.v, &along);
            }
        }
    }
    let inverse = S::one() / whole;
    for slot in out.iter_mut().filter(|slot| !slot.is_zero()) {
        *slot *= inverse;
    }
}

fn start<S: Real>(evaluation: &Evaluation<'_, S>, moments: &mut Vec<SpatialInertia<S>>) {
    moments.clear();
    moments.resize(evaluation.numbers.bodies.len(), SpatialInertia::none());
}

/// A place of a body, in its axes from its centre of mass, from the origin of its link, in the axes of that.
fn in_link<S: Real>(evaluation: &Evaluation<'_, S>, body: usize, place: &Vector3<S>) -> Vector3<S> {
    let tree = evaluation.layout.tree.as_ref();
    let link = tree.and_then(|tree| evaluation.links.get(*tree.of_body.get(body)?));
    link.map_or(*place, |link| link.centre + link.body * place)
}

/// What links carry, from the leaves.
fn hand_on<S: Real>(evaluation: &Evaluation<'_, S>, moments: &mut [SpatialInertia<S>]) {
    let Some(tree) = &evaluation.layout.tree else {
        return;
    };
    for (link, motion) in tree.links.iter().zip(evaluation.links).rev() {
        let Some(inboard) = link.inboard else {
            continue;
        };
        let own = moments[link.body];
        moments[tree.links[inboard].body].take(&own, &motion.turn, &motion.offset);
    }
}

/// Writes the rows of (2) and (3): those along the axes (3 × n_v), and those about them if asked for.
fn write<S: Real>(
    evaluation: &Evaluation<'_, S>,
    moments: &[SpatialInertia<S>],
    moving: &mut [S],
    turning: Option<&mut [S]>,
) {
    let layout = evaluation.layout;
    let turning = turning.unwrap_or_default();
    for (body, slots) in layout.own_bodies() {
        S::section(&evaluation.scene.bodies[body].name);
        write_own(
            evaluation,
            (body, slots),
            &moments[body],
            [&mut *moving, &mut *turning],
        );
    }
    let links = layout.tree.iter().flat_map(|tree| &tree.links);
    for (link, motion) in links.zip(evaluation.links) {
        if link.joint.is_none() {
            continue;
        }
        S::section(&evaluation.scene.bodies[link.body].name);
        let SpatialInertia { mass, moment, .. } = &moments[link.body];
        for (speed, column) in (link.slots.v..).zip(motion.columns.iter()) {
            let along = column.linear.map(|x| *mass * x) + column.angular.cross(moment);
            let about = column.angular.map(|x| *mass * x);
            let columns = [motion.axes * along, motion.axes * about];
            for (rows, column) in [&mut *moving, &mut *turning].into_iter().zip(columns) {
                for (row, value) in rows.chunks_exact_mut(layout.nv.max(1)).zip(column.iter()) {
                    row[speed] = *value;
                }
            }
        }
    }
}

/// (3).
fn write_own<S: Real>(
    evaluation: &Evaluation<'_, S>,
    (body, slots): (usize, Slots),
    SpatialInertia { mass, moment, .. }: &SpatialInertia<S>,
    [moving, turning]: [&mut [S]; 2],
) {
    let (layout, motion) = (evaluation.layout, &evaluation.motions[body]);
    let directions = layout.directions;
    // A world axis, and the moment, in the components of the angular velocity.
    let back = motion.rotation.transpose();
    let components = evaluation.scene.angular_velocity;
    let own = |axis: &Vector3<S>| match components {
        AngularVelocity::Body => back * axis,
        AngularVelocity::World => *axis,
    };
    let arm = match components {
        AngularVelocity::Body => *moment,
        AngularVelocity::World => motion.arm(moment),
    };
    for (axis, row) in moving.chunks_exact_mut(layout.nv.max(1)).enumerate() {
        let along: Vector3<S> = unit(axis);
        directions.write_linear(row, slots.v, &along.map(|x| *mass * x));
        directions.write_angular(row, slots.v, &arm.cross(&own(&along)));
    }
    for (axis, row) in turning.chunks_exact_mut(layout.nv.max(1)).enumerate() {
        let about = own(&unit(axis));
        directions.write_angular(row, slots.v, &about.map(|x| *mass * x));
    }
}

fn unit<S: Real>(axis: usize) -> Vector3<S> {
    Vector3::from_fn(|row, _| if row == axis { S::one() } else { S::zero() })
}
