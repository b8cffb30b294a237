//! The step that is measured, and the halves that it is cut into.

use super::polynomial::{POINTS, Polynomial};

/// Halvings after which what something of time alone hides is noise: it may swing thousands of times in a step.
pub(super) const FASTEST: usize = 10;

/// A half of a part of a step: how often the step was halved, which half, and where it lies in the step, 0 … 1.
#[derive(Clone, Copy)]
pub(super) struct Half {
    pub depth: usize,
    pub side: usize,
    pub part: [f64; 2],
}

impl Half {
    /// A whole step.
    pub const WHOLE: Half = Half {
        depth: 0,
        side: 0,
        part: [0.0, 1.0],
    };

    /// Both of its halves.
    pub fn halves(self) -> [Half; 2] {
        let [low, high] = self.part;
        let middle = 0.5 * (low + high);
        [([low, middle], 0), ([middle, high], 1)].map(|(part, side)| Half {
            depth: self.depth + 1,
            side,
            part,
        })
    }

    /// Its place among all that are under way at once.
    pub fn index(self) -> usize {
        2 * self.depth + self.side
    }
}

/// Whether something of time alone that is measured is hidden between looks at times of a span [s].
pub(crate) type HiddenInTime<'a> = dyn Fn([f64; 2], &[f64]) -> bool + 'a;

/// The step that is measured.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredStep<'a> {
    /// Its start [s].
    pub time: f64,
    /// Its size [s].
    pub size: f64,
    /// Its end [s], as the next one begins: the sum of both but for rounding.
    pub end: f64,
    /// Up to which part of its size a quantity is resolved.
    pub tolerance: f64,
    /// Whether quantities have no value of their own between its ends, as the forces of a `stepwise` node, whose rule is one of whole steps: they are
    /// straight there.
    pub straight: bool,
    /// Whether quantities are at its start what they were at the end of the step before.
    pub continues: bool,
    /// What tells whether looks hide something; `None` where nothing that is measured is of time alone.
    pub hidden: Option<&'a HiddenInTime<'a>>,
}

impl MeasuredStep<'_> {
    /// When a part of it begins and ends [s].
    pub(super) fn times(&self, part: [f64; 2]) -> [f64; 2] {
        part.map(|part| match part {
            1.0 => self.end,
            part => self.time + part * self.size,
        })
    }

    /// Whether so many looks at a half hide something of time alone.
    pub(super) fn hides(&self, half: Half, count: usize) -> bool {
        let Some(hidden) = self.hidden.filter(|_| half.depth < FASTEST) else {
            return false;
        };
        let [low, high] = half.part;
        let stride = Polynomial::stride(count);
        let places = Polynomial::places();
        let mut looks = [0.0; POINTS];
        let own = places.iter().step_by(stride);
        for (look, place) in looks.iter_mut().zip(own) {
            *look = self.time + (low + place * (high - low)) * self.size;
        }
        hidden(
            self.times(half.part),
            looks.get(..count).unwrap_or_default(),
        )
    }
}
