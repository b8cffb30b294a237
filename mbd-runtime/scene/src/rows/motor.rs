//! A motor: a coordinate of a joint that a course f prescribes, one more row of the joint. f, ḟ and f̈ are those of a function of time, or three
//! quantities of inputs and states.
//!
//! ```text
//! slide     Φ = a1·d − f(t)               Φ_t = −ḟ                    γ = γ(a1·d) + f̈                              [m]      (1)
//! turn      Φ = S cos f − C sin f         Φ_t = −(S sin f + C cos f) ḟ                                             [1]      (2)
//!           γ = cos f γ(S) − sin f γ(C) + 2 (Ṡ sin f + Ċ cos f) ḟ + (S sin f + C cos f) f̈ + (S cos f − C sin f) ḟ²          (3)
//! thread    as (1), for θ of coordinates (5)                                                                           [rad]    (4)
//! ```
//!
//! One of the two axes of C is that of S, so that (2) is the product of that axis and of the other two rotated by f: one row, whatever f.
//! C and S are the cosine and the sine of the angle as in [`crate::rows::coordinate`], so that (2) is sin(θ − f): f may count turns, and nothing
//! jumps. It also holds half a turn off: the start must satisfy cos(θ − f) > 0. The multiplier of the row is the force [N] or the torque
//! [N m] of the motor along the coordinate. Singular, half a turn off apart, only where nothing is left to move.
//! Rejected: θ − f with θ from atan2, which jumps once a turn. Source: derived.

use super::basic::{Row, rotated_rows};
use super::ends::Ends;
use crate::{Coordinate, Jet, Measure, Real};

impl<S: Real> Ends<'_, S> {
    /// The row that holds a coordinate to a course of time.
    pub fn prescribed(&self, coordinate: &Coordinate, course: &Jet<S>) -> Row<S> {
        let Measure::Angle { cosine, sine } = &coordinate.measure else {
            let row = self.row(coordinate);
            return Row {
                value: row.value - course.value,
                time: row.time - course.rate,
                bias: row.bias + course.curve,
                relative: row.relative + course.curve,
                ..row
            };
        };
        let [row, ahead] = rotated_rows(self, cosine, sine, course.value.sin_cos());
        let turning = ahead.parent().angular.dot(&self.spin().difference);
        let ahead = ahead.value;
        let own = (turning + turning) * course.rate
            + ahead * course.curve
            + row.value * (course.rate * course.rate);
        Row {
            time: -(ahead * course.rate),
            bias: row.bias + own,
            relative: row.relative + own,
            ..row
        }
    }

    /// The row whose Φ_v v̇ − γ is the second rate of a coordinate: (1), or (2) for f the angle itself, where d²(sin(θ − f))/dt² = θ̈.
    pub fn second_rate(&self, coordinate: &Coordinate) -> Row<S> {
        let here = Jet {
            value: self.value(coordinate),
            rate: S::zero(),
            curve: S::zero(),
        };
        let mut row = self.prescribed(coordinate, &here);
        row.prescribe(self);
        row
    }

    /// cos(θ − f) of (2), positive on the branch that is meant; 1 for a coordinate without another.
    pub fn prescribed_cosine(&self, coordinate: &Coordinate, course: S) -> S {
        let Measure::Angle { cosine, sine } = &coordinate.measure else {
            return S::one();
        };
        let (sin, cos) = course.sin_cos();
        self.cosine(&sine[0], &sine[1]) * sin + self.cosine(&cosine[0], &cosine[1]) * cos
    }
}
