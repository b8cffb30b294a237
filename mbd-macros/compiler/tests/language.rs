//! The language: declarations in `pass/` are read, declarations in `fail/` give the message their first line names.

use mbd_compiler::{Reading, read_text};

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
fn found(reading: &Reading) -> Vec<String> {
    reading
        .errors
        .iter()
        .flat_map(|message| {
            let lines = message.in_file("");
            let lines: Vec<String> = lines.lines().map(|l| l[1..].to_string()).collect();
            lines
        })
        .collect()
}

#[test]
fn a_mistake_is_told_at_its_place_with_its_remedy() {
    let mut wrong = Vec::new();
    for (name, text) in files("fail") {
        let (wanted, declaration) = expected(&text);
        let reading = read_text(&declaration);
        assert!(reading.scene.is_none(), "{name} was read");
        let found = found(&reading);
        if found != wanted {
            wrong.push(format!("{name}:\n{}", found.join("\n")));
        }
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            let head: Vec<String> = found.iter().map(|line| format!("//~ {line}\n")).collect();
            let path = format!("{}/tests/fail/{name}", env!("CARGO_MANIFEST_DIR"));
            let text = format!("{}{}\n", head.concat(), declaration.trim_end());
            std::fs::write(path, text).unwrap();
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
