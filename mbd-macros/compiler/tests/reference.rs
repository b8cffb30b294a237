//! The description of the language is true: its examples are read without a mistake, and its table of joints is the catalogue.

use mbd_compiler::{Reading, read_text, read_toml};
use mbd_scene::JointLaw;

const REFERENCE: &str = include_str!("../../LANGUAGE.md");

#[test]
fn every_example_is_read_without_mistake_or_warning() {
    let examples: Vec<&str> = REFERENCE.split("```").skip(1).step_by(2).collect();
    assert!(!examples.is_empty());
    for example in examples {
        let reading = read(example);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        assert!(reading.warnings.is_empty(), "{:?}", reading.warnings);
    }
}

/// An example of a page: a scene in TOML, without the table of its run, or the text of a declaration.
fn read(example: &str) -> Reading {
    match example.strip_prefix("toml") {
        Some(document) => read_toml(document.split("[run]").next().unwrap_or(document)),
        None => read_text(example.trim_start_matches("text")),
    }
}

#[test]
fn every_joint_has_its_row_with_its_freedoms() {
    for (keyword, freedoms, summary) in JointLaw::CATALOGUE {
        let row = REFERENCE
            .lines()
            .find(|line| line.starts_with(&format!("| `{keyword}` |")));
        let row = row.unwrap_or_else(|| panic!("no row for `{keyword}`"));
        assert!(
            row.contains(&format!("| {freedoms} | {summary} |")),
            "{row}"
        );
    }
}
