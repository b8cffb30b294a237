//! `mbd grammar`: the language for editors that take TextMate grammars, made of the one vocabulary.

use std::collections::BTreeSet;

use mbd_compiler::Vocabulary;
use serde_json::{Value, json};

/// The grammar as JSON: save it where the editor looks for `mbd.tmLanguage.json`.
pub fn grammar() -> String {
    let text = serde_json::to_string_pretty(&document(&Vocabulary::new()));
    // Made of texts alone: it can be written.
    text.unwrap_or_default() + "\n"
}

fn document(words: &Vocabulary) -> Value {
    let rule = |name: &str, pattern: String| json!({ "name": name, "match": pattern });
    let whole = |list: &BTreeSet<&str>| format!(r"\b(?:{})\b", any(list));
    let units = any(&words.units);
    json!({
        "name": "mbd",
        "scopeName": "source.mbd",
        "fileTypes": ["mbd"],
        "patterns": [
            rule("comment.line.documentation.mbd", "//[/!].*$".into()),
            rule("comment.line.double-slash.mbd", "//.*$".into()),
            json!({ "name": "comment.block.mbd", "begin": r"/\*", "end": r"\*/" }),
            json!({ "name": "string.quoted.double.mbd", "begin": "\"", "end": "\"" }),
            rule("entity.name.section.mbd", r"^\s*\[[^\]]*\]\s*$".into()),
            json!({
                "match": format!(r"(\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?)(?:\s*((?:{units})(?:\^-?\d+)?(?:\s*[*/]\s*(?:{units})(?:\^-?\d+)?)*)\b)?"),
                "captures": { "1": { "name": "constant.numeric.mbd" }, "2": { "name": "keyword.other.unit.mbd" } },
            }),
            rule("storage.type.mbd", r"\b(?:pub|model|loop)\b".into()),
            rule("variable.parameter.mbd", format!(r"\b(?:{})(?=\s*:)", any(&words.fields))),
            rule("keyword.declaration.mbd", whole(&words.items)),
            rule("keyword.control.mbd", whole(&words.clauses)),
            rule("support.type.mbd", whole(&words.kinds)),
            rule("support.function.mbd", format!(r"\b(?:{})(?=\s*\()", any(&words.functions))),
            rule("constant.language.mbd", r"\b(?:world|time|com)\b".into()),
        ],
    })
}

/// One of these words, the longest first; none of them has a letter that means something in a pattern.
fn any(words: &BTreeSet<&str>) -> String {
    let mut words: Vec<&str> = words.iter().copied().collect();
    words.sort_by_key(|word| std::cmp::Reverse(word.len()));
    words.join("|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_the_language_is_in_the_grammar_and_none_means_something_else_there() {
        let words = Vocabulary::new();
        let text = grammar();
        assert!(serde_json::from_str::<Value>(&text).is_ok());
        let lists = [
            &words.items,
            &words.clauses,
            &words.fields,
            &words.kinds,
            &words.functions,
            &words.units,
        ];
        for word in lists.into_iter().flatten() {
            assert!(text.contains(word), "{word}");
            assert!(
                word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'),
                "{word}"
            );
        }
        for word in [
            "body",
            "hinge",
            "free_length",
            "capsule",
            "stops",
            "kN",
            "smoothstep",
        ] {
            assert!(
                lists.into_iter().flatten().any(|known| *known == word),
                "{word}"
            );
        }
    }
}
