//! Metrics while a run goes on: of every step that is taken, the quantity over the step, by the interpolant of the method.
//!
//! Over a step a quantity is a polynomial through five values, where that does not do through nine. Where the last coefficients say that it is not one, the
//! step is cut in half, and each half again: a corner is enclosed, a curve resolved. Extremes, passings of a level and integrals then are those of
//! polynomials. So a metric neither depends on which rows a history has nor on where steps happen to end.
//!
//! Evaluations are what this costs: where two polynomials follow each other they share a value, and a quantity is looked at no closer than its metrics hang
//! on it: the largest value needs no digits of a step in which the quantity stays small, or rises from end to end. One value inside such a step tells that:
//! where it and those at the ends are further below the largest so far than they are apart from each other, several times, or where the parabola through
//! the three is several times less bent than it would have to be to turn.
//!
//! Rejected: reading metrics from the rows of a history, straight between them: their error is that of the grid and not that of the run.

mod parts;
mod polynomial;
mod step;
mod sum;

use crate::error::StepError;
use crate::metric::{MetricReader, MissingMetric};
use polynomial::{DEGREE, POINTS, Polynomial};
use step::{FASTEST, Half};
use sum::{MeasuredPart, QuantityAt, Sum, one_time};

pub(crate) use parts::MeasuredRun;
pub(crate) use step::MeasuredStep;

/// Writes the columns at a part of a step, 0 … 1.
type ColumnValues<'a> = dyn FnMut(f64, &mut [f64]) -> Result<(), StepError> + 'a;

/// The most halvings of a step.
const DEEPEST: usize = 30;
/// Halvings after which what does not get smaller is noise, where nothing of time alone is measured.
const PATIENCE: usize = 3;
/// The point of a step that is looked at first, one of those that are looked at next; not its middle, where what repeats itself in time with the steps may
/// be what it is at the ends.
const FIRST_LOOK: usize = 2;
/// How many times as far from the values of the ends and of the first look as these are apart a quantity is taken to get, and how many times as bent as
/// the parabola through them.
const APART: f64 = 4.0;
/// How many values polynomials have, one after the other until one does.
const COUNTS: [usize; 2] = [5, POINTS];

/// What is measured of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measures {
    /// What, and which of the columns each reads.
    readers: Vec<(MetricReader, usize)>,
    sums: Vec<Sum>,
    columns: Vec<Column>,
    /// The readers of columns that are looked at over time, each with its column.
    followed: Vec<[usize; 2]>,
    /// Values at the points of the halves of each halving, column by column.
    values: Vec<f64>,
    /// The same at another place.
    looked: Vec<f64>,
    /// What becomes of each column over each half.
    states: Vec<Resolving>,
    /// Up to when the run was measured [s].
    until: f64,
    /// The instant whose values are known as those of the end of a step [s]; NaN: of none.
    held: f64,
    /// What was known at an instant the run may go back to [s].
    kept: (f64, Vec<Sum>),
}

/// The same metrics with the same values, to the bit.
impl PartialEq for Measures {
    fn eq(&self, other: &Self) -> bool {
        let values = |measures: &Self| -> Vec<Option<u64>> {
            let all = measures.readers.iter().zip(&measures.sums);
            let values = all.map(|((reader, _), sum)| sum.value(reader.take).ok());
            values.map(|value| value.map(f64::to_bits)).collect()
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
    /// Whether a metric hangs on it before the end of the run.
    over_time: bool,
}

/// What becomes of a column over a half: each is resolved by itself, so that no metric depends on which others there are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Resolving {
    /// It was resolved over more than this half.
    #[default]
    Done,
    /// It is resolved here by so many values, or gets no smoother.
    Here(usize),
    /// It is cut further.
    Further,
}

impl Measures {
    /// Of these metrics, each of which reads one of so many columns.
    pub(crate) fn new(readers: Vec<(MetricReader, usize)>, columns: usize) -> Self {
        let of = |column: usize, readers: &[(MetricReader, usize)]| Column {
            over_time: readers
                .iter()
                .any(|(reader, own)| *own == column && reader.is_over_time()),
            ..Column::default()
        };
        let columns: Vec<Column> = (0..columns).map(|at| of(at, &readers)).collect();
        let own = readers.iter().enumerate().map(|(at, (_, own))| [at, *own]);
        let over_time = |own: usize| columns.get(own).is_some_and(|it| it.over_time);
        let followed = own.filter(|[_, own]| over_time(*own)).collect();
        let count = columns.len();
        let mut measures = Measures {
            sums: vec![Sum::NOTHING; readers.len()],
            columns,
            followed,
            values: vec![0.0; (2 * DEEPEST + 2) * POINTS * count],
            looked: vec![0.0; count],
            states: vec![Resolving::Done; (2 * DEEPEST + 2) * count],
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

    /// Whether steps are looked at.
    pub(crate) fn is_over_time(&self) -> bool {
        !self.followed.is_empty()
    }

    /// For another run.
    pub(crate) fn clear(&mut self) {
        self.sums.fill(Sum::NOTHING);
        for column in &mut self.columns {
            (column.size, column.noise) = (0.0, 0.0);
        }
        (self.until, self.held) = (f64::NAN, f64::NAN);
        self.kept.0 = f64::NAN;
    }

    /// The value of a metric and what it may be off by; `None` where it is not measured.
    pub(crate) fn value(&self, reader: &MetricReader) -> Option<Result<[f64; 2], MissingMetric>> {
        let mut all = self.readers.iter().zip(&self.sums);
        let (_, sum) = all.find(|((known, _), _)| known == reader)?;
        let value = sum.value(reader.take);
        Some(value.map(|value| [value, sum.open(reader.take)]))
    }

    /// An event, at the last instant that was measured.
    pub(crate) fn happens(&mut self, time: f64, event: &str) {
        let all = self.sums.iter_mut().zip(&self.readers);
        for (sum, (reader, _)) in all.filter(|(_, (reader, _))| reader.event == event) {
            sum.happens(reader, time);
        }
    }

    /// What was measured, as that of a part of a run that came to several models, by readers that are `whole` there.
    pub(crate) fn as_part(
        &self,
        (model, end): (usize, f64),
        whole: &dyn Fn(&MetricReader) -> MetricReader,
    ) -> MeasuredRun {
        let readers = self.readers.iter().map(|(reader, _)| whole(reader));
        MeasuredRun {
            model,
            end,
            sums: readers.zip(self.sums.iter().copied()).collect(),
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
            let all = self.sums.iter_mut();
            all.for_each(|sum| sum.spoil(MissingMetric::TakenBack));
        }
        self.until = time;
    }

    /// An instant: the start of a run, its end behind what events changed there. `at` writes the columns.
    pub(crate) fn instant(
        &mut self,
        time: f64,
        mut at: impl FnMut(&mut [f64]) -> Result<(), StepError>,
    ) -> Result<(), StepError> {
        if !self.columns.is_empty()
            && let Err(error) = at(self.row(Half::WHOLE, DEGREE))
        {
            let all = self.readers.iter().zip(&mut self.sums);
            let of_the_end = all.filter(|((reader, _), _)| reader.is_of_the_end());
            of_the_end.for_each(|(_, sum)| sum.spoil(MissingMetric::NotANumber { time }));
            return Err(error);
        }
        let first = DEGREE * self.columns.len();
        let values = self.values.get(first..).unwrap_or_default();
        for ((reader, column), sum) in self.readers.iter().zip(&mut self.sums) {
            let value = values.get(*column).copied().unwrap_or(f64::NAN);
            let part = MeasuredPart {
                polynomial: &Polynomial::constant(value),
                times: [time; 2],
                end: value,
                values: [value; 2],
                allowed: 0.0,
                nothing: 0.0,
                gap: (!value.is_finite()).then_some(time),
                rough: false,
                encloses_jump: false,
                open: 0.0,
            };
            sum.add(reader, part, &mut |_| Ok(value))?;
        }
        (self.until, self.held) = (time, time);
        Ok(())
    }

    /// Whether the values at an instant are known as those of the end of a step, where steps are looked at.
    pub(crate) fn goes_on_from(&self, time: f64) -> bool {
        self.held == time || !self.is_over_time()
    }

    /// A step. `at` writes the columns at a part of it, 0 … 1.
    pub(crate) fn step(
        &mut self,
        step: MeasuredStep<'_>,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let end = step.end;
        if self.is_over_time() {
            let opens = self.opens_at(step.time);
            let known = step.continues && self.held == step.time && opens.is_none();
            if known {
                self.copy((Half::WHOLE, DEGREE), (Half::WHOLE, 0));
            } else {
                let behind = opens.map_or(0.0, |time| (time - step.time) / step.size);
                at(behind.min(1.0), self.row(Half::WHOLE, 0))?;
            }
            self.held = f64::NAN;
            at(1.0, self.row(Half::WHOLE, DEGREE))?;
            let times = [step.time, end];
            if known && step.straight && self.add_straight(times) {
                (self.until, self.held) = (end, end);
                return Ok(());
            }
            let mut further = false;
            for column in 0..self.columns.len() {
                if !self.columns.get(column).is_some_and(|it| it.over_time) {
                    continue;
                }
                let inside = !step.straight
                    && self.any_sum(column, |sum, reader| sum.looks_inside(reader, times));
                let state = match inside {
                    true => Resolving::Further,
                    false => Resolving::Here(2),
                };
                further |= inside;
                self.set_state(Half::WHOLE, column, state);
                if !known {
                    self.see((Half::WHOLE, 0), step.time, column);
                }
                self.see((Half::WHOLE, DEGREE), end, column);
            }
            if further && !self.look_once(step, at)? {
                self.look_inside(Half::WHOLE, Some(FIRST_LOOK), step, at)?;
                self.resolve(Half::WHOLE, step, at)?;
            } else {
                self.add(Half::WHOLE, step, at)?;
            }
            self.held = end;
        }
        self.until = end;
        Ok(())
    }

    /// Adds a step over which quantities are straight, where no metric takes more than the values at its ends; `false`, and nothing happened, where one does.
    fn add_straight(&mut self, times: [f64; 2]) -> bool {
        let count = self.columns.len();
        let [first, last] = [0, DEGREE].map(|point| self.values.get(point * count..));
        let (Some(first), Some(last)) = (first, last) else {
            return false;
        };
        let ends = |column: usize| Some([*first.get(column)?, *last.get(column)?]);
        let told = |[reader, column]: &[usize; 2]| {
            let own = self.readers.get(*reader).zip(ends(*column));
            own.is_some_and(|((reader, _), ends)| Sum::is_told_by_ends(reader, times, ends))
        };
        if !self.followed.iter().all(told) {
            return false;
        }
        for &[reader, column] in &self.followed {
            let own = (self.readers.get(reader), self.sums.get_mut(reader));
            if let ((Some((reader, _)), Some(sum)), Some(ends)) = (own, ends(column)) {
                sum.add_straight(reader, times, ends);
                if let Some(known) = self.columns.get_mut(column) {
                    known.size = known.size.max(ends[1].abs());
                }
            }
        }
        true
    }

    /// Where a window begins at an instant: a time right behind it, since of what jumps there the window holds the side behind [s].
    fn opens_at(&self, instant: f64) -> Option<f64> {
        let apart = one_time(instant);
        let followed = self.followed.iter();
        let begins = followed.filter_map(|[at, _]| Some(self.readers.get(*at)?.0.window[0]));
        let here = begins.filter(|from| (from - instant).abs() <= apart);
        here.map(|from| from.max(instant) + apart).reduce(f64::max)
    }

    /// The values at a point of a half.
    fn row(&mut self, half: Half, point: usize) -> &mut [f64] {
        let count = self.columns.len();
        let first = (half.index() * POINTS + point) * count;
        let row = self.values.get_mut(first..first + count);
        row.unwrap_or_default()
    }

    fn value_at(&self, half: Half, point: usize, column: usize) -> f64 {
        let at = (half.index() * POINTS + point) * self.columns.len() + column;
        self.values.get(at).copied().unwrap_or(f64::NAN)
    }

    /// Writes the values at a point of a half, that are known, to another point.
    fn copy(&mut self, (from, point): (Half, usize), (to, place): (Half, usize)) {
        let count = self.columns.len();
        let [source, target] = [(from, point), (to, place)]
            .map(|(half, point)| (half.index() * POINTS + point) * count);
        if source + count <= self.values.len() && target + count <= self.values.len() {
            self.values.copy_within(source..source + count, target);
        }
    }

    /// Sees the size of a column at a point of a half, where a metric counts: what is infinite before a window leaves nothing in it unresolved.
    fn see(&mut self, (half, point): (Half, usize), time: f64, column: usize) {
        let value = self.value_at(half, point, column);
        let counts = |_: &Sum, reader: &MetricReader| {
            let [from, to] = reader.window;
            (from..=to).contains(&time)
        };
        if value.is_finite()
            && self.any_sum(column, counts)
            && let Some(column) = self.columns.get_mut(column)
        {
            column.size = column.size.max(value.abs());
        }
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

    /// Whether what holds of a metric of a column does of one of them.
    fn any_sum(&self, column: usize, holds: impl Fn(&Sum, &MetricReader) -> bool) -> bool {
        let all = self.readers.iter().zip(&self.sums);
        let mut own = all.filter(|((_, own), _)| *own == column);
        own.any(|((reader, _), sum)| holds(sum, reader))
    }

    /// A column over a half, through so many values.
    fn polynomial(&self, half: Half, column: usize, count: usize) -> Polynomial {
        let stride = Polynomial::stride(count);
        Polynomial::through(count, |place| self.value_at(half, place * stride, column))
    }

    /// Whether a polynomial is not yet what a metric of its column needs over a half.
    fn is_open(
        &self,
        half: Half,
        column: usize,
        polynomial: &Polynomial,
        step: MeasuredStep<'_>,
    ) -> bool {
        let known = self.columns.get(column).copied().unwrap_or_default();
        let allowed = (step.tolerance * known.size).max(2.0 * known.noise);
        let times = step.times(half.part);
        if !polynomial.tail().is_finite() {
            // A gap is cut off where it lies before or behind what a metric needs.
            return self.any_sum(column, |sum, reader| {
                let [from, to] = reader.span();
                let cuts = [from, to].map(|time| times[0] < time && time < times[1]);
                let gap = self.gap((half, column, polynomial), step, reader);
                cuts.contains(&true)
                    && sum.looks_inside(reader, times)
                    && gap.is_some_and(|gap| gap < from || to < gap)
            });
        }
        let changes =
            |sum: &Sum, reader: &MetricReader| sum.could_change_by(reader, times, polynomial);
        polynomial.error() > allowed && self.any_sum(column, changes)
    }

    /// When a column has a value over a half that is not a number: where a metric needs it, if there is such a time [s].
    fn gap(
        &self,
        (half, column, polynomial): (Half, usize, &Polynomial),
        step: MeasuredStep<'_>,
        reader: &MetricReader,
    ) -> Option<f64> {
        let [begin, end] = step.times(half.part);
        let [from, to] = reader.span();
        let stride = Polynomial::stride(polynomial.points().count());
        let places = Polynomial::places().into_iter().enumerate();
        let own = places.filter(|(point, _)| point % stride == 0);
        let gaps = own.filter(|(point, _)| !self.value_at(half, *point, column).is_finite());
        let mut times = gaps.map(|(_, place)| match place {
            1.0 => end,
            place => begin + place * (end - begin),
        });
        let first = times.next()?;
        let needed = |time: &f64| (from..=to).contains(time);
        let mut all = std::iter::once(first).chain(times);
        Some(all.find(needed).unwrap_or(first))
    }

    /// Evaluates columns once inside a step whose ends are known; whether that does for each.
    fn look_once(
        &mut self,
        step: MeasuredStep<'_>,
        at: &mut ColumnValues<'_>,
    ) -> Result<bool, StepError> {
        let part = Polynomial::places()[FIRST_LOOK];
        at(part, self.row(Half::WHOLE, FIRST_LOOK))?;
        let (time, times) = (step.time + part * step.size, step.times([0.0, 1.0]));
        if step.hides(Half::WHOLE, 2) {
            return Ok(false);
        }
        let mut all = true;
        for column in 0..self.columns.len() {
            if self.state(Half::WHOLE, column) != Resolving::Further {
                continue;
            }
            self.see((Half::WHOLE, FIRST_LOOK), time, column);
            let values = [0, FIRST_LOOK, DEGREE].map(|at| self.value_at(Half::WHOLE, at, column));
            let [least, most] = values.into_iter().fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[least, most], value| [least.min(value), most.max(value)],
            );
            let [first, looked, last] = values;
            // c of the parabola first (1 − s) + last s + c s (1 − s) through the three: where it is small, the quantity only rises or only falls.
            let bend = (looked - first - part * (last - first)) / (part * (1.0 - part));
            let further = match APART * bend.abs() <= (last - first).abs() {
                true => 0.0,
                false => APART * (most - least),
            };
            let bounds = [least - further, most + further];
            let size = self.columns.get(column).map_or(0.0, |known| known.size);
            let allowed = step.tolerance * size;
            let is_open = |sum: &Sum, reader: &MetricReader| {
                !sum.is_beyond(reader, times, bounds, ([first, last], allowed))
            };
            // What is not a number is no least or largest, but a gap; and what rests at all three, as a slack line does, may be at work between them.
            let tells = values.iter().all(|value| value.is_finite()) && least < most;
            if tells && !self.any_sum(column, is_open) {
                self.set_state(Half::WHOLE, column, Resolving::Here(2));
            } else {
                all = false;
            }
        }
        Ok(all)
    }

    /// Evaluates columns inside a half whose ends are known, and a point that was `seen`, until each is resolved, or all its points are.
    fn look_inside(
        &mut self,
        half: Half,
        seen: Option<usize>,
        step: MeasuredStep<'_>,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let [low, high] = half.part;
        let mut known = 2;
        for count in COUNTS {
            let all = 0..self.columns.len();
            let mut further = all.clone();
            if !further.any(|column| self.state(half, column) == Resolving::Further) {
                break;
            }
            let (stride, before) = (Polynomial::stride(count), Polynomial::stride(known));
            let places = Polynomial::places().into_iter().enumerate();
            let new = places.filter(|(point, _)| {
                point % stride == 0 && point % before != 0 && seen != Some(*point)
            });
            for (point, place) in new {
                let part = low + place * (high - low);
                at(part, self.row(half, point))?;
                let time = step.time + part * step.size;
                for column in all.clone() {
                    if self.state(half, column) == Resolving::Further {
                        self.see((half, point), time, column);
                    }
                }
            }
            let hides = step.hides(half, count);
            for column in all {
                if self.state(half, column) == Resolving::Further {
                    let polynomial = self.polynomial(half, column, count);
                    if !hides && !self.is_open(half, column, &polynomial, step) {
                        self.set_state(half, column, Resolving::Here(count));
                    }
                }
            }
            known = count;
        }
        Ok(())
    }

    /// Adds the columns that are resolved over a half, and cuts it for the others.
    fn resolve(
        &mut self,
        half: Half,
        step: MeasuredStep<'_>,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        self.add(half, step, at)?;
        let all = 0..self.columns.len();
        let further = |column: usize| self.state(half, column) == Resolving::Further;
        if !all.clone().any(further) {
            return Ok(());
        }
        let halves = half.halves();
        for own in halves {
            for column in all.clone() {
                let state = match self.state(half, column) {
                    Resolving::Further => Resolving::Further,
                    Resolving::Here(_) | Resolving::Done => Resolving::Done,
                };
                self.set_state(own, column, state);
            }
            let first = own.side * DEGREE / 2;
            self.copy((half, first), (own, 0));
            self.copy((half, first + DEGREE / 2), (own, DEGREE));
            self.look_inside(own, None, step, at)?;
        }
        for column in all {
            if self.state(half, column) == Resolving::Further {
                self.give_up(half, halves, column, step);
            }
        }
        for own in halves {
            self.resolve(own, step, at)?;
        }
        Ok(())
    }

    /// Cuts a column no further whose halves are as rough as the whole, or the smallest there are.
    fn give_up(&mut self, whole: Half, halves: [Half; 2], column: usize, step: MeasuredStep<'_>) {
        let tail = |half: Half| self.polynomial(half, column, POINTS).tail();
        let is_open = |half: &Half| self.state(*half, column) == Resolving::Further;
        let depth = whole.depth + 1;
        let smaller = halves.map(tail).into_iter().fold(f64::INFINITY, f64::min);
        let patience = if step.hidden.is_some() {
            FASTEST
        } else {
            PATIENCE
        };
        let rough = depth >= patience && halves.iter().all(is_open) && smaller > 0.5 * tail(whole);
        let known = self.columns.get_mut(column).filter(|_| rough);
        if let Some(known) = known {
            known.noise = known.noise.max(smaller);
        }
        if !rough && depth < DEEPEST {
            return;
        }
        for half in halves {
            if self.state(half, column) == Resolving::Further {
                self.set_state(half, column, Resolving::Here(POINTS));
            }
        }
    }

    /// Adds the columns that are resolved over a half.
    fn add(
        &mut self,
        half: Half,
        step: MeasuredStep<'_>,
        at: &mut ColumnValues<'_>,
    ) -> Result<(), StepError> {
        let times = step.times(half.part);
        for index in 0..self.readers.len() {
            let Some((reader, column)) = self.readers.get(index) else {
                continue;
            };
            let Resolving::Here(count) = self.state(half, *column) else {
                continue;
            };
            if count == 2 {
                let ends = [0, DEGREE].map(|point| self.value_at(half, point, *column));
                let sum = self.sums.get_mut(index);
                if sum.is_some_and(|sum| sum.add_straight(reader, times, ends)) {
                    continue;
                }
            }
            let polynomial = self.polynomial(half, *column, count);
            let gap = self.gap((half, *column, &polynomial), step, reader);
            let end = self.value_at(half, DEGREE, *column);
            let size = self.columns.get(*column).map_or(0.0, |known| known.size);
            let stride = Polynomial::stride(count);
            let ends = [0, DEGREE].map(|point| self.value_at(half, point, *column));
            let values = (0..count).map(|place| self.value_at(half, place * stride, *column));
            let values = values.fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[least, most], value| [least.min(value), most.max(value)],
            );
            let Some(sum) = self.sums.get_mut(index) else {
                continue;
            };
            let rough = !step.straight
                && polynomial.error() > step.tolerance * size
                && sum.could_change_by(reader, times, &polynomial);
            // What is halved that often is a corner or a jump in an interval of time that is nothing.
            let open = match rough && half.depth < DEEPEST {
                true => polynomial.tail(),
                false => 0.0,
            };
            let part = MeasuredPart {
                polynomial: &polynomial,
                times,
                end,
                values,
                allowed: polynomial.tail().max(step.tolerance * size),
                nothing: step.tolerance * size,
                gap,
                rough,
                encloses_jump: rough && half.depth >= DEEPEST,
                open,
            };
            let (looked, [low, high]) = (&mut self.looked, half.part);
            let law: &mut QuantityAt<'_> = &mut |place| match 0.5 * (place + 1.0) {
                0.0 => Ok(ends[0]),
                1.0 => Ok(ends[1]),
                part if step.straight => Ok((1.0 - part) * ends[0] + part * ends[1]),
                part => {
                    at(low + part * (high - low), looked)?;
                    Ok(looked.get(*column).copied().unwrap_or(f64::NAN))
                }
            };
            sum.add(reader, part, law)?;
        }
        Ok(())
    }
}
