//! A TOML document of a scene as the text of a declaration: the same items, names, repetitions and units.

use std::borrow::Cow;
use std::fmt::Write;

use mbd_scene::Scene;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::comments::Comments;
use super::forms::{is_set, is_taken, only_law};
use super::write_toml;
use crate::lexeme::LineStarts;
use crate::syntax::words::{self, ItemWord};

/// Writes a scene as the text of a declaration. Numbers without a unit are SI; repeated items are written one by one.
#[must_use]
pub fn write_text(scene: &Scene) -> String {
    toml_to_text(&write_toml(scene)).unwrap_or_default()
}

/// The text of the declaration that a TOML document holds; `None` if it is no TOML. What [`read_toml`](super::read_toml) refuses is not
/// looked at.
#[must_use]
pub fn toml_to_text(document: &str) -> Option<String> {
    let table = DeTable::parse(document).ok()?;
    let mut places = Vec::new();
    keys(table.get_ref(), false, &mut places);
    let starts = LineStarts::new(document);
    let places = places.into_iter().map(|at| starts.position(at)).collect();
    let mut writer = DeclarationWriter {
        comments: Comments::of_document(document).assign(places),
        starts,
        document,
        text: String::new(),
    };
    writer.model(table.get_ref());
    Some(writer.text)
}

/// A key with its value, each with its place in the document.
pub(super) type DocumentEntry<'e, 't> = (&'e Spanned<Cow<'t, str>>, &'e Spanned<DeValue<'t>>);

/// The entries of a table in the order of the document.
pub(super) fn entries<'e, 't>(table: &'e DeTable<'t>) -> Vec<DocumentEntry<'e, 't>> {
    let mut entries: Vec<DocumentEntry<'e, 't>> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// Where the keys of a table and of all in it stand; of a table of things with names these names.
fn keys(table: &DeTable<'_>, within: bool, places: &mut Vec<usize>) {
    for (key, value) in table {
        let spec = words::find(key.get_ref(), within);
        let inner = match value.get_ref() {
            DeValue::Table(inner) => Some(inner),
            _ => None,
        };
        if inner.is_none() || spec.is_none_or(|spec| !spec.named) {
            places.push(key.span().start);
        }
        if let Some(inner) = inner {
            keys(inner, true, places);
        }
    }
}

struct DeclarationWriter<'d> {
    comments: Comments,
    starts: LineStarts<'d>,
    document: &'d str,
    text: String,
}

impl DeclarationWriter<'_> {
    fn model(&mut self, table: &DeTable<'_>) {
        let of = |word: &str| table.get(word).map(|value| self.value(value));
        let (name, doc) = (of("model").unwrap_or_default(), of("doc"));
        let heads = ["model", "doc"].map(|word| table.get_key_value(word));
        for (key, _) in heads.into_iter().flatten() {
            self.lines(&self.comments_of(key), "");
        }
        self.doc(doc, "");
        let _ = writeln!(self.text, "model {name} {{");
        let mut items = Vec::new();
        for (key, value) in entries(table) {
            match (words::find(key.get_ref(), false), value.get_ref()) {
                (Some(spec), DeValue::Table(inner)) if spec.named => {
                    let named = entries(inner).into_iter();
                    items.extend(named.map(|(name, value)| (spec, name, value)));
                }
                (Some(spec), _) => items.push((spec, key, value)),
                (None, _) => {}
            }
        }
        items.sort_by_key(|(_, key, _)| key.span().start);
        for (spec, key, value) in items {
            self.item(spec, key, value);
        }
        let rest = self.comments.rest().to_vec();
        self.lines(&rest, "    ");
        self.text.push_str("}\n");
    }

    /// The comments that belong to a key.
    fn comments_of(&self, key: &Spanned<Cow<'_, str>>) -> Vec<String> {
        let place = self.starts.position(key.span().start);
        self.comments.of(place).to_vec()
    }

    /// Those of a key and of all keys in its value.
    fn comments_in(
        &self,
        key: &Spanned<Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) -> Vec<String> {
        let mut all = self.comments_of(key);
        if let DeValue::Table(table) = value.get_ref() {
            let inner = entries(table).into_iter();
            all.extend(inner.flat_map(|(key, value)| self.comments_in(key, value)));
        }
        all
    }

    fn lines(&mut self, comments: &[String], indent: &str) {
        for line in comments {
            let _ = writeln!(self.text, "{indent}// {line}");
        }
    }

    /// A value as it stands in a declaration.
    fn value(&self, value: &Spanned<DeValue<'_>>) -> String {
        match value.get_ref() {
            DeValue::String(text) => text.trim().to_owned(),
            DeValue::Array(parts) => {
                let parts: Vec<String> = parts.iter().map(|part| self.value(part)).collect();
                format!("[{}]", parts.join(", "))
            }
            _ => self.document.get(value.span()).unwrap_or("").to_owned(),
        }
    }

    fn doc(&mut self, doc: Option<String>, indent: &str) {
        for line in doc.iter().flat_map(|doc| doc.lines()) {
            let _ = writeln!(self.text, "{indent}/// {line}");
        }
    }

    fn item(&mut self, spec: &ItemWord, key: &Spanned<Cow<'_, str>>, value: &Spanned<DeValue<'_>>) {
        let name: &str = key.get_ref();
        let indent = "    ";
        let empty = DeTable::new();
        let table = match value.get_ref() {
            DeValue::Table(table) => table,
            DeValue::Boolean(false) => return,
            _ => &empty,
        };
        let mut comments = self.comments_of(key);
        for (key, value) in entries(table) {
            let word: &str = key.get_ref();
            let is_field = is_field(spec, word) && !matches!(value.get_ref(), DeValue::Boolean(_));
            if !is_field {
                comments.extend(self.comments_in(key, value));
            }
        }
        self.lines(&comments, indent);
        self.doc(table.get("doc").map(|doc| self.value(doc)), indent);
        let marked = |mark: &&str| {
            matches!(
                table.get(*mark).map(Spanned::get_ref),
                Some(DeValue::Boolean(true))
            )
        };
        let mark = spec
            .mark
            .filter(marked)
            .map_or(String::new(), |mark| format!("{mark} "));
        let head = self.head(spec, name, value);
        let fields = self.fields(spec, table);
        let _ = match fields.is_empty() {
            true => writeln!(self.text, "{indent}{mark}{head};"),
            false => writeln!(
                self.text,
                "{indent}{mark}{head} {{\n{indent}    {},\n{indent}}}",
                fields.join(&format!(",\n{indent}    "))
            ),
        };
    }

    /// What stands outside the braces.
    fn head(&self, spec: &ItemWord, name: &str, value: &Spanned<DeValue<'_>>) -> String {
        let mut head = spec.word.to_owned();
        if spec.named {
            let _ = write!(head, " {name}");
        }
        let table = match value.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        };
        if let Some((law, fields)) = table.and_then(|table| only_law(spec, table)) {
            let fields = entries(fields).into_iter();
            let fields =
                fields.map(|(key, value)| format!("{}: {}", key.get_ref(), self.value(value)));
            let fields: Vec<String> = fields.collect();
            let _ = write!(head, ": {} {{ {} }}", law.get_ref(), fields.join(", "));
            return head;
        }
        let written = self.document.get(value.span()).unwrap_or("");
        let alone = spec.alone(written).map(|clause| clause.key);
        for clause in spec.clauses {
            let given = match table {
                Some(table) => table.get(clause.key),
                None => (alone == Some(clause.key)).then_some(value),
            };
            let taken = table.filter(|_| given.is_none() && clause.sign == "=");
            if let Some((take, of)) = taken.and_then(|table| taken_of_a_run(spec, table)) {
                let _ = write!(head, " = {take} {}", self.value(of));
            }
            if let Some(given) = given {
                let space = if clause.sign == ":" { "" } else { " " };
                let value = match clause.key {
                    words::FILE => format!("{:?}", self.value(given)),
                    _ => self.value(given),
                };
                let _ = write!(head, "{space}{} {value}", clause.sign);
            }
        }
        head
    }

    /// What stands between the braces.
    fn fields(&self, spec: &ItemWord, table: &DeTable<'_>) -> Vec<String> {
        let mut fields = Vec::new();
        for (key, value) in entries(table) {
            let word: &str = key.get_ref();
            let inner = words::find(word, true).filter(|_| spec.fields.is_some());
            let first = fields.len();
            match (inner, value.get_ref()) {
                _ if !is_field(spec, word) => continue,
                (_, DeValue::Boolean(_)) => {}
                (Some(inner), DeValue::Table(_)) if !inner.named => {
                    fields.push(self.head(inner, "", value));
                }
                (Some(inner), DeValue::Table(table)) => {
                    let named = entries(table).into_iter();
                    fields.extend(named.map(|(name, value)| {
                        let field = self.head(inner, name.get_ref(), value);
                        above(&self.comments_in(name, value), field)
                    }));
                    continue;
                }
                (None, DeValue::Table(table)) if is_set(spec, word) => {
                    let of = entries(table).into_iter();
                    let of =
                        of.map(|(key, value)| format!("{} = {}", key.get_ref(), self.value(value)));
                    let of: Vec<String> = of.collect();
                    fields.push(format!("{word}: [{}]", of.join(", ")));
                }
                (None, DeValue::Table(table)) => {
                    let of = entries(table).into_iter();
                    let of =
                        of.map(|(key, value)| format!("{}: {}", key.get_ref(), self.value(value)));
                    fields.push(format!(
                        "{word}: {{ {} }}",
                        of.collect::<Vec<_>>().join(", ")
                    ));
                }
                _ => fields.push(format!("{word}: {}", self.value(value))),
            }
            if let Some(field) = fields.get_mut(first) {
                *field = above(&self.comments_in(key, value), std::mem::take(field));
            }
        }
        fields
    }
}

/// A field between braces with comments above it.
fn above(comments: &[String], field: String) -> String {
    let lines = comments.iter().map(|line| format!("// {line}\n        "));
    lines.chain([field]).collect()
}

/// Whether a key is a field between the braces of an item.
fn is_field(spec: &ItemWord, word: &str) -> bool {
    word != "doc" && !is_taken(spec, word) && !spec.clauses.iter().any(|clause| clause.key == word)
}

/// The `max = "cord.tension"` of a metric.
fn taken_of_a_run<'e, 't>(
    spec: &ItemWord,
    table: &'e DeTable<'t>,
) -> Option<DocumentEntry<'e, 't>> {
    let mut entries = entries(table).into_iter();
    entries.find(|(key, _)| is_taken(spec, key.get_ref()))
}
