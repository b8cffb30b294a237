//! Mutated declarations: whatever is written, reading ends soon, never panics, and a failure has a place.

mod dice;

use dice::Dice;
use mbd_compiler::{Location, Reading, read_text, read_tokens};
use mbd_scene::{Layout, Redundancy};

/// Words, numbers and signs of a text, roughly.
fn pieces(text: &str) -> Vec<String> {
    let mut pieces: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !line.trim().starts_with("//")) {
        let mut word = String::new();
        for c in line.chars() {
            if c.is_alphanumeric() || c == '_' || c == '.' {
                word.push(c);
            } else {
                pieces.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
                pieces.extend((!c.is_whitespace()).then(|| c.to_string()));
            }
        }
        pieces.extend((!word.is_empty()).then_some(word));
    }
    pieces
}

const STRANGE: &[&str] = &[
    "0",
    "-1",
    "1e308",
    "1e-308",
    "1e999",
    "NaN",
    "0.5",
    "2.0kg",
    "3",
    "..",
    "..=",
    ".",
    ":",
    ";",
    ",",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "=",
    "^",
    "^9",
    "*",
    "/",
    "kg",
    "N/m",
    "m^-9",
    "deg",
    "world",
    "body",
    "point",
    "line",
    "spring",
    "const",
    "param",
    "frame",
    "at",
    "in",
    "from",
    "to",
    "com",
    "time",
    "i",
    "[i in 0..3]",
    "[i in 0..999999999999]",
    "static",
    "rate",
    "external",
    "norm",
    "cross",
    "full",
    "diag",
    "none",
    "é",
    "\"x\"",
    "#[doc]",
    "///",
    "x",
    "min",
    "'a",
];

fn mutate(pieces: &mut Vec<String>, dice: &mut Dice, others: &[Vec<String>]) {
    let at = dice.below(pieces.len());
    if pieces.is_empty() {
        return;
    }
    match dice.below(6) {
        0 => {
            pieces.remove(at);
        }
        1 => {
            let copy = pieces[at].clone();
            pieces.insert(at, copy);
        }
        2 => {
            let other = dice.below(pieces.len());
            pieces.swap(at, other);
        }
        3 => pieces[at] = STRANGE[dice.below(STRANGE.len())].to_string(),
        4 => {
            let source = &others[dice.below(others.len())];
            pieces[at] = source[dice.below(source.len())].clone();
        }
        _ => {
            let end = (at + dice.below(12)).min(pieces.len());
            let part: Vec<String> = pieces[at..end].to_vec();
            let place = dice.below(pieces.len());
            pieces.splice(place..place, part);
        }
    }
}

fn check(reading: &Reading, text: &str) {
    if reading.scene.is_none() {
        assert!(!reading.errors.is_empty(), "silent failure of:\n{text}");
    }
    for message in reading.errors.iter().chain(&reading.warnings) {
        let first = message.places.first().expect("a message without a place");
        if let Location::Text { line, column } = first.location {
            assert!(line >= 1 && column >= 1);
        }
        assert!(!message.text.is_empty());
    }
    // A scene is laid out for its equations, which looks for rows that repeat others; after errors the skeleton for the interface alone.
    let layout = match &reading.scene {
        Some(scene) => Layout::new(scene),
        None => Layout::keeping(&reading.skeleton, Redundancy::default()),
    };
    assert!(layout.nx() <= 200_000);
}

fn declarations() -> Vec<Vec<String>> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pass");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths
        .iter()
        .map(|path| pieces(&std::fs::read_to_string(path).unwrap()))
        .collect()
}

/// Reads `count` mutated declarations; how many are still scenes.
fn read_mutated(seed: u64, count: usize) -> usize {
    let declarations = declarations();
    let mut dice = Dice(seed);
    let mut read = 0;
    for number in 0..count {
        let mut pieces = declarations[dice.below(declarations.len())].clone();
        for _ in 0..=dice.below(4) {
            mutate(&mut pieces, &mut dice, &declarations);
        }
        let text = pieces.join(" ");
        let begin = std::time::Instant::now();
        let reading = read_text(&text);
        assert!(begin.elapsed().as_secs_f64() < 5.0, "slow:\n{text}");
        check(&reading, &text);
        if number % 20 == 0 {
            // Whatever is left of a declaration, the search for repeated rows ends.
            let found = Layout::new(&reading.skeleton).redundancy;
            assert!(found.repeats.len() <= reading.skeleton.joints.len());
        }
        read += usize::from(reading.scene.is_some());
    }
    read
}

#[test]
fn a_hundred_thousand_mutated_declarations_end_in_a_scene_or_in_messages_with_places() {
    let read: usize = std::thread::scope(|scope| {
        let workers: Vec<_> = (1..=4)
            .map(|seed| scope.spawn(move || read_mutated(0x5EED_0000 + seed, 25_000)))
            .collect();
        workers.into_iter().map(|w| w.join().unwrap()).sum()
    });
    assert!(read > 100, "only {read} are still scenes");
}

#[test]
fn mutated_tokens_of_a_macro_end_in_a_scene_or_in_messages() {
    let declarations = declarations();
    let mut dice = Dice(0x5EED_0000_0000_0002);
    for _ in 0..5_000 {
        let mut pieces = declarations[dice.below(declarations.len())].clone();
        for _ in 0..=dice.below(4) {
            mutate(&mut pieces, &mut dice, &declarations);
        }
        let text = pieces.join(" ");
        if let Ok(tokens) = text.parse::<proc_macro2::TokenStream>() {
            let reading = read_tokens(tokens);
            check(&reading, &text);
            let told: Vec<_> = reading
                .errors
                .iter()
                .map(|e| e.to_compile_error())
                .collect();
            assert_eq!(told.is_empty(), reading.scene.is_some());
        }
    }
}
