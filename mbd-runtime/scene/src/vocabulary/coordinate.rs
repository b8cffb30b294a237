//! Joint coordinates: the scalars of a joint that can be measured, and along which springs, stops and motors act.
//!
//! A joint tells them as data; value, rate, direction of the generalised force and γ follow once for all joints in
//! [`crate::rows::coordinate`].

use super::dimension::{ANGLE, LENGTH};
use crate::{Axis, Dimension};

/// A scalar of a joint. Coordinate number i of a joint is its q(i), and the rate is its u(i).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Its name in the language, `angle`.
    pub name: &'static str,
    /// The name of its rate, `angle_rate`.
    pub rate: &'static str,
    /// How it is measured.
    pub measure: Measure,
}

/// How a coordinate is measured; the first axis of a pair is fixed in frame 1, the second in frame 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// The displacement of the child's joint point along an axis of frame 1 [m].
    Slide(Axis),
    /// The angle whose cosine and sine are the products of two pairs of axes [rad], in (−π, π].
    Angle {
        /// The pair whose product is the cosine.
        cosine: [Axis; 2],
        /// The pair whose product is the sine.
        sine: [Axis; 2],
    },
    /// The angle about the axis of a thread [rad], its full turns told by the displacement along the axis: it counts every turn and has no bound.
    Thread {
        /// The axis of frame 1.
        axis: Axis,
        /// Which number of the joint is the displacement in a full turn [m].
        pitch: usize,
    },
}

/// The pairs of axes whose products are the cosine and the sine of the angle about an axis that both frames share.
pub(crate) fn angle_about(axis: Axis) -> [[Axis; 2]; 2] {
    let [u, v] = axis.complement();
    [[u, u], [v, u]]
}

impl Coordinate {
    /// A displacement along an axis of frame 1.
    pub(crate) const fn slide(name: &'static str, rate: &'static str, axis: Axis) -> Self {
        Coordinate {
            name,
            rate,
            measure: Measure::Slide(axis),
        }
    }

    /// The angle about an axis that both frames share.
    pub(crate) fn turn(name: &'static str, rate: &'static str, axis: Axis) -> Self {
        let [cosine, sine] = angle_about(axis);
        Coordinate {
            name,
            rate,
            measure: Measure::Angle { cosine, sine },
        }
    }

    /// What it measures: a length [m] or an angle [rad].
    #[must_use]
    pub const fn dimension(&self) -> Dimension {
        match self.measure {
            Measure::Slide(_) => LENGTH,
            Measure::Angle { .. } | Measure::Thread { .. } => ANGLE,
        }
    }

    /// What its rate measures [m/s or rad/s].
    #[must_use]
    pub const fn rate_dimension(&self) -> Dimension {
        Dimension {
            time: -2,
            ..self.dimension()
        }
    }

    /// Its unit: `rad` of an angle, else `m`.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        if self.is_angle() { "rad" } else { "m" }
    }

    /// Whether it is an angle [rad].
    #[must_use]
    pub const fn is_angle(&self) -> bool {
        !matches!(self.measure, Measure::Slide(_))
    }

    /// Whether it jumps by a full turn where it passes half a turn.
    #[must_use]
    pub const fn is_periodic(&self) -> bool {
        matches!(self.measure, Measure::Angle { .. })
    }
}
