//! Batches: every case is a run of its own, whatever runs beside it.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use mbd_runtime::{
    Batch, Case, Content, Finished, Generic, Model, Options, Sampling, Simulation, StepError, Why,
    model,
};

model! {
    /// A lamp on a cord from a knot without mass, in air; the cord may go slack.
    pub model Lamp<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 2.0 kg in 0.5 kg ..= 5.0 kg;
        param stiffness = 5 kN/m in 1 kN/m ..= 20 kN/m;
        input wind: speed;
        world { frame left at [-1.0, 0.0, 2.0] m, frame right at [1.5, 0.0, 2.2] m }
        point lamp { mass: mass, start at [0.4, 0.3, 0.8] m }
        point knot;
        line a from world.left to knot { free_length: 1.2 m, stiffness: stiffness }
        line b from world.right to knot { free_length: 1.6 m, stiffness: stiffness }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: stiffness }
        load air on lamp =
            0.05 kg/m * ([wind, 0.0, 0.0] - lamp.velocity) * norm([wind, 0.0, 0.0] - lamp.velocity);
        event low = lamp.position.z falls 1.0 m;
        output pull = cord.tension;
    }
}

model! {
    /// A stone that is thrown.
    model Stone {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        input push: force;
        point stone { mass: 2.0 kg }
        load by_hand on stone = [push, 0.0, 0.0];
        output height = stone.position.z;
    }
}

fn lamp() -> Lamp<f64> {
    Lamp::new(LampParams::default()).expect("declared defaults can be run")
}

/// Cases that differ in everything a case can say; the third cannot be run.
fn cases() -> impl Iterator<Item = Case> + Send {
    (0..23_u32).map(|k| {
        let mass = if k == 2 {
            9.0
        } else {
            0.6 + 0.17 * f64::from(k)
        };
        let mut start = LampState::at_origin();
        start.set_lamp(mbd_runtime::PointState {
            position: [0.4 + 0.01 * f64::from(k), 0.3, 0.9],
            velocity: [0.0, 0.1 * f64::from(k), 0.0],
        });
        Case::new()
            .params([mass, 2000.0 + 300.0 * f64::from(k)])
            .inputs(&LampInputs {
                wind: 0.3 * f64::from(k),
            })
            .state(0.0, start.to_vec())
    })
}

/// Everything of a result but the time on the clock, to the bit.
fn bits(finished: &[Finished<Vec<f64>>]) -> Vec<(usize, Vec<u64>, u64)> {
    let of = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect();
    let one = |it: &Finished<Vec<f64>>| match &it.result {
        Ok(pulls) => (it.case, of(pulls), it.statistics.steps),
        Err(failed) => (it.case, of(&failed.state), it.statistics.steps),
    };
    finished.iter().map(one).collect()
}

fn pulls(model: &dyn Model<f64>, threads: usize) -> Vec<Finished<Vec<f64>>> {
    Batch::new(model, Options::tsit5(1e-7), 0.5)
        .cases(cases())
        .threads(threads)
        .run(|_, history| history.column("pull").unwrap_or_default().to_vec())
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let one = bits(&pulls(&lamp(), 1));
    assert_eq!(one.len(), 23);
    for threads in [2, 5] {
        assert_eq!(bits(&pulls(&lamp(), threads)), one, "{threads}");
    }
}

#[test]
fn a_case_alone_is_what_it_is_among_others() {
    let among = pulls(&lamp(), 2);
    for (number, case) in cases().enumerate().skip(7).step_by(5) {
        let alone = Batch::new(&lamp(), Options::tsit5(1e-7), 0.5)
            .cases([case])
            .numbered_from(number)
            .threads(1)
            .run(|_, history| history.column("pull").unwrap_or_default().to_vec());
        assert_eq!(bits(&alone), bits(&among[number..=number]));
    }
}

#[test]
fn a_case_that_cannot_be_run_is_a_result_in_its_place() {
    let all = pulls(&lamp(), 3);
    let numbers: Vec<usize> = all.iter().map(|finished| finished.case).collect();
    assert_eq!(numbers, (0..23).collect::<Vec<_>>());
    let failed: Vec<usize> = (0..23).filter(|case| all[*case].result.is_err()).collect();
    assert_eq!(failed, [2]);
    let failed = all[2].result.as_ref().expect_err("out of range");
    assert_eq!(failed.why.status(), "params");
    assert!(failed.to_string().contains("mass"), "{failed}");
    assert!(failed.time.is_nan() && failed.state.is_empty());
}

#[test]
fn generic_and_generated_batches_agree() {
    let generic = Generic::<f64>::with_defaults(Lamp::<f64>::scene()).expect("a scene");
    let (laws, code) = (pulls(&generic, 2), pulls(&lamp(), 2));
    for (laws, code) in laws.iter().zip(&code) {
        let [laws, code] =
            [laws, code].map(|it| it.result.as_ref().ok().and_then(|it| largest(Some(it))));
        // The third case cannot be run.
        match (laws, code) {
            (Some(laws), Some(code)) => assert!(code > 1.0 && (laws - code).abs() < 1e-4 * code),
            (laws, code) => assert_eq!(laws, code),
        }
    }
}

fn largest(column: Option<&[f64]>) -> Option<f64> {
    column?.iter().copied().reduce(f64::max)
}

#[test]
fn single_precision_flies_in_batches_too() {
    let single = Lamp::<f32>::new(LampParams::default()).expect("declared defaults");
    let masses = [1.0_f32, 2.0];
    let pulls = Batch::new(&single, Options::rk4(1e-3), 0.5)
        .cases(masses.map(|mass| Case::new().params([mass, 5000.0])))
        .threads(2)
        .run(|_, history| largest(history.column("pull")));
    let double = Batch::new(&lamp(), Options::rk4(1e-3), 0.5)
        .cases(masses.map(|mass| Case::new().params([f64::from(mass), 5000.0])))
        .run(|_, history| largest(history.column("pull")));
    for (single, double) in pulls.iter().zip(&double) {
        let single = single
            .result
            .as_ref()
            .ok()
            .copied()
            .flatten()
            .expect("a pull");
        let double = double
            .result
            .as_ref()
            .ok()
            .copied()
            .flatten()
            .expect("a pull");
        assert!(
            double > 1.0 && (single - double).abs() < 1e-2 * double,
            "{single} {double}"
        );
    }
}

fn stone() -> Stone {
    Stone::new(StoneParams::default()).expect("no params")
}

fn thrown(speed: f64) -> Case {
    Case::new().state(0.0, [0.0, 0.0, 0.0, 0.0, 0.0, speed])
}

/// z = v t − ½ g t².
#[test]
fn every_case_falls_along_its_own_parabola() {
    let speeds: Vec<f64> = (0..40).map(|k| 0.25 * f64::from(k)).collect();
    let heights = Batch::new(&stone(), Options::rk4(0.05), 1.5)
        .cases(speeds.iter().map(|speed| thrown(*speed)))
        .run(|_, history| history.column("height").map(|it| it[it.len() - 1]));
    for (finished, speed) in heights.iter().zip(&speeds) {
        let height = finished.result.as_ref().ok().copied().flatten();
        let height = height.expect("a height");
        assert!((height - (1.5 * speed - 11.25)).abs() < 1e-12);
    }
}

#[test]
fn a_batch_of_no_cases_has_no_results() {
    let batch = || Batch::new(&stone(), Options::rk4(0.05), 1.0);
    assert!(batch().run(|_, _| ()).is_empty());
    assert!(
        batch()
            .cases(Vec::new())
            .threads(4)
            .run(|_, _| ())
            .is_empty()
    );
}

#[test]
fn code_of_the_caller_that_panics_fails_its_own_case_alone() {
    let all = Batch::new(&stone(), Options::rk4(0.05), 1.0)
        .cases((0..9).map(|_| thrown(1.0)))
        .threads(2)
        .prepare(|case, run| {
            let number = case.number();
            run.control(move |sample, inputs: &mut StoneInputs| {
                assert!(number != 4 || sample.time < 0.5, "the hand slipped");
                inputs.push = 0.0;
            })
        })
        .run(|case, history| {
            assert!(case.number() != 6, "cannot be read");
            history.len()
        });
    let failed: Vec<usize> = (0..9).filter(|case| all[*case].result.is_err()).collect();
    assert_eq!(failed, [4, 6]);
    let slipped = all[4].result.as_ref().expect_err("it panicked");
    assert_eq!(slipped.why, Why::Panic("the hand slipped".into()));
    assert!((slipped.time - 0.45).abs() < 1e-12, "{}", slipped.time);
    // v = 1 m/s − g t: the last accepted step.
    assert!((slipped.state[5] - (1.0 - 4.5)).abs() < 1e-12);
}

#[test]
fn a_run_that_stops_leaves_its_last_good_state_and_its_reason() {
    let all = Batch::new(&stone(), Options::rk4(0.05), 1.0)
        .cases([thrown(1.0), thrown(f64::NAN), thrown(2.0)])
        .prepare(|case, run| {
            let number = case.number();
            run.control(move |sample, inputs: &mut StoneInputs| {
                let breaks = number == 2 && sample.time > 0.72;
                inputs.push = if breaks { f64::NAN } else { 0.0 };
            })
        })
        .run(|_, history| history.len());
    assert_eq!(all[0].result, Ok(21));
    let refused = all[1].result.as_ref().expect_err("NaN is no speed");
    assert_eq!(refused.why.status(), "range");
    let stopped = all[2].result.as_ref().expect_err("the push is no number");
    assert!(
        matches!(&stopped.why, Why::Run(error) if matches!(error.cause, StepError::NonFinite { .. }))
    );
    assert!((stopped.time - 0.7).abs() < 1e-12);
    assert!((stopped.state[5] - (2.0 - 7.0)).abs() < 1e-12);
    assert_eq!(all[2].statistics.steps, 14);
}

#[test]
fn a_batch_can_be_cancelled_and_keeps_what_is_done() {
    let switch = AtomicBool::new(false);
    let all = Batch::new(&stone(), Options::rk4(0.05), 1.0)
        .cases((0..1_000_000).map(|_| thrown(1.0)))
        .threads(3)
        .cancel(&switch)
        .progress(|tally| switch.store(tally.done >= 50, Ordering::Relaxed))
        .run(|_, history| history.len());
    assert!((50..200).contains(&all.len()), "{}", all.len());
    assert!(all.iter().all(|finished| finished.result == Ok(21)));
    // A switch that is on already: nothing is begun.
    let switch = AtomicBool::new(true);
    let none = Batch::new(&stone(), Options::rk4(0.05), 1.0)
        .cases([thrown(1.0)])
        .cancel(&switch)
        .run(|_, _| ());
    assert!(none.is_empty());
}

#[test]
fn cases_are_asked_for_as_threads_are_free_and_no_earlier() {
    let asked = AtomicUsize::new(0);
    let mut ahead = 0;
    let cases = (0..5000).map(|_| {
        asked.fetch_add(1, Ordering::Relaxed);
        thrown(1.0)
    });
    let mut seen = 0;
    let tally = Batch::new(&stone(), Options::rk4(0.1), 0.1)
        .cases(cases)
        .threads(2)
        .record(Sampling::Steps, Content::RESULTS)
        .each(
            |_, history| history.len(),
            |finished| {
                assert_eq!(finished.case, seen);
                seen += 1;
                ahead = ahead.max(asked.load(Ordering::Relaxed) - seen);
                ControlFlow::Continue(())
            },
        );
    assert_eq!((tally.done, tally.failed, seen), (5000, 0, 5000));
    assert_eq!(tally.expected, Some(5000));
    assert!(ahead <= 40, "{ahead} cases in memory");
}

#[test]
fn whoever_is_given_the_results_may_have_enough() {
    let mut seen = 0;
    Batch::new(&stone(), Options::rk4(0.1), 0.1)
        .cases((0..100).map(|_| thrown(1.0)))
        .threads(2)
        .each(
            |_, _| (),
            |_| {
                seen += 1;
                match seen {
                    7 => ControlFlow::Break(()),
                    _ => ControlFlow::Continue(()),
                }
            },
        );
    assert_eq!(seen, 7);
}

/// The words of a panic of this code.
fn words(code: impl FnOnce()) -> String {
    let words = catch_unwind(AssertUnwindSafe(code)).expect_err("it panics");
    let words = words.downcast::<&str>().expect("words as they stand here");
    (*words).to_owned()
}

#[test]
fn a_panic_of_who_is_given_the_results_or_gives_the_cases_ends_the_batch_with_its_words() {
    // More cases than may be under way: those who fly them wait for room when it happens.
    let cases = |bad: usize| {
        (0..5000).map(move |number| {
            assert!(number != bad, "no such case");
            thrown(1.0)
        })
    };
    let batch = || Batch::new(&stone(), Options::rk4(0.1), 0.1).threads(2);
    let mut seen = 0;
    let given = |finished: Finished<()>| {
        assert!(finished.case != 9, "enough of it");
        seen += 1;
        ControlFlow::Continue(())
    };
    let said = words(|| {
        batch().cases(cases(usize::MAX)).each(|_, _| (), given);
    });
    assert_eq!((said.as_str(), seen), ("enough of it", 9));

    let said = words(|| {
        let watched = batch().progress(|tally| assert!(tally.done < 9, "enough of it"));
        watched.cases(cases(usize::MAX)).run(|_, _| ());
    });
    assert_eq!(said, "enough of it");

    let said = words(|| {
        batch().cases(cases(40)).run(|_, _| ());
    });
    assert_eq!(said, "no such case");
}

#[test]
fn a_batch_flies_what_a_simulation_flies() {
    let alone = {
        let mut run = Simulation::new(&lamp(), Options::tsit5(1e-7)).expect("offered");
        run.run(0.5).expect("nothing stops it");
        run.state().to_vec()
    };
    let content = Content {
        state: true,
        ..Content::RESULTS
    };
    let ends = Batch::new(&lamp(), Options::tsit5(1e-7), 0.5)
        .cases([Case::new()])
        .record(Sampling::At(vec![0.5]), content)
        .run(|_, history| history.column("lamp.x").map(|x| x[x.len() - 1]));
    assert_eq!(ends[0].result, Ok(Some(alone[0])));
}
