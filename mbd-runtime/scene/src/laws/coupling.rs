//! Couplings: one row over the ends of several joints, a linear relation of their coordinates.
//!
//! ```text
//! Φ = Σ f x − c,   Φ_v = Σ f Φ_v(x),   γ = Σ f γ(x)          x, Φ_v(x), γ(x) of `rows/coordinate.rs`                (1)
//! Φ → m atan2(sin(Φ/m), cos(Φ/m))                                                                                (2)
//! ```
//!
//! An angle of (−π, π] is known up to full turns, so Φ of one such angle up to multiples of 2π f, and of several up to multiples of 2π m: m is
//! the largest number of which their factors are whole multiples. (2) is the nearest to zero of these, so nothing jumps while the coupling
//! holds, and every root is one that is meant: a gear shifted by a tooth is the same gear. m is live for one angle; for several the factors
//! are constants with a common measure, 20/43 and not √2. Without such angles there is nothing to take out.
//! Rejected: sin(Φ/m), which also holds half a period off and needs a branch; counting turns, which is hidden memory.
//! Source: derived.

use crate::laws::numbers::constant;
use crate::rows::{Row, Rows};
use crate::vocabulary::Relation;
use crate::{Formula, Joint, Real, Scene};

/// Most periods of the relation in that of its smallest factor.
const MOST_PERIODS: f64 = 1000.0;
/// Less than this part of the smallest factor is rounding.
const ROUNDING: f64 = 1e-9;

/// The constants of a coupling.
#[derive(Clone, Copy, Debug)]
pub struct Coupling<S> {
    relation: Relation<S>,
    /// m of (2); `None`: nothing is periodic.
    measure: Option<S>,
}

impl<S: Real> Coupling<S> {
    /// Of a joint with these numbers; `None` if it couples nothing. NaN makes Φ of a relation that (2) cannot make continuous.
    pub fn new(scene: &Scene, joint: &Joint, numbers: &[S]) -> Option<Self> {
        let relation = joint.law.relation(numbers)?;
        let factors = relation.factors.iter().zip(periodic(scene, joint));
        let mut factors = factors.filter_map(|(factor, periodic)| periodic.then_some(*factor));
        let measure = match (factors.next(), factors.next()) {
            (None, _) => None,
            (Some(only), None) => Some(only.abs()),
            _ => Some(S::from_f64(measure(scene, joint).unwrap_or(f64::NAN))),
        };
        Some(Coupling { relation, measure })
    }

    /// Writes the row from those of its coordinates.
    pub fn constrain(&self, coordinates: impl Iterator<Item = Row<S>>, rows: &mut Rows<S>) {
        let factors = self.relation.factors.iter();
        let terms = coordinates
            .zip(factors)
            .map(|(row, &factor)| row.scaled(factor));
        rows.couple(terms, |sum| self.value(sum));
    }

    /// Writes the row that holds one coordinate at a number, or, without one, where it is.
    pub fn hold(&self, of: impl Iterator<Item = Row<S>>, at: Option<S>, rows: &mut Rows<S>) {
        rows.couple(of.take(1), |value| {
            at.map_or_else(S::zero, |at| self.value(value - at))
        });
    }

    /// f of a coordinate.
    pub fn factor(&self, number: usize) -> S {
        let factors = self.relation.factors.iter();
        factors.copied().nth(number).unwrap_or_else(S::zero)
    }

    /// Φ for Σ f x, by (1) alone: turns of the angles count.
    pub fn off(&self, sum: S) -> S {
        sum - self.relation.constant
    }

    /// Φ for Σ f x, by (1) and (2).
    pub fn value(&self, sum: S) -> S {
        let off = self.off(sum);
        self.measure.map_or(off, |measure| {
            let (sin, cos) = (off / measure).sin_cos();
            measure * sin.atan2(cos)
        })
    }
}

/// Per coordinate that a joint couples, whether it jumps by full turns.
fn periodic<'a>(scene: &'a Scene, joint: &'a Joint) -> impl Iterator<Item = bool> + 'a {
    let couples = joint.law.couples().iter();
    couples.map(|&(of, index)| {
        let coordinate = scene.coordinate(of, index);
        coordinate.is_some_and(|(_, coordinate)| coordinate.is_periodic())
    })
}

/// Whether a joint couples angles that jump by full turns in a relation that cannot be made continuous: of several such angles by factors that
/// are not constants with a common measure.
#[must_use]
pub fn is_discontinuous(scene: &Scene, joint: &Joint) -> bool {
    periodic(scene, joint).filter(|periodic| *periodic).count() > 1
        && measure(scene, joint).is_none()
}

/// m of (2) of several angles.
fn measure(scene: &Scene, joint: &Joint) -> Option<f64> {
    let live =
        |formula: &Formula| scene.contains(formula, |part| matches!(part, Formula::Param(_)));
    let numbers = joint.law.numbers();
    let numbers = numbers.iter().map(|(_, formula)| match live(formula) {
        true => f64::NAN,
        false => constant(scene, &[], formula),
    });
    let numbers: Vec<f64> = numbers.collect();
    let relation = joint.law.relation(&numbers)?;
    let factors = relation.factors.iter().zip(periodic(scene, joint));
    let factors = factors.filter_map(|(factor, periodic)| periodic.then_some(factor.abs()));
    let factors: Vec<f64> = factors.collect();
    if !factors.iter().all(|factor| factor.is_finite()) {
        return None;
    }
    let smallest = factors.iter().copied().fold(f64::INFINITY, f64::min);
    let common = factors.into_iter().reduce(|mut a, mut b| {
        // Euclid, as far as rounding lets it.
        while b > ROUNDING * smallest {
            (a, b) = (b, (a - b * (a / b).round()).abs());
        }
        a
    })?;
    let periods = (smallest / common).round();
    ((1.0..=MOST_PERIODS).contains(&periods)).then(|| smallest / periods)
}
