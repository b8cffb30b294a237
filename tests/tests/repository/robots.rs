//! The page about robots sums up what is stored of them.

use std::fs::read_to_string;
use std::path::Path;

/// The largest difference of a column, where it is one.
fn largest(rows: &[Vec<&str>], column: usize) -> f64 {
    let numbers = rows.iter().map(|row| row[column].parse::<f64>());
    let numbers: Result<Vec<f64>, _> = numbers.collect();
    numbers.expect("numbers").into_iter().fold(0.0, f64::max)
}

#[test]
fn the_table_of_robots_is_that_of_the_stored_comparison() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let read = |file: &str| read_to_string(root.join(file)).expect(file);
    let (stored, page) = (
        read("tests/reference/robots/example_robot_data.csv"),
        read("docs/robots.md"),
    );
    let rows = stored.lines().filter(|line| !line.starts_with('#')).skip(1);
    // What is told may have commas; whoever asks for more than the first four fields asks for its words.
    let rows: Vec<Vec<&str>> = rows.map(|line| line.splitn(5, ',').collect()).collect();
    let (still, moving): (Vec<_>, Vec<_>) = rows
        .iter()
        .cloned()
        .partition(|row| row[2] == "nothing moves");
    let (compared, refused): (Vec<_>, Vec<_>) = moving
        .into_iter()
        .partition(|row| row[2].parse::<f64>().is_ok());
    let (relative, plain): (Vec<_>, Vec<_>) = compared
        .into_iter()
        .partition(|row| row[4].contains("by relative coordinates"));
    for line in [
        format!("| of {} files,", rows.len()),
        format!(
            "| agree, base at rest and flying | {}: with the base at rest to {:.1e} ",
            plain.len(),
            largest(&plain, 2)
        ),
        format!("flying to {:.1e} ", largest(&plain, 3)),
        format!("`inertias: unchecked` | {}: ", relative.len()),
        format!("carries nothing | {}: ", refused.len()),
        format!("or no link | {}: ", still.len()),
    ] {
        assert!(page.contains(&line), "docs/robots.md has no `{line}`");
    }
}
