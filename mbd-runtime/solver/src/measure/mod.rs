//! Metrics while a run goes on: of every step that is taken, the quantity over the step, by the interpolant of the method.
//!
//! Over a step a quantity is a polynomial through nine values. Where its last coefficients say that it is not one, the step is cut in half, and each
//! half again: a corner is enclosed, a curve resolved. Extremes, passings of a level and integrals then are those of polynomials. So a metric neither depends
//! on which rows a history has nor on where steps happen to end.
//!
//! Rejected: reading metrics from the rows of a history, straight between them: their error is that of the grid and not that of the run.

mod polynomial;
mod sum;

use crate::error::StepError;
use crate::metric::MetricReader;
use polynomial::{POINTS, Polynomial};
use sum::Sum;

/// Writes the columns at a part of a step, 0 … 1.
type ColumnValues<'a> = dyn FnMut(f64, &mut [f64]) -> Result<(), StepError> + 'a;

/// The most halvings of a step.
const DEEPEST: usize = 30;
/// Halvings after which what does not get smaller is noise.
const PATIENCE: usize = 3;

/// What is measured of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measures {
    /// What, and which of the columns each reads.
    readers: Vec<(MetricReader, usize)>,
    sums: Vec<Sum>,
    columns: Vec<Column>,
    /// Values at the points of the halves of each halving, column by column.
    values: Vec<f64>,
    /// What becomes of each column over each half.
    states: Vec<Resolving>,
    /// Up to when the run was measured [s].
    until: f64,
    /// The instant whose values are the first of those [s]; NaN: of none.
    held: f64,
    /// What was known at an instant the run may go back to [s].
    kept: (f64, Vec<Sum>),
}

/// The same metrics with the same values, to the bit.
impl PartialEq for Measures {
    fn eq(&self, other: &Self) -> bool {
        let values = |measures: &Self| -> Vec<u64> {
            let all = measures.readers.iter().zip(&measures.sums);
            let values = all.map(|((reader, _), sum)| sum.value(reader.take).to_bits());
            values.collect()
        };
        self.readers == other.readers && values(self) == values(other)
    }
}

/// What is known of a quantity that is measured.
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    /// Its largest size so far.
    size: f64,
    /// What halving did not make smaller.
    noise: f64,
}

/// What becomes of a column over a half: each is resolved by itself, so that no metric depends on which others there are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Resolving {
    /// It was resolved over more than this half.
    #[default]
    Done,
    /// It is resolved here, or gets no smoother.
    Here,
    /// It is cut further.
    Further,
}

/// A half of a part of a step: how often the step was halved, which half, and where it lies in the step, 0 … 1.
#[derive(Clone, Copy)]
struct Half {
    depth: usize,
    side: usize,
    part: [f64; 2],
}

impl Half {
    /// Its place among all that are under way at once.
    fn index(self) -> usize {
        2 * self.depth + self.side
    }
}

/// The step that is measured.
#[derive(Clone, Copy)]
pub(crate) struct MeasuredStep {
    /// Its start [s].
    pub time: f64,
    /// Its size [s].
    pub size: f64,
    /// Up to which part of its size a quantity is resolved.
    pub tolerance: f64,
}

impl Measures {
    /// Of these metrics, each of which reads one of so many columns.
    pub(crate) fn new(readers: Vec<(MetricReader, usize)>, columns: usize) -> Self {
        let mut measures = Measures {
            sums: vec![Sum::NOTHING; readers.len()],
            columns: vec![Column::default(); columns],
            values: vec![0.0; (2 * DEEPEST + 2) * POINTS * columns],
            states: vec![Resolving::Done; (2 * DEEPEST + 2) * columns],
            until: f64::NAN,
            held: f64::NAN,
            kept: (f64::NAN, vec![Sum::NOTHING; readers.len()]),
            readers,
        };
        measures.clear();
        measures
    }

    /// Whether there is anything to measure over time.
    pub(crate) fn is_empty(&self) -> bool {
        self.readers.is_empty()
    }

    /// For another run.
    pub(crate) fn clear(&mut self) {
        self.sums.fill(Sum::NOTHING);
        self.columns.fill(Column::default());
        (self.until, self.held) = (f64::NAN, f64::NAN);
        self.kept.0 = f64::NAN;
    }

    /// The value of a metric; `None` where it is not measured.
    pub(crate) fn value(&self, reader: &MetricReader) -> Option<[f64; 2]> {
        let mut all = self.readers.iter().zip(&self.sums);
        let (_, sum) = all.find(|((known, _), _)| known == reader)?;
        Some([sum.value(reader.take), sum.open(reader.take)])
    }

    /// An event, at the last instant that was measured.
    pub(crate) fn happens(&mut self, time: f64, event: &str) {
        let all = self.sums.iter_mut().zip(&self.readers);
        for (sum, (reader, _)) in all.filter(|(_, (reader, _))| reader.event == event) {
            sum.happens(reader, time);
        }
    }

    /// Adds what a later part of the run was measured to be, by a history whose columns are in these places here.
    pub(crate) fn add_part(&mut self, part: &Measures, places: &[usize]) {
        for ((reader, _), sum) in part.readers.iter().zip(&part.sums) {
            let reader = MetricReader {
                column: places.get(reader.column).copied().unwrap_or(0),
                ..reader.clone()
            };
            let known = self.readers.iter().position(|(known, _)| *known == reader);
            match known.and_then(|at| self.sums.get_mut(at)) {
                Some(own) => own.add_part(&reader, sum),
                None => {
                    self.readers.push((reader, 0));
                    self.sums.push(*sum);
                }
            }
        }
    }

    /// Keeps what is known at this instant, to go back to.
    pub(crate) fn keep(&mut self, time: f64) {
        self.kept.0 = time;
        self.kept.1.copy_from_slice(&self.sums);
    }

    /// Takes back what was measured after a time. What cannot be taken back has no value any more.
    pub(crate) fn cut(&mut self, time: f64) {
        self.held = f64::NAN;
        if self.until.is_nan() || self.until <= time {
            return;
        }
        if self.kept.0 == time {
            self.sums.copy_from_slice(&self.kept.1);
        } else {
            self.sums.iter_mut().for_each(Sum::spoil);
        }
        self.until = time;
    }

    /// An instant: the start of a run, its end behind what events changed there. `at` writes the columns.
    pub(crate) fn instant(
        &mut self,
        time: f64,
        mut at: impl FnMut(&mut [f64]) -> Result<(), StepError>,
    ) -> Result<(), StepError> {
        let count = self.columns.len();
        if count > 0 {
            at(self.values.get_mut(..count).unwrap_or_default())?;
        }
        for ((reader, column), sum) in self.readers.iter().zip(&mut self.sums) {
            let value = self.values.get(*column).copied().unwrap_or(f64::NAN);
            let polynomial = Polynomial::through([value; POINTS]);
            sum.add(reader, &polynomial, [time; 2], (false, 0.0));
        }
        (self.until, self.held) = (time, time);
        Ok(())
    }

    /// A step. `at` writes the columns at a part of it, 0 … 1.
    pub(crate) fn step(
        &mut self,
        step: MeasuredStep,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let whole = Half {
            depth: 0,
            side: 0,
            part: [0.0, 1.0],
        };
        if !self.columns.is_empty() {
            self.sample(whole, &|_| true, at)?;
            for column in 0..self.columns.len() {
                let state = match self.is_open(whole, column, step) {
                    true => Resolving::Further,
                    false => Resolving::Here,
                };
                self.set_state(whole, column, state);
            }
            self.resolve(whole, step, at)?;
        }
        (self.until, self.held) = (step.time + step.size, f64::NAN);
        Ok(())
    }

    /// A step between whose ends the quantities have no value of their own, as the forces of a `stepwise` node, whose rule is one of whole steps: straight
    /// between them.
    pub(crate) fn step_by_ends(
        &mut self,
        step: MeasuredStep,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let count = self.columns.len();
        let times = [step.time, step.time + step.size];
        let (now, before) = self.values.split_at_mut(count);
        let before = before.get_mut(..count).unwrap_or_default();
        if self.held == step.time {
            before.copy_from_slice(now);
        } else if count > 0 {
            at(0.0, before)?;
        }
        if count > 0 {
            at(1.0, now)?;
        }
        for ((reader, column), sum) in self.readers.iter().zip(&mut self.sums) {
            let end = |list: &[f64]| list.get(*column).copied().unwrap_or(f64::NAN);
            let (a, b) = (end(before), end(now));
            let polynomial = Polynomial::through(Polynomial::places().map(|part| match part {
                1.0 => b,
                part => a + part * (b - a),
            }));
            sum.add(reader, &polynomial, times, (false, 0.0));
        }
        (self.until, self.held) = (times[1], times[1]);
        Ok(())
    }

    /// Evaluates the columns at the points of a half, for those that `count` there.
    fn sample(
        &mut self,
        half: Half,
        counts: &dyn Fn(Resolving) -> bool,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let count = self.columns.len();
        let [low, high] = half.part;
        let states = self.states.get(half.index() * count..).unwrap_or_default();
        let room = self.values.chunks_exact_mut(count.max(1));
        let rows = room.skip(half.index() * POINTS);
        for (place, row) in Polynomial::places().into_iter().zip(rows) {
            at(low + place * (high - low), row)?;
            let all = self.columns.iter_mut().zip(row.iter()).zip(states);
            for ((column, value), _) in all.filter(|(_, state)| counts(**state)) {
                column.size = column.size.max(value.abs());
            }
        }
        Ok(())
    }

    fn state(&self, half: Half, column: usize) -> Resolving {
        let at = half.index() * self.columns.len() + column;
        self.states.get(at).copied().unwrap_or_default()
    }

    fn set_state(&mut self, half: Half, column: usize, state: Resolving) {
        let at = half.index() * self.columns.len() + column;
        if let Some(slot) = self.states.get_mut(at) {
            *slot = state;
        }
    }

    /// A column over a half.
    fn polynomial(&self, half: Half, column: usize) -> Polynomial {
        let count = self.columns.len();
        let first = half.index() * POINTS;
        let value = |point: usize| self.values.get((first + point) * count + column).copied();
        Polynomial::through(std::array::from_fn(|point| {
            value(point).unwrap_or(f64::NAN)
        }))
    }

    /// Whether a column is not yet resolved over a half.
    fn is_open(&self, half: Half, column: usize, step: MeasuredStep) -> bool {
        let known = self.columns.get(column).copied().unwrap_or_default();
        let allowed = (step.tolerance * known.size).max(2.0 * known.noise);
        self.polynomial(half, column).tail() > allowed
    }

    /// Adds the columns that are resolved over a half of which the values are known, and cuts it for the others.
    fn resolve(
        &mut self,
        half: Half,
        step: MeasuredStep,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        self.add(half, step);
        let all = 0..self.columns.len();
        let further = |column: usize| self.state(half, column) == Resolving::Further;
        if !all.clone().any(further) {
            return Ok(());
        }
        let [low, high] = half.part;
        let middle = 0.5 * (low + high);
        let halves = [([low, middle], 0), ([middle, high], 1)].map(|(part, side)| Half {
            depth: half.depth + 1,
            side,
            part,
        });
        for own in halves {
            for column in all.clone() {
                let state = self.state(half, column);
                self.set_state(own, column, state);
            }
            self.sample(own, &|state| state == Resolving::Further, at)?;
        }
        for column in all {
            let states = match self.state(half, column) {
                Resolving::Further => self.cut_column(half, halves, column, step),
                Resolving::Here | Resolving::Done => [Resolving::Done; 2],
            };
            for (own, state) in halves.into_iter().zip(states) {
                self.set_state(own, column, state);
            }
        }
        for own in halves {
            self.resolve(own, step, at)?;
        }
        Ok(())
    }

    /// What becomes of a column over both halves of a part over which it was not resolved.
    fn cut_column(
        &mut self,
        whole: Half,
        halves: [Half; 2],
        column: usize,
        step: MeasuredStep,
    ) -> [Resolving; 2] {
        let open = halves.map(|half| self.is_open(half, column, step));
        let depth = whole.depth + 1;
        let before = self.polynomial(whole, column).tail();
        let [one, other] = halves.map(|half| self.polynomial(half, column).tail());
        let smaller = one.min(other);
        if open == [true; 2] && smaller > 0.5 * before && depth >= PATIENCE {
            // Both halves are as rough as the whole.
            if let Some(known) = self.columns.get_mut(column) {
                known.noise = known.noise.max(smaller);
            }
            return [Resolving::Here; 2];
        }
        open.map(|open| match open && depth < DEEPEST {
            true => Resolving::Further,
            false => Resolving::Here,
        })
    }

    fn add(&mut self, half: Half, step: MeasuredStep) {
        let times = half.part.map(|part| match part {
            1.0 => step.time + step.size,
            part => step.time + part * step.size,
        });
        for index in 0..self.readers.len() {
            let Some((reader, column)) = self.readers.get(index) else {
                continue;
            };
            if self.state(half, *column) != Resolving::Here {
                continue;
            }
            let polynomial = self.polynomial(half, *column);
            let size = self.columns.get(*column).map_or(0.0, |known| known.size);
            let tail = polynomial.tail();
            let rough = tail > step.tolerance * size;
            // What is halved that often is a corner or a jump in an interval of time that is nothing.
            let open = match rough && half.depth < DEEPEST {
                true => tail,
                false => 0.0,
            };
            if let Some(sum) = self.sums.get_mut(index) {
                sum.add(reader, &polynomial, times, (rough, open));
            }
        }
    }
}
