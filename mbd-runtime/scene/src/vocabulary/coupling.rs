//! Couplings: joints that hold a linear relation of coordinates of other joints. What such a joint says; the law is in [`crate::laws::coupling`].

use crate::scalar::Few;
use crate::{Coordinate, Dimension, Real};

/// Most coordinates that one coupling couples.
pub const MOST_COUPLED: usize = 3;

/// A relation Σ f x = c of joint coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Relation<S> {
    /// f, one a coordinate.
    pub factors: Few<S, MOST_COUPLED>,
    /// c.
    pub constant: S,
}

impl<S: Real> Relation<S> {
    /// Of factors, in the order of the coordinates.
    #[must_use]
    pub fn new<const N: usize>(factors: [S; N], constant: S) -> Self {
        const { assert!(N <= MOST_COUPLED) };
        let mut few = Few::new(S::zero());
        few.extend(factors);
        Relation {
            factors: few,
            constant,
        }
    }
}

/// What a number of a coupling between two coordinates measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupled {
    /// The coordinate that follows; zero where it is not given.
    To,
    /// That coordinate per the one that leads; it must be given.
    ToPerFrom,
}

impl Coupled {
    /// The dimension and the unit, with the radians that a dimension does not show.
    #[must_use]
    pub fn of(self, [to, from]: &[Coordinate; 2]) -> (Dimension, &'static str) {
        let per = match self {
            Coupled::To => Dimension::default(),
            Coupled::ToPerFrom => from.dimension(),
        };
        let dimension = Dimension {
            length: to.dimension().length - per.length,
            ..to.dimension()
        };
        let unit = match (self, to.is_angle(), from.is_angle()) {
            (Coupled::To, true, _) => "rad",
            (Coupled::To, false, _) => "m",
            (Coupled::ToPerFrom, true, false) => "rad/m",
            (Coupled::ToPerFrom, false, true) => "m/rad",
            (Coupled::ToPerFrom, ..) => "",
        };
        (dimension, unit)
    }
}
