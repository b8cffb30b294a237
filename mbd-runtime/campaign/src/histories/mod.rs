//! Histories of chosen cases: `case_000017.csv` with the columns of `mbd run`, `case_000017.parquet` with the same numbers, and `case_000017.html`, its page.
//!
//! Which cases are worst is known when all are there: they are flown again then, which gives the numbers of their rows to the bit.

mod choice;
mod page;

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::campaign::{Campaign, CasePart};
use crate::failure::Failure;
use crate::parquet;
use crate::progress::ProgressLine;
use crate::results::{CaseRow, Results};
use mbd_report::files;

pub use choice::{Choice, Chosen};
pub(crate) use page::with_motion;

/// Their folder in a folder of results.
const FOLDER: &str = "histories";

/// The history of a case, as it is reached from the folder of results.
#[must_use]
pub fn history_of(case: u64) -> String {
    format!("{FOLDER}/case_{case:06}.csv")
}

/// The page of a case, as it is reached from the folder of results.
#[must_use]
pub fn page_of(case: u64) -> String {
    format!("{FOLDER}/case_{case:06}.html")
}

/// The page of a part of a case that came to several scenes, by its number from 1, as it is reached from the folder of results.
#[must_use]
pub fn part_of(case: u64, part: usize) -> String {
    format!("{FOLDER}/case_{case:06}_{part}.html")
}

/// Whether history and page of a case are in a folder of results. The page is written last: where it is, both are.
#[must_use]
pub fn is_there(folder: &Path, case: u64) -> bool {
    folder.join(page_of(case)).is_file()
}

/// Whether a case has a history: it has none where its run could not begin.
#[must_use]
pub fn can_be(results: &Results, case: u64) -> bool {
    let row = usize::try_from(case)
        .ok()
        .and_then(|case| results.rows.get(case));
    row.is_some_and(|row| !row.time.is_nan())
}

/// The chosen cases whose histories are not in a folder of results yet.
pub fn missing<'c>(folder: &Path, results: &Results, chosen: &'c [Chosen]) -> Vec<&'c Chosen> {
    let all = chosen.iter().filter(|chosen| can_be(results, chosen.case));
    all.filter(|chosen| !is_there(folder, chosen.case))
        .collect()
}

/// Flies cases again, on so many threads, and writes their histories and pages into a folder of results. `replay` is the command that repeats a case,
/// without its number.
///
/// # Errors
/// A file cannot be written; a case flown again is not the row that is there.
pub fn write(
    (campaign, results): (&Campaign, &Results),
    chosen: &[&Chosen],
    (folder, replay): (&Path, &str),
    threads: usize,
    progress: &mut ProgressLine,
) -> Result<(), Failure> {
    files::make_folder(&folder.join(FOLDER)).map_err(|error| Failure::unwritten(&error))?;
    let waiting: Mutex<VecDeque<&Chosen>> = Mutex::new(chosen.iter().copied().collect());
    let next = || {
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.pop_front()
    };
    let stop = || {
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.clear();
    };
    let work = |told: std::sync::mpsc::Sender<Result<(), Failure>>| {
        while let Some(chosen) = next() {
            let written = write_one((campaign, results), chosen, (folder, replay));
            if written.is_err() {
                stop();
            }
            // Who collects waits for all of us.
            let _ = told.send(written);
        }
    };
    let (told, results) = std::sync::mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, chosen.len().max(1)) {
            let told = told.clone();
            scope.spawn(|| work(told));
        }
        drop(told);
        let mut failure = None;
        for (done, written) in (1..).zip(results) {
            let share = done as f64 / chosen.len() as f64;
            progress.show(share, &format!("{done} of {} histories", chosen.len()));
            if let Err(error) = written {
                failure.get_or_insert(error);
            }
        }
        progress.clear();
        failure.map_or(Ok(()), Err)
    })
}

/// A case flown again: its row, and the scenes that its run came to.
///
/// # Errors
/// There is no such case; what comes out is not the row that is there.
pub(crate) fn flown_again(
    (campaign, results): (&Campaign, &Results),
    case: u64,
    folder: &Path,
) -> Result<(CaseRow, Vec<CasePart>), String> {
    let (row, parts) = campaign
        .replay_parts(case)
        .map_err(|error| error.to_string())?;
    let there = usize::try_from(case)
        .ok()
        .and_then(|case| results.rows.get(case));
    let there = there.map(CaseRow::line).unwrap_or_default();
    if there != row.line() {
        return Err(format!(
            "case {case} flown again is not its row in {}: other equations, or another kind of processor\n  there {there}\n  here  {}",
            folder.display(),
            row.line()
        ));
    }
    Ok((row, parts))
}

fn write_one(
    (campaign, results): (&Campaign, &Results),
    chosen: &Chosen,
    (folder, replay): (&Path, &str),
) -> Result<(), Failure> {
    let case = chosen.case;
    let (row, parts) = flown_again((campaign, results), case, folder).map_err(Failure::Invalid)?;
    let history = campaign.whole(&parts);
    let pages = page::pages(campaign, (&row, &parts, &history), chosen, replay);
    let csv = folder.join(history_of(case));
    files::write_whole(&csv, |to| history.to_csv(to))
        .and_then(|()| {
            files::write_whole(&csv.with_extension("parquet"), |to| {
                parquet::write_history(to, &history)
            })
        })
        .and_then(|()| {
            let mut pages = pages.iter();
            pages.try_for_each(|(file, page)| page.write(folder.join(file)))
        })
        .map_err(|error| Failure::unwritten(&error))
}
