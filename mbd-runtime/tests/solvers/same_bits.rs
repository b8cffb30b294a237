//! Batches flown with other lanes and threads, and the bits of their results.

use mbd_runtime::{Batch, Beside, Case, Content, Finished, Model, Options, Sampling};

/// A result but what the clock says and how it was made.
pub type Bits = (usize, Result<Vec<u64>, String>, String);

/// What is the same wherever a case is flown.
pub fn bits(finished: &[Finished<Vec<f64>>]) -> Vec<Bits> {
    let of = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let one = |it: &Finished<Vec<f64>>| {
        let result = match &it.result {
            Ok(columns) => Ok(of(columns)),
            Err(failed) => Err(format!(
                "{} {:?} {}",
                failed.time,
                of(&failed.state),
                failed.why
            )),
        };
        (it.case, result, format!("{:?}", it.statistics))
    };
    finished.iter().map(one).collect()
}

/// All columns, one after the other, the times of the events, and the metrics.
pub fn fly(
    model: &dyn Model<f64>,
    options: Options,
    sampling: Sampling,
    cases: impl Iterator<Item = Case> + Send,
    (threads, lanes): (usize, usize),
) -> Vec<Finished<Vec<f64>>> {
    Batch::new(model, options, 2.0)
        .cases(cases)
        .threads(threads)
        .lanes(lanes)
        .record(sampling, Content::ALL)
        .run(|_, history| {
            let columns = history
                .names()
                .iter()
                .filter_map(|name| history.column(&name.name));
            let events = history.events.iter().map(|(time, _)| *time);
            let metrics = history.metrics(model.scene()).into_iter();
            let metrics = metrics.map(|metric| metric.value.unwrap_or(f64::NAN));
            let columns = columns.flatten().copied();
            columns.chain(events).chain(metrics).collect()
        })
}

/// Whatever the lanes and the threads; at least this part of the steps is made in lanes.
pub fn assert_same_bits<C: Iterator<Item = Case> + Send>(
    model: &Beside,
    options: &[Options],
    at_least: f64,
    cases: impl Fn() -> C,
) {
    for options in options {
        for sampling in [Sampling::Steps, Sampling::Every(0.013)] {
            let fly = |threads, lanes| {
                let sampling = sampling.clone();
                fly(model, *options, sampling, cases(), (threads, lanes))
            };
            let alone = fly(1, 1);
            assert!(alone.iter().all(|it| it.beside == 0));
            assert!(
                alone.iter().any(|it| it.result.is_ok()),
                "{:?}",
                alone[0].result
            );
            for (threads, lanes) in [(1, 4), (2, 4), (5, 8)] {
                let beside = fly(threads, lanes);
                assert_eq!(bits(&beside), bits(&alone), "{options:?} {threads} {lanes}");
            }
            let eight = fly(1, 8);
            assert_eq!(bits(&eight), bits(&alone), "{options:?} 1 8");
            let of = |of: fn(&Finished<Vec<f64>>) -> u64| eight.iter().map(of).sum::<u64>();
            let (steps, beside) = (of(|it| it.statistics.steps), of(|it| it.beside));
            println!("{options:?}: {beside} of {steps} steps beside each other");
            let part = beside as f64 / steps as f64;
            assert!(part > at_least, "{options:?}: {beside} of {steps}");
        }
    }
}
