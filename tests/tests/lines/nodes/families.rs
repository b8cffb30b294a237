//! Random families of equilibrium problems: no failure without load, typed outcomes always, bounded work.
//!
//! The full campaign: `cargo test -p tests --test lines nodes::families -- --ignored --nocapture`.

use mbd_runtime::node::Outcome;
use tests::families::{COMBINATIONS, Family, Start, Tally, run, solve};
use tests::random::Random;
use tests::web::Confluence;

fn print(family: Family, start: Start, loaded: bool, tally: &Tally) {
    let (mean, p99, most) = tally.steps();
    println!(
        "{family:?}, start {start:?}, {}: {} problems, warm {}, homotopy {}, search {}, slack {}, failed {}; steps mean {mean:.2}, p99 {p99}, max {most}",
        if loaded { "loaded" } else { "no load" },
        tally.problems,
        tally.warm,
        tally.homotopy,
        tally.search,
        tally.slack,
        tally.failed,
    );
}

/// Runs every combination and checks the promise of the solver.
fn campaign(count: usize, seed: u64) {
    for (index, (family, start)) in COMBINATIONS.into_iter().enumerate() {
        for loaded in [false, true] {
            let tally = run(
                family,
                start,
                loaded,
                count,
                seed + 2 * index as u64 + u64::from(loaded),
            );
            print(family, start, loaded, &tally);
            let (_, _, most) = tally.steps();
            if loaded {
                assert!(
                    family.is_spread() || tally.failed == 0,
                    "{family:?} {start:?}: {} failures",
                    tally.failed
                );
                assert!(most <= 632, "{family:?} {start:?}: {most} steps");
            } else {
                assert_eq!(tally.failed, 0, "{family:?} {start:?}");
                assert!(most <= 100, "{family:?} {start:?}: {most} steps");
            }
        }
    }
}

#[test]
fn every_family_of_random_scenes_balances() {
    campaign(3_000, 7);
}

#[test]
#[ignore = "the full campaign, two million scenes: ten seconds"]
fn every_family_of_a_million_random_scenes_balances() {
    campaign(60_000, 1_000_003);
}

#[test]
fn a_warm_start_costs_few_newton_steps() {
    let mut random = Random::new(11);
    for (moved, mean_bound) in [(1e-2, 3.0), (1e-3, 2.6), (1e-4, 2.4), (1e-6, 2.0)] {
        let (mut total, mut solved) = (0, 0);
        while solved < 2_000 {
            let mut problem: Confluence<f64> = Family::Random.problem(&mut random);
            let mut p = Start::Centroid.place(&problem, &mut random);
            let first = solve(&problem.web().unwrap(), &mut p);
            if !matches!(first, Outcome::Taut { .. }) {
                continue;
            }
            for anchor in &mut problem.anchors {
                let shift = random.vector(moved);
                anchor.iter_mut().zip(shift).for_each(|(x, dx)| *x += dx);
            }
            total += solve(&problem.web().unwrap(), &mut p).iterations();
            solved += 1;
        }
        let mean = total as f64 / f64::from(solved);
        println!("anchors moved by {moved:e}: {mean:.2} steps");
        assert!(mean <= mean_bound, "{mean} steps at {moved:e}");
    }
}
