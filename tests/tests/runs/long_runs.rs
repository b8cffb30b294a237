//! The long runs of `cargo run --release -p tests --example long_runs`, as far as a test goes.

use fuzz::{
    Corpus, LARGE, SLOWEST, Tally, Verdict, declared_in_text, declared_in_toml, judge, large_file,
};
use mbd_compiler::read_tokens;
use mbd_scene::{Layout, Redundancy};
use tests::cores::on_all_cores;
use tests::networks::{Decided, KINDS, Solved};
use tests::points::costs;

/// Parts in which inputs are read beside each other.
const PARTS: u64 = 4;

/// Reads inputs on all cores.
fn many(count: u64, input: impl Fn(&Corpus, u64) -> fuzz::Input + Sync) -> Tally {
    let corpus = Corpus::new();
    let tallies = on_all_cores(PARTS, |part| {
        let mut tally = Tally {
            skipped: PARTS,
            ..Tally::default()
        };
        for number in (part * count / PARTS)..((part + 1) * count / PARTS) {
            tally.count(number, &input(&corpus, number));
        }
        tally
    });
    tallies.into_iter().fold(Tally::default(), Tally::with)
}

#[test]
fn a_hundred_thousand_declarations_end_in_a_scene_with_all_its_items_or_in_messages_with_places() {
    let tally = many(100_000, Corpus::declaration);
    assert_eq!(tally.broken, [], "{} s of {SLOWEST} s", tally.slowest.0);
    // A fourth of them are meant, and mutations of others leave some as they should be.
    assert!(tally.scenes > 30_000, "{}", tally.scenes);
}

#[test]
fn declarations_that_came_back_from_a_document_as_other_scenes_come_back_as_themselves() {
    let corpus = Corpus::new();
    let numbers = [209507, 231907, 384606, 588163, 653311, 690754, 710566];
    for number in numbers {
        let judged = judge(&corpus.declaration(number));
        assert!(judged.is_ok(), "{number}: {judged:?}");
    }
}

#[test]
fn a_million_bytes_of_mutated_files_end_in_scenes_or_messages() {
    let tally = many(900, Corpus::file);
    assert_eq!(tally.broken, []);
    assert!(tally.bytes > 1_000_000 && tally.scenes > 0, "{tally:?}");
}

#[test]
fn files_that_are_large_in_one_way_take_time_and_memory_in_proportion() {
    for (name, input) in (0..LARGE).filter_map(|number| large_file(200_000, number)) {
        let judged = judge(&input);
        assert!(judged.is_ok(), "{name}: {judged:?}");
    }
}

#[test]
fn mutated_tokens_of_a_macro_end_in_a_scene_or_in_messages() {
    let corpus = Corpus::new();
    let mut read = 0;
    for number in 0..5_000 {
        let text = corpus.text(number);
        let Ok(tokens) = text.parse::<proc_macro2::TokenStream>() else {
            continue;
        };
        let reading = read_tokens(tokens);
        let told: Vec<_> = reading
            .errors
            .iter()
            .map(|e| e.to_compile_error())
            .collect();
        assert_eq!(told.is_empty(), reading.scene.is_some(), "{text}");
        read += usize::from(reading.scene.is_some());
        let layout = Layout::keeping(&reading.skeleton, Redundancy::default());
        assert!(layout.nx() <= 200_000);
    }
    assert!(read > 100, "{read}");
}

#[test]
fn things_are_counted_without_the_compiler_as_they_are_declared() {
    let text = "/// Bodies: body x {}\nmodel A { gravity: none; const N = 3; /* body c {} */
        body b[i in 0..=N] { mass: 1 kg, frame f at [0, 0, 0] m } point p[i in 0..2] { mass: 1 kg } point q;
        loop joint j: hinge from b[0].f to b[1].f { axis: y } output o = if time > 1 s { 1 } else { 2 }; }";
    let counts = declared_in_text(text);
    let found = ["const", "body", "point", "joint", "output", "line"].map(|kind| counts[kind]);
    assert_eq!(found, [Some(1), None, Some(3), Some(1), Some(1), Some(0)]);
    let lists = "model A { output a = [1, (2, 3)] in m; output b = [1, 2, 3,]; output c = [1, 2, 3, 4]; output d = [1, 2] * x; output e[i in 0..3] = i; }";
    assert_eq!(declared_in_text(lists)["output"], Some(2 + 1 + 4 + 1 + 3));
    let counts = declared_in_toml("[point.\"p[i in 0..=2]\"]\nmass = \"1 kg\"\n[body.b]\n");
    let counts = counts.expect("a document");
    assert_eq!((counts["point"], counts["body"]), (Some(3), Some(1)));
    // A declaration that loses an item is found.
    let corpus = Corpus::new();
    let mut lost = corpus.declaration(0);
    assert_eq!(judge(&lost).map(|(verdict, _)| verdict), Ok(Verdict::Scene));
    let at = lost.text.rfind('}').expect("a brace");
    lost.text.insert_str(at, "/* */ output late = time; ");
    assert_eq!(judge(&lost).map(|(verdict, _)| verdict), Ok(Verdict::Scene));
    let counts = declared_in_text(&lost.text);
    assert!(counts["output"] >= Some(1));
}

#[test]
fn networks_of_fifty_nodes_balance() {
    // Newton steps of one, on the average: a third more than ten thousand of the kind took. A homotopy from the start on takes two to three times as many.
    let steps = [22, 18, 90, 530, 45];
    for (kind, steps) in KINDS.into_iter().zip(steps) {
        let mut solved = Solved::default();
        for number in 0..20 {
            solved.solve(kind, number, 50);
        }
        assert!(solved.steps < 20 * steps, "{kind:?} {}", solved.steps);
        assert_eq!(
            (solved.named, &solved.unnamed[..], &solved.wrong[..]),
            (0, &[][..], &[][..]),
            "{kind:?}"
        );
        assert!(solved.taut > 0, "{solved:?}");
    }
}

#[test]
fn rate_problems_are_decided_as_the_convex_minimum_demands() {
    let mut decided = Decided::default();
    (0..20_000).for_each(|number| decided.decide(number));
    assert_eq!(decided.broken, []);
    let [full, idle, algebraic] = decided.spreads;
    assert!(full > 1000 && idle > 1000 && algebraic < 100, "{decided:?}");
    assert!(decided.open < 1e-2, "{decided:?}");
}

#[test]
fn a_rope_of_points_is_read_and_started() {
    let costs = costs(200).expect("a run");
    assert!(costs.read > 0.0 && costs.step > 0.0);
}
