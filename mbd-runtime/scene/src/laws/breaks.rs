//! Times known beforehand at which what acts has a kink or a jump: adaptive steps end there, so that none leaps over a pulse, and fixed steps at jumps.
//!
//! ```text
//! table(a + b t): t = (x_k − a)/b at every entry x_k;     |f|, min, max and choices over f = a + b t: t = −a/b            (1)
//! ```
//!
//! A step that begins where nothing changes has an error of zero, whatever lies inside it: what it leaps over, the next one never sees. Functions of
//! time that are not linear, as sin and exp, have no such times. What f is at such a time corrects it: a late one is the difference of numbers as large as it is, and a
//! step would end beside the jump. Entries of a table at times that a run does not tell apart are one jump: no step lies between them. Derived.

use crate::laws::formula::scalar;
use crate::laws::ground::with_params;
use crate::{Formula, Function, Scene};

/// Three times that tell whether a formula is linear in time [s], and the part of the values within which it is.
const LOOKS: [f64; 3] = [0.0, 1.0, 3.7];
const LINEAR: f64 = 1e-9;

/// A time of (1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Break {
    /// When [s].
    pub time: f64,
    /// Whether something may jump there: at a choice, and where two entries of a table are one time.
    pub jumps: bool,
    /// Whether it acts, and is not only told.
    pub acts: bool,
}

/// The times of (1) for these params, in order, of everything that a run reads; `apart` says how far from a time another one is at least [s].
#[must_use]
pub fn breaks(scene: &Scene, params: &[f64], apart: impl Fn(f64) -> f64) -> Vec<Break> {
    let mut breaks = Vec::new();
    let told = scene.told_by_runs().map(|formula| (formula, false));
    let acting = scene.acting_formulas().map(|formula| (formula, true));
    for (formula, acts) in told.chain(acting) {
        let mut add = |time: f64, jumps: bool| {
            if time.is_finite() {
                breaks.push(Break { time, jumps, acts });
            }
        };
        scene.walk(formula, &mut |part| match part {
            Formula::Lookup(table, arguments) => {
                let Some(table) = scene.tables.get(*table) else {
                    return;
                };
                let second = table.second.iter().map(|second| &second.z);
                let entries = std::iter::once(&table.x).chain(second);
                for (argument, entries) in arguments.iter().zip(entries) {
                    let Some(line) = Straight::of(scene, params, [argument, &ZERO]) else {
                        continue;
                    };
                    let times: Vec<f64> = entries.iter().map(|x| line.time_of(*x)).collect();
                    let are_one = |a: f64, b: f64| (a - b).abs() <= apart(a);
                    for (at, &time) in times.iter().enumerate() {
                        let beside = [at.checked_sub(1), Some(at + 1)].into_iter().flatten();
                        let mut beside = beside.filter_map(|other| times.get(other));
                        add(time, beside.any(|&other| are_one(time, other)));
                    }
                }
            }
            Formula::Apply(function, parts) => {
                if let Some(line) = compared(*function, parts)
                    .and_then(|difference| Straight::of(scene, params, difference))
                {
                    let jumps = matches!(function, Function::IfLess | Function::IfAtMost);
                    add(line.time_of(0.0), jumps);
                }
            }
            _ => {}
        });
    }
    breaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    breaks.dedup_by(|later, kept| {
        let same = later.time == kept.time;
        kept.jumps |= same && later.jumps;
        kept.acts |= same && later.acts;
        same
    });
    breaks
}

const ZERO: Formula = Formula::Number(0.0);

/// What a function compares.
fn compared(function: Function, parts: &[Formula]) -> Option<[&Formula; 2]> {
    match (function, parts) {
        (Function::Abs, [a, ..]) => Some([a, &ZERO]),
        (Function::Min | Function::Max | Function::IfLess | Function::IfAtMost, [a, b, ..]) => {
            Some([a, b])
        }
        _ => None,
    }
}

/// A difference that is a + b t.
struct Straight<'s> {
    scene: &'s Scene,
    params: &'s [f64],
    difference: [&'s Formula; 2],
    a: f64,
    b: f64,
}

impl<'s> Straight<'s> {
    /// `None` of a difference that is not, and of one that stays.
    fn of(scene: &'s Scene, params: &'s [f64], difference: [&'s Formula; 2]) -> Option<Self> {
        if !difference.iter().all(|part| scene.is_of_time(part)) {
            return None;
        }
        let mut line = Straight {
            scene,
            params,
            difference,
            a: 0.0,
            b: 0.0,
        };
        let [a, at_one, later] = LOOKS.map(|time| line.at(time));
        (line.a, line.b) = (a, at_one - a);
        let off = (later - a - LOOKS[2] * line.b).abs();
        let straight = off <= LINEAR * (a.abs() + at_one.abs() + later.abs());
        (straight && line.b != 0.0).then_some(line)
    }

    fn at(&self, time: f64) -> f64 {
        let context = with_params(self.scene, self.params, time);
        let [first, second] = self.difference.map(|part| scalar(part, &context));
        first - second
    }

    /// When it has a value [s].
    fn time_of(&self, value: f64) -> f64 {
        let time = (value - self.a) / self.b;
        time + (value - self.at(time)) / self.b
    }
}
