//! Times known beforehand at which what acts has a kink or a jump: adaptive steps end there, so that none leaps over a pulse.
//!
//! ```text
//! table(a + b t): t = (x_k − a)/b at every entry x_k;     |f|, min, max and choices over f = a + b t: t = −a/b            (1)
//! ```
//!
//! A step that begins where nothing changes has an error of zero, whatever lies inside it: what it leaps over, the next one never sees. Functions of
//! time that are not linear, as sin and exp, have no such times. Derived.

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
    /// Whether what acts may jump there: at a choice.
    pub jumps: bool,
}

/// The times of (1) for these params, in order, of everything that a run reads.
#[must_use]
pub fn breaks(scene: &Scene, params: &[f64]) -> Vec<Break> {
    let mut breaks = Vec::new();
    let mut add = |time: f64, jumps: bool| {
        if time.is_finite() {
            breaks.push(Break { time, jumps });
        }
    };
    for formula in scene.read_by_runs() {
        scene.walk(formula, &mut |part| match part {
            Formula::Lookup(table, arguments) => {
                let Some(table) = scene.tables.get(*table) else {
                    return;
                };
                let second = table.second.iter().map(|second| &second.z);
                let entries = std::iter::once(&table.x).chain(second);
                for (argument, entries) in arguments.iter().zip(entries) {
                    if let Some([a, b]) = linear(scene, params, [argument, &ZERO]) {
                        entries.iter().for_each(|x| add((x - a) / b, false));
                    }
                }
            }
            Formula::Apply(function, parts) => {
                if let Some([a, b]) = compared(*function, parts)
                    .and_then(|difference| linear(scene, params, difference))
                {
                    let jumps = matches!(function, Function::IfLess | Function::IfAtMost);
                    add(-a / b, jumps);
                }
            }
            _ => {}
        });
    }
    breaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    breaks.dedup_by(|later, kept| {
        let same = later.time == kept.time;
        kept.jumps |= same && later.jumps;
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

/// a and b of a difference that is a + b t; `None` of another one.
fn linear(scene: &Scene, params: &[f64], difference: [&Formula; 2]) -> Option<[f64; 2]> {
    if !difference.iter().all(|part| scene.is_of_time(part)) {
        return None;
    }
    let [a, at_one, later] = LOOKS.map(|time| {
        let context = with_params(scene, params, time);
        let [first, second] = difference.map(|part| scalar(part, &context));
        first - second
    });
    let rate = at_one - a;
    let off = (later - a - LOOKS[2] * rate).abs();
    let straight = off <= LINEAR * (a.abs() + at_one.abs() + later.abs());
    (straight && rate != 0.0).then_some([a, rate])
}
