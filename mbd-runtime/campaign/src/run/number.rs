//! Numbers with units, as a person writes them in a setting.

use mbd_compiler::{mixes_turns, read_number, read_vector};
use mbd_runtime::scene::Unit;
use toml::Value;

use super::names::{PlanError, wrong};

/// A number in SI from `"2.6 m"` or from a bare number; `unit` is what it must measure.
pub(crate) fn number(setting: &str, value: &Value, unit: &str) -> Result<f64, PlanError> {
    let number = match value {
        Value::Integer(whole) => *whole as f64,
        Value::Float(number) => *number,
        Value::String(text) => return with_unit(setting, text, unit),
        other => {
            return Err(wrong(
                setting,
                format!("expected a number, found {}", other.type_str()),
            ));
        }
    };
    if number.is_finite() {
        Ok(number)
    } else {
        Err(wrong(setting, "give it a finite value"))
    }
}

/// The same of a param or an input: radians need no unit, as in a declaration, up to a full turn.
pub(crate) fn supplied(setting: &str, value: &Value, unit: &str) -> Result<f64, PlanError> {
    let bare = value.as_str().and_then(|text| text.trim().parse().ok());
    match bare.filter(|bare: &f64| unit == "rad" && bare.is_finite()) {
        Some(radians) => within_a_turn(setting, radians, unit).map(|()| radians),
        None => number(setting, value, unit),
    }
}

/// Refuses a number without a unit where one in SI is seldom meant: beside another unit in the declaration, and as an angle of more than a turn.
pub(crate) fn not_bare(setting: &str, value: &Value, unit: &str) -> Result<(), PlanError> {
    let number = match value {
        Value::Integer(whole) => *whole as f64,
        Value::Float(number) => *number,
        Value::Array(parts) => {
            return parts
                .iter()
                .try_for_each(|part| not_bare(setting, part, unit));
        }
        _ => return Ok(()),
    };
    let declared = read_number(&format!("1 {unit}")).ok();
    let factor = declared.map_or(1.0, |(_, unit)| unit.factor);
    if number != 0.0 && factor != 1.0 {
        let text = format!(
            "{number} has no unit, and what it is given for is declared in {unit}: write `\"{number} {unit}\"`"
        );
        return Err(wrong(setting, text));
    }
    within_a_turn(setting, number, unit)
}

/// Refuses a number without a unit that would be more than a full turn in radians.
fn within_a_turn(setting: &str, number: f64, unit: &str) -> Result<(), PlanError> {
    if unit != "rad" || number.abs() <= std::f64::consts::TAU {
        return Ok(());
    }
    let text = format!(
        "{number} has no unit and would be more than a full turn in radians: write `\"{number} deg\"`, or `\"{number} rad\"` if that is meant"
    );
    Err(wrong(setting, text))
}

fn with_unit(setting: &str, text: &str, unit: &str) -> Result<f64, PlanError> {
    let (value, given) = read_number(text).map_err(|text| wrong(setting, text))?;
    measured(setting, text, (value, &given), unit)
}

/// As many numbers in SI as there are units: in brackets, each with its unit or bare, or in one text, `"[8, 0, 0] m/s"`, where the units are all the same.
pub(crate) fn numbers(setting: &str, value: &Value, units: &[&str]) -> Result<Vec<f64>, PlanError> {
    let count = |found: usize| match found == units.len() {
        true => Ok(()),
        false => Err(wrong(
            setting,
            format!("expected {} numbers, found {found}", units.len()),
        )),
    };
    match value {
        Value::Array(list) => {
            count(list.len())?;
            let each = list.iter().zip(units);
            each.map(|(value, unit)| number(setting, value, unit))
                .collect()
        }
        Value::String(text) if text.trim_start().starts_with('[') => {
            let given = read_vector(text).map_err(|text| wrong(setting, text))?;
            count(given.len())?;
            let each = given.iter().zip(units);
            each.map(|((value, given), unit)| measured(setting, text, (*value, given), unit))
                .collect()
        }
        single => {
            if let [unit] = units {
                return Ok(vec![number(setting, single, unit)?]);
            }
            let example = match units {
                [unit, ..] if units.iter().all(|other| other == unit) => {
                    format!("\"{}\"", format!("[1, 0, 0] {unit}").trim_end())
                }
                units => zeros(units),
            };
            Err(wrong(
                setting,
                format!(
                    "expected {} numbers, found one: write them in brackets, such as `{example}`",
                    units.len()
                ),
            ))
        }
    }
}

/// How nothing of as many numbers as there are units is written in TOML.
pub(crate) fn zeros(units: &[&str]) -> String {
    let each: Vec<String> = units
        .iter()
        .map(|unit| format!("\"{}\"", format!("0 {unit}").trim_end()))
        .collect();
    format!("[{}]", each.join(", "))
}

/// A number that was read with its unit, checked against what it must measure.
fn measured(
    setting: &str,
    text: &str,
    (value, given): (f64, &Unit),
    unit: &str,
) -> Result<f64, PlanError> {
    let expected = match unit {
        "" => None,
        unit => read_number(&format!("1 {unit}")).ok().map(|(_, unit)| unit),
    };
    if given.text.is_empty() && !unit.is_empty() && value != 0.0 {
        return Err(wrong(
            setting,
            format!("`{text}` needs a unit, such as {unit}"),
        ));
    }
    let bare = given.text.is_empty();
    let dimension = expected.as_ref().map(|unit| unit.dimension);
    if expected.is_some_and(|expected| mixes_turns(&expected, given)) {
        let text = format!(
            "`{text}` is no number in {unit}: `Hz` counts turns, and a turn a second is 2 pi rad/s or 60 rpm; write it in {unit}"
        );
        return Err(wrong(setting, text));
    }
    if !bare && dimension.unwrap_or_default() != given.dimension {
        let unit = if unit.is_empty() { "no unit" } else { unit };
        return Err(wrong(
            setting,
            format!("`{text}` has the wrong unit: expected {unit}"),
        ));
    }
    if value.is_finite() {
        Ok(value)
    } else {
        Err(wrong(setting, "give it a finite value"))
    }
}

/// The same, zero or above.
pub(crate) fn not_negative(setting: &str, value: &Value, unit: &str) -> Result<f64, PlanError> {
    let number = number(setting, value, unit)?;
    if number >= 0.0 {
        Ok(number)
    } else {
        Err(wrong(setting, "must not be negative"))
    }
}

/// The same, above zero.
pub(crate) fn positive(setting: &str, value: &Value, unit: &str) -> Result<f64, PlanError> {
    let number = number(setting, value, unit)?;
    if number > 0.0 {
        Ok(number)
    } else {
        Err(wrong(setting, "must be positive"))
    }
}
