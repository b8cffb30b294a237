//! A number with its unit, or three of them, on their own: what a command line or a settings file gives for a param.

use mbd_scene::Unit;

use crate::lexeme::{self, Bracket, LexemeKind, Region};
use crate::messages::{LexemeMessage, syntax as say};
use crate::syntax::{Cursor, ValueSyntax, unit};
use crate::units;

/// Reads `780 kg`, `-2.5e3N/m`, `3/s` or `0.46`: the value in SI, and the unit as written (its text is empty when there is none).
///
/// # Errors
/// What is wrong with the text.
pub fn read_number(text: &str) -> Result<(f64, Unit), String> {
    read(text, |cursor| number(cursor, text))
}

/// Reads `[8, 0, 0] m/s` or `[8 m/s, 0, 0]`: the values in SI, each with its unit.
///
/// # Errors
/// What is wrong with the text.
pub fn read_vector(text: &str) -> Result<Vec<(f64, Unit)>, String> {
    read(text, |cursor| {
        let Some(group) = cursor.group(Bracket::Square) else {
            return Err(format!(
                "`{text}` is no vector with a unit, such as `[8, 0, 0] m/s`"
            ));
        };
        let shared = unit::suffix(cursor).map_err(told)?;
        let parts = Cursor::new(group).comma_separated().into_iter();
        let parts = parts.map(|part| {
            let mut part = Cursor::new(part);
            let (value, own) = number(&mut part, text)?;
            part.finish("the end of the number").map_err(told)?;
            match &shared {
                Some(unit) if !own.text.is_empty() && own.dimension != unit.dimension => {
                    Err(format!(
                        "`{text}` has two units that do not fit, one inside its brackets and one behind them: write one of them"
                    ))
                }
                Some(_) if !own.text.is_empty() => Ok((value, own)),
                Some(unit) => Ok((value * unit.factor, unit.clone())),
                None => Ok((value, own)),
            }
        });
        parts.collect()
    })
}

/// Reads all of a text.
fn read<V>(
    text: &str,
    value: impl FnOnce(&mut Cursor<'_>) -> Result<V, String>,
) -> Result<V, String> {
    if text.trim().is_empty() {
        return Err("a value is missing: write a number with its unit, such as `2.5 kN/m`".into());
    }
    let (lexemes, places, messages) = lexeme::from_text(text);
    if let Some(message) = messages.located(&places).into_iter().next() {
        return Err(message.text);
    }
    let mut cursor = Cursor::new(ValueSyntax {
        lexemes: &lexemes,
        at: Region::START,
    });
    let value = value(&mut cursor)?;
    cursor.finish("the end of the number").map_err(told)?;
    Ok(value)
}

fn told(report: LexemeMessage) -> String {
    report.text
}

/// Whether a number that is not zero is read as zero: it is smaller than any that there is.
pub(crate) fn vanishes(text: &str, value: f64) -> bool {
    let significand = text.split(['e', 'E']).next().unwrap_or_default();
    value == 0.0 && significand.contains(|c: char| c.is_ascii_digit() && c != '0')
}

/// Takes a number with its sign and its unit.
fn number(cursor: &mut Cursor<'_>, text: &str) -> Result<(f64, Unit), String> {
    let sign = if cursor.sign('-').is_some() {
        -1.0
    } else {
        1.0
    };
    let digits = match cursor.peek().map(|lexeme| &lexeme.kind) {
        Some(LexemeKind::Number(digits)) => digits.replace('_', ""),
        _ => String::new(),
    };
    let number = digits.parse::<f64>().ok();
    let Some(number) = number.filter(|number| number.is_finite()) else {
        if let (Some(_), Some(LexemeKind::Number(digits))) =
            (cursor.sign('.'), cursor.peek().map(|lexeme| &lexeme.kind))
        {
            return Err(told(say::leading_point(cursor.here(), digits)));
        }
        return Err(format!(
            "`{text}` is no number with a unit, such as `2.5 kN/m`"
        ));
    };
    if vanishes(&digits, number) {
        return Err(format!("`{text}` is too small"));
    }
    cursor.take();
    let unit = match unit::suffix(cursor).map_err(told)? {
        None => unit::below(cursor).map_err(told)?,
        unit => unit,
    };
    let unit = unit.unwrap_or_else(|| units::si("", units::NONE));
    let value = sign * number * unit.factor;
    if value.is_finite() {
        Ok((value, unit))
    } else {
        Err(format!("`{text}` is too large"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_becomes_si_with_the_dimension_of_its_unit() {
        let (value, unit) = read_number("60 kN/m").unwrap();
        assert_eq!((value, unit.text.as_str()), (60e3, "kN/m"));
        let (value, unit) = read_number("-2.5e-3").unwrap();
        assert_eq!((value, unit.text.as_str()), (-2.5e-3, ""));
        assert_eq!(read_number("2.0kg").unwrap().0, 2.0);
        assert_eq!(read_number("1_000 g").unwrap().0, 1.0);
    }

    #[test]
    fn a_number_may_be_so_much_a_second_as_in_a_declaration() {
        let read = |text| read_number(text).map(|(value, unit)| (value, unit.text));
        for (text, value, unit) in [
            ("3/s", 3.0, "1/s"),
            ("-3 / ms^2", -3e6, "1/ms^2"),
            ("3/(mm*s)", 3e3, "1/(mm*s)"),
        ] {
            assert_eq!(read(text), Ok((value, unit.to_string())), "{text}");
            let unit = read_number(&format!("1 {unit}")).map(|(_, unit)| unit);
            assert_eq!(read_number(text).map(|(_, unit)| unit), unit, "{text}");
        }
        let [rate, none, _] = &read_vector("[2/s, 0, 0]").unwrap()[..] else {
            panic!("three numbers");
        };
        assert_eq!((rate.0, rate.1.text.as_str()), (2.0, "1/s"));
        assert_eq!(none.1.text, "");
        for text in ["3/", "3/2", "3/s/", "1/2 m"] {
            assert!(read_number(text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_said() {
        for text in [
            "", "kg", "1 tons", "1 kg kg", "--1", "1e999", "[1, 2] m", "1 kg; 2", "(1",
        ] {
            assert!(read_number(text).is_err(), "{text}");
        }
        let point = read_number("-.5 kg").unwrap_err();
        assert!(point.contains("write `0.5`"), "{point}");
        assert!(
            read_number("1 tons")
                .unwrap_err()
                .contains("unknown unit `tons`")
        );
    }

    #[test]
    fn a_vector_has_its_unit_behind_or_inside_its_brackets() {
        let values = |text: &str| -> Result<Vec<f64>, String> {
            read_vector(text).map(|all| all.into_iter().map(|(value, _)| value).collect())
        };
        assert_eq!(
            values("[8, -0.5, 0] km/h"),
            values("[8 km/h, -0.5 km/h, 0 m/s]")
        );
        assert_eq!(values("[1, 2, 3] km"), Ok(vec![1e3, 2e3, 3e3]));
        // What has a unit already stands for itself.
        assert_eq!(values("[1 m, 2, 3] km"), Ok(vec![1.0, 2e3, 3e3]));
        for text in [
            "",
            "[1 s, 2, 3] m",
            "[1, x, 3] m",
            "3 m",
            "[1, 2 3] m",
            "[1, 2, 3] m m",
        ] {
            assert!(values(text).is_err(), "{text}");
        }
    }
}
