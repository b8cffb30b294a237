//! Joint coordinates in motion: value, rate, direction of the generalised force, γ; once for all joints.
//!
//! ```text
//! slide     s = a1·d                      an in-plane row (3) of [`crate::rows::basic`]                                  [m]      (1)
//! turn      θ = atan2(S, C)               C = a1·b2, S = c1·d2, two perpendicular rows (2)                        [rad]    (2)
//!           ρ = C² + S²                   1 where the joint holds
//!           Φ_v(θ) = (C Φ_v(S) − S Φ_v(C))/ρ,   θ̇ = (C Ṡ − S Ċ)/ρ                                                          (3)
//!           γ(θ) = (C γ(S) − S γ(C) + θ̇ ρ̇)/ρ,   ρ̇ = 2 (C Ċ + S Ṡ)                                                          (4)
//! thread    θ = φ + atan2(S cos φ − C sin φ, C cos φ + S sin φ),   φ = a1·d/h, h = pitch/2π                     [rad]    (5)
//!           the turn nearest to what the displacement says; Φ_v(θ) and γ(θ) are those of the turn, φ drops out of them
//! ```
//!
//! The second rate of a coordinate is Φ_v v̇ − γ. A generalised force Q [N or N m] on a coordinate acts on the bodies as Φ_vᵀ Q: its power
//! is Q times the rate, in every state, also off the joint. A turn lies in (−π, π] and jumps there; a thread counts turns, and what acts along it is a
//! couple about its axis: the nut carries what pushes along the axis, not the couple.
//! Singular at ρ = 0, a quarter turn off the joint, where no angle is defined. Rejected: θ̇ = a1·(ω_c − ω_p), which is the rate of θ only
//! where the joint holds, so that the energy of a spring would not balance inside a step.
//! Source: derived, from the rows of Kamman, Connecting Joints I.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::basic::{Row, in_plane, rotated_rows};
use super::ends::Ends;
use crate::vocabulary::angle_about;
use crate::{Axis, Coordinate, Measure, Real};

/// An angle while it is measured: C and S, the rows C Φ(S) − S Φ(C) and C Φ(C) + S Φ(S) at these, and 1/ρ.
struct MeasuredAngle<S: Real> {
    products: [S; 2],
    behind: Row<S>,
    ahead: Row<S>,
    inverse: S,
}

impl<S: Real> MeasuredAngle<S> {
    fn new(ends: &Ends<'_, S>, cosine: &[Axis; 2], sine: &[Axis; 2]) -> Self {
        let [x, y] = [cosine, sine].map(|[a, b]| ends.cosine(a, b));
        let [behind, ahead] = rotated_rows(ends, cosine, sine, (y, x));
        MeasuredAngle {
            products: [x, y],
            behind,
            ahead,
            inverse: S::one() / (x * x + y * y),
        }
    }

    /// Φ_v by (3).
    fn parent(&self) -> Vector3<S> {
        self.behind.parent().angular.map(|n| n * self.inverse)
    }

    /// θ, Φ_v and γ by (2) to (4); w = ω_p − ω_c.
    fn row(&self, w: &Vector3<S>) -> Row<S> {
        let [x, y] = self.products;
        let row = self.behind.scaled(self.inverse);
        let stretching = S::from_f64(2.0) * self.ahead.parent().angular.dot(w);
        let own = row.parent().angular.dot(w) * (stretching * self.inverse);
        Row {
            value: y.atan2(x),
            bias: row.bias + own,
            relative: row.relative + own,
            ..row
        }
    }
}

impl<S: Real> Ends<'_, S> {
    /// The value of a coordinate [m or rad].
    pub fn value(&self, coordinate: &Coordinate) -> S {
        let value = match &coordinate.measure {
            Measure::Slide(axis) => self.displacement(axis),
            Measure::Angle { cosine, sine } => {
                let [c, s] = [cosine, sine].map(|[a, b]| self.cosine(a, b));
                s.atan2(c)
            }
            Measure::Thread { axis, pitch } => self.thread_angle(axis, *pitch),
        };
        value.label(coordinate.name)
    }

    /// The rate of a coordinate [m/s or rad/s].
    pub fn rate(&self, coordinate: &Coordinate) -> S {
        let rate = match &coordinate.measure {
            Measure::Slide(axis) => self.way_rate(axis),
            Measure::Angle { cosine, sine } => self.turning(cosine, sine),
            Measure::Thread { axis, .. } => {
                let [cosine, sine] = angle_about(*axis);
                self.turning(&cosine, &sine)
            }
        };
        rate.label(coordinate.rate)
    }

    /// A coordinate as a row: its value, Φ_v of (1) or (3), γ of (4). A motion that keeps the coordinate's rate has Φ_v v̇ = γ.
    pub fn row(&self, coordinate: &Coordinate) -> Row<S> {
        let w = || self.spin().difference;
        match &coordinate.measure {
            Measure::Slide(axis) => in_plane(self, axis),
            Measure::Angle { cosine, sine } => MeasuredAngle::new(self, cosine, sine).row(&w()),
            Measure::Thread { axis, .. } => {
                let [cosine, sine] = angle_about(*axis);
                Row {
                    value: self.value(coordinate),
                    ..MeasuredAngle::new(self, &cosine, &sine).row(&w())
                }
            }
        }
    }

    /// The rate of an angle by (3).
    fn turning(&self, cosine: &[Axis; 2], sine: &[Axis; 2]) -> S {
        let swept = MeasuredAngle::new(self, cosine, sine).parent();
        swept.dot(&self.spin().difference)
    }

    /// θ of (5).
    fn thread_angle(&self, axis: &Axis, pitch: usize) -> S {
        let [cosine, sine] = angle_about(*axis);
        let angle = self.displacement(axis) / self.lead(pitch);
        let (sin, cos) = angle.sin_cos();
        let [c, s] = [cosine, sine].map(|[a, b]| self.cosine(&a, &b));
        angle + (s * cos - c * sin).atan2(c * cos + s * sin)
    }

    /// a1·d [m].
    fn displacement(&self, axis: &Axis) -> S {
        let gap = self.reach() - self.parent.arm;
        self.parent.axis(axis).dot(&gap)
    }

    /// Its rate [m/s]: a1·(u − ω_p × e).
    fn way_rate(&self, axis: &Axis) -> S {
        self.parent.axis(axis).dot(&self.slide_rate())
    }

    /// Displacement along the axis per radian [m/rad].
    fn lead(&self, pitch: usize) -> S {
        (self.number(pitch) * S::from_f64(1.0 / TAU)).label("lead")
    }
}
