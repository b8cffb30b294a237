//! Gear: one coordinate of a joint follows one of another. Also a rack and pinion, and a joint that mimics another.
//!
//! ```text
//! Φ = x_to − ratio · x_from − offset     1 row [m or rad], modulo what full turns of the angles add; see `laws/coupling.rs`          (1)
//! ```
//!
//! The multiplier is the force or torque along x_to; along x_from the gear acts with −ratio times it, so that it does no work.
//! Source: derived; a linear relation of the coordinates of `laws/coordinate.rs`. Singular at ratio 0, which holds x_to alone: refused.
//! Rejected: a relation of speeds, which drifts; sin Φ, which also holds half a period off.

use serde::{Deserialize, Serialize};

use super::dimension::ANGLE;
use super::{Coupled, Field, Fields, JointDefinition, Relation, Rule};
use crate::{Formula, Real};

/// A gear between two joint coordinates: takes one freedom.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// x_to and x_from: joint and number of the coordinate.
    pub couples: [(usize, usize); 2],
    /// x_to per x_from [m/rad, rad/m, or 1]; negative where they run against each other, not zero.
    pub ratio: Formula,
    /// x_to where x_from is zero [m or rad].
    pub offset: Formula,
}

static RATIO: Field = Field {
    name: "ratio",
    dimension: ANGLE,
    rule: Rule::NotZero,
};

static OFFSET: Field = Field {
    name: "offset",
    dimension: ANGLE,
    rule: Rule::Finite,
};

impl JointDefinition for Gear {
    const FREEDOMS: usize = 5;
    const COORDINATES: usize = 0;
    const SUMMARY: &'static str =
        "a coordinate of one joint is `ratio` times that of another, plus `offset`";

    fn read(fields: &mut dyn Fields) -> Self {
        Gear {
            couples: fields.coordinates(),
            ratio: fields.coupled(&RATIO, Coupled::ToPerFrom),
            offset: fields.coupled(&OFFSET, Coupled::To),
        }
    }

    fn numbers(&self) -> Vec<(&'static Field, &Formula)> {
        vec![(&RATIO, &self.ratio), (&OFFSET, &self.offset)]
    }

    fn numbers_mut(&mut self) -> Vec<&mut Formula> {
        vec![&mut self.ratio, &mut self.offset]
    }

    fn couples(&self) -> &[(usize, usize)] {
        &self.couples
    }

    fn relation<S: Real>(&self, numbers: &[S]) -> Option<Relation<S>> {
        let &[ratio, offset] = numbers else {
            return None;
        };
        Some(Relation::new([S::one(), -ratio], offset))
    }
}
