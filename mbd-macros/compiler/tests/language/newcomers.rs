//! Mistakes: each is told at its place with its remedy, and what a message proposes takes it away.

use mbd_compiler::{Reading, immovable, read_text};
use mbd_scene::Layout;

use super::{expected, files, lines};

/// Compares what every file of a folder is told with its first lines; `UPDATE_GOLDEN` writes them.
fn compare(folder: &str, told: impl Fn(&str, &Reading) -> Vec<String>) {
    let mut wrong = Vec::new();
    for (name, text) in files(folder) {
        let (wanted, declaration) = expected(&text);
        let found = told(&name, &read_text(&declaration));
        if found != wanted {
            wrong.push(format!("{name}:\n{}", found.join("\n")));
        }
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            let head: Vec<String> = found.iter().map(|line| format!("//~ {line}\n")).collect();
            let path = format!("{}/tests/{folder}/{name}", env!("CARGO_MANIFEST_DIR"));
            let text = format!("{}{}\n", head.concat(), declaration.trim_end());
            std::fs::write(path, text).unwrap();
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_mistake_is_told_at_its_place_with_its_remedy() {
    compare("fail", |name, reading| {
        assert!(reading.scene.is_none(), "{name} was read");
        lines(&reading.errors)
    });
}

/// Everything that a declaration is told before it runs: errors, what cannot move, warnings.
fn everything_told(reading: &Reading) -> Vec<String> {
    let mut errors = reading.errors.clone();
    if let Some(scene) = &reading.scene {
        errors.extend(immovable(reading, &Layout::new(scene)));
    }
    let warnings = lines(&reading.warnings).into_iter();
    let warnings = warnings.map(|line| format!("warning: {line}"));
    lines(&errors).into_iter().chain(warnings).collect()
}

/// What new users write by mistake, and what they guess: declarations written by people who had not seen the language, one mistake or wish
/// each. A file without `//~` lines is accepted as it stands.
#[test]
fn what_new_users_write_is_accepted_or_answered() {
    compare("users/broken", |_, reading| everything_told(reading));
    compare("users/wished", |_, reading| everything_told(reading));
}

/// The word that a message proposes in place of the one where it stands.
fn proposed(message: &str) -> Option<&str> {
    let mut forms = ["did you mean `", "here it is called `"].into_iter();
    let behind = forms.find_map(|form| message.split_once(form))?.1;
    behind.split('`').next()
}

/// The text with the word at a line and column, both from 1, replaced.
fn with_word(text: &str, (line, column): (usize, usize), word: &str) -> Option<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let old = lines.get(line - 1)?;
    let (before, behind): (String, String) = (
        old.chars().take(column - 1).collect(),
        old.chars().skip(column - 1).collect(),
    );
    let rest = behind.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
    lines[line - 1] = format!("{before}{word}{rest}");
    Some(lines.join("\n"))
}

#[test]
fn every_word_that_a_message_proposes_takes_the_message_away() {
    let mut tried = 0;
    for folder in ["fail", "users/broken"] {
        for (name, text) in files(folder) {
            let (_, declaration) = expected(&text);
            for message in lines(&read_text(&declaration).errors) {
                let mut parts = message.splitn(3, ':');
                let mut number = || parts.next()?.trim().parse::<usize>().ok();
                let (Some(line), Some(column)) = (number(), number()) else {
                    continue;
                };
                // `run` is no item either: the message says where it stands.
                let Some(word) = proposed(&message).filter(|word| *word != "run") else {
                    continue;
                };
                let again = with_word(&declaration, (line, column), word).unwrap();
                let left = lines(&read_text(&again).errors);
                let place = format!("{line}:{column}: unknown");
                let stays = left
                    .iter()
                    .any(|left| *left == message || left.starts_with(&place));
                assert!(
                    !stays,
                    "{name}: {message}\nwith `{word}`:\n{}",
                    left.join("\n")
                );
                tried += 1;
            }
        }
    }
    assert!(tried > 50, "{tried} words were proposed");
}
