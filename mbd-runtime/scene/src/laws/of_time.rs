//! What changes with time alone, or with declared states, and what of it the ends of a step and its stages do not show.
//!
//! ```text
//! g unseen between a and b:   some t in (a, b) with g(t) outside the hull of g(s) at all times s that were looked at                (1)
//! ```
//!
//! A step that begins where nothing moves has an error of zero whatever lies inside it, a pulse `exp(-((t − 10 s)/w)^2)` as well as nothing. What
//! changes with time alone is known beforehand: its range over a span holds everything it can be there, so that bisection finds
//! what lies outside the hull, however short it lasts, and the first time at which a guard passes. What declared states change, a clock, a charge, the angle of a
//! cam, is looked at in the same way along the course that they take over a step. Derived.

use crate::laws::formula::{Value, scalar, value};
use crate::laws::ground::with_states;
use crate::scalar::Range;
use crate::{Dual, Formula, Function, Real, Scene};

/// By how much of the hull a value must be outside it to count as unseen.
const MARGIN: f64 = 0.25;
/// By how much of itself, where the hull has no width.
const ROUNDING: f64 = 1e-9;
/// The part of all that a number is in a run that is noticed, and at how many parts of the run it is sampled for that.
const NOTICED: f64 = 0.1;
const SAMPLES: u32 = 64;
/// Most spans that are looked at for one answer, and the shortest of them in parts of the whole.
const MOST_SPANS: u32 = 128;
const MOST_SPANS_OF_GUARDS: u32 = 16_384;
const SHORTEST: f64 = 1e-12;
/// Times closer than this part of them are one time.
const SAME: f64 = 1e-14;
/// Spans that wait at a time: every bisection leaves one more.
const WAITING: usize = MOST_SPANS as usize + 1;

/// The value of a declared state, by number, at a time of a step [s], and its rate then: where it is a square of time, bounds hold everything.
pub type StateCourse<'a> = &'a dyn Fn(usize, f64) -> [f64; 2];

/// That of what no state changes.
const STILL: StateCourse<'static> = &|_, _| [f64::NAN; 2];

/// A number of time alone, or of time and declared states, that is not constant.
#[derive(Clone, Debug)]
struct TimeFunction {
    formula: Formula,
    /// Whether it never jumps.
    is_continuous: bool,
    /// Whether it hangs on declared states.
    follows_states: bool,
}

impl TimeFunction {
    fn new(scene: &Scene, formula: Formula) -> Self {
        use Function::{Atan2, Floor, IfAtMost, IfLess};
        let jumps =
            |part: &Formula| matches!(part, Formula::Apply(Atan2 | Floor | IfAtMost | IfLess, _));
        TimeFunction {
            is_continuous: !scene.contains(&formula, jumps),
            follows_states: scene.contains(&formula, |part| matches!(part, Formula::State(_))),
            formula,
        }
    }
}

/// The formulas of time alone of a scene, and those of time and declared states, for some params.
#[derive(Clone, Debug, Default)]
pub struct TimeFunctions {
    /// Scalars that are not constant, of what acts: those of time alone, then those of states.
    acting: Vec<TimeFunction>,
    /// The same of outputs, and of what metrics measure.
    measured: Vec<TimeFunction>,
    /// The guards of events that are of time alone, with their numbers.
    guards: Vec<(usize, TimeFunction)>,
    params: Vec<f64>,
}

/// Spans of time that wait to be looked at.
struct Bisection {
    /// Each with what it may hold.
    waiting: [([f64; 2], f64); WAITING],
    count: usize,
    left: u32,
    shortest: f64,
}

impl Bisection {
    fn new(whole: [f64; 2], most: u32) -> Self {
        Bisection {
            waiting: [([0.0; 2], 0.0); WAITING],
            count: 0,
            left: most,
            shortest: SHORTEST * (whole[1] - whole[0]),
        }
    }

    /// A span waits, unless it is too short to matter.
    fn add(&mut self, [from, to]: [f64; 2], may_hold: f64) {
        let long = to - from > self.shortest;
        if let Some(free) = self.waiting.get_mut(self.count).filter(|_| long) {
            *free = ([from, to], may_hold);
            self.count += 1;
        }
    }

    /// Takes the span that was added last, unless enough were looked at.
    fn last(&mut self) -> Option<[f64; 2]> {
        self.count = self.count.checked_sub(1)?;
        self.left = self.left.checked_sub(1)?;
        self.waiting.get(self.count).map(|(span, _)| *span)
    }

    /// Takes the span that may hold most, with what that is.
    fn most(&mut self) -> Option<([f64; 2], f64)> {
        let own = self.waiting.get_mut(..self.count)?;
        let best = (0..own.len()).max_by(|a, b| own[*a].1.total_cmp(&own[*b].1))?;
        own.swap(best, self.count - 1);
        let found = own.last().copied();
        self.last().and(found)
    }

    fn drop_all(&mut self) {
        self.count = 0;
    }
}

impl TimeFunctions {
    /// Those of a scene.
    #[must_use]
    pub fn new(scene: &Scene, params: &[f64]) -> Self {
        let (mut acting, mut measured) = (Vec::new(), Vec::new());
        let frames = scene.world_frames.iter().flat_map(|frame| {
            let rotation = frame.rotation.iter().flatten().flatten();
            frame.position.iter().chain(rotation)
        });
        let lets = scene.lets.iter().map(|named| &named.value);
        let all = || {
            scene
                .acting_formulas()
                .chain(frames.clone())
                .chain(lets.clone())
        };
        all().for_each(|formula| collect(scene, &changes, formula, &mut acting));
        all().for_each(|formula| collect(scene, &follows, formula, &mut acting));
        for output in &scene.outputs {
            collect(scene, &changes, &output.value, &mut measured);
        }
        let events = scene.events.iter().enumerate();
        let guards = events.filter(|(_, event)| changes(scene, &event.guard));
        let mut functions = TimeFunctions {
            acting: Vec::new(),
            measured: Vec::new(),
            guards: guards
                .map(|(at, event)| (at, TimeFunction::new(scene, event.guard.clone())))
                .collect(),
            params: params.to_vec(),
        };
        functions.acting = functions.scalars(scene, acting);
        functions.measured = functions.scalars(scene, measured);
        functions
    }

    /// Each of some formulas once, of vectors their components.
    fn scalars(&self, scene: &Scene, formulas: Vec<Formula>) -> Vec<TimeFunction> {
        let mut scalars: Vec<Formula> = Vec::new();
        for formula in formulas {
            let start = with_states(scene, &self.params, 0.0, |_| Some(0.0));
            let parts = match value(&formula, &start) {
                Value::Scalar(_) => vec![formula],
                Value::Vector(_) => {
                    let part = |axis| Formula::Component(vec![formula.clone()], axis);
                    (0..3).map(part).collect()
                }
            };
            for part in parts {
                if !scalars.contains(&part) {
                    scalars.push(part);
                }
            }
        }
        let scalars = scalars.into_iter();
        scalars
            .map(|formula| TimeFunction::new(scene, formula))
            .collect()
    }

    /// The same with other params.
    pub fn set_params(&mut self, params: Vec<f64>) {
        self.params = params;
    }

    /// How many numbers that act change with time alone.
    #[must_use]
    pub fn acting(&self) -> usize {
        self.acting.len()
    }

    /// Whether something that is measured changes with time alone.
    #[must_use]
    pub fn measures(&self) -> bool {
        !self.measured.is_empty()
    }

    /// What a number is over a span: by its range, and of one that does not jump by its slope from the middle on,
    /// g(t) ∈ g(m) + g′(span) (t − m), which closes in on it with the square of the span.
    fn during(
        &self,
        scene: &Scene,
        number: &TimeFunction,
        course: StateCourse<'_>,
        [from, to]: [f64; 2],
    ) -> Range {
        if !number.is_continuous {
            let states = |state| along(course, state, [from, to]).value;
            return self.value(scene, number, Range::between(from, to), states);
        }
        let along = self.along(scene, number, course, [from, to]);
        let middle = 0.5 * (from + to);
        let half = Range::between(from - middle, to - middle);
        let own = self.at(scene, number, course, middle);
        along
            .value
            .meet(Range::from_f64(own) + along.slopes[0] * half)
    }

    /// A number at a time.
    fn at(&self, scene: &Scene, number: &TimeFunction, course: StateCourse<'_>, time: f64) -> f64 {
        self.value(scene, number, time, |state| course(state, time)[0])
    }

    /// A number at a time of any scalar, and at declared states.
    fn value<S: Real>(
        &self,
        scene: &Scene,
        number: &TimeFunction,
        time: S,
        states: impl Fn(usize) -> S,
    ) -> S {
        let leaves = with_states(scene, &self.params, time, |state| Some(states(state)));
        scalar(&number.formula, &leaves)
    }

    /// A number and its slope while time is in a span.
    fn along(
        &self,
        scene: &Scene,
        number: &TimeFunction,
        course: StateCourse<'_>,
        [from, to]: [f64; 2],
    ) -> Dual<Range, 1> {
        let time = Dual::variable(Range::between(from, to), 0);
        self.value(scene, number, time, |state| {
            along(course, state, [from, to])
        })
    }

    /// Whether a number that acts hangs on declared states.
    #[must_use]
    pub fn follows_states(&self, number: usize) -> bool {
        let own = self.acting.get(number);
        own.is_some_and(|own| own.follows_states)
    }

    /// Whether a number that acts, of time alone, rises or falls all over a span, or stays: then its ends show everything, and those of every part of it.
    #[must_use]
    pub fn is_monotone(&self, scene: &Scene, number: usize, span: [f64; 2]) -> bool {
        let own = self.acting.get(number);
        own.is_some_and(|own| self.keeps_going(scene, own, span))
    }

    fn keeps_going(&self, scene: &Scene, number: &TimeFunction, span: [f64; 2]) -> bool {
        number.is_continuous && {
            let [slope] = self.along(scene, number, STILL, span).slopes;
            slope.low >= 0.0 || slope.high <= 0.0
        }
    }

    /// A time in a span at which a number that acts is unseen by (1), where it was looked at at the times `seen` [s] and states take this course.
    pub fn unseen(
        &self,
        scene: &Scene,
        number: usize,
        course: StateCourse<'_>,
        span: [f64; 2],
        seen: impl Iterator<Item = f64>,
    ) -> Option<f64> {
        let number = self.acting.get(number)?;
        self.unseen_of(scene, (number, course), span, seen)
    }

    /// Whether something that is measured is unseen by (1) in a span, where it was looked at at the times `seen` [s].
    pub fn hides(
        &self,
        scene: &Scene,
        span: [f64; 2],
        seen: impl Iterator<Item = f64> + Clone,
    ) -> bool {
        let unseen = |number| {
            self.unseen_of(scene, (number, STILL), span, seen.clone())
                .is_some()
        };
        self.measured.iter().any(unseen)
    }

    fn unseen_of(
        &self,
        scene: &Scene,
        (number, course): (&TimeFunction, StateCourse<'_>),
        whole: [f64; 2],
        seen: impl Iterator<Item = f64>,
    ) -> Option<f64> {
        let at = |time: f64| Range::from_f64(self.at(scene, number, course, time));
        let margin = |hull: Range| {
            let size = hull.low.abs().max(hull.high.abs());
            (MARGIN * hull.width()).max(ROUNDING * size)
        };
        let bounds = self.during(scene, number, course, whole);
        let ends = at(whole[0]).hull(at(whole[1]));
        // Most of what there is rises or falls over a step, and both ends were looked at.
        if ends.beyond(bounds) <= margin(ends) {
            return None;
        }
        let hull = seen.map(at).fold(ends, Range::hull);
        let margin = margin(hull);
        let mut worst = (margin, None);
        let mut spans = Bisection::new(whole, MOST_SPANS);
        spans.add(whole, hull.beyond(bounds));
        while let Some((span, may_hold)) = spans.most() {
            // Twice as far out as what is known is not worth a look.
            if may_hold <= margin || may_hold <= 2.0 * worst.0 && worst.1.is_some() {
                break;
            }
            let middle = 0.5 * (span[0] + span[1]);
            let out = hull.beyond(at(middle));
            if out > worst.0 {
                worst = (out, Some(middle));
            }
            for half in [[span[0], middle], [middle, span[1]]] {
                spans.add(half, hull.beyond(self.during(scene, number, course, half)));
            }
        }
        worst.1
    }

    /// A time in a span at which a number that acts is unseen by (1) in every step of a size around it, whose ends and middle are looked at, by more than a
    /// tenth of all that it is in the span [s]; `None` where steps see it, or where it swings so often that this is not known. Steps end on `ends`, where
    /// it may jump.
    #[must_use]
    pub fn hidden_from_steps(
        &self,
        scene: &Scene,
        whole: [f64; 2],
        step: f64,
        ends: &[f64],
    ) -> Option<f64> {
        let hidden = |number| self.hidden_of(scene, number, whole, (step, ends));
        let mut of_time = self.acting.iter().filter(|own| !own.follows_states);
        of_time.find_map(hidden)
    }

    fn hidden_of(
        &self,
        scene: &Scene,
        number: &TimeFunction,
        [begin, end]: [f64; 2],
        (step, ends): (f64, &[f64]),
    ) -> Option<f64> {
        if self.keeps_going(scene, number, [begin, end]) {
            return None;
        }
        let at = |time: f64| Range::from_f64(self.at(scene, number, STILL, time));
        let part = |number: u32| begin + (end - begin) * f64::from(number) / f64::from(SAMPLES);
        let all = (0..=SAMPLES).map(|number| at(part(number)));
        let mut total = all.reduce(Range::hull)?;
        let mut spans = Bisection::new([begin, end], MOST_SPANS_OF_GUARDS);
        spans.add([begin, end], 0.0);
        while let Some(span) = spans.last() {
            if self.during(scene, number, STILL, span).width() <= NOTICED * total.width() {
                continue;
            }
            let middle = 0.5 * (span[0] + span[1]);
            total = total.hull(at(middle));
            if span[1] - span[0] > step {
                spans.add([middle, span[1]], 0.0);
                spans.add([span[0], middle], 0.0);
                continue;
            }
            // What jumps at the end of a step is on both its sides what their steps see.
            let apart = |time: f64| SAME * time.abs();
            let inside =
                |time: &&f64| span[0] + apart(**time) < **time && **time < span[1] - apart(**time);
            if let Some(&cut) = ends.iter().find(inside) {
                spans.add([cut + apart(cut), span[1]], 0.0);
                spans.add([span[0], cut - apart(cut)], 0.0);
                continue;
            }
            let looks = [span[0], middle, span[1]];
            let Some(found) = self.unseen_of(scene, (number, STILL), span, looks.into_iter())
            else {
                continue;
            };
            let seen = looks.into_iter().map(at).reduce(Range::hull)?;
            let out = seen.beyond(at(found));
            if out > NOTICED * total.hull(at(found)).width() {
                return Some(found);
            }
        }
        None
    }

    /// The first time in a span at which the guard of an event, less `zero`, is on the other side than at its start [s]; `None` where it stays on its
    /// side, and of an event whose guard is not of time alone.
    #[must_use]
    pub fn first_passing(
        &self,
        scene: &Scene,
        event: usize,
        (zero, positive): (f64, bool),
        whole: [f64; 2],
    ) -> Option<f64> {
        let between = self.between_sides(scene, event, (zero, positive), whole);
        between.map(|[_, behind]| behind)
    }

    /// That time, and before it the last one up to which the guard is known to be on its side.
    fn between_sides(
        &self,
        scene: &Scene,
        event: usize,
        (zero, positive): (f64, bool),
        whole: [f64; 2],
    ) -> Option<[f64; 2]> {
        let guard = self.guard_of(event)?;
        let sign = if positive { 1.0 } else { -1.0 };
        let during = |span: [f64; 2]| {
            let range = self.during(scene, guard, STILL, span);
            (range - Range::from_f64(zero)) * Range::from_f64(sign)
        };
        let (mut before, mut behind) = (whole[0], None);
        let mut spans = Bisection::new(whole, MOST_SPANS_OF_GUARDS);
        spans.add(whole, 0.0);
        while let Some(span) = spans.last() {
            if during(span).low >= 0.0 {
                before = span[1];
                continue;
            }
            let middle = 0.5 * (span[0] + span[1]);
            if sign * (self.at(scene, guard, STILL, middle) - zero) < 0.0 {
                behind = Some(middle);
                // Nothing later is first.
                spans.drop_all();
            } else {
                spans.add([middle, span[1]], 0.0);
            }
            spans.add([span[0], middle], 0.0);
        }
        behind.map(|behind| [before, behind])
    }

    /// The guard of an event, if it is of time alone.
    fn guard_of(&self, event: usize) -> Option<&TimeFunction> {
        let mut guards = self.guards.iter();
        let own = guards.find(|(own, _)| *own == event);
        own.map(|(_, guard)| guard)
    }

    /// When the guard of an event, less `zero`, passes to the other side in a span, as close as times are [s]; `None` as of the first passing.
    #[must_use]
    pub fn passes(
        &self,
        scene: &Scene,
        event: usize,
        (zero, positive): (f64, bool),
        whole: [f64; 2],
    ) -> Option<f64> {
        let [before, behind] = self.between_sides(scene, event, (zero, positive), whole)?;
        let guard = self.guard_of(event)?;
        let off = |time: &f64| (self.at(scene, guard, STILL, *time) - zero).abs();
        // About zero there are more times than a span is cut into: of those between, zero is the one that is said.
        let said = 0_f64.max(before).min(behind);
        let all = [behind, behind.next_down(), said].into_iter();
        all.min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

/// A declared state and its slope while time is in a span: both bounds hold where it is a square of time.
fn along(course: StateCourse<'_>, state: usize, [from, to]: [f64; 2]) -> Dual<Range, 1> {
    let [[a, before], [b, behind]] = [from, to].map(|time| course(state, time));
    let ends = Range::between(a, b);
    let turns = before * behind < 0.0;
    let crest = from + (to - from) * before / (before - behind);
    Dual {
        value: match turns {
            true => ends.hull(Range::from_f64(course(state, crest)[0])),
            false => ends,
        },
        slopes: [Range::between(before, behind)],
    }
}

/// Whether a formula is of time alone and not constant.
fn changes(scene: &Scene, formula: &Formula) -> bool {
    scene.is_of_time(formula) && scene.contains(formula, |part| matches!(part, Formula::Time))
}

/// Whether a formula is of declared states, and of nothing but these and time.
fn follows(scene: &Scene, formula: &Formula) -> bool {
    scene.is_of_time_and_states(formula)
        && scene.contains(formula, |part| matches!(part, Formula::State(_)))
}

/// The largest parts of a formula that change in a way. Time and states themselves, and what is said of a `let`, are left out: the ones have no pulse, the other has
/// a place of its own.
fn collect(
    scene: &Scene,
    way: &impl Fn(&Scene, &Formula) -> bool,
    formula: &Formula,
    found: &mut Vec<Formula>,
) {
    match formula {
        Formula::Time | Formula::State(_) | Formula::Let(_) => {}
        Formula::Apply(Function::Neg, _) => descend(scene, way, formula, found),
        _ if way(scene, formula) => found.push(formula.clone()),
        _ => descend(scene, way, formula, found),
    }
}

fn descend(
    scene: &Scene,
    way: &impl Fn(&Scene, &Formula) -> bool,
    formula: &Formula,
    found: &mut Vec<Formula>,
) {
    match formula {
        Formula::Vector(parts)
        | Formula::Apply(_, parts)
        | Formula::Component(parts, _)
        | Formula::Lookup(_, parts) => {
            let parts = parts.iter();
            parts.for_each(|part| collect(scene, way, part, found));
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{State, Unit};

    fn number(x: f64) -> Formula {
        Formula::Number(x)
    }

    fn apply(function: Function, parts: impl IntoIterator<Item = Formula>) -> Formula {
        Formula::Apply(function, parts.into_iter().collect())
    }

    /// exp(−((t − t0)/w)²).
    fn pulse(t0: f64, w: f64) -> Formula {
        let from = apply(Function::Sub, [Formula::Time, number(t0)]);
        let part = apply(Function::Div, [from, number(w)]);
        let square = apply(Function::Power, [part, number(2.0)]);
        apply(Function::Exp, [apply(Function::Neg, [square])])
    }

    fn sine(rate: f64) -> Formula {
        let angle = apply(Function::Mul, [number(rate), Formula::Time]);
        apply(Function::Sin, [angle])
    }

    /// Where the rate of a state is unseen in a span whose ends and middle were looked at.
    fn unseen(rate: Formula, [from, to]: [f64; 2]) -> Option<f64> {
        let state = State {
            name: "s".into(),
            doc: String::new(),
            start: number(0.0),
            unit: Unit::default(),
            rate,
        };
        let scene = Scene {
            states: vec![state],
            ..Scene::default()
        };
        let functions = TimeFunctions::new(&scene, &[]);
        let seen = [0.0, 0.5, 1.0].map(|part| from + part * (to - from));
        functions.unseen(&scene, 0, STILL, [from, to], seen.into_iter())
    }

    #[test]
    fn the_top_of_a_pulse_is_found_however_short_it_is() {
        for width in [1.0, 1e-2, 1e-4, 1e-7] {
            for at in [3.1, 617.3, 990.9] {
                let found = unseen(pulse(at, width), [0.0, 1000.0]);
                let found = found.unwrap_or_else(|| panic!("{width} {at}"));
                assert!((found - at).abs() < width, "{width} {at}: {found}");
            }
        }
    }

    #[test]
    fn its_top_is_found_wherever_it_is_in_a_step() {
        for number in 0..2000 {
            let from = 617.3 - 5.6 * f64::from(number) / 2000.0 - 1e-3;
            let found = unseen(pulse(617.3, 1e-4), [from, from + 5.6]);
            assert!(
                found.is_some_and(|at| (at - 617.3).abs() < 1e-4),
                "{from}: {found:?}"
            );
        }
    }

    #[test]
    fn bounds_hold_every_value_and_close_in_on_it_with_the_square_of_the_span() {
        use Function::{Abs, Add, Atan2, Cos, Floor, IfLess, Max, Min, Mul, Sub, Tanh};
        let three = || apply(Mul, [number(3.0), sine(1.3)]);
        let clock = || apply(Sub, [Formula::Time, number(2.2)]);
        let formulas = [
            apply(Mul, [three(), pulse(2.0, 0.7)]),
            apply(Abs, [three()]),
            apply(Max, [three(), apply(Mul, [clock(), clock()])]),
            apply(Min, [apply(Cos, [clock()]), apply(Tanh, [clock()])]),
            apply(Floor, [three()]),
            apply(
                Atan2,
                [
                    sine(2.0),
                    apply(Cos, [apply(Mul, [number(2.0), Formula::Time])]),
                ],
            ),
            apply(
                IfLess,
                [
                    Formula::Time,
                    number(1.7),
                    three(),
                    apply(Add, [three(), number(5.0)]),
                ],
            ),
            apply(Function::Div, [number(1.0), clock()]),
        ];
        let (scene, functions) = (Scene::default(), TimeFunctions::default());
        for formula in formulas {
            let own = TimeFunction::new(&scene, formula);
            for place in 0..500 {
                for width in [1.0, 0.1, 1e-3] {
                    let from = 0.01 * f64::from(place);
                    let bounds = functions.during(&scene, &own, STILL, [from, from + width]);
                    for part in 0..=20 {
                        let time = from + width * f64::from(part) / 20.0;
                        let value: f64 = functions.at(&scene, &own, STILL, time);
                        let slack = 1e-12 * (1.0 + value.abs());
                        assert!(
                            !value.is_finite()
                                || bounds.low <= value + slack && value - slack <= bounds.high,
                            "{own:?} at {time}: {value} in {bounds:?}"
                        );
                    }
                }
            }
        }
        // Near the crest of a product the excess is that of the curve.
        let own = TimeFunction::new(&scene, apply(Mul, [sine(1.0), pulse(1.5, 3.0)]));
        let excess = |width: f64| {
            let bounds = functions.during(&scene, &own, STILL, [1.5 - width, 1.5 + width]);
            bounds.width()
        };
        let [coarse, fine] = [0.02, 0.01].map(excess);
        assert!(fine < 0.3 * coarse + 0.1 * 0.01, "{coarse} {fine}");
    }

    #[test]
    fn what_a_state_passes_on_its_course_is_found() {
        // exp(−((c − 3)/w)²) along c = 4 t − t², which turns at 4.
        let clock = State {
            name: "c".into(),
            doc: String::new(),
            start: number(0.0),
            unit: Unit::default(),
            rate: number(1.0),
        };
        let of = |w: f64| {
            let from = apply(Function::Sub, [Formula::State(0), number(3.0)]);
            let part = apply(Function::Div, [from, number(w)]);
            let square = apply(Function::Mul, [part.clone(), part]);
            State {
                rate: apply(Function::Exp, [apply(Function::Neg, [square])]),
                ..clock.clone()
            }
        };
        let course: StateCourse<'_> = &|_, t| [4.0 * t - t * t, 4.0 - 2.0 * t];
        for width in [0.1, 1e-3, 1e-6] {
            let scene = Scene {
                states: vec![clock.clone(), of(width)],
                ..Scene::default()
            };
            let functions = TimeFunctions::new(&scene, &[]);
            assert_eq!(functions.acting(), 1);
            assert!(functions.follows_states(0));
            let seen = || [0.0, 2.0, 4.0].into_iter();
            let found = functions.unseen(&scene, 0, course, [0.0, 4.0], seen());
            let found = found.unwrap_or_else(|| panic!("{width}"));
            assert!(
                (course(0, found)[0] - 3.0).abs() < width,
                "{width}: {found}"
            );
            let found = functions.unseen(&scene, 0, course, [0.0, 0.9], [0.0, 0.9].into_iter());
            assert_eq!(found, None);
        }
    }

    #[test]
    fn what_the_looks_show_is_not_unseen() {
        // A pulse elsewhere, one as wide as the span, a quarter of a period, nothing that changes.
        assert_eq!(unseen(pulse(5.0, 0.1), [6.0, 100.0]), None);
        assert_eq!(unseen(pulse(0.5, 10.0), [0.0, 1.0]), None);
        assert_eq!(unseen(sine(1.0), [0.0, 1.5]), None);
        assert_eq!(unseen(Formula::Time, [0.0, 1e9]), None);
        let one = [sine(1.0), sine(1.0)].map(|it| apply(Function::Power, [it, number(0.0)]));
        assert_eq!(unseen(apply(Function::Add, one), [0.0, 10.0]), None);
        // A whole number of periods looks like rest.
        let found = unseen(sine(std::f64::consts::TAU), [0.0, 8.0]).expect("a crest or a trough");
        assert!((found * std::f64::consts::TAU).sin().abs() > 0.5, "{found}");
    }

    #[test]
    fn what_fixed_steps_do_not_see_is_found_and_what_they_see_is_not() {
        let hidden = |formula: Formula, step: f64| {
            let functions = TimeFunctions {
                acting: vec![TimeFunction::new(&Scene::default(), formula)],
                ..TimeFunctions::default()
            };
            functions.hidden_from_steps(&Scene::default(), [0.0, 20.0], step, &[])
        };
        let tau = std::f64::consts::TAU;
        let found = hidden(pulse(10.2037, 1e-4), 0.01).expect("a pulse between stages");
        assert!((found - 10.2037).abs() < 1e-4, "{found}");
        assert_eq!(hidden(pulse(10.2037, 0.05), 0.01), None);
        assert_eq!(hidden(sine(5.0 * tau), 0.01), None);
        assert!(hidden(sine(180.0 * tau), 0.01).is_some());
        // A kink is between stages, but no step misses much of it.
        let kink = apply(Function::Sub, [Formula::Time, number(7.7777)]);
        assert_eq!(hidden(apply(Function::Abs, [kink]), 0.01), None);
    }

    #[test]
    fn the_first_passing_of_a_guard_is_found_among_thousands() {
        let guard = |formula: Formula, from: f64, positive: bool| {
            let functions = TimeFunctions {
                guards: vec![(7, TimeFunction::new(&Scene::default(), formula))],
                ..TimeFunctions::default()
            };
            let side = (0.0, positive);
            functions.first_passing(&Scene::default(), 7, side, [from, from + 1000.0])
        };
        let tau = std::f64::consts::TAU;
        let fast = sine(50.0 * tau);
        for (from, positive, at) in [
            (0.001, true, 0.01),
            (0.011, false, 0.02),
            (7.0001, true, 7.01),
        ] {
            let found = guard(fast.clone(), from, positive).expect("a passing");
            assert!(found > at && found - at < 1e-8, "{found} {at}");
        }
        // One that comes close passes nothing.
        let close = apply(Function::Add, [sine(tau), number(1.000_001)]);
        assert_eq!(guard(close, 0.0, true), None);
        let short = apply(Function::Sub, [pulse(333.3, 1e-6), number(0.5)]);
        let found = guard(short, 0.0, false).expect("a pulse");
        assert!((found - 333.3).abs() < 1e-6, "{found}");
    }
}
