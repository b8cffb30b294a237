//! Items and fields: split into keyword, name, clauses and braces. After a mistake reading goes on at the next item.

use super::expression::is_call;
use super::model::docs;
use super::words::{self, Clause, ItemWord};
use super::{ClauseValue, Cursor, Item, NameSyntax, ValueSyntax, Word, foreign};
use crate::lexeme::{Bracket, LexemeIndex, LexemeKind, Region};
use crate::messages::resolve::unknown_field;
use crate::messages::{LexemeMessage, Messages, similar, syntax as say};

/// Reads all items of a model, or all fields of an item (`inside`).
pub fn items<'a>(mut cursor: Cursor<'a>, inside: bool, messages: &mut Messages) -> Vec<Item<'a>> {
    let mut items = Vec::new();
    loop {
        let doc = docs(&mut cursor);
        if cursor.at_end() {
            return items;
        }
        if let Some(at) = cursor.sign(if inside { ',' } else { ';' }) {
            if doc.is_empty() {
                messages.push(say::expected(
                    at.into(),
                    "an item",
                    if inside { "," } else { ";" },
                ));
            }
            continue;
        }
        if let Some(at) = cursor.sign('#') {
            cursor.sign('!');
            if cursor.group(Bracket::Square).is_some() {
                messages.push(say::attribute(at.into()));
            } else {
                messages.push(say::hash_comment(at.into()));
                recover(&mut cursor, inside);
            }
            continue;
        }
        if inside && begins_outside(&cursor) {
            // Everything from here belongs behind the brace that is missing.
            let next = cursor.peek_word().unwrap_or_default();
            messages.push(say::closed_before(cursor.here(), next));
            return items;
        }
        let marked = mark(&mut cursor, inside);
        let Some(word) = cursor.word() else {
            if let Some((report, rest)) = cursor.behind_comma_of_numbers() {
                messages.push(report);
                cursor = rest;
                let before: Option<&mut Item<'_>> = items.last_mut();
                before.into_iter().for_each(|field| field.broken = true);
                recover(&mut cursor, inside);
                continue;
            }
            messages.push(cursor.expected(if inside { "a field" } else { "an item" }));
            recover(&mut cursor, inside);
            continue;
        };
        let (word, spec) = match inside {
            true => inner(&cursor, word, messages),
            false => {
                let spec = words::find(&word.text, false);
                (word, spec)
            }
        };
        if spec.is_none() && !inside {
            let mut behind = cursor;
            messages.push(match words::marked_by(&word.text) {
                Some(marked) => say::marks_another(word.at.into(), &word.text, marked),
                None if behind.sign('=').is_some() => {
                    say::number_without_item(word.at.into(), &word.text)
                }
                None => say::unknown_item(word.at.into(), &word.text),
            });
            items.push(lost(&cursor, word));
            recover(&mut cursor, inside);
            continue;
        }
        let mut item = Item {
            doc,
            marked,
            at: word.at.into(),
            word,
            name: None,
            clauses: Vec::new(),
            block: Vec::new(),
            broken: false,
        };
        let result = match spec {
            Some(spec) => rest(&mut cursor, spec, &mut item, inside, messages),
            None => field(&mut cursor, &mut item),
        };
        item.at = item.at.to(cursor.before());
        if let Err(report) = result {
            messages.push(report);
            item.broken = true;
            recover(&mut cursor, inside);
        }
        items.push(item);
    }
}

/// The item that begins between braces with this word, if it is one: `fram tip at …` has a name as no field does.
fn inner(
    cursor: &Cursor<'_>,
    word: Word,
    messages: &mut Messages,
) -> (Word, Option<&'static ItemWord>) {
    let spec = words::find(&word.text, true);
    let frame = &words::FRAME;
    let named = cursor.peek_word().is_some_and(|name| name != "at");
    let near = similar::nearest(&word.text, [frame.word]).is_some();
    if spec.is_some() || !named || !near {
        return (word, spec);
    }
    messages.push(say::misspelt_inner(word.at.into(), &word.text, frame.word));
    let meant = Word {
        text: frame.word.to_owned(),
        ..word
    };
    (meant, Some(frame))
}

/// Takes the word that marks an item: `loop` before a joint.
fn mark(cursor: &mut Cursor<'_>, inside: bool) -> Option<LexemeIndex> {
    (begins_marked(cursor) && !inside)
        .then(|| cursor.take())
        .flatten()
        .map(|lexeme| lexeme.at)
}

/// Whether an item with a word before its keyword begins here: `loop joint`.
fn begins_marked(cursor: &Cursor<'_>) -> bool {
    let marked = cursor.peek_word().and_then(words::marked_by);
    let next = cursor.ahead(1).map(|lexeme| &lexeme.kind);
    marked.is_some_and(|marked| matches!(next, Some(LexemeKind::Word(word)) if word == marked.word))
}

/// An item with an unknown keyword: its name may be used elsewhere.
fn lost<'a>(cursor: &Cursor<'a>, word: Word) -> Item<'a> {
    let mut ahead = *cursor;
    // `Modelica.Mechanics.MultiBody.Parts.Body rod` declares `rod`.
    while ahead.sign('.').is_some() {
        ahead.word();
    }
    Item {
        doc: String::new(),
        marked: None,
        at: word.at.into(),
        word,
        name: ahead.word().map(|word| NameSyntax { word, index: None }),
        clauses: Vec::new(),
        block: Vec::new(),
        broken: true,
    }
}

/// `key: value`, after the key.
fn field<'a>(cursor: &mut Cursor<'a>, item: &mut Item<'a>) -> Result<(), LexemeMessage> {
    let Some(sign) = cursor.sign(':') else {
        return Err(no_colon(cursor, &item.word));
    };
    if let Some(report) = kind_and_name(cursor, &item.word.text) {
        return Err(report);
    }
    if let (Some(next), Some(LexemeKind::Sign(':'))) =
        (cursor.peek_word(), cursor.ahead(1).map(|next| &next.kind))
    {
        return Err(say::two_colons(cursor.here(), &item.word.text, next));
    }
    let start = *cursor;
    while !ends(cursor, true) {
        cursor.take_tree();
    }
    push_clause(item, ":", sign.into(), cursor.since(start))?;
    separator(cursor, true)
}

/// The report of a field without its colon: `stop`, `detach h`, `mass = 1 kg`.
fn no_colon(cursor: &Cursor<'_>, field: &Word) -> LexemeMessage {
    if ends(cursor, true) {
        return say::field_alone(field.at.into(), &field.text);
    }
    let mut behind = *cursor;
    if behind.sign('=').is_some() {
        return say::equals_for_colon(cursor.here(), &field.text);
    }
    match behind.word() {
        Some(value) if ends(&behind, true) => {
            say::no_colon(value.at.into(), &field.text, &value.text)
        }
        // What another item or place has, as `velocity [1, 0, 0] m/s` behind the comma after a start.
        _ => foreign::translated(foreign::EXPECTED_FIELDS, &field.text).map_or_else(
            || cursor.expected(&format!("`:` and a value after `{}`", field.text)),
            |_| unknown_field(field.at.into(), &field.text, &[]),
        ),
    }
}

/// Takes `line cord` where the name alone stands as a value, and reports it.
fn kind_and_name(cursor: &mut Cursor<'_>, field: &str) -> Option<LexemeMessage> {
    if !begins_outside(cursor) {
        return None;
    }
    let mut ahead = *cursor;
    let (kind, name) = (ahead.word()?, ahead.word()?);
    let fills =
        ahead.at_end() || matches!(ahead.peek().map(|l| &l.kind), Some(LexemeKind::Sign(',')));
    fills.then(|| {
        *cursor = ahead;
        let at = Region::from(kind.at).to(name.at.into());
        say::kind_and_name(at, field, &name.text)
    })
}

/// What follows the keyword of an item.
fn rest<'a>(
    cursor: &mut Cursor<'a>,
    spec: &'static ItemWord,
    item: &mut Item<'a>,
    inside: bool,
    messages: &mut Messages,
) -> Result<(), LexemeMessage> {
    if spec.named {
        let name = item.name.insert(name(cursor, spec)?);
        if let Some(report) = name.refused_index(spec) {
            return Err(report);
        }
    }
    loop {
        if ends(cursor, inside) || !inside && begins_world(cursor) {
            break;
        }
        if let Some((sign, at)) = clause(cursor, spec) {
            if cursor.peek_word() == Some("if") && ["from", "to", "on", "at"].contains(&sign) {
                return Err(say::conditional_end(cursor.here(), spec.word));
            }
            let value = clause_value(cursor, spec, sign, inside)?;
            push_clause(item, sign, at, value)?;
        } else if let Some(block) = cursor.group(Bracket::Brace) {
            if spec.fields.is_none() {
                return Err(say::no_fields(block.at, spec));
            }
            item.block = items(Cursor::new(block), true, messages);
            item.broken |= item.block.iter().any(|field| field.broken);
            let mut ahead = *cursor;
            if let Some((sign, at)) = clause(&mut ahead, spec).filter(|_| !inside) {
                return Err(say::clause_behind_braces(at, spec, sign));
            }
            cursor.sign(if inside { ',' } else { ';' });
            return needed(item, spec);
        } else {
            let report = unfit(cursor, spec, item, inside);
            if cursor.peek().map(|lexeme| lexeme.shown()).as_deref() == Some(".") {
                // No name of its own: it is not taken twice.
                item.name = None;
            }
            return Err(report);
        }
    }
    needed(item, spec)?;
    if !inside && braces_left_out(cursor, spec, item) {
        return Ok(());
    }
    separator(cursor, inside)
}

/// The report of what no clause of an item begins with.
fn unfit(
    cursor: &Cursor<'_>,
    spec: &'static ItemWord,
    item: &Item<'_>,
    inside: bool,
) -> LexemeMessage {
    let found = cursor.peek().map(|lexeme| lexeme.shown());
    let found = found.unwrap_or_default();
    match (found.as_str(), &item.name) {
        ("=", None) if inside => say::equals_for_colon(cursor.here(), &item.word.text),
        // `output pin.angle in deg`: what stands where a name is wanted is shown.
        (".", Some(name)) if ["output", "metric", "let"].contains(&spec.word) => {
            say::shown_without_name(name.word.at.into(), spec, &name.word.text)
        }
        // `spring NAME on pin.angle`
        ("on" | "at", Some(_)) if ["line", "spring"].contains(&spec.word) => {
            let mut behind = *cursor;
            behind.take();
            let joint = behind.word();
            behind.group(Bracket::Square);
            let coordinate = behind.sign('.').and_then(|_| behind.word());
            match joint.filter(|_| behind.peek_word().is_none()) {
                Some(joint) => say::along_a_coordinate(
                    cursor.here(),
                    spec,
                    &joint.text,
                    coordinate.as_ref().map(|word| word.text.as_str()),
                ),
                None => say::form(cursor.here(), spec, &found),
            }
        }
        (found, _) => say::form(cursor.here(), spec, found),
    }
}

/// The name after a keyword, with its repetition.
fn name<'a>(
    cursor: &mut Cursor<'a>,
    spec: &'static ItemWord,
) -> Result<NameSyntax<'a>, LexemeMessage> {
    // `param in = …` has a name, though none that can be, which is told of every name; `load on body` has none.
    let mut behind = *cursor;
    let is_clause = clause(&mut behind, spec).is_some()
        && !matches!(
            behind.peek().map(|lexeme| &lexeme.kind),
            Some(LexemeKind::Sign('=' | ':' | ';') | LexemeKind::Open(..))
        )
        && clause(&mut behind, spec).is_none();
    let word = match cursor.word() {
        Some(word) if !is_clause => word,
        _ => {
            // `line[i in 0..2] sling from …`
            let mut behind = *cursor;
            let index = behind.group(Bracket::Square);
            return Err(match index.and_then(|_| behind.word()) {
                Some(word) => say::index_before_name(cursor.before(), spec, &word.text),
                None => say::no_name(cursor.before(), spec),
            });
        }
    };
    let index = cursor.group(Bracket::Square);
    Ok(NameSyntax { word, index })
}

/// Takes the sign of a clause of this item.
fn clause(cursor: &mut Cursor<'_>, spec: &'static ItemWord) -> Option<(&'static str, Region)> {
    spec.clauses.iter().find_map(|clause| {
        let sign = clause.sign;
        let at = match sign {
            ":" | "=" => cursor.signs(sign),
            word => cursor.keyword(word).map(Region::from),
        };
        at.map(|at| (sign, at))
    })
}

/// The value of a clause: up to the next clause, the braces, or the end of the item.
fn clause_value<'a>(
    cursor: &mut Cursor<'a>,
    spec: &'static ItemWord,
    sign: &str,
    inside: bool,
) -> Result<ValueSyntax<'a>, LexemeMessage> {
    let start = *cursor;
    let braces = spec.fields.is_none() && (sign == "=" || !spec.named);
    // Braces of `if a < b { … } else { … }` belong to the value.
    let mut conditional = false;
    // First it is a place: `to world { … }`.
    let mut begun = false;
    let ended = |cursor: &Cursor<'_>, begun: bool| {
        ends(cursor, inside) || begun && !inside && begins_world(cursor)
    };
    while !ended(cursor, begun) {
        begun = true;
        // Signs that hold a `=` which begins no value.
        if ["..=", "==", "!=", "<=", ">="]
            .iter()
            .any(|signs| cursor.signs(signs).is_some())
        {
            continue;
        }
        let brace = matches!(
            cursor.peek().map(|lexeme| &lexeme.kind),
            Some(LexemeKind::Open(Bracket::Brace, _))
        );
        let mut ahead = *cursor;
        if (brace && !braces && !conditional) || clause(&mut ahead, spec).is_some() {
            break;
        }
        let next = cursor.peek().map(|lexeme| &lexeme.kind);
        if next == Some(&LexemeKind::Sign('?')) {
            return Err(cursor.operand_expected("the end of the value"));
        }
        let over = cursor.peek_word().is_some_and(|word| OVER.contains(&word));
        if over && ["line", "spring"].contains(&spec.word) {
            return Err(say::led_over(cursor.here()));
        }
        conditional = match cursor.peek_word() {
            // `if(a < b, this, that)` has no branches in braces.
            Some("if") => !is_call(*cursor),
            Some("else") => true,
            _ => conditional && !brace,
        };
        cursor.take_tree();
    }
    Ok(cursor.since(start))
}

/// Words by which people lead a line over something.
const OVER: &[&str] = &["via", "over", "through", "around"];

/// Adds a clause: each once, none empty.
pub fn push_clause<'a>(
    item: &mut Item<'a>,
    sign: &'static str,
    at: Region,
    value: ValueSyntax<'a>,
) -> Result<(), LexemeMessage> {
    if let Some(first) = item.given(sign) {
        if item.word.text == "event" && sign == "=" {
            return Err(say::event_compares(at, "=", false));
        }
        return Err(say::repeated_clause(at, sign, first.at));
    }
    if value.lexemes.is_empty() {
        return Err(say::empty_value(at, sign));
    }
    item.clauses.push(ClauseValue { sign, at, value });
    Ok(())
}

fn needed(item: &Item<'_>, spec: &'static ItemWord) -> Result<(), LexemeMessage> {
    let missing = spec.lacks(|sign| item.given(sign).is_some());
    match missing {
        Some(clause) => Err(say::missing_clause(item.name_at(), spec, clause.sign)),
        None => Ok(()),
    }
}

/// Whether the item ends here: at its separator, at the end, or where the next item begins without one.
fn ends(cursor: &Cursor<'_>, inside: bool) -> bool {
    match cursor.peek().map(|lexeme| &lexeme.kind) {
        None | Some(LexemeKind::Doc(_)) => true,
        Some(LexemeKind::Sign(',')) if inside => true,
        Some(LexemeKind::Sign(';')) => true,
        Some(LexemeKind::Word(word)) => {
            let next = cursor.ahead(1).map(|lexeme| &lexeme.kind);
            let spec = words::find(word, inside);
            let named = spec.is_some_and(|spec| spec.named);
            let begins =
                |sign: &Clause| matches!(next, Some(LexemeKind::Word(word)) if word == sign.sign);
            let unnamed = spec.is_some_and(|spec| inside && spec.clauses.iter().any(begins));
            (named && is_name(next))
                || (!inside && begins_marked(cursor))
                || unnamed
                || (inside && matches!(next, Some(LexemeKind::Sign(':'))))
                || (inside && begins_outside(cursor))
        }
        _ => false,
    }
}

/// Whether an item that stands outside braces begins here: `joint NAME`.
fn begins_outside(cursor: &Cursor<'_>) -> bool {
    let spec = cursor.peek_word().and_then(|word| words::find(word, false));
    let next = cursor.ahead(1).map(|lexeme| &lexeme.kind);
    spec.is_some_and(|spec| spec.named) && is_name(next)
}

/// Whether the item begins here that has no name: `world { … }`, where no place is wanted.
fn begins_world(cursor: &Cursor<'_>) -> bool {
    let spec = cursor.peek_word().and_then(|word| words::find(word, false));
    let next = cursor.ahead(1).map(|lexeme| &lexeme.kind);
    spec.is_some_and(|spec| !spec.named && spec.fields.is_some())
        && matches!(next, Some(LexemeKind::Open(Bracket::Brace, _)))
}

/// Whether a name stands here: what has the name `load` itself is followed by another word, `from load to hook`.
fn is_name(lexeme: Option<&LexemeKind>) -> bool {
    matches!(lexeme, Some(LexemeKind::Word(word)) if words::reserved(word).is_none())
}

/// Whether an item ends at its name or a place, where it may have braces and has none: what comes next begins another item, as behind braces,
/// so that no `;` is needed.
fn braces_left_out(cursor: &Cursor<'_>, spec: &ItemWord, item: &Item<'_>) -> bool {
    let semicolon = matches!(cursor.peek().map(|l| &l.kind), Some(LexemeKind::Sign(';')));
    let at_place = item.clauses.last().is_none_or(|last| last.sign == "to");
    spec.named && spec.fields.is_some() && at_place && !semicolon
}

/// Takes the separator after an item.
fn separator(cursor: &mut Cursor<'_>, inside: bool) -> Result<(), LexemeMessage> {
    let sign = if inside { ',' } else { ';' };
    if cursor.sign(sign).is_some() || (inside && cursor.at_end()) {
        return Ok(());
    }
    if inside && matches!(cursor.peek().map(|l| &l.kind), Some(LexemeKind::Sign(';'))) {
        return Err(say::wrong_separator(cursor.here()));
    }
    if inside && begins_outside(cursor) {
        // Told by `items`, which goes on there.
        return Ok(());
    }
    Err(say::missing_separator(cursor.before(), sign))
}

/// Goes on after the next separator or braces, or at the next item.
fn recover(cursor: &mut Cursor<'_>, inside: bool) {
    let just_ended = |cursor: &Cursor<'_>| {
        let mut ahead = *cursor;
        docs(&mut ahead);
        ahead.peek_word().is_some_and(|word| {
            let next = ahead.ahead(1).map(|lexeme| &lexeme.kind);
            let spec = words::find(word, inside);
            match (spec, next) {
                (Some(spec), Some(LexemeKind::Word(_))) => spec.named,
                (Some(spec), Some(LexemeKind::Sign(':' | ';'))) => !spec.named,
                // `world` is an end, too: `from a.tip to world { … }`.
                (Some(spec), Some(LexemeKind::Open(Bracket::Brace, _))) => {
                    !spec.named && !ahead.after_word()
                }
                (None, Some(LexemeKind::Sign(':'))) => inside,
                _ => false,
            }
        })
    };
    while !cursor.at_end() && !just_ended(cursor) {
        let kind = cursor.peek().map(|lexeme| &lexeme.kind);
        let separator = matches!(kind, Some(LexemeKind::Sign(';')))
            || (inside && matches!(kind, Some(LexemeKind::Sign(','))));
        let braces = !inside && matches!(kind, Some(LexemeKind::Open(Bracket::Brace, _)));
        cursor.take_tree();
        let goes_on = cursor
            .peek_word()
            .is_some_and(|word| ["else", "from", "to", "on", "at"].contains(&word));
        if separator || (braces && !goes_on) {
            cursor.sign(';');
            return;
        }
    }
}
