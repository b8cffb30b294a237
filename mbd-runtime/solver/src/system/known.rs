//! What was evaluated elsewhere at the end of a step that is tried: energy, and the lists that a run reads there.

use mbd_scene::{Float, Layout, Quantity};

/// The lists of numbers that can be known: guards, declared outputs, tension and stretch of the lines, angles whose turns are counted.
pub(crate) const LISTS: [Quantity; 4] = [
    Quantity::Guards,
    Quantity::Outputs,
    Quantity::Lines,
    Quantity::CountedAngles,
];

/// Where outputs and lines are among them.
pub(crate) const OUTPUTS: usize = 1;
pub(crate) const LINES: usize = 2;

/// What a run looks at at the end of every step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct EndLooks {
    /// Energy and powers, by the model.
    pub energy: bool,
    /// Each of [`LISTS`].
    pub lists: [bool; LISTS.len()],
}

impl EndLooks {
    /// Nothing.
    pub(crate) const NOTHING: EndLooks = EndLooks {
        energy: false,
        lists: [false; LISTS.len()],
    };

    /// What either looks at.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        let lists = self.lists.iter().zip(other.lists);
        let mut either = lists.map(|(own, other)| *own || other);
        EndLooks {
            energy: self.energy || other.energy,
            lists: std::array::from_fn(|_| either.next().unwrap_or_default()),
        }
    }
}

/// Energy and lists at the end of a step, as long as that is neither taken nor tried anew.
#[derive(Clone, Debug)]
pub(crate) struct KnownAtEnd<T> {
    /// When [s]; not a number where nothing is known.
    time: f64,
    energy: Option<[T; 6]>,
    /// Each of [`LISTS`], and whether it is known.
    lists: [(Vec<T>, bool); LISTS.len()],
}

impl<T: Float> KnownAtEnd<T> {
    /// Nothing is known.
    pub(crate) fn new(layout: &Layout) -> Self {
        KnownAtEnd {
            time: f64::NAN,
            energy: None,
            lists: LISTS.map(|what| (vec![T::zero(); layout.len(what)], false)),
        }
    }

    /// Knows what was evaluated at a time [s]; `fill` writes one of [`LISTS`], by its place there, or says that it is not known.
    pub(crate) fn learn(
        &mut self,
        time: f64,
        energy: Option<[T; 6]>,
        fill: impl Fn(usize, &mut [T]) -> bool,
    ) {
        (self.time, self.energy) = (time, energy);
        for (place, (list, known)) in self.lists.iter_mut().enumerate() {
            *known = fill(place, list);
        }
    }

    /// The end of another step comes next.
    pub(crate) fn forget(&mut self) {
        self.time = f64::NAN;
    }

    /// A list at a time, if it is known.
    pub(crate) fn list(&self, what: Quantity, time: f64) -> Option<&[T]> {
        if self.time != time {
            return None;
        }
        let mut own = LISTS.iter().zip(&self.lists);
        let (_, (list, known)) = own.find(|(own, _)| **own == what)?;
        known.then_some(list)
    }

    /// Energy and powers at a time, if they are known.
    pub(crate) fn energy(&self, time: f64) -> Option<[T; 6]> {
        self.energy.filter(|_| self.time == time)
    }
}
