//! What is found before the timed flights: tight references, largest stable steps, largest accurate steps. Nothing here is timed, so
//! all of it runs side by side.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use super::comparison::{END, EQUAL_ERROR, TIGHT, errors, grid, options, tight};
use super::scene::TestCase;
use super::stability::{StabilityLimit, largest_stable_step, largest_taut_step};
use super::variant::{Confluence, Flight, FlightError, FlightPlan, fly};

/// Something to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// The tight run of a model.
    Reference(TestCase, Confluence),
    /// The largest stable steps of a model.
    Limit(Confluence),
    /// The largest step at which a model is accurate in case 2.
    Accurate(Confluence),
}

/// What was found.
#[derive(Clone, Debug)]
pub enum Prepared {
    /// A tight run, sampled on the grid.
    Reference(Box<Flight>),
    /// Largest stable steps.
    Limit(StabilityLimit),
    /// A step [s] and its riser-force error from 2 s on [N].
    Accurate(f64, f64),
}

/// Finds everything, as many tasks at a time as there are processors. `tell` is called with each task that begins and the share begun.
///
/// # Errors
/// What stopped a flight that must not stop.
pub fn prepare(
    tasks: &[Task],
    weight: f64,
    mut tell: impl FnMut(&str, f64),
) -> Result<Vec<(Task, Prepared)>, FlightError> {
    let next = AtomicUsize::new(0);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let (send, receive) = mpsc::channel();
    let mut found: Vec<(usize, Result<Prepared, FlightError>)> = thread::scope(|scope| {
        for _ in 0..workers.min(tasks.len()) {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                while let Some((index, task)) = take(next, tasks) {
                    // The receiver outlives the scope; a failed send could only mean that nobody wants the result.
                    let _ = send.send((index, find(task, weight)));
                }
            });
        }
        drop(send);
        let mut found = Vec::with_capacity(tasks.len());
        for result in receive {
            found.push(result);
            let share = found.len() as f64 / tasks.len() as f64;
            tell("tight references and largest steps", share);
        }
        found
    });
    found.sort_by_key(|(index, _)| *index);
    let results = found.into_iter().map(|(_, found)| found);
    tasks
        .iter()
        .zip(results)
        .map(|(task, found)| Ok((*task, found?)))
        .collect()
}

fn take(next: &AtomicUsize, tasks: &[Task]) -> Option<(usize, Task)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    tasks.get(index).map(|task| (index, *task))
}

fn find(task: Task, weight: f64) -> Result<Prepared, FlightError> {
    match task {
        Task::Reference(case, confluence) => {
            let plan = FlightPlan::new(case, confluence, tight(TIGHT), END);
            fly(&plan.sampled(&grid())).map(|flight| Prepared::Reference(Box::new(flight)))
        }
        Task::Limit(confluence) => largest_stable_step(confluence).map(Prepared::Limit),
        Task::Accurate(confluence) => {
            accurate_step(confluence, weight).map(|(step, error)| Prepared::Accurate(step, error))
        }
    }
}

/// The largest of a sequence of steps (ratio 0.9) at which the riser force of case 2 is accurate from 2 s on, and its error.
fn accurate_step(confluence: Confluence, weight: f64) -> Result<(f64, f64), FlightError> {
    let times: Vec<f64> = (0..=136).map(|i| 2.0 + 0.5 * f64::from(i)).collect();
    let plan = |confluence, options| {
        FlightPlan::new(TestCase::Two, confluence, options, END).sampled(&times)
    };
    let exact = fly(&plan(confluence.exact(), tight(TIGHT)))?;
    let mut step = largest_taut_step(confluence)?;
    loop {
        if let Ok(flight) = fly(&plan(confluence, options(step, false))) {
            let error = errors(&flight, &exact)[1];
            if error <= EQUAL_ERROR * weight {
                return Ok((step, error));
            }
        }
        step *= 0.9;
    }
}
