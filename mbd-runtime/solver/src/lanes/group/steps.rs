//! The steps of a group: those that were taken up, and those that were made.

use super::super::Lanes;
use super::MOST;
use crate::system::EndLooks;

/// The steps that were taken up.
pub(super) struct Upcoming {
    /// Start and size of each lane's [s]; not a number where there is none.
    pub steps: [[f64; 2]; MOST],
    /// How many there are, and the first lane with one.
    pub count: usize,
    pub first: usize,
    /// What some run looks at at the end.
    pub looks: EndLooks,
}

impl Upcoming {
    pub const NONE: Upcoming = Upcoming {
        steps: [[f64::NAN; 2]; MOST],
        count: 0,
        first: MOST,
        looks: EndLooks::NOTHING,
    };

    pub fn add(&mut self, lane: usize, step: [f64; 2], looks: EndLooks) {
        self.steps[lane] = step;
        self.count += 1;
        self.first = self.first.min(lane);
        self.looks = self.looks.and(looks);
    }

    pub fn has(&self, lane: usize) -> bool {
        let own = self.steps.get(lane);
        own.is_some_and(|[time, _]| time.is_finite())
    }

    /// Times at the start, or sizes; idle lanes have those of the first that is not.
    pub fn lanes<L: Lanes>(&self, which: usize) -> L {
        L::each(|lane| match self.has(lane) {
            true => self.steps[lane][which],
            false => self.steps[self.first][which],
        })
    }
}

/// Steps that were made, and what is known at their ends.
pub(super) struct MadeSteps<L> {
    pub steps: Upcoming,
    pub energy: [L; 6],
    pub drift: L,
    /// One in a lane whose nodes were found along with the rates.
    pub holds: L,
    /// Zero in a lane in which every rate is finite.
    pub faults: L,
    /// [`Explicit::squares`].
    pub squares: [L; 3],
}

impl<L: Lanes> MadeSteps<L> {
    /// Whether there is one in a lane that its run can go on from.
    pub fn has(&self, lane: usize) -> bool {
        self.steps.has(lane) && self.holds.lane(lane) == 1.0 && self.faults.lane(lane) == 0.0
    }
}
