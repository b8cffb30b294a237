//! The language: declarations in `pass/` are read, declarations in `fail/` give the message their first line names.

mod calls;
mod frames;
mod newcomers;
mod outputs;
mod repetitions;
mod units;
mod values;

use mbd_compiler::{Message, Reading, read_text};

/// Messages as text, one a line.
fn told(reading: &Reading) -> String {
    let lines: Vec<String> = reading
        .errors
        .iter()
        .map(|message| message.in_file("scene.mbd"))
        .collect();
    lines.join("\n")
}

fn files(folder: &str) -> Vec<(String, String)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).unwrap())
        })
        .collect()
}

#[test]
fn declarations_without_a_mistake_are_read() {
    for (name, text) in files("pass") {
        let reading = read_text(&text);
        assert!(reading.scene.is_some(), "{name}:\n{}", told(&reading));
        assert!(
            reading.warnings.is_empty(),
            "{name}: {:?}",
            reading.warnings
        );
    }
}

/// The lines `//~ line:column: message` that say what is wrong with a declaration, places counted from the line after them.
fn expected(text: &str) -> (Vec<&str>, String) {
    let head: Vec<&str> = text
        .lines()
        .take_while(|line| line.starts_with("//~ "))
        .map(|line| line.trim_start_matches("//~ "))
        .collect();
    let rest: Vec<&str> = text.lines().skip(head.len()).collect();
    (head, rest.join("\n"))
}

/// All messages with all their places.
fn lines(messages: &[Message]) -> Vec<String> {
    let told = |message: &Message| -> Vec<String> {
        let lines = message.in_file("");
        lines.lines().map(|line| line[1..].to_string()).collect()
    };
    messages.iter().flat_map(told).collect()
}

#[test]
fn what_is_probably_not_meant_is_a_warning() {
    for (name, text) in files("warn") {
        let (wanted, declaration) = expected(&text);
        let reading = read_text(&declaration);
        assert!(reading.scene.is_some(), "{name}:\n{}", told(&reading));
        assert_eq!(lines(&reading.warnings), wanted, "{name}");
    }
}

/// A pendulum with a mass called like a unit, and these items.
fn pendulum(items: &str) -> Reading {
    let text = format!(
        "model Pendulum {{
            gravity: [0, 0, -9.81] m/s^2;
            param m = 2 kg;
            body rod {{ mass: m, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 1] m }}
            {items}
        }}"
    );
    read_text(&text)
}

fn parachute() -> String {
    let path = format!("{}/tests/pass/parachute.mbd", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}
