//! Screw: a rotation about an axis that advances along it.
//!
//! ```text
//! Φ = [ u1·d ; v1·d ; u1·a2 ; v1·a2 ; h (u1·u2 sin φ − v1·u2 cos φ) ]     5 rows [m m 1 1 m], h = pitch/2π, φ = a1·d/h      (1)
//!   the last row is h sin(φ − θ), θ the angle from u1 to u2
//! s = h θ a, R12 = turn(a, θ); H = [h a; a], b = 0                                                                          (2)
//! ```
//!
//! Source: derived; 1 freedom. The attitude rows also hold for a2 = −a1, the last row for a nut half a turn off: the start must satisfy
//! a1·a2 > 0 and cos(φ − θ) > 0. Singular at pitch 0, which is a hinge. Rejected: a1·d − h θ with θ from atan2, which jumps once a turn.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::dimension::LENGTH;
use super::motion::write;
use super::{
    Axis, Carried, Coordinate, Field, Fields, JointDefinition, Measure, Pose, Relative, Rule, Twist,
};
use crate::rows::{Ends, Rows, helix};
use crate::{Formula, Real};

/// A nut on a thread: 1 freedom, the angle about the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Screw {
    /// The axis, the same components in both joint frames.
    #[serde(default)]
    pub axis: Axis,
    /// Displacement along the axis in a full turn [m]; positive for a right-handed thread, not zero.
    pub pitch: Formula,
}

static PITCH: Field = Field {
    name: "pitch",
    dimension: LENGTH,
    rule: Rule::NotZero,
};

/// Displacement along the axis per radian [m].
fn lead<S: Real>(pitch: S) -> S {
    (pitch * S::from_f64(1.0 / TAU)).label("lead")
}

impl JointDefinition for Screw {
    const FREEDOMS: usize = 1;
    const SUMMARY: &'static str = "a rotation about `axis` that advances by `pitch` a turn";

    fn read(fields: &mut dyn Fields) -> Self {
        Screw {
            axis: fields.axis("axis", Axis::Z),
            pitch: fields.number(&PITCH),
        }
    }

    fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
        vec![(&PITCH, &self.pitch)]
    }

    fn numbers_mut(&mut self) -> Vec<&mut Formula> {
        vec![&mut self.pitch]
    }

    fn constrain<S: Real>(&self, ends: &Ends<'_, S>, rows: &mut Rows<S>) {
        for u in self.axis.complement() {
            rows.in_plane(ends, &u);
        }
        for u in self.axis.complement() {
            rows.perpendicular(ends, &u, &self.axis);
        }
        rows.helix(ends, &self.axis, lead(ends.number(0)));
    }

    fn carried<S: Real>(&self, ends: &Ends<'_, S>, _own: bool) -> Option<Carried<S>> {
        // The helix row holds the slide of a cylindrical joint: κ ẋ + c·ω, c the couple of the row.
        let across = Carried::in_planes(ends, &self.axis.complement());
        let mut carried = across.turns(ends, &self.axis);
        let (row, slope) = helix(ends, &self.axis, lead(ends.number(0)));
        let along = ends.parent.outward.apply(&ends.parent.axis(&self.axis));
        let inverse = S::one() / (slope * along.dot(&along));
        carried.hold_after(Twist::slide(along), inverse);
        let turn = &mut carried.free[0];
        let advance = -(row.child().angular.dot(&turn.angular) * inverse);
        turn.linear = along.map(|x| advance * x);
        Some(carried)
    }

    fn motion<S: Real>(&self, at: &Relative<'_, S>) -> Pose<S> {
        let displacement = lead(at.number(0)) * at.q(0);
        Pose {
            position: self.axis.vector::<S>().map(|x| displacement * x),
            rotation: self.axis.turn(at.q(0)),
        }
    }

    fn subspace<S: Real>(&self, at: &Relative<'_, S>, columns: &mut [Twist<S>]) {
        let axis = self.axis.vector::<S>();
        let column = Twist {
            linear: axis.map(|x| lead(at.number(0)) * x),
            angular: axis,
        };
        write(columns, [column]);
    }

    fn coordinate(&self, index: usize) -> Option<Coordinate> {
        (index == 0).then_some(Coordinate {
            name: "angle",
            rate: "angle_rate",
            measure: Measure::Thread {
                axis: self.axis,
                pitch: 0,
            },
        })
    }

    fn branch<S: Real>(&self, ends: &Ends<'_, S>) -> [S; 3] {
        let rotated = ends.helix_cosine(&self.axis, lead(ends.number(0)));
        [ends.cosine(&self.axis, &self.axis), rotated, S::one()]
    }
}
