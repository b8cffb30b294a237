//! Numbers with units, as a person writes them in a setting.

use mbd_compiler::read_number;
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

fn with_unit(setting: &str, text: &str, unit: &str) -> Result<f64, PlanError> {
    let (value, given) = read_number(text).map_err(|text| wrong(setting, text))?;
    let expected = match unit {
        "" => None,
        unit => read_number(&format!("1 {unit}"))
            .ok()
            .map(|(_, unit)| unit.dimension),
    };
    if given.text.is_empty() && !unit.is_empty() && value != 0.0 {
        return Err(wrong(
            setting,
            format!("`{text}` needs a unit, such as {unit}"),
        ));
    }
    let bare = given.text.is_empty();
    if !bare && expected.unwrap_or_default() != given.dimension {
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

/// The same, above zero.
pub(crate) fn positive(setting: &str, value: &Value, unit: &str) -> Result<f64, PlanError> {
    let number = number(setting, value, unit)?;
    if number > 0.0 {
        Ok(number)
    } else {
        Err(wrong(setting, "must be positive"))
    }
}
