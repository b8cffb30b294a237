//! The error of a campaign: a few of its cases flown again with finer steps, metric by metric.
//!
//! A case that keeps to its tolerance, or whose fixed step loses little energy, may still be wrong in what is read from it, and ten thousand of them have the
//! same mistake. So the nominal, and of many cases two more, are flown again with a quarter of the step or a tenth of the tolerance. Rejected: every case twice,
//! which costs as much again as the campaign.

use std::ops::ControlFlow;

use mbd_runtime::scene::plain;

use crate::campaign::{Campaign, Resources};
use crate::results::{LARGE_ERROR, Results};

/// One more case is flown again for so many, up to [`MOST`] beside the nominal.
const EACH: u64 = 100;
const MOST: u64 = 2;
/// A metric that never is more than this part of the largest of its unit may be what rounding and tolerances leave of zero.
const SMALL_PART: f64 = 1e-6;
/// What is nothing in any unit.
const NOTHING: f64 = 1e-9;

/// What is known of the error of a campaign.
pub(super) struct Accuracy {
    /// A line, or a few.
    pub text: String,
    /// Whether it is so large that it is an exit code.
    pub is_large: bool,
}

/// What is said where no case is flown again, and why.
pub(super) fn unestimated(why: &str) -> String {
    format!("the error of the cases is not estimated: {why}\n")
}

/// Flies a few cases again with finer steps, and compares them with their rows; where none is flown again, why not.
pub(super) fn accuracy(campaign: Campaign, results: &Results, resources: Resources) -> Accuracy {
    let none = |why: &str| Accuracy {
        text: unestimated(why),
        is_large: false,
    };
    if !campaign.estimates() {
        return none("the settings ask for none (`estimate = false`)");
    }
    let (rows, metrics) = (&results.rows, &results.manifest.metrics);
    let more = (campaign.cases() / EACH).min(MOST);
    let chosen = (0..=more).map(|number| number * (campaign.cases() / (more + 1)));
    let chosen: Vec<usize> = chosen
        .filter_map(|case| usize::try_from(case).ok())
        .filter(|case| rows.get(*case).is_some_and(|row| row.reached_end()))
        .collect();
    let method = campaign.method();
    let change = match method.fixed_step() {
        Some(step) => format!("take a shorter step than {step} s"),
        None => "take a tighter tolerance".to_owned(),
    };
    let hidden = campaign.hidden_from_steps();
    let numbers: Vec<u64> = chosen.iter().map(|case| *case as u64).collect();
    if numbers.is_empty() {
        return none("none of those that are flown again reached its end");
    }
    let Some(finer) = campaign.finer(&numbers) else {
        return none("nothing finer than the tolerance is told apart from rounding");
    };
    let mut flown = Vec::new();
    finer.run(
        numbers.len(),
        &|place| numbers.get(place).copied().unwrap_or(0),
        resources,
        |case| {
            flown.push(case.row);
            ControlFlow::Continue(())
        },
    );
    let size = |at: usize| {
        let own = rows.iter().chain(&flown);
        let values = own.filter_map(|row| row.metrics.get(at).copied());
        values
            .filter(|x| x.is_finite())
            .fold(0.0, |most: f64, x| most.max(x.abs()))
    };
    let sizes: Vec<(&str, f64)> = metrics
        .iter()
        .enumerate()
        .map(|(at, metric)| (metric.unit.as_str(), size(at)))
        .collect();
    let mut worst: Option<(f64, String)> = None;
    let mut lost = Vec::new();
    for finer in &flown {
        let Some(row) = rows.iter().find(|row| row.case == finer.case) else {
            continue;
        };
        if !finer.reached_end() {
            lost.push(format!(
                "case {} flown again with finer steps does not reach its end: {}",
                finer.case, finer.why
            ));
        }
        let pairs = row.metrics.iter().zip(&finer.metrics);
        for ((metric, (unit, size)), (own, other)) in metrics.iter().zip(&sizes).zip(pairs) {
            // A reaction that is one choice of many says nothing.
            if !metric.remark.is_empty() || own.is_nan() && other.is_nan() || !finer.reached_end() {
                continue;
            }
            let alike = sizes.iter().filter(|(other, _)| other == unit);
            let largest = alike.fold(0.0, |most: f64, (_, size)| most.max(*size));
            let scale = size.max(SMALL_PART * largest);
            let error = (own - other).abs();
            let part = match error.is_nan() {
                // One of both has no value: an event happened in one alone.
                true => f64::INFINITY,
                false if scale <= NOTHING => continue,
                false => error / scale,
            };
            if worst.as_ref().is_none_or(|(most, _)| part > *most) {
                let off = match error.is_nan() {
                    true => "has a value in one of both alone".to_owned(),
                    false => format!(
                        "is off by about {}, {} % of the largest of all cases",
                        format!("{} {}", plain(error, 2), metric.unit).trim_end(),
                        plain(100.0 * part, 2)
                    ),
                };
                worst = Some((
                    part,
                    format!("`{}` of case {} {off}", metric.name, finer.case),
                ));
            }
        }
    }
    let is_large = worst.as_ref().is_some_and(|(part, _)| *part > LARGE_ERROR);
    let numbers: Vec<String> = flown.iter().map(|row| row.case.to_string()).collect();
    let told = worst.map(|(_, worst)| {
        let remedy = match is_large {
            true => format!(
                ": {change}; where that does not help, the motion is chaotic over this time"
            ),
            false => String::new(),
        };
        let again = match numbers.len() {
            1 => format!("case {} flown again with finer steps", numbers.join("")),
            _ => format!("cases {} flown again with finer steps", numbers.join(", ")),
        };
        format!("{again}: {worst}{remedy}")
    });
    let hidden = hidden.map(|time| {
        format!(
            "what acts changes at {} s in less than a step, and no stage of a step sees it: {change}, or an adaptive method",
            plain(time, 9)
        )
    });
    let is_large = is_large || hidden.is_some() || !lost.is_empty();
    let sign = if is_large { "warning: " } else { "" };
    let lines = hidden.into_iter().chain(lost).chain(told);
    let text: String = lines.map(|line| format!("{sign}{line}\n")).collect();
    match text.is_empty() {
        true => none("no metric is ever more than zero"),
        false => Accuracy { text, is_large },
    }
}
