//! A folder of results: the cases in blocks, a file each, that no number of shards, threads or interruptions changes.
//!
//! Shard I of N runs blocks I − 1, I − 1 + N, …. A file is written under another name and renamed when it is whole, so what is there is right: a run
//! that goes on skips it, two processes on one shard write the same bytes, and nothing is locked.

use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::campaign::{Campaign, FlownCase, Resources};
use crate::envelopes::{self, Envelope};
use crate::failure::Failure;
use crate::manifest::Manifest;
use crate::progress::ProgressLine;
use crate::results::{CaseRow, head, join};
use crate::table::{counted, number};
use mbd_report::files;

/// A part of a campaign: which, from 1, of how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1.
    pub index: u64,
    /// Of how many.
    pub of: u64,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { index: 1, of: 1 };

    /// A shard as it is written, `3/8`; of `/8` the number comes from the scheduler's variables.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn find(text: &str, variable: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        match text.strip_prefix('/') {
            None => text.parse(),
            Some(of) => {
                // Kubernetes counts from zero, the others as the array was written.
                let schedulers = [
                    ("SLURM_ARRAY_TASK_ID", 0),
                    ("HQ_TASK_ID", 0),
                    ("JOB_COMPLETION_INDEX", 1),
                ];
                let found = schedulers
                    .iter()
                    .find_map(|(name, add)| Some((variable(name)?, add)));
                let Some((number, add)) = found else {
                    return Err(format!(
                        "`{text}` needs one of SLURM_ARRAY_TASK_ID, HQ_TASK_ID, JOB_COMPLETION_INDEX; or write it as 3/{of}"
                    ));
                };
                let index = number
                    .parse::<u64>()
                    .map_err(|_| format!("`{number}` is no number of a shard"))?;
                format!("{}/{of}", index + add).parse()
            }
        }
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('/')
            .and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((index, of)) if (1..=of).contains(&index) => Ok(Shard { index, of }),
            _ => Err(format!(
                "`{text}` is no shard: write it as 3/8, from 1/8 to 8/8"
            )),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

fn block_file(folder: &Path, block: u64) -> PathBuf {
    folder.join("blocks").join(format!("{block:08}.csv"))
}

/// What to do where a file of a block is not what its campaign writes: the block is there as long as its rows are, and flown where they are not.
pub(crate) fn fly_again(folder: &Path, block: u64) -> String {
    format!(
        "take {} away, and go on with --resume",
        block_file(folder, block).display()
    )
}

fn wall_file(folder: &Path, block: u64) -> PathBuf {
    folder.join("seconds").join(format!("{block:08}.csv"))
}

/// What a shard did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Cases that were run.
    pub cases: u64,
    /// Those of them that did not reach their end.
    pub failed: u64,
    /// Those that did, where a metric or an output is no finite number.
    pub not_finite: u64,
    /// Those that did, but whose run made or lost too much energy.
    pub unbalanced: u64,
    /// Those that did, where a metric is not resolved.
    pub unresolved: u64,
    /// Those that did inside the window of a metric.
    pub partial: u64,
    /// Cases that were there already.
    pub skipped: u64,
    /// Steps that were tried.
    pub steps: u64,
    /// Those of them that were tried in lanes, beside those of other cases.
    pub beside: u64,
}

/// Runs the blocks of a shard that are not in the folder yet.
///
/// # Errors
/// The folder holds another campaign, or blocks of this shard where none were expected (`resume`); a file cannot be written.
pub fn run(
    campaign: &Campaign,
    folder: &Path,
    (shard, resume): (Shard, bool),
    resources: Resources,
    progress: &mut ProgressLine,
) -> Result<Done, Failure> {
    let manifest = campaign.manifest();
    let parts = ["", "blocks", "seconds"].into_iter();
    for part in parts.chain(manifest.envelopes.iter().map(|_| "envelopes")) {
        files::make_folder(&folder.join(part)).map_err(|error| Failure::unwritten(&error))?;
    }
    manifest.claim(folder)?;
    let own = (shard.index - 1..manifest.blocks()).step_by(shard.of as usize);
    let (there, missing): (Vec<u64>, Vec<u64>) =
        own.partition(|block| block_file(folder, *block).is_file());
    if !there.is_empty() && !resume {
        return Err(Failure::Usage(format!(
            "{} holds {} of the {} blocks of shard {shard} already: go on with --resume, or take another folder",
            folder.display(),
            there.len(),
            there.len() + missing.len()
        )));
    }
    let skipped = there
        .iter()
        .map(|block| manifest.cases_of(*block).count() as u64)
        .sum();
    let mut done = Done {
        skipped,
        ..Done::default()
    };
    let all: usize = missing
        .iter()
        .map(|block| manifest.cases_of(*block).count())
        .sum();
    // Every block but the last one of all has as many cases as the first.
    let size = manifest.cases_of(0).count().max(1);
    let case_at =
        |place: usize| manifest.cases_of(missing[place / size]).start + (place % size) as u64;
    let mut written = OpenBlock::default();
    let mut waiting = missing.iter().copied().peekable();
    let mut unwritten = None;
    campaign.run(all, &case_at, resources, |flown| {
        done.add(&flown);
        progress.show(
            done.cases as f64 / all as f64,
            &format!(
                "{} of {}, {} failed",
                done.cases,
                counted(all as u64, "case"),
                done.failed
            ),
        );
        let case = flown.row.case;
        written.add(&manifest, &flown);
        let Some(&block) = waiting.peek() else {
            return ControlFlow::Break(());
        };
        if case + 1 < manifest.cases_of(block).end {
            return ControlFlow::Continue(());
        }
        waiting.next();
        match written.write_files(&manifest, folder, block) {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                unwritten = Some(error);
                ControlFlow::Break(())
            }
        }
    });
    progress.clear();
    match unwritten {
        Some(error) => Err(Failure::unwritten(&error)),
        None => Ok(done),
    }
}

/// A block that is under way.
#[derive(Default)]
struct OpenBlock {
    rows: String,
    seconds: String,
    numbers: envelopes::CaseBlock,
}

impl OpenBlock {
    fn add(&mut self, manifest: &Manifest, flown: &FlownCase) {
        let row = &flown.row;
        self.rows += &(row.line() + "\n");
        self.seconds += &format!("{},{}\n", row.case, number(flown.seconds));
        if let Some(envelopes) = &manifest.envelopes {
            self.numbers.push(envelopes, flown.numbers.as_deref());
        }
    }

    /// Writes it, and is empty. The rows last: where they are, everything is.
    fn write_files(&mut self, manifest: &Manifest, folder: &Path, block: u64) -> io::Result<()> {
        files::write_shared(&wall_file(folder, block), std::mem::take(&mut self.seconds))?;
        if let Some(envelopes) = &manifest.envelopes {
            let numbers = self.numbers.take(envelopes);
            files::write_shared(&envelopes::path(folder, block), numbers)?;
        }
        files::write_shared(&block_file(folder, block), std::mem::take(&mut self.rows))
    }
}

impl Done {
    fn add(&mut self, flown: &FlownCase) {
        let [steps, beside] = flown.steps;
        self.cases += 1;
        self.failed += u64::from(!flown.row.reached_end());
        self.not_finite += u64::from(flown.row.status == CaseRow::NOT_FINITE);
        self.unbalanced += u64::from(flown.row.status == CaseRow::UNBALANCED);
        self.unresolved += u64::from(flown.row.status == CaseRow::UNRESOLVED);
        self.partial += u64::from(flown.row.status == CaseRow::PARTIAL);
        self.steps += steps;
        self.beside += beside;
    }
}

/// Numbers as ranges: `1-3,7`.
fn ranges(numbers: &[u64]) -> String {
    let mut parts: Vec<[u64; 2]> = Vec::new();
    for &number in numbers {
        match parts.last_mut() {
            Some([_, last]) if *last + 1 == number => *last = number,
            _ => parts.push([number, number]),
        }
    }
    let told: Vec<String> = parts
        .into_iter()
        .map(|[first, last]| match first == last {
            true => first.to_string(),
            false => format!("{first}-{last}"),
        })
        .collect();
    told.join(",")
}

/// Puts all blocks of a folder together: `cases.csv`, `seconds.csv` with the time each case took on the clock, and `envelopes.csv`, which are handed back. `shards` is how many the campaign
/// was begun with, to tell which of them have to run again.
///
/// # Errors
/// Blocks are missing; a file cannot be written.
pub fn gather(folder: &Path, shards: Option<u64>) -> Result<Vec<Envelope>, Failure> {
    let manifest = Manifest::read(folder)?;
    let blocks = 0..manifest.blocks();
    let missing: Vec<u64> = blocks
        .clone()
        .filter(|block| !block_file(folder, *block).is_file())
        .collect();
    if !missing.is_empty() {
        let no_shards = || {
            "; run the campaign again with --resume; of shards `--shards` with how many there are tells which"
                .to_owned()
        };
        let again = shards.filter(|of| *of > 0).map_or_else(no_shards, |of| {
            let mut again: Vec<u64> = missing.iter().map(|block| block % of + 1).collect();
            again.sort_unstable();
            again.dedup();
            format!("; run again: --array={}", ranges(&again))
        });
        return Err(Failure::Aborted(format!(
            "{}: {} of {} blocks are missing ({}){again}",
            folder.display(),
            missing.len(),
            blocks.end,
            ranges(&missing)
        )));
    }
    let join_all = |name: &str, head: &str, file: fn(&Path, u64) -> PathBuf| {
        let paths: Vec<PathBuf> = blocks.clone().map(|block| file(folder, block)).collect();
        let paths = paths
            .iter()
            .map(PathBuf::as_path)
            .filter(|path| path.is_file());
        files::write_whole(&folder.join(name), |to| join(head, paths, to))
    };
    join_all("seconds.csv", "case,seconds [s]", wall_file)
        .and_then(|()| join_all("cases.csv", &head(&manifest), block_file))
        .map_err(|error| Failure::unwritten(&error))?;
    let told = envelopes::told(folder, &manifest)
        .map_err(|error| Failure::Usage(format!("cannot read {error}")))?;
    if !told.is_empty() {
        files::write_whole(&folder.join("envelopes.csv"), |to| {
            envelopes::table(&told, to)
        })
        .map_err(|error| Failure::unwritten(&error))?;
    }
    Ok(told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_one_and_schedulers_number_them() {
        assert_eq!("3/8".parse(), Ok(Shard { index: 3, of: 8 }));
        for text in ["0/8", "9/8", "3", "a/b", "-1/2", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        let under = |name: &'static str, value: &'static str| {
            Shard::find("/8", move |asked| (asked == name).then(|| value.to_owned()))
        };
        assert_eq!(
            under("SLURM_ARRAY_TASK_ID", "5"),
            Ok(Shard { index: 5, of: 8 })
        );
        assert_eq!(under("HQ_TASK_ID", "8"), Ok(Shard { index: 8, of: 8 }));
        assert_eq!(
            under("JOB_COMPLETION_INDEX", "0"),
            Ok(Shard { index: 1, of: 8 })
        );
        assert!(under("PBS_ARRAYID", "1").is_err());
    }

    #[test]
    fn numbers_are_told_as_ranges() {
        assert_eq!(ranges(&[5, 17, 18, 19, 30]), "5,17-19,30");
        assert_eq!(ranges(&[]), "");
    }
}
