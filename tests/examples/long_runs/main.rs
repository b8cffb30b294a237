//! The long runs behind the short tests, each with the promise it is held to: `cargo run --release -p tests --example long_runs -- WHAT COUNT [FIRST [NODES]]`.
//!
//! | what | count of | promise |
//! |---|---|---|
//! | `fuzz` | declarations, random and mutated, as text and in TOML | a scene with every item declared, or messages with places; 2 s each, of large ones a megabyte; no panic |
//! | `files` | bytes of files, mutated: declarations, documents, robots | the same |
//! | `large` | bytes of each file that is large in one way | the same |
//! | `networks` | networks of 50 nodes, or of so many as said | in balance, or the two lines named that are too uneven |
//! | `rates` | rate problems of one node | the minimum of the convex problem |
//! | `points` | points of the largest scene | start, step and memory grow no faster than the points |
//!
//! A case is known by its number: `fuzz 1 4711` looks at one again. A broken promise is exit code 1.

mod watch;

use std::process::{Command, ExitCode};
use std::time::Instant;

use fuzz::{Corpus, LARGE, SLOWEST, Tally, large_file, memory};
use tests::networks::{Decided, KINDS, Kind, Solved};
use tests::points::costs;

use watch::Watch;

const USAGE: &str = "long_runs fuzz|files|large|networks|rates|points COUNT [FIRST [NODES]]";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize| arguments.get(index).and_then(|text| text.parse().ok());
    let (Some(what), Some(count)) = (arguments.first(), number(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let first = number(2).unwrap_or(0);
    let began = Instant::now();
    let kept = match what.as_str() {
        "fuzz" => fuzz(count, first),
        "files" => files(count, first),
        "large" => large(count),
        "single" => single(count, first),
        "networks" => networks(count, first, number(3).unwrap_or(50)),
        "rates" => rates(count, first),
        "points" => points(count),
        "rope" => rope(count),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    println!("{:.0} s", began.elapsed().as_secs_f64());
    if kept {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

fn megabytes(bytes: usize) -> f64 {
    bytes as f64 / 1e6
}

fn peak() -> String {
    memory().map_or_else(
        || "?".to_owned(),
        |bytes| format!("{:.0} MB", megabytes(bytes)),
    )
}

/// Tells what came of inputs; whether every promise was kept.
fn told(tally: &Tally) -> bool {
    println!(
        "{} inputs, {:.1} MB: {} scenes, {} promises broken; slowest {:.3} s (number {}); most memory {}",
        tally.inputs,
        megabytes(tally.bytes),
        tally.scenes,
        tally.broken.len(),
        tally.slowest.0,
        tally.slowest.1,
        peak()
    );
    let mut told: Vec<&str> = Vec::new();
    for (number, why) in &tally.broken {
        // Three of a kind are enough.
        let kind = why.split_once(':').map_or(why.as_str(), |(kind, _)| kind);
        if told.iter().filter(|known| **known == kind).count() < 3 {
            println!("number {number}: {why}");
            told.push(kind);
        }
    }
    tally.broken.is_empty()
}

fn fuzz(count: u64, first: u64) -> bool {
    let (corpus, watch) = (Corpus::new(), Watch::begin());
    let mut tally = Tally::default();
    for number in first..first + count {
        let input = corpus.declaration(number);
        watch.at(number);
        tally.count(number, &input);
        if count == 1 {
            println!("{}", input.text);
        }
    }
    told(&tally)
}

fn files(bytes: u64, first: u64) -> bool {
    let (corpus, watch) = (Corpus::new(), Watch::begin());
    let mut tally = Tally::default();
    let mut number = first;
    while tally.bytes < usize::try_from(bytes).unwrap_or(usize::MAX) {
        let input = corpus.file(number);
        watch.at(number);
        tally.count(number, &input);
        if bytes == 1 {
            println!("{}", input.text);
        }
        number += 1;
    }
    told(&tally)
}

/// Each file in a process of its own, whose memory is that of this file.
fn large(size: u64) -> bool {
    let Ok(program) = std::env::current_exe() else {
        return false;
    };
    println!("{SLOWEST} s for a megabyte; file | bytes | time | most memory | times its bytes");
    (0..LARGE).fold(true, |kept, number| {
        let mut child = Command::new(&program);
        child.args(["single", &size.to_string(), &number.to_string()]);
        child.status().is_ok_and(|status| status.success()) && kept
    })
}

/// One of the large files.
fn single(size: u64, number: u64) -> bool {
    let size = usize::try_from(size).unwrap_or(usize::MAX);
    let number = usize::try_from(number).unwrap_or(usize::MAX);
    let Some((name, input)) = large_file(size, number) else {
        return false;
    };
    let (watch, before) = (Watch::begin(), memory());
    watch.at(number as u64);
    let mut tally = Tally::default();
    tally.count(number as u64, &input);
    let broken = tally.broken.first().map_or("", |(_, why)| why);
    let more = memory().zip(before);
    let more = more.map_or(f64::NAN, |(all, before)| all.saturating_sub(before) as f64);
    println!(
        "{name} | {} | {:.2} s | {:.0} MB | {:.0} {broken}",
        input.text.len(),
        tally.slowest.0,
        more / 1e6,
        more / input.text.len().max(1) as f64
    );
    tally.broken.is_empty()
}

fn networks(count: u64, first: u64, nodes: u64) -> bool {
    let nodes = usize::try_from(nodes).unwrap_or(usize::MAX);
    let mut kept = true;
    for kind in KINDS {
        let began = Instant::now();
        let mut solved = Solved::default();
        // Where stiffness is uneven a balance takes ten times as long.
        let share = match kind {
            Kind::Uneven(_) => 40,
            _ => 4,
        };
        for number in first..first + count / share {
            solved.solve(kind, number, nodes);
        }
        println!(
            "{kind:?}: {} networks of {nodes} nodes: {} taut, {} slack, {} told by two lines (ratio from {:.0e}), {} told without, {} wrong; \
             Newton steps mean {:.1}, most {}; worst balance {:.1e}; {:.0} s",
            solved.problems,
            solved.taut,
            solved.slack,
            solved.named,
            solved.ratio,
            solved.unnamed.len(),
            solved.wrong.len(),
            solved.steps as f64 / solved.problems.max(1) as f64,
            solved.most,
            solved.worst,
            began.elapsed().as_secs_f64()
        );
        for (what, list) in [
            ("told without names", &solved.unnamed),
            ("wrong", &solved.wrong),
        ] {
            if !list.is_empty() {
                println!("  {what}: {:?}", &list[..list.len().min(10)]);
            }
        }
        kept &= solved.unnamed.is_empty() && solved.wrong.is_empty();
    }
    kept
}

fn rates(count: u64, first: u64) -> bool {
    let mut decided = Decided::default();
    for number in first..first + count {
        decided.decide(number);
    }
    let [full, idle, algebraic] = decided.spreads;
    println!(
        "{} rate problems: {full} decided by dampers in all directions, {idle} where nothing pulls, {algebraic} by the balance of what pulls \
         (open {:.1e}); {} broken",
        decided.problems,
        decided.open,
        decided.broken.len()
    );
    for (number, what) in decided.broken.iter().take(10) {
        println!("  number {number}: {what}");
    }
    decided.broken.is_empty()
}

/// A rope of an eighth, a fourth, half of the points, and all: each in a process of its own, whose memory is that of this rope.
fn points(count: u64) -> bool {
    println!(
        "points | read | layout | generic | start | step | interpreted | start of that | most memory"
    );
    let Ok(program) = std::env::current_exe() else {
        return false;
    };
    [8, 4, 2, 1].iter().all(|part| {
        let mut child = Command::new(&program);
        child.args(["rope", &(count / part).to_string()]);
        child.status().is_ok_and(|status| status.success())
    })
}

fn rope(count: u64) -> bool {
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    match costs(count) {
        Ok(costs) => {
            let times = [
                costs.read,
                costs.layout,
                costs.generic,
                costs.start,
                costs.step,
                costs.interpreted,
                costs.start_interpreted,
            ];
            let times: Vec<String> = times.iter().map(|time| format!("{time:.4} s")).collect();
            println!("{count} | {} | {}", times.join(" | "), peak());
            true
        }
        Err(error) => {
            println!("{count}: {error}");
            false
        }
    }
}
