//! What changes with time alone, and what of it the ends of a step and its stages do not show.
//!
//! ```text
//! g unseen between a and b:   some t in (a, b) with g(t) outside the hull of g(s) at all times s that were looked at                (1)
//! ```
//!
//! A step that begins where nothing moves has an error of zero whatever lies inside it, a pulse `exp(-((t − 10 s)/w)^2)` as well as nothing. What
//! changes with time alone is known beforehand: its range over a span holds everything it can be there, so that bisection finds
//! what lies outside the hull, however short it lasts, and the first time at which a guard passes. Derived.

use crate::laws::formula::{Context, Value, of_let, scalar, value};
use crate::scalar::Range;
use crate::{Formula, Function, Real, Scene};

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
/// Spans that wait at a time: every bisection leaves one more.
const WAITING: usize = MOST_SPANS as usize + 1;

/// The formulas of time alone of a scene, for some params.
#[derive(Clone, Debug, Default)]
pub struct TimeFunctions {
    /// Scalars that are not constant, of what acts.
    acting: Vec<Formula>,
    /// The same of outputs, and of what metrics measure.
    measured: Vec<Formula>,
    /// The guards of events that are of time alone, with their numbers.
    guards: Vec<(usize, Formula)>,
    params: Vec<f64>,
}

/// The leaves of a formula of time while time is in a span, or at one.
struct During<'a, S> {
    scene: &'a Scene,
    params: &'a [f64],
    time: S,
}

impl<S: Real> Context<S> for During<'_, S> {
    fn scene(&self) -> &Scene {
        self.scene
    }

    fn param(&self, index: usize) -> Option<S> {
        self.params.get(index).copied().map(S::from_f64)
    }

    fn named(&self, index: usize) -> Option<Value<S>> {
        of_let(index, self)
    }

    fn time(&self) -> Option<S> {
        Some(self.time)
    }
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
        for formula in scene.acting_formulas().chain(frames).chain(lets) {
            collect(scene, formula, &mut acting);
        }
        for output in &scene.outputs {
            collect(scene, &output.value, &mut measured);
        }
        let events = scene.events.iter().enumerate();
        let guards = events.filter(|(_, event)| changes(scene, &event.guard));
        let mut functions = TimeFunctions {
            acting: Vec::new(),
            measured: Vec::new(),
            guards: guards
                .map(|(at, event)| (at, event.guard.clone()))
                .collect(),
            params: params.to_vec(),
        };
        functions.acting = functions.scalars(scene, acting);
        functions.measured = functions.scalars(scene, measured);
        functions
    }

    /// Each of some formulas once, of vectors their components.
    fn scalars(&self, scene: &Scene, formulas: Vec<Formula>) -> Vec<Formula> {
        let mut scalars: Vec<Formula> = Vec::new();
        for formula in formulas {
            let parts = match self.at::<f64>(scene, &formula, 0.0) {
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
        scalars
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

    fn at<S: Real>(&self, scene: &Scene, formula: &Formula, time: S) -> Value<S> {
        let during = During {
            scene,
            params: &self.params,
            time,
        };
        value(formula, &during)
    }

    fn scalar<S: Real>(&self, scene: &Scene, formula: &Formula, time: S) -> S {
        let during = During {
            scene,
            params: &self.params,
            time,
        };
        scalar(formula, &during)
    }

    /// A time in a span at which a number that acts is unseen by (1), where it was looked at at the times `seen` [s].
    pub fn unseen(
        &self,
        scene: &Scene,
        number: usize,
        span: [f64; 2],
        seen: impl Iterator<Item = f64>,
    ) -> Option<f64> {
        let formula = self.acting.get(number)?;
        self.unseen_of(scene, formula, span, seen)
    }

    /// Whether something that is measured is unseen by (1) in a span, where it was looked at at the times `seen` [s].
    pub fn hides(
        &self,
        scene: &Scene,
        span: [f64; 2],
        seen: impl Iterator<Item = f64> + Clone,
    ) -> bool {
        let unseen = |formula| self.unseen_of(scene, formula, span, seen.clone()).is_some();
        self.measured.iter().any(unseen)
    }

    fn unseen_of(
        &self,
        scene: &Scene,
        formula: &Formula,
        whole: [f64; 2],
        seen: impl Iterator<Item = f64>,
    ) -> Option<f64> {
        let during = |[from, to]: [f64; 2]| self.scalar(scene, formula, Range::between(from, to));
        let at = |time: f64| Range::from_f64(self.scalar(scene, formula, time));
        let hull = seen.map(at).reduce(Range::hull)?;
        let size = hull.low.abs().max(hull.high.abs());
        let margin = (MARGIN * hull.width()).max(ROUNDING * size);
        let mut worst = (margin, None);
        let mut spans = Bisection::new(whole, MOST_SPANS);
        spans.add(whole, hull.beyond(during(whole)));
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
                spans.add(half, hull.beyond(during(half)));
            }
        }
        worst.1
    }

    /// A time in a span at which a number that acts is unseen by (1) in every step of a size around it, whose ends and middle are looked at, by more than a
    /// tenth of all that it is in the span [s]; `None` where steps see it, or where it swings so often that this is not known.
    #[must_use]
    pub fn hidden_from_steps(&self, scene: &Scene, whole: [f64; 2], step: f64) -> Option<f64> {
        let hidden = |formula| self.hidden_of(scene, formula, whole, step);
        self.acting.iter().find_map(hidden)
    }

    fn hidden_of(
        &self,
        scene: &Scene,
        formula: &Formula,
        [begin, end]: [f64; 2],
        step: f64,
    ) -> Option<f64> {
        let at = |time: f64| Range::from_f64(self.scalar(scene, formula, time));
        let during = |[from, to]: [f64; 2]| self.scalar(scene, formula, Range::between(from, to));
        let part = |number: u32| begin + (end - begin) * f64::from(number) / f64::from(SAMPLES);
        let all = (0..=SAMPLES).map(|number| at(part(number)));
        let mut total = all.reduce(Range::hull)?;
        let mut spans = Bisection::new([begin, end], MOST_SPANS_OF_GUARDS);
        spans.add([begin, end], 0.0);
        while let Some(span) = spans.last() {
            if during(span).width() <= NOTICED * total.width() {
                continue;
            }
            let middle = 0.5 * (span[0] + span[1]);
            total = total.hull(at(middle));
            if span[1] - span[0] > step {
                spans.add([middle, span[1]], 0.0);
                spans.add([span[0], middle], 0.0);
                continue;
            }
            let looks = [span[0], middle, span[1]];
            let Some(found) = self.unseen_of(scene, formula, span, looks.into_iter()) else {
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
        let (_, formula) = self.guards.iter().find(|(own, _)| *own == event)?;
        let sign = if positive { 1.0 } else { -1.0 };
        let during = |[from, to]: [f64; 2]| {
            let range = self.scalar(scene, formula, Range::between(from, to));
            (range - Range::from_f64(zero)) * Range::from_f64(sign)
        };
        let mut first = None;
        let mut spans = Bisection::new(whole, MOST_SPANS_OF_GUARDS);
        spans.add(whole, 0.0);
        while let Some(span) = spans.last() {
            if during(span).low >= 0.0 {
                continue;
            }
            let middle = 0.5 * (span[0] + span[1]);
            if sign * (self.scalar(scene, formula, middle) - zero) < 0.0 {
                first = Some(middle);
                // Nothing later is first.
                spans.drop_all();
            } else {
                spans.add([middle, span[1]], 0.0);
            }
            spans.add([span[0], middle], 0.0);
        }
        first
    }
}

/// Whether a formula is of time alone and not constant.
fn changes(scene: &Scene, formula: &Formula) -> bool {
    scene.is_of_time(formula) && scene.contains(formula, |part| matches!(part, Formula::Time))
}

/// The largest parts of a formula that change with time alone. Time itself, and what is said of a `let`, is left out: the one has no pulse, the other has a place
/// of its own.
fn collect(scene: &Scene, formula: &Formula, found: &mut Vec<Formula>) {
    match formula {
        Formula::Time | Formula::Let(_) => {}
        Formula::Apply(Function::Neg, _) => descend(scene, formula, found),
        _ if changes(scene, formula) => found.push(formula.clone()),
        _ => descend(scene, formula, found),
    }
}

fn descend(scene: &Scene, formula: &Formula, found: &mut Vec<Formula>) {
    match formula {
        Formula::Vector(parts)
        | Formula::Apply(_, parts)
        | Formula::Component(parts, _)
        | Formula::Lookup(_, parts) => {
            parts.iter().for_each(|part| collect(scene, part, found));
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
        functions.unseen(&scene, 0, [from, to], seen.into_iter())
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
                acting: vec![formula],
                ..TimeFunctions::default()
            };
            functions.hidden_from_steps(&Scene::default(), [0.0, 20.0], step)
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
                guards: vec![(7, formula)],
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
