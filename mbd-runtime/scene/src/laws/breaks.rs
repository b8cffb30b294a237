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

/// The times of (1) for these params [s], in order, of everything that a run reads.
#[must_use]
pub fn breaks(scene: &Scene, params: &[f64]) -> Vec<f64> {
    let mut times = Vec::new();
    let linear = |of: &dyn Fn(f64) -> f64| {
        let [a, b, c] = LOOKS.map(of);
        let rate = b - a;
        let straight = (c - a - LOOKS[2] * rate).abs() <= LINEAR * (a.abs() + b.abs() + c.abs());
        (straight && rate != 0.0).then_some([a, rate])
    };
    let value = |formula: &Formula, time: f64| scalar(formula, &with_params(scene, params, time));
    let of_time = |parts: &[Formula]| {
        parts.iter().all(|part| scene.is_of_time(part))
            && parts
                .iter()
                .any(|part| scene.contains(part, |part| matches!(part, Formula::Time)))
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
                    let alone = std::slice::from_ref(argument);
                    if let Some([a, b]) = of_time(alone)
                        .then(|| linear(&|time| value(argument, time)))
                        .flatten()
                    {
                        times.extend(entries.iter().map(|x| (x - a) / b));
                    }
                }
            }
            Formula::Apply(function, parts) => {
                let compared = match (function, parts.as_slice()) {
                    (Function::Abs, [a, ..]) => std::slice::from_ref(a),
                    (
                        Function::Min | Function::Max | Function::IfLess | Function::IfAtMost,
                        [_, _, ..],
                    ) => &parts[..2],
                    _ => return,
                };
                let apart = |time: f64| {
                    let mut values = compared.iter().map(|part| value(part, time));
                    let first = values.next().unwrap_or_default();
                    first - values.next().unwrap_or_default()
                };
                if let Some([a, b]) = of_time(compared).then(|| linear(&apart)).flatten() {
                    times.push(-a / b);
                }
            }
            _ => {}
        });
    }
    times.retain(|time| time.is_finite());
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
