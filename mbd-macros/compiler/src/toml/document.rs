//! The text of a declaration as a TOML document: the same items, names, repetitions, units and expressions.

use std::fmt::Write;

use super::comments::Comments;
use super::write::{key, quoted};
use crate::lexeme::{Bracket, Places, from_text, without_mark};
use crate::messages::Messages;
use crate::syntax::item::items;
use crate::syntax::words::{self, ItemWord};
use crate::syntax::{Cursor, Item, NameSyntax, ValueSyntax, Word, model};

/// The TOML document of the text of a declaration, with its comments; `None` of a text that cannot be read.
#[must_use]
pub fn text_to_toml(text: &str) -> Option<String> {
    let (lexemes, places, mut messages) = from_text(without_mark(text));
    let model = model(&lexemes, &mut messages)?;
    let name = model.name.as_ref().filter(|_| messages.is_empty())?;
    let all = model.items.iter();
    let all = all.flat_map(|item| std::iter::once(item).chain(&item.block));
    let all = all.map(|item| &item.word).chain([name]);
    let all = all.map(|word| places.position(word.at)).collect();
    let mut writer = DocumentWriter {
        comments: Comments::of_text(without_mark(text)).assign(all),
        places: &places,
        out: String::new(),
        grouped: None,
        groups: Vec::new(),
    };
    writer.comments(name);
    let generic = if model.generic { "<T>" } else { "" };
    writer.entry("model", &format!("{}{generic}", name.text));
    writer.doc(&model.doc);
    // Keys in front of the first table belong to the document.
    let (settings, things): (Vec<&Item<'_>>, Vec<&Item<'_>>) =
        model.items.iter().partition(|item| writer.is_key(item));
    settings.iter().for_each(|item| writer.setting(item));
    for item in things {
        writer.thing(item, words::find(&item.word.text, false)?)?;
    }
    let rest = writer.comments.rest().to_vec();
    writer.lines(&rest);
    Some(writer.out)
}

struct DocumentWriter<'p> {
    comments: Comments,
    places: &'p Places,
    out: String,
    /// The keyword of the table that is open for one item a line.
    grouped: Option<&'static str>,
    /// The keywords that had such a table: it stands once.
    groups: Vec<&'static str>,
}

impl DocumentWriter<'_> {
    /// Whether an item is one key of the document.
    fn is_key(&self, item: &Item<'_>) -> bool {
        item.name.is_none() && item.block.is_empty() && item.word.text != "world"
    }

    fn entry(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.out, "{key} = {}", quoted(value));
    }

    /// The comments that belong to a word, each on a line.
    fn comments(&mut self, word: &Word) {
        let lines = self.comments.of(self.places.position(word.at)).to_vec();
        self.lines(&lines);
    }

    fn lines(&mut self, comments: &[String]) {
        for line in comments {
            let _ = writeln!(self.out, "# {line}");
        }
    }

    fn doc(&mut self, doc: &str) {
        if !doc.is_empty() {
            self.entry("doc", doc);
        }
    }

    fn setting(&mut self, item: &Item<'_>) {
        self.comments(&item.word);
        match item.clause(":") {
            Some(value) => {
                let value = self.text(value);
                let value = value.trim_matches('"').to_owned();
                self.entry(&item.word.text, &value);
            }
            None => {
                let _ = writeln!(self.out, "{} = true", item.word.text);
            }
        }
    }

    /// An item that is a table, or a line of the table of its kind.
    fn thing(&mut self, item: &Item<'_>, spec: &'static ItemWord) -> Option<()> {
        let name = item.name.as_ref().map(|name| self.name(name));
        let small = item.doc.is_empty() && item.block.is_empty() && item.marked.is_none();
        let ends = spec.clauses.iter().any(|clause| clause.key == "from");
        if let (Some(name), true) = (&name, small && !ends && !item.clauses.is_empty()) {
            if self.grouped != Some(spec.word) && !self.groups.contains(&spec.word) {
                let _ = writeln!(self.out, "\n[{}]", spec.word);
                self.groups.push(spec.word);
                self.grouped = Some(spec.word);
            }
            if self.grouped == Some(spec.word) {
                self.comments(&item.word);
                let value = self.inline(item, spec);
                let _ = writeln!(self.out, "{} = {value}", key(name));
                return Some(());
            }
        }
        self.grouped = None;
        self.out.push('\n');
        self.comments(&item.word);
        let _ = match &name {
            Some(name) => writeln!(self.out, "[{}.{}]", spec.word, key(name)),
            None => writeln!(self.out, "[{}]", spec.word),
        };
        self.doc(&item.doc);
        if let (Some(mark), Some(_)) = (spec.mark, item.marked) {
            let _ = writeln!(self.out, "{mark} = true");
        }
        for (key, value) in self.clauses(item, spec) {
            let _ = writeln!(self.out, "{key} = {value}");
        }
        let (starts, fields): (Vec<&Item<'_>>, Vec<&Item<'_>>) =
            item.block.iter().partition(is_start);
        for field in fields {
            self.comments(&field.word);
            let (key, value) = self.field(field, spec)?;
            let _ = writeln!(self.out, "{key} = {value}");
        }
        starts.iter().for_each(|start| self.comments(&start.word));
        // A text may say it in parts.
        let parts: Vec<(&str, String)> = starts
            .iter()
            .flat_map(|start| self.clauses(start, &words::START))
            .collect();
        if !parts.is_empty() {
            let parts = parts.iter().map(|(key, value)| (*key, value.as_str()));
            let _ = writeln!(self.out, "{} = {}", words::START.word, table(parts));
        }
        Some(())
    }

    /// Keys and values in quotes of what stands outside the braces, in the order of the language.
    fn clauses(&self, item: &Item<'_>, spec: &ItemWord) -> Vec<(&'static str, String)> {
        let given = spec.clauses.iter().filter_map(|clause| {
            let value = self.text(item.clause(clause.sign)?);
            Some(match clause.key {
                words::FILE => (clause.key, quoted(value.trim_matches('"'))),
                key => (key, quoted(&value)),
            })
        });
        given.collect()
    }

    /// The value of an item without braces: its one value, or a table on one line.
    fn inline(&self, item: &Item<'_>, spec: &ItemWord) -> String {
        let mut given = self.clauses(item, spec);
        if !item.doc.is_empty() {
            given.insert(0, ("doc", quoted(&item.doc)));
        }
        match given.as_slice() {
            [(key, value)] if spec.alone(value).is_some_and(|only| only.key == *key) => {
                value.clone()
            }
            given => table(given.iter().map(|(key, value)| (*key, value.as_str()))),
        }
    }

    /// A field with its value.
    fn field(&self, field: &Item<'_>, of: &ItemWord) -> Option<(String, String)> {
        let word = field.word.text.as_str();
        if let (Some(inner), Some(name)) = (words::find(word, true), &field.name) {
            let key = format!("{word}.{}", key(&self.name(name)));
            return Some((key, self.inline(field, inner)));
        }
        let value = field.clause(":")?;
        let mut cursor = Cursor::new(value);
        match cursor.group(Bracket::Brace) {
            // The fields of a coordinate.
            Some(group) if of.word == "joint" && cursor.at_end() => {
                let mut messages = Messages::default();
                let block = items(Cursor::new(group), true, &mut messages);
                let own: Vec<(&str, String)> = block
                    .iter()
                    .filter_map(|own| {
                        let value = quoted(&self.text(own.clause(":")?));
                        Some((own.word.text.as_str(), value))
                    })
                    .collect();
                let fields = own.iter().map(|(key, value)| (*key, value.as_str()));
                Some((word.to_owned(), table(fields)))
            }
            _ => Some((word.to_owned(), quoted(&self.text(value)))),
        }
    }

    /// `leg[i in 0..3]`
    fn name(&self, name: &NameSyntax<'_>) -> String {
        let index = name.index.map(|index| self.text(index));
        let index = index.map_or_else(String::new, |index| format!("[{index}]"));
        format!("{}{index}", name.word.text)
    }

    /// A value as it was written, on one line: a blank where there was anything between two of its lexemes.
    fn text(&self, value: ValueSyntax<'_>) -> String {
        let mut text = String::new();
        let mut end = None;
        for lexeme in value.lexemes {
            let (line, column) = self.places.position(lexeme.at);
            if end.is_some_and(|end| end != (line, column)) {
                text.push(' ');
            }
            let shown = lexeme.shown();
            end = Some((line, column + shown.chars().count()));
            text.push_str(&shown);
        }
        text
    }
}

/// Whether a field places a body or a point; that of a coordinate has a value.
fn is_start(field: &&Item<'_>) -> bool {
    field.word.text == words::START.word && field.clause(":").is_none()
}

/// A table on one line.
fn table<'t>(fields: impl Iterator<Item = (&'t str, &'t str)>) -> String {
    let fields = fields.map(|(key, value)| format!("{key} = {value}"));
    format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
}
