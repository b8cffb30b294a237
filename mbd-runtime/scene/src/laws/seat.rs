//! What the unknowns of a body in the system of the joints are: the velocity of a point of it, and its angular velocity along some axes.
//!
//! ```text
//! own axes, centre of mass             what no joint carries                                                              (1)
//! own axes, the joint's point          what a joint carries at a point: its point rows have no angular columns            (2)
//! the parent's axes and point          what a joint locks to its parent: both move alike but for what slides              (3)
//! ```
//!
//! In (3) the point is the parent's, shifted by the gap that the points of a rigid joint have off the constraints; a joint to the world
//! takes the axes of the world and the centre of mass.

use nalgebra::Vector3;

use super::evaluation::Evaluation;
use super::rows::{End, Ends, Turn};
use crate::elimination::Part;
use crate::{AngularVelocity, Partition, Place, Real};

/// The axes and the point of the unknowns of a body.
#[derive(Clone, Copy, Debug)]
pub struct Seat<S: Real> {
    /// The body whose axes they are; `None` for those of the world.
    along: Option<usize>,
    /// These components → world axes.
    pub outward: Turn<S>,
    /// Components along the body's own axes → these.
    pub turn: Turn<S>,
    /// The point from the centre of mass, these components [m]; `None` for the centre of mass itself.
    pub reference: Option<Vector3<S>>,
}

impl<S: Real> Seat<S> {
    /// Rows k of R r̃ for the reference point r: a velocity of the centre of mass is that of the reference point + R r̃ ω.
    pub fn levers(&self) -> Option<[Vector3<S>; 3]> {
        let reference = self.reference?;
        Some(std::array::from_fn(|k| {
            self.outward.row(k).cross(&reference)
        }))
    }

    /// The reference point from the centre of mass [m].
    pub fn arm(&self) -> Vector3<S> {
        self.reference.unwrap_or_else(Vector3::zeros)
    }
}

/// The way a joint parts the speeds of the body of a place, if it carries that body.
pub(super) fn carried<S: Real>(
    evaluation: &Evaluation<'_, S>,
    body: usize,
) -> Option<(usize, Partition)> {
    let plan = &evaluation.layout.elimination;
    let joint = (*plan.carriers.get(body)?)?;
    let step = plan.step_of(Part::Body(body))?;
    Some((joint, plan.steps.get(step)?.partition?))
}

impl<S: Real> Evaluation<'_, S> {
    /// The seats of all bodies of the system, carriers before what they carry.
    pub(super) fn seats(&self, seats: &mut [Option<Seat<S>>]) {
        for step in self.layout.elimination.steps.iter().rev() {
            if let Part::Body(body) = step.part {
                let seat = self.seat(body, seats);
                if let Some(slot) = seats.get_mut(body) {
                    *slot = seat;
                }
            }
        }
    }

    fn seat(&self, body: usize, seats: &[Option<Seat<S>>]) -> Option<Seat<S>> {
        let motion = self.motions.get(body)?;
        let own = Seat {
            along: Some(body),
            outward: Turn::By(motion.rotation),
            turn: Turn::None,
            reference: None,
        };
        let Some((joint, partition)) = carried(self, body) else {
            return Some(own);
        };
        let declared = self.scene.joints.get(joint)?;
        let point = self.arm_of(declared.child)?;
        let Some(ways) = partition.locked else {
            return Some(Seat {
                reference: Some(point),
                ..own
            });
        };
        let Place::Body(parent, _) = declared.parent else {
            return Some(Seat {
                along: None,
                outward: Turn::None,
                turn: own.outward,
                reference: None,
            });
        };
        let carrier = (*seats.get(parent)?)?;
        let turn = carrier.outward.to(&own.outward);
        let inboard = carrier.arm();
        let reference = if ways.sliding {
            let apart = motion.position - self.motions.get(parent)?.position;
            inboard - carrier.outward.back(&apart)
        } else {
            let held = carrier.turn.apply(&self.arm_of(declared.parent)?);
            inboard - held + turn.apply(&point)
        };
        Some(Seat {
            turn,
            reference: Some(reference),
            ..carrier
        })
    }

    /// A place on a body from its centre of mass, own axes.
    fn arm_of(&self, place: Place) -> Option<Vector3<S>> {
        let Place::Body(body, frame) = place else {
            return None;
        };
        let frames = &self.numbers.bodies.get(body)?.frames;
        Some(frames.get(frame)?.position)
    }

    /// The two ends of a joint in the system: columns multiply the unknowns of the bodies.
    pub(super) fn system_ends(
        &self,
        joint: usize,
        seats: &[Option<Seat<S>>],
    ) -> Option<Ends<'_, S>> {
        let declared = self.scene.joints.get(joint)?;
        let seat = |place: Place| match place {
            Place::Body(body, _) => seats.get(body).copied().flatten(),
            _ => None,
        };
        let [parent, child] = [declared.parent, declared.child].map(|place| (place, seat(place)));
        let along = |seat: Option<Seat<S>>| seat.and_then(|seat| seat.along);
        let components = if along(parent.1) == along(child.1) {
            // The same components on both sides.
            AngularVelocity::World
        } else {
            AngularVelocity::Body
        };
        let [parent, child] = [parent, child].map(|(place, seat)| self.seated(place, seat));
        let numbers = self.numbers.joints.get(joint)?;
        Some(Ends::new(parent?, child?, numbers, components))
    }

    fn seated(&self, place: Place, seat: Option<Seat<S>>) -> Option<End<S>> {
        let end = self.end(place, AngularVelocity::Body)?;
        let (Some(seat), Place::Body(body, _)) = (seat, place) else {
            return Some(end);
        };
        let end = End {
            reference: seat.arm(),
            ..end
        };
        if seat.along == Some(body) {
            return Some(end);
        }
        if seat.along.is_none() {
            return Some(End {
                reference: seat.arm(),
                ..self.end(place, AngularVelocity::World)?
            });
        }
        Some(End {
            omega: seat.turn.apply(&end.omega),
            outward: seat.outward,
            arm: seat.turn.apply(&end.arm),
            frame: seat.turn.after(&end.frame),
            ..end
        })
    }
}
