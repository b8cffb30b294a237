//! A TOML document of a scene as the text of a declaration: the same items, names, repetitions and units.

use std::borrow::Cow;
use std::fmt::Write;

use mbd_scene::Scene;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::write_toml;
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
    let mut writer = DeclarationWriter {
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

struct DeclarationWriter<'d> {
    document: &'d str,
    text: String,
}

impl DeclarationWriter<'_> {
    fn model(&mut self, table: &DeTable<'_>) {
        let of = |word: &str| table.get(word).map(|value| self.value(value));
        let (name, doc) = (of("model").unwrap_or_default(), of("doc"));
        self.doc(doc, "");
        let _ = writeln!(self.text, "pub model {name} {{");
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
            self.item(spec, key.get_ref(), value);
        }
        self.text.push_str("}\n");
    }

    /// A value as it stands in a declaration.
    fn value(&self, value: &Spanned<DeValue<'_>>) -> String {
        match value.get_ref() {
            DeValue::String(text) => text.trim().to_owned(),
            _ => self.document.get(value.span()).unwrap_or("").to_owned(),
        }
    }

    fn doc(&mut self, doc: Option<String>, indent: &str) {
        for line in doc.iter().flat_map(|doc| doc.lines()) {
            let _ = writeln!(self.text, "{indent}/// {line}");
        }
    }

    fn item(&mut self, spec: &ItemWord, name: &str, value: &Spanned<DeValue<'_>>) {
        let indent = "    ";
        let empty = DeTable::new();
        let table = match value.get_ref() {
            DeValue::Table(table) => table,
            DeValue::Boolean(false) => return,
            _ => &empty,
        };
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
        for clause in spec.clauses {
            let given = match table {
                Some(table) => table.get(clause.key),
                None => clause.needed.then_some(value),
            };
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
        let clause = |word: &str| spec.clauses.iter().any(|clause| clause.key == word);
        for (key, value) in entries(table) {
            let word: &str = key.get_ref();
            let inner = words::find(word, true).filter(|_| spec.fields.is_some());
            match (inner, value.get_ref()) {
                _ if clause(word) || word == "doc" => {}
                (_, DeValue::Boolean(_)) => {}
                (Some(inner), DeValue::Table(_)) if !inner.named => {
                    fields.push(self.head(inner, "", value));
                }
                (Some(inner), DeValue::Table(table)) => {
                    let named = entries(table).into_iter();
                    fields
                        .extend(named.map(|(name, value)| self.head(inner, name.get_ref(), value)));
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
        }
        fields
    }
}
