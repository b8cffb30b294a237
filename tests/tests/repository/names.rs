//! Names of types: a reader who has met one knows what it is wherever it stands.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Source folders of the crates, tests left out.
const SOURCES: [&str; 9] = [
    "mbd-runtime/scene/src",
    "mbd-runtime/solver/src",
    "mbd-runtime/src",
    "mbd-runtime/campaign/src",
    "mbd-runtime/report/src",
    "mbd-macros/src",
    "mbd-macros/compiler/src",
    "models/src",
    "models/command/src",
];

/// Words that declare a type or a trait.
const KINDS: [&str; 4] = ["struct", "enum", "trait", "type"];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|it| it == "rs") {
            found.push(path);
        }
    }
}

/// Types and traits that a file declares, those of test modules left out.
fn declared(code: TokenStream, names: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = code.into_iter().collect();
    let word = |at: usize| match tokens.get(at) {
        Some(TokenTree::Ident(word)) => Some(word.to_string()),
        _ => None,
    };
    let mut for_tests = false;
    for (at, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Group(group) => match group.delimiter() {
                Delimiter::Bracket => {
                    let attribute = group.stream().to_string().replace(' ', "");
                    for_tests |= attribute == "cfg(test)";
                }
                Delimiter::Brace => {
                    let module = at >= 2 && word(at - 2).is_some_and(|it| it == "mod");
                    if module && !for_tests {
                        declared(group.stream(), names);
                    }
                    for_tests = false;
                }
                _ => {}
            },
            TokenTree::Ident(kind) if KINDS.contains(&kind.to_string().as_str()) => {
                if let Some(name) = word(at + 1).filter(|_| !for_tests) {
                    names.push(name);
                }
            }
            TokenTree::Punct(sign) if sign.as_char() == ';' => for_tests = false,
            _ => {}
        }
    }
}

#[test]
fn a_name_of_a_type_has_one_meaning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for source in SOURCES {
        let mut files = Vec::new();
        rust_files(&root.join(source), &mut files);
        for file in files {
            let file = file.strip_prefix(&root).unwrap();
            if file.components().any(|it| it.as_os_str() == "tests") {
                continue;
            }
            let file_name = file.display().to_string();
            let text = std::fs::read_to_string(root.join(file)).unwrap();
            let mut names = Vec::new();
            let code = text
                .parse()
                .unwrap_or_else(|error| panic!("{file_name}: {error}"));
            declared(code, &mut names);
            for name in names {
                places.entry(name).or_default().push(file_name.clone());
            }
        }
    }
    assert!(places.len() > 500, "only {} types were read", places.len());
    places.retain(|_, files| files.len() > 1);
    assert!(
        places.is_empty(),
        "names with several meanings: {places:#?}"
    );
}
