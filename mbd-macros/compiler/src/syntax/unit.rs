//! Units: words combined with `*`, `/`, `^` and round brackets.

use mbd_scene::{Dimension, Unit};

use super::Cursor;
use crate::lexeme::{Bracket, LexemeKind, Region};
use crate::messages::{LexemeMessage, syntax as say};
use crate::units;

/// Takes a unit that must fill the rest of the cursor: after `in`, in the type of an input, after brackets.
pub fn whole(mut cursor: Cursor<'_>) -> Result<Unit, LexemeMessage> {
    if alone(&cursor) {
        return Ok(units::si("", units::NONE));
    }
    let bracket = matches!(
        cursor.peek().map(|lexeme| &lexeme.kind),
        Some(LexemeKind::Open(Bracket::Round, _))
    );
    let first = match reciprocal(&mut cursor) {
        Some(one) => one,
        None if cursor.peek_word().is_some() || bracket => factor(&mut cursor, true)?,
        None => return Err(say::unit_expected(cursor.here())),
    };
    let unit = product(&mut cursor, first, true)?;
    no_unit_behind(&cursor, &unit)?;
    cursor.finish("the end of the unit")?;
    Ok(unit)
}

/// Takes a unit if one comes next. A word right after a number must be a unit; after `*` or `/` it may be something else.
pub fn suffix(cursor: &mut Cursor<'_>) -> Result<Option<Unit>, LexemeMessage> {
    trailing(cursor, false)
}

/// The same where no operator can follow: what stands behind `*` or `/` is a unit, too.
pub fn suffix_alone(cursor: &mut Cursor<'_>) -> Result<Option<Unit>, LexemeMessage> {
    trailing(cursor, true)
}

fn trailing(cursor: &mut Cursor<'_>, strict: bool) -> Result<Option<Unit>, LexemeMessage> {
    let first = match reciprocal(cursor) {
        Some(one) => one,
        None if cursor.peek_word().is_some() => factor(cursor, true)?,
        None => return in_brackets(cursor),
    };
    let unit = product(cursor, first, strict)?;
    no_unit_behind(cursor, &unit)?;
    Ok(Some(unit))
}

/// Takes what stands below the line of a number without a unit of its own: the `/s` of `3/s`, the `/(m*s)` of `3/(m*s)`.
pub fn below(cursor: &mut Cursor<'_>) -> Result<Option<Unit>, LexemeMessage> {
    let mut ahead = *cursor;
    if ahead.sign('/').is_none() {
        return Ok(None);
    }
    let unit = product(cursor, units::si("1", units::NONE), false)?;
    Ok((unit.text != "1").then_some(unit))
}

/// Takes a unit in brackets alone, `(kg*m)`, `(1/s)^2`: how it is told from a name that is a unit, too. What is no unit stays.
fn in_brackets(cursor: &mut Cursor<'_>) -> Result<Option<Unit>, LexemeMessage> {
    let (here, mut ahead) = (cursor.here(), *cursor);
    let Some(group) = ahead.group(Bracket::Round) else {
        return Ok(None);
    };
    let mut first = Cursor::new(group);
    if first.peek_word().is_none() && reciprocal(&mut first).is_none() {
        return Ok(None);
    }
    let Ok(inner) = whole(Cursor::new(group)) else {
        return Ok(None);
    };
    *cursor = ahead;
    let base = Unit {
        text: format!("({})", inner.text),
        ..inner
    };
    raised(base, here, cursor).map(Some)
}

/// Refuses `kg m^2`: a unit behind a unit without a sign between them.
fn no_unit_behind(cursor: &Cursor<'_>, unit: &Unit) -> Result<(), LexemeMessage> {
    let mut ahead = *cursor;
    let mut all = vec![unit.text.clone()];
    while ahead
        .peek_word()
        .is_some_and(|word| units::find(word).is_some())
    {
        let next = factor(&mut ahead, true)?;
        all.push(product(&mut ahead, next, false)?.text);
    }
    match all.as_slice() {
        [_] => Ok(()),
        all => Err(say::unit_behind_unit(cursor.here(), all)),
    }
}

/// Whether a `1` is all that is left: what has no unit.
fn alone(cursor: &Cursor<'_>) -> bool {
    let one = cursor.peek();
    one.is_some_and(|one| one.kind == LexemeKind::Number("1".to_string()))
        && cursor.ahead(1).is_none()
}

/// Takes the `1` of `1/s`.
fn reciprocal(cursor: &mut Cursor<'_>) -> Option<Unit> {
    let (one, over) = (cursor.peek()?, cursor.ahead(1)?);
    let fits =
        one.kind == LexemeKind::Number("1".to_string()) && over.kind == LexemeKind::Sign('/');
    fits.then(|| {
        cursor.take();
        units::si("1", units::NONE)
    })
}

/// The `* a / b` after a first factor. Without `strict` it stops before what is no unit.
fn product(cursor: &mut Cursor<'_>, first: Unit, strict: bool) -> Result<Unit, LexemeMessage> {
    let mut unit = first;
    loop {
        let mut ahead = *cursor;
        let divide = if ahead.sign('*').is_some() {
            false
        } else if ahead.sign('/').is_some() {
            true
        } else {
            return Ok(unit);
        };
        let here = ahead.here();
        let next = match factor(&mut ahead, strict) {
            Ok(next) => next,
            Err(report) if strict => return Err(report),
            Err(_) => return Ok(unit),
        };
        if !divide && !strict && next.text.split('^').next() == Some("g") {
            // `2 kg * g` is a weight, seldom grams: a name, which is told where nothing has it.
            return Ok(unit);
        }
        *cursor = ahead;
        let sign = if divide { '/' } else { '*' };
        let dimension = if divide {
            units::over(unit.dimension, next.dimension)
        } else {
            units::times(unit.dimension, next.dimension)
        };
        unit = Unit {
            text: format!("{}{sign}{}", unit.text, next.text),
            factor: if divide {
                unit.factor / next.factor
            } else {
                unit.factor * next.factor
            },
            dimension: bounded(dimension).ok_or_else(|| say::unit_range(here))?,
        };
    }
}

/// One word or bracket, with its exponent. `sure`: no name can stand there, so that other spellings are read, too, as our words.
fn factor(cursor: &mut Cursor<'_>, sure: bool) -> Result<Unit, LexemeMessage> {
    let here = cursor.here();
    let base = if let Some(inner) = cursor.group(Bracket::Round) {
        let inner = whole(Cursor::new(inner))?;
        Unit {
            text: format!("({})", inner.text),
            ..inner
        }
    } else {
        let mut word = cursor
            .word()
            .ok_or_else(|| say::unit_expected(cursor.here()))?;
        if let Some(ours) = units::spelled(&word.text).filter(|_| sure) {
            word.text = ours.to_owned();
        }
        let call = word.text == "min" && cursor.group(Bracket::Round).is_some();
        let path = matches!(cursor.peek().map(|l| &l.kind), Some(LexemeKind::Sign('.')));
        if call || (path && !super::expression::range(cursor)) {
            return Err(match cursor.ahead(1).map(|l| &l.kind) {
                Some(LexemeKind::Word(next))
                    if [&word.text, next].iter().all(|w| units::find(w).is_some()) =>
                {
                    say::unit_product(here, &word.text, next)
                }
                _ if path && units::find(&word.text).is_some() => {
                    say::point_behind_unit(cursor.here(), &word.text)
                }
                _ => say::unknown_unit(here, &word.text),
            });
        }
        let (factor, dimension) =
            units::find(&word.text).ok_or_else(|| say::unknown_unit(here, &word.text))?;
        Unit {
            text: word.text,
            factor,
            dimension,
        }
    };
    raised(base, here, cursor)
}

/// A unit with the exponent that stands behind it, if one does.
fn raised(base: Unit, here: Region, cursor: &mut Cursor<'_>) -> Result<Unit, LexemeMessage> {
    if cursor.sign('^').is_none() {
        return Ok(base);
    }
    let (n, halves) = exponent(cursor)?;
    let raised =
        units::power(base.dimension, n).and_then(|d| if halves { units::root(d) } else { Some(d) });
    let factor = base.factor.powi(n);
    if matches!(cursor.peek().map(|l| &l.kind), Some(LexemeKind::Sign('^'))) {
        return Err(say::power_of_a_power(cursor.here(), &base.text));
    }
    Ok(Unit {
        text: if halves {
            format!("{}^({n}/2)", base.text)
        } else {
            format!("{}^{n}", base.text)
        },
        factor: if halves { factor.sqrt() } else { factor },
        dimension: bounded(raised).ok_or_else(|| say::unit_range(here))?,
    })
}

/// A whole exponent, or one with a half: `(n/2)`, `1.5`.
fn exponent(cursor: &mut Cursor<'_>) -> Result<(i32, bool), LexemeMessage> {
    if let Some(inner) = cursor.group(Bracket::Round) {
        let mut inner = Cursor::new(inner);
        let n = whole_number(&mut inner)?;
        let halves = inner.sign('/').is_some();
        if halves {
            let two = inner.here();
            if whole_number(&mut inner)? != 2 {
                return Err(say::unit_exponent(two));
            }
        }
        inner.finish("`)`")?;
        return Ok((n, halves));
    }
    if let Some(halves) = half_number(cursor) {
        return Ok((halves, true));
    }
    whole_number(cursor).map(|n| (n, false))
}

/// Twice an exponent with a half: 3 of `1.5`.
fn half_number(cursor: &mut Cursor<'_>) -> Option<i32> {
    let mut ahead = *cursor;
    let negative = ahead.sign('-').is_some();
    let Some(LexemeKind::Number(text)) = ahead.take().map(|lexeme| &lexeme.kind) else {
        return None;
    };
    let whole = text.strip_suffix(".5")?.parse::<i32>().ok()?;
    let twice = (whole < 9).then_some(2 * whole + 1)?;
    *cursor = ahead;
    Some(if negative { -twice } else { twice })
}

fn whole_number(cursor: &mut Cursor<'_>) -> Result<i32, LexemeMessage> {
    let negative = cursor.sign('-').is_some();
    let here = cursor.here();
    let value = match cursor.take().map(|lexeme| &lexeme.kind) {
        Some(LexemeKind::Number(text)) => text.parse::<i32>().ok(),
        _ => None,
    };
    match value {
        Some(n) if n <= 9 => Ok(if negative { -n } else { n }),
        _ => Err(say::unit_exponent(here)),
    }
}

/// A dimension of sensible size.
fn bounded(dimension: Option<Dimension>) -> Option<Dimension> {
    dimension.filter(|d| {
        [d.mass, d.length, d.time, d.current]
            .iter()
            .all(|e| e.abs() <= 40)
    })
}
