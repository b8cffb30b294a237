//! The head of a model: `/// doc`, `pub model Name<T> { … }`.

use super::item::items;
use super::{ClauseValue, Cursor, Item, ModelSyntax, ValueSyntax, words};
use crate::lexeme::{Bracket, Lexeme, LexemeKind, Region};
use crate::messages::{LexemeMessage, Messages, syntax as say};

/// Reads a model from all lexemes of a source. Nothing is `None` only when the source is empty.
pub fn model<'a>(lexemes: &'a [Lexeme], messages: &mut Messages) -> Option<ModelSyntax<'a>> {
    let (first, last) = (lexemes.first()?, lexemes.last()?);
    let mut cursor = Cursor::new(ValueSyntax {
        lexemes,
        at: Region {
            first: first.at,
            last: last.at,
        },
    });
    let mut model = ModelSyntax {
        doc: docs(&mut cursor),
        ..ModelSyntax::default()
    };
    if let Some(item) = robot(&mut cursor) {
        // `urdf = "robot.urdf", items`: the model has the name of the robot.
        model.visibility = "pub".to_string();
        model.items = items(cursor, false, messages);
        model.items.insert(0, item);
        return Some(model);
    }
    if let Err(report) = head(&mut cursor, &mut model) {
        messages.push(report);
    }
    match cursor.group(Bracket::Brace) {
        Some(body) => {
            model.items = items(Cursor::new(body), false, messages);
            if !cursor.at_end() {
                messages.push(say::after_model(cursor.here()));
            }
        }
        None if messages.is_empty() => messages.push(say::no_model(cursor.here())),
        None => {}
    }
    Some(model)
}

/// Whether items stand at the top, without the head of a model around them.
pub fn begins_with_item(lexemes: &[Lexeme]) -> bool {
    let mut lexemes = lexemes.iter();
    let first = lexemes.find(|lexeme| !matches!(lexeme.kind, LexemeKind::Doc(_)));
    let assigned = lexemes
        .next()
        .is_some_and(|next| next.kind == LexemeKind::Sign('='));
    let item = first.is_some_and(
        |lexeme| matches!(&lexeme.kind, LexemeKind::Word(word) if words::find(word, false).is_some()),
    );
    item && !assigned
}

/// Takes `urdf = "robot.urdf",`, which stands for the item `urdf: "robot.urdf";`.
fn robot<'a>(cursor: &mut Cursor<'a>) -> Option<Item<'a>> {
    let mut ahead = *cursor;
    let word = ahead.word().filter(|word| word.text == "urdf")?;
    let sign = ahead.sign('=')?;
    let start = ahead;
    ahead.take();
    let given = ClauseValue {
        sign: ":",
        at: sign.into(),
        value: ahead.since(start),
    };
    ahead.sign(',').or_else(|| ahead.sign(';'));
    *cursor = ahead;
    Some(Item {
        doc: String::new(),
        marked: None,
        at: word.at.into(),
        word,
        name: None,
        clauses: vec![given],
        block: Vec::new(),
        broken: false,
    })
}

/// Takes doc comments: one line each, without the space after `///`.
pub fn docs(cursor: &mut Cursor<'_>) -> String {
    let mut lines = Vec::new();
    while let Some(LexemeKind::Doc(text)) = cursor.peek().map(|lexeme| &lexeme.kind) {
        lines.push(text.strip_prefix(' ').unwrap_or(text).to_string());
        cursor.take();
    }
    lines.join("\n").trim_end().to_string()
}

/// `pub(crate) model Name<T>`.
pub fn head<'a>(cursor: &mut Cursor<'a>, model: &mut ModelSyntax<'a>) -> Result<(), LexemeMessage> {
    if cursor.keyword("pub").is_some() {
        model.visibility = "pub".to_string();
        if let Some(within) = cursor.group(Bracket::Round) {
            let path: Vec<String> = within.lexemes.iter().map(Lexeme::shown).collect();
            model.visibility = format!("pub({})", path.join(" "));
        }
    }
    cursor
        .keyword("model")
        .ok_or_else(|| say::no_model(cursor.here()))?;
    name(cursor, model)
}

/// `Name<T>`.
pub fn name<'a>(cursor: &mut Cursor<'a>, model: &mut ModelSyntax<'a>) -> Result<(), LexemeMessage> {
    let word = cursor
        .word()
        .ok_or_else(|| cursor.expected("the name of the model"))?;
    if super::words::reserved(&word.text).is_some() {
        return Err(say::reserved_name(word.at.into(), &word.text));
    }
    model.name = Some(word);
    if cursor.sign('<').is_some() {
        cursor
            .word()
            .ok_or_else(|| cursor.expected("the name of the scalar, such as `T`"))?;
        cursor.sign('>').ok_or_else(|| cursor.expected("`>`"))?;
        model.generic = true;
    }
    Ok(())
}
