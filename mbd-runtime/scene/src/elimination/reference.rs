//! Reference frames: what the unknowns of a body in the system of the joints are, the velocity of a point of it and its angular velocity.
//!
//! ```text
//! own axes, centre of mass             a body alone                                                              (1)
//! world axes, centre of mass           a body that carries others, and is not carried                            (2)
//! own or world axes, joint point Q     a body that its parent joint lets turn                                     (3)
//! the parent's axes and point          a body that its parent joint does not let turn                             (4)
//! ```
//!
//! In (4) the point is the parent's, shifted by
//! the gap that the points of a rigid joint have off the constraints.

use nalgebra::{Matrix3, Vector3};

use crate::laws::evaluation::Evaluation;
use crate::rows::{End, Ends, Rotation};
use crate::{AngularVelocity, Part, Place, Real};

/// The axes and the point of the unknowns of a body.
#[derive(Clone, Copy, Debug)]
pub struct Reference<S: Real> {
    /// The body whose axes they are; `None` for those of the world.
    along: Option<usize>,
    /// These components → world axes.
    pub outward: Rotation<S>,
    /// Components along the body's own axes → these.
    pub turn: Rotation<S>,
    /// What makes a rotation of that, and of `outward`: 1 over the length of their columns, which quaternions leave inside a step.
    pub units: [S; 2],
    /// The point from the centre of mass, these components [m]; `None` for the centre of mass itself.
    pub point: Option<Vector3<S>>,
    /// The same along the body's own axes, where it is a place on the body.
    pub place: Option<Vector3<S>>,
}

impl<S: Real> Reference<S> {
    /// Rows k of R r̃ for the reference point r: a velocity of the centre of mass is that of the reference point + R r̃ ω.
    pub fn levers(&self) -> Option<[Vector3<S>; 3]> {
        Some(self.lever(&self.point?))
    }

    /// Rows k of R r̃ for a point r from the reference point, these components.
    pub fn lever(&self, r: &Vector3<S>) -> [Vector3<S>; 3] {
        std::array::from_fn(|k| self.outward.row(k).cross(r))
    }

    /// The reference point from the centre of mass [m].
    pub fn arm(&self) -> Vector3<S> {
        self.point.unwrap_or_else(Vector3::zeros)
    }

    /// Components of other axes, `outward` of which takes them to the world's, → these.
    pub fn turn_from(&self, outward: &Rotation<S>) -> Rotation<S> {
        self.outward.to(outward)
    }

    /// The rotation from the components of another reference frame to these; none where the axes are the same.
    pub fn rotation_from(&self, other: &Self) -> Rotation<S> {
        if self.along == other.along {
            return Rotation::Identity;
        }
        let unit = self.units[1] * other.units[1];
        match self.turn_from(&other.outward) {
            Rotation::Identity => Rotation::Identity,
            Rotation::Matrix(turn) => Rotation::Matrix(turn.map(|x| x * unit)),
        }
    }

    /// Own components of an angular acceleration in these.
    pub fn own_components(&self, spin: &Vector3<S>) -> Vector3<S> {
        match self.turn {
            Rotation::Identity => *spin,
            turn => turn.back(&spin.map(|x| x * self.units[0])),
        }
    }
}

impl<S: Real> Evaluation<'_, S> {
    /// The two ends of a joint that carries its child, columns on the child at its joint point: own components of the child where its
    /// unknowns are along these, those of the world else.
    pub(super) fn carrying_ends(&self, joint: usize, own: bool) -> Option<Ends<'_, S>> {
        let components = match own {
            true => AngularVelocity::Body,
            false => AngularVelocity::World,
        };
        let declared = self.scene.joints.get(joint)?;
        let end = |place: Place| {
            let end = self.end(place, components)?;
            Some(match own {
                true => end,
                false => self.exact(place, end),
            })
        };
        let (parent, child) = (end(declared.parent)?, end(declared.child)?);
        let reference = child.arm;
        let numbers = self.numbers.joints.get(joint)?;
        Some(Ends::new(
            parent,
            End { reference, ..child },
            numbers,
            components,
        ))
    }

    /// An end in world components with the angular velocity by which its arms turn.
    fn exact(&self, place: Place, end: End<S>) -> End<S> {
        match place {
            Place::Body(body, _) => End {
                omega: self.motions[body].omega_exact(self.scene.angular_velocity),
                ..end
            },
            _ => end,
        }
    }

    /// The reference frame of a body; `references` those of what carries it.
    pub(super) fn reference(
        &self,
        body: usize,
        references: &[Option<Reference<S>>],
    ) -> Option<Reference<S>> {
        let motion = self.motions.get(body)?;
        let plan = &self.layout.elimination;
        let own = Reference {
            along: Some(body),
            outward: Rotation::Matrix(motion.rotation),
            turn: Rotation::Identity,
            units: [S::one(), motion.unit],
            point: None,
            place: None,
        };
        let world = Reference {
            along: None,
            outward: Rotation::Identity,
            turn: own.outward,
            units: [motion.unit, S::one()],
            ..own
        };
        let Some((joint, carrying)) = plan.carrying(body) else {
            let parents = plan.parent_joints.iter().flatten();
            let on = |joint: &usize| self.layout.joints[*joint].ends[0] == Some(Part::Body(body));
            return Some(if parents.into_iter().any(on) {
                world
            } else {
                own
            });
        };
        let declared = self.scene.joints.get(joint)?;
        let place = self.arm_of(declared.child)?;
        if carrying.shared {
            let Place::Body(parent, _) = declared.parent else {
                return Some(world);
            };
            let inboard = (*references.get(parent)?)?;
            let turn = inboard.turn_from(&own.outward);
            let point = if carrying.meets {
                let held = inboard.turn.apply(&self.arm_of(declared.parent)?);
                inboard.arm() - held + turn.apply(&place)
            } else {
                let apart = motion.position - self.motions.get(parent)?.position;
                inboard.arm() - inboard.outward.back(&apart)
            };
            return Some(Reference {
                turn,
                units: [motion.unit * inboard.units[1], inboard.units[1]],
                point: Some(point),
                place: None,
                ..inboard
            });
        }
        let axes = if carrying.own { own } else { world };
        Some(Reference {
            point: Some(axes.turn.apply(&place)),
            place: Some(place),
            ..axes
        })
    }

    /// A place on a body from its centre of mass, own axes.
    pub(super) fn arm_of(&self, place: Place) -> Option<Vector3<S>> {
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
        references: &[Option<Reference<S>>],
    ) -> Option<Ends<'_, S>> {
        let declared = self.scene.joints.get(joint)?;
        let reference = |place: Place| match place {
            Place::Body(body, _) => references.get(body).copied().flatten(),
            _ => None,
        };
        let both = [declared.parent, declared.child].map(|place| (place, reference(place)));
        let along = both.map(|(_, reference)| reference.and_then(|reference| reference.along));
        let components = if along[0] == along[1] {
            // The same components on both sides.
            AngularVelocity::World
        } else {
            AngularVelocity::Body
        };
        let [parent, child] = both.map(|(place, reference)| self.referred(place, reference));
        let numbers = self.numbers.joints.get(joint)?;
        Some(Ends::new(parent?, child?, numbers, components))
    }

    fn referred(&self, place: Place, reference: Option<Reference<S>>) -> Option<End<S>> {
        let end = self.end(place, AngularVelocity::Body)?;
        let Some(axes) = reference else {
            return Some(end);
        };
        let end = match (axes.along, axes.turn) {
            (None, _) => self.exact(place, self.end(place, AngularVelocity::World)?),
            (_, Rotation::Identity) => end,
            (_, turn) => End {
                omega: turn.apply(&end.omega),
                outward: axes.outward,
                arm: turn.apply(&end.arm),
                frame: turn.after(&end.frame),
                ..end
            },
        };
        Some(End {
            reference: axes.arm(),
            ..end
        })
    }
}

/// R I Rᵀ of a symmetric matrix. A diagonal one is rotated as the sphere of two equal elements and what is more along the other axes.
pub(super) fn rotated<S: Real>(turn: &Rotation<S>, inertia: &Matrix3<S>) -> Matrix3<S> {
    let Rotation::Matrix(r) = turn else {
        return *inertia;
    };
    let diagonal = (0..3).all(|k| inertia[(k, (k + 1) % 3)].is_zero());
    if !diagonal {
        // A structural fact of the declaration, not a branch on the state: inertia is constant.
        return r * inertia * r.transpose();
    }
    let more = |base: usize, k: usize| inertia[(k, k)] - inertia[(base, base)];
    let equal = |base: &usize| (0..3).filter(|&k| more(*base, k).is_zero()).count();
    let base = (0..3).rev().max_by_key(equal).unwrap_or(0);
    let mut sum = Matrix3::from_diagonal_element(inertia[(base, base)]);
    for k in (0..3).filter(|&k| !more(base, k).is_zero()) {
        let axis = r.column(k).into_owned();
        let scaled = axis.map(|x| more(base, k) * x);
        for i in 0..3 {
            for j in 0..=i {
                sum[(i, j)] += scaled[i] * axis[j];
                sum[(j, i)] = sum[(i, j)];
            }
        }
    }
    sum
}
