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

/// What a pattern that matches is called.
fn rule(name: &str, pattern: &str) -> Value {
    json!({ "name": format!("{name}.mbd"), "match": pattern })
}

/// What the parts of a pattern that matches are called, in the order of its groups.
fn parts(names: &[&str], pattern: &str) -> Value {
    let captures: serde_json::Map<String, Value> = (1..)
        .zip(names)
        .map(|(group, name): (usize, _)| {
            (group.to_string(), json!({ "name": format!("{name}.mbd") }))
        })
        .collect();
    json!({ "match": pattern, "captures": captures })
}

/// The first pattern that matches where nothing has matched before it counts.
fn document(words: &Vocabulary) -> Value {
    let naming = any(&words.naming);
    let unit = format!(
        r"(?:{0})(?:\^-?\d+)?(?:[ \t]*[*/][ \t]*(?:{0})(?:\^-?\d+)?)*\b",
        any(&words.units)
    );
    // `1/s` is a unit, too.
    let unit = format!(r"(?:1[ \t]*/[ \t]*)?{unit}");
    let own = ["com", "time", "world"];
    let others = words.others.iter().filter(|word| !own.contains(word));
    let controls = words.clauses.iter().chain(others);
    let controls: BTreeSet<&str> = controls.copied().chain(["if", "else"]).collect();
    let calls: BTreeSet<&str> = words
        .functions
        .iter()
        .chain(&words.others)
        .copied()
        .collect();
    json!({
        "name": "mbd",
        "scopeName": "source.mbd",
        "fileTypes": ["mbd"],
        "patterns": [{ "include": "#settings" }, { "include": "#declaration" }],
        "repository": {
            "declaration": { "patterns": [
                rule("comment.line.documentation", "//[/!].*$"),
                rule("comment.line.double-slash", "//.*$"),
                { "include": "#comment" },
                { "include": "#text" },
                parts(
                    &["constant.numeric", "keyword.other.unit"],
                    &format!(r"(\b\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?)(?:[ \t]*({unit}))?"),
                ),
                // Behind the bracket of a vector or of a sum.
                parts(&["punctuation", "keyword.other.unit"], &format!(r"([\])])[ \t]*({unit})")),
                // What an input or a state is in.
                parts(&["punctuation", "keyword.other.unit"], &format!(r"([:\[])[ \t]*({unit})(?=\s*[=;])")),
                parts(&["keyword.control", "keyword.other.unit"], &format!(r"\b(in)[ \t]+({unit})(?=\s*[;,}}])")),
                parts(&["storage.type", "entity.name.type"], r"\b(model)\s+([A-Za-z_]\w*)"),
                rule("storage.type", r"\b(?:pub|crate|model|loop)\b"),
                parts(&["keyword.declaration", "entity.name.variable"], &format!(r"\b({naming})\s+([A-Za-z_]\w*)")),
                parts(&["punctuation", "variable.other.property"], r"(?<=[\w\]])(\.)([A-Za-z_]\w*)"),
                rule("variable.parameter", &format!(r"\b(?:{})(?=\s*:)", any(&words.fields))),
                rule("constant.language", r"\b(?:world(?!\s*\{)|time|com|pi)\b"),
                rule("support.function", &format!(r"\b(?:{})(?=\s*\()", any(&calls))),
                rule("entity.name.function", r"\b[A-Za-z_]\w*(?=\()"),
                rule("keyword.declaration", &format!(r"\b(?:{})\b", any(&words.items))),
                rule("keyword.control", &format!(r"\b(?:{})\b", any(&controls))),
                rule("support.type", &format!(r"\b(?:{})\b", any(&words.kinds))),
                rule("variable.other", r"\b[A-Za-z_]\w*"),
                rule("keyword.operator", r"\.\.=?|[-+*/^=<>]+"),
                rule("punctuation", r"[\[\](){}.,;:]"),
            ] },
            "comment": {
                "name": "comment.block.mbd", "begin": r"/\*", "end": r"\*/", "patterns": [{ "include": "#comment" }],
            },
            "text": { "name": "string.quoted.double.mbd", "begin": "\"", "end": "\"" },
            // How a scene file is run: TOML, up to the end.
            "settings": { "begin": r"^(?=\s*\[run\b)", "end": "(?!)", "patterns": [
                rule("comment.line.number-sign", "#.*$"),
                rule("entity.name.section", r"^\s*\[[^\]=]*\]+(?=\s*(?:#|$))"),
                rule("variable.other.key", r#"^\s*(?:"[^"]*"|[\w.-]|\[\d+\])+(?=\s*=)"#),
                { "include": "#text" },
                rule("constant.language", r"\b(?:true|false|nan|inf)\b"),
                rule("constant.numeric", r"[-+]?\b\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?"),
                rule("variable.other.key", r"\b[A-Za-z_][\w.-]*"),
                rule("punctuation", r"[\[\]{}.,=]"),
            ] },
        },
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
    use super::super::list;
    use super::super::scene_file::SceneFile;
    use super::*;

    #[test]
    fn every_word_of_the_language_is_in_the_grammar_and_none_means_something_else_there() {
        let words = Vocabulary::new();
        let text = grammar();
        assert!(serde_json::from_str::<Value>(&text).is_ok());
        let lists = [
            &words.items,
            &words.naming,
            &words.clauses,
            &words.fields,
            &words.kinds,
            &words.functions,
            &words.others,
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

    /// What is neither comment, text nor word is a sign of one of the last patterns.
    #[test]
    fn every_sign_of_the_ready_scenes_has_a_pattern() {
        let signs = ["..", "-+*/^=<>", "[](){}.,;:", "\"#"].concat();
        let files = list::names().filter_map(|name| SceneFile::find(name.as_ref()).ok());
        let all = files.filter(|file| file.document.is_none());
        let all = all.map(|file| file.source);
        for line in all.collect::<Vec<_>>().iter().flat_map(|text| text.lines()) {
            let code = line.split("//").next().unwrap_or_default();
            let code = code.split(" #").next().unwrap_or_default();
            let texts = code.split('"').step_by(2);
            for sign in texts.flat_map(str::chars) {
                let known = sign.is_ascii_alphanumeric() || sign == '_' || sign == ' ';
                assert!(known || signs.contains(sign), "`{sign}` in {line}");
            }
        }
        let grammar: Value = serde_json::from_str(&grammar()).expect("JSON");
        let patterns = grammar["repository"]["declaration"]["patterns"].as_array();
        let last = patterns.into_iter().flatten().rev().take(3);
        let names: Vec<&Value> = last.map(|pattern| &pattern["name"]).collect();
        assert_eq!(
            names,
            [
                "punctuation.mbd",
                "keyword.operator.mbd",
                "variable.other.mbd"
            ]
        );
    }
}
