//! A number with its unit, on its own: what a command line or a settings file gives for a param.

use mbd_scene::Unit;

use crate::lexeme::{self, LexemeKind, Region};
use crate::messages::LexemeMessage;
use crate::syntax::{Cursor, ValueSyntax, unit};
use crate::units;

/// Reads `780 kg`, `-2.5e3N/m` or `0.46`: the value in SI, and the unit as written (its text is empty when there is none).
///
/// # Errors
/// What is wrong with the text.
pub fn read_number(text: &str) -> Result<(f64, Unit), String> {
    let (lexemes, places, messages) = lexeme::from_text(text);
    if let Some(message) = messages.located(&places).into_iter().next() {
        return Err(message.text);
    }
    let mut cursor = Cursor::new(ValueSyntax {
        lexemes: &lexemes,
        at: Region::START,
    });
    let told = |report: LexemeMessage| report.text;
    let sign = if cursor.sign('-').is_some() {
        -1.0
    } else {
        1.0
    };
    let number = match cursor.peek().map(|lexeme| &lexeme.kind) {
        Some(LexemeKind::Number(digits)) => digits.replace('_', "").parse::<f64>().ok(),
        _ => None,
    };
    let Some(number) = number.filter(|number| number.is_finite()) else {
        return Err(format!(
            "`{text}` is no number with a unit, such as `2.5 kN/m`"
        ));
    };
    cursor.take();
    let unit = unit::suffix(&mut cursor).map_err(told)?;
    cursor.finish("the end of the number").map_err(told)?;
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
    fn what_is_no_number_is_said() {
        for text in [
            "", "kg", "1 kgs", "1 kg kg", "--1", "1e999", "[1, 2] m", "1 kg; 2", "(1",
        ] {
            assert!(read_number(text).is_err(), "{text}");
        }
        assert!(
            read_number("1 kgs")
                .unwrap_err()
                .contains("unknown unit `kgs`")
        );
    }
}
