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
