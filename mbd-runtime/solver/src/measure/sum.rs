//! What a run has shown of one metric so far.

use mbd_scene::metrics::Take;

use super::polynomial::Polynomial;
use crate::error::StepError;
use crate::locate::POINT;
use crate::metric::{MetricReader, MissingMetric};
use crate::trajectory::resolution;

/// The quantity itself at a place of its polynomial, −1 … 1: the law at the interpolated state.
pub(super) type QuantityAt<'a> = dyn FnMut(f64) -> Result<f64, StepError> + 'a;

/// What is known of a metric up to an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum {
    /// How much of the window was seen [s].
    span: f64,
    /// ∫ of the quantity, of its square, or the time above the level.
    sum: f64,
    /// The largest or smallest value.
    extreme: f64,
    /// When the level was first passed, or the event first happened [s].
    first: f64,
    /// The quantity at the event.
    at_event: f64,
    /// The quantity at the last instant of the window.
    last: f64,
    /// The quantity at the last instant that was looked at, in the window or not.
    now: f64,
    /// Whether anything of the window was seen.
    seen: bool,
    /// Why it has no value, whatever else was seen.
    missing: Option<MissingMetric>,
    /// What parts that stayed unresolved leave open of the value.
    open: f64,
}

/// A part of the run.
#[derive(Clone, Copy)]
pub(super) struct MeasuredPart<'a> {
    /// The quantity over it.
    pub polynomial: &'a Polynomial,
    /// When it begins and ends [s].
    pub times: [f64; 2],
    /// The quantity at its end.
    pub end: f64,
    /// The least and the largest of the values that the polynomial goes through.
    pub values: [f64; 2],
    /// What the polynomial may be off by.
    pub allowed: f64,
    /// What is no difference between values.
    pub nothing: f64,
    /// When a value of the polynomial is not a number, where the metric needs it if possible [s].
    pub gap: Option<f64>,
    /// Whether the quantity is no polynomial there.
    pub rough: bool,
    /// Whether it jumps there, in an interval of time that is nothing.
    pub encloses_jump: bool,
    /// What the polynomial is then off by.
    pub open: f64,
}

impl Sum {
    pub(super) const NOTHING: Sum = Sum {
        span: 0.0,
        sum: 0.0,
        extreme: f64::NAN,
        first: f64::NAN,
        at_event: f64::NAN,
        last: f64::NAN,
        now: f64::NAN,
        seen: false,
        missing: None,
        open: 0.0,
    };

    /// Whether it hangs on the quantity inside a part of the run, and not only at its end.
    pub(super) fn looks_inside(&self, of: &MetricReader, [begin, end]: [f64; 2]) -> bool {
        let [from, to] = of.window;
        let inside = from <= end && begin <= to;
        inside
            && match of.take {
                Take::Value | Take::TimeOf | Take::Final => false,
                Take::FirstAbove => self.first.is_nan(),
                _ => true,
            }
    }

    /// Whether another polynomial that is about this one over a part of the run could give it another value.
    pub(super) fn could_change_by(
        &self,
        of: &MetricReader,
        times: [f64; 2],
        polynomial: &Polynomial,
    ) -> bool {
        let [least, most] = polynomial.bounds();
        let level = of.level.unwrap_or(f64::NAN);
        let enough = match of.take {
            Take::Max => most <= self.extreme,
            Take::Min => least >= self.extreme,
            Take::FirstAbove => most <= level,
            Take::TimeAbove => most <= level || least > level,
            _ => false,
        };
        !enough && self.looks_inside(of, times)
    }

    /// Whether a quantity between these bounds over a part of the run cannot give it another value than the ends of that part do, by more than what
    /// quantities are resolved to.
    pub(super) fn is_beyond(
        &self,
        of: &MetricReader,
        [begin, end]: [f64; 2],
        [least, most]: [f64; 2],
        ([first, last], allowed): ([f64; 2], f64),
    ) -> bool {
        let [from, to] = of.window;
        let whole = from <= begin && end <= to;
        let beyond = match of.take {
            Take::Max => most <= self.extreme.max(first.max(last)) + allowed,
            Take::Min => least >= self.extreme.min(first.min(last)) - allowed,
            _ => false,
        };
        whole && beyond || !self.looks_inside(of, [begin, end])
    }

    /// Whether the values at the ends of a part of the run over which a quantity is straight tell what becomes of a metric.
    #[inline]
    pub(super) fn is_told_by_ends(
        of: &MetricReader,
        [begin, end]: [f64; 2],
        [first, last]: [f64; 2],
    ) -> bool {
        let [from, to] = of.window;
        let inside = from <= begin && end <= to;
        inside && matches!(of.take, Take::Max | Take::Min) && first.is_finite() && last.is_finite()
    }

    /// A part of the run over which the quantity is straight between two values; `false` where it takes more than these to tell what becomes of the metric.
    #[inline]
    pub(super) fn add_straight(
        &mut self,
        of: &MetricReader,
        times: [f64; 2],
        ends: [f64; 2],
    ) -> bool {
        if !Sum::is_told_by_ends(of, times, ends) {
            return false;
        }
        let ([begin, end], [first, last]) = (times, ends);
        self.extreme = match of.take {
            Take::Max => self.extreme.max(first.max(last)),
            Take::Min => self.extreme.min(first.min(last)),
            _ => return false,
        };
        self.span += end - begin;
        (self.now, self.last, self.seen) = (last, last, true);
        true
    }

    /// A part of the run.
    ///
    /// # Errors
    /// Those of the law.
    pub(super) fn add(
        &mut self,
        of: &MetricReader,
        part: MeasuredPart<'_>,
        law: &mut QuantityAt<'_>,
    ) -> Result<(), StepError> {
        let MeasuredPart {
            polynomial,
            times: [begin, end],
            rough,
            encloses_jump,
            open,
            mut values,
            allowed,
            nothing,
            ..
        } = part;
        self.now = part.end;
        let (low, high) = (of.window[0].max(begin), of.window[1].min(end));
        let width = end - begin;
        let [shared, window] = [high - low, of.window[1] - of.window[0]];
        // What ends on an event that begins the window, or begins with one that ends it, is not of it.
        let touches = shared <= one_time(high) && shared < width.min(window);
        if low > high || touches || matches!(of.take, Take::Value | Take::TimeOf) {
            return Ok(());
        }
        // A time as a place on the polynomial, and a part of it in seconds.
        let place = |time: f64| match time {
            time if time <= begin => -1.0,
            time if time >= end => 1.0,
            time => 2.0 * (time - begin) / width - 1.0,
        };
        let time = |place: f64| begin + 0.5 * (place + 1.0) * width;
        if of.take == Take::Final {
            // The last instant alone counts, whatever was before.
            let last = if high == end {
                part.end
            } else {
                law(place(high))?
            };
            let missing = MissingMetric::NotANumber { time: high };
            self.missing = (!last.is_finite()).then_some(missing);
            (self.last, self.seen) = (last, true);
            return Ok(());
        }
        if let Some(time) = part.gap {
            let found = self.first.is_finite() && of.take == Take::FirstAbove;
            if !found && self.missing.is_none() {
                self.missing = Some(MissingMetric::NotANumber { time });
            }
            self.seen = true;
            return Ok(());
        }
        // Of a jump at which the window begins or ends it holds its own side: what the polynomial has between both is no value of the quantity.
        let own_side = match encloses_jump && low < high {
            true if low > begin && high == end => Some(polynomial.at(1.0)),
            true if low == begin && high < end => Some(polynomial.at(-1.0)),
            _ => None,
        };
        let constant = own_side.map(Polynomial::constant);
        let polynomial = constant.as_ref().unwrap_or(polynomial);
        if let Some(value) = own_side {
            values = [value; 2];
        }
        let [least, most] = values;
        let part = [place(low), place(high)];
        self.last = polynomial.at(part[1]);
        // As the integral counts it: a mean lies between the values it is of, however narrow the window.
        self.span += 0.5 * width * (part[1] - part[0]);
        let level = of.level.unwrap_or(f64::NAN);
        // What rests at the level, as a contact that is open, is not above it where a step ends a rounding behind its event, or the polynomial swings.
        let reaches = || {
            most > level + nothing
                || polynomial.bounds()[1] > level
                    && largest((polynomial, part), rough, |_, x| Ok(x)).unwrap_or(f64::NAN)
                        > level + allowed.max(nothing)
        };
        match of.take {
            Take::Max if polynomial.bounds()[1] <= self.extreme => {}
            Take::Min if polynomial.bounds()[0] >= self.extreme => {}
            Take::Max => {
                let largest =
                    largest((polynomial, part), rough, |s, x| match of_values(x, most) {
                        true => Ok(x),
                        false => law(s),
                    })?;
                self.extreme = self.extreme.max(largest);
            }
            Take::Min => {
                let largest = largest((polynomial, part), rough, |s, x| {
                    match of_values(-x, -least) {
                        true => Ok(-x),
                        false => Ok(-law(s)?),
                    }
                })?;
                self.extreme = self.extreme.min(0.0 - largest);
            }
            Take::Mean | Take::Integral => {
                self.sum += 0.5 * width * polynomial.integral(part, |x| x);
            }
            Take::Rms => self.sum += 0.5 * width * polynomial.integral(part, |x| x * x),
            Take::TimeAbove if reaches() => polynomial.monotone(part, |ends| {
                let (from, to) = above(polynomial, level, ends);
                self.sum += 0.5 * width * (to - from);
            }),
            Take::FirstAbove if self.first.is_nan() && reaches() => {
                polynomial.monotone(part, |ends| {
                    let (from, to) = above(polynomial, level, ends);
                    let is_above = to > from || polynomial.at(to) > level;
                    if self.first.is_nan() && is_above {
                        self.first = time(from);
                    }
                })
            }
            _ => {}
        }
        if open > 0.0 {
            self.open += match of.take {
                Take::Mean | Take::Integral => open * (high - low),
                // |∫ x² − ∫ p²| ≤ ∫ |x − p| |x + p|.
                Take::Rms => 2.0 * open * (high - low) * self.last.abs().max(open),
                Take::TimeAbove => {
                    let near = |s: &f64| (polynomial.at(*s) - level).abs() <= open;
                    let points = polynomial.points().count();
                    let near = polynomial.points().filter(near).count();
                    (high - low) * near as f64 / points as f64
                }
                _ => 0.0,
            };
            if matches!(of.take, Take::Max | Take::Min) {
                self.open = self.open.max(open);
            }
        }
        self.seen = true;
        Ok(())
    }

    /// A later part of the run.
    pub(super) fn add_part(&mut self, of: &MetricReader, later: &Sum) {
        self.span += later.span;
        self.sum += later.sum;
        self.extreme = match of.take {
            Take::Min => self.extreme.min(later.extreme),
            _ => self.extreme.max(later.extreme),
        };
        if self.first.is_nan() {
            (self.first, self.at_event) = (later.first, later.at_event);
        }
        if later.seen {
            self.last = later.last;
        }
        self.missing = match of.take {
            Take::Final if later.seen => later.missing,
            _ => self.missing.or(later.missing),
        };
        self.now = later.now;
        self.seen |= later.seen;
        self.open = match of.take {
            Take::Max | Take::Min => self.open.max(later.open),
            _ => self.open + later.open,
        };
    }

    /// An event at an instant that was looked at just before.
    pub(super) fn happens(&mut self, of: &MetricReader, time: f64) {
        let [from, to] = of.window;
        let inside = (from..=to + one_time(time)).contains(&time);
        if inside && self.first.is_nan() && matches!(of.take, Take::Value | Take::TimeOf) {
            (self.first, self.at_event) = (time, self.now);
        }
    }

    /// Its value.
    pub(super) fn value(&self, take: Take) -> Result<f64, MissingMetric> {
        let of_an_event = matches!(take, Take::TimeOf | Take::Value);
        let value = self.number(take);
        match self.missing {
            Some(missing) => Err(missing),
            None if value.is_finite() => Ok(value),
            None if of_an_event && self.first.is_nan() => Err(MissingMetric::NoEvent),
            None if of_an_event => Err(MissingMetric::NotANumber { time: self.first }),
            None if !self.seen => Err(MissingMetric::NothingInWindow),
            None if take == Take::FirstAbove => Err(MissingMetric::NotPassed),
            None => Err(MissingMetric::TooLarge),
        }
    }

    /// The number that was seen; not finite where there is none.
    fn number(&self, take: Take) -> f64 {
        let over_span = |alone: f64| match self.span > 0.0 {
            true => self.sum / self.span,
            false => alone,
        };
        match take {
            Take::TimeOf | Take::FirstAbove => self.first,
            Take::Value => self.at_event,
            _ if !self.seen => f64::NAN,
            Take::Max | Take::Min => self.extreme,
            Take::Final => self.last,
            Take::Mean => over_span(self.last),
            Take::Rms => over_span(self.last * self.last).sqrt(),
            Take::Integral | Take::TimeAbove => self.sum,
        }
    }

    /// What it may be off by because the quantity was not resolved in time: zero where it was.
    pub(super) fn open(&self, take: Take) -> f64 {
        match take {
            Take::Mean if self.span > 0.0 => self.open / self.span,
            Take::Rms if self.span > 0.0 => {
                let square = (self.sum / self.span).max(f64::MIN_POSITIVE);
                0.5 * self.open / self.span / square.sqrt()
            }
            _ => self.open,
        }
    }

    /// Forgets what cannot be told any more, for this reason.
    pub(super) fn spoil(&mut self, why: MissingMetric) {
        self.missing = Some(why);
        (self.first, self.at_event) = (f64::NAN, f64::NAN);
    }
}

/// Events happen up to so much later than the time at which a window begins or ends, where they are at that time [s].
pub(super) fn one_time(time: f64) -> f64 {
    resolution(time).max(2.0 * POINT)
}

/// The part of a piece that rises or falls which is above a level; empty, at its end, where none is.
fn above(polynomial: &Polynomial, level: f64, [low, high]: [f64; 2]) -> (f64, f64) {
    match [low, high].map(|s| polynomial.at(s) > level) {
        [true, true] => (low, high),
        [false, false] => (high, high),
        [true, false] => (low, polynomial.passes(level, [low, high])),
        [false, true] => (polynomial.passes(level, [low, high]), high),
    }
}

/// Whether a value of a polynomial has a sign that the largest of the values it goes through has. Where it alone is above zero the law is asked: the least
/// of what is never negative, a tension or a square, is not below zero, and a polynomial is, beside a corner by several times what it is off by.
fn of_values(value: f64, largest: f64) -> bool {
    value <= 0.0 || largest > 0.0
}

/// The largest value of a polynomial, as `of` counts by its place and its value there; of a rough part by its values alone: a polynomial through a jump
/// overshoots.
fn largest(
    (polynomial, [low, high]): (&Polynomial, [f64; 2]),
    rough: bool,
    mut of: impl FnMut(f64, f64) -> Result<f64, StepError>,
) -> Result<f64, StepError> {
    let mut so_far = Ok(f64::NAN);
    let mut see = |s: f64| {
        if let Ok(known) = &mut so_far {
            match of(s, polynomial.at(s)) {
                Ok(value) => *known = known.max(value),
                Err(error) => so_far = Err(error),
            }
        }
    };
    see(low);
    if rough {
        let points = polynomial.points();
        points.filter(|s| (low..=high).contains(s)).for_each(see);
    } else {
        polynomial.monotone([low, high], |[_, end]| see(end));
    }
    so_far
}
