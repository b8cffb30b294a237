//! The commands of campaigns: what can be typed, for `mbd` and for a user's own model alike.

mod accuracy;
mod program;
mod source;
mod told;

use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::blocks::{self, Done, Shard};
use crate::campaign::{Campaign, Resources};
use crate::failure::Failure;
use crate::histories::{self, Chosen};
use crate::page::Page;
use crate::progress::ProgressLine;
use crate::results::{CaseRow, Results};
use crate::run::Phase;
use crate::summary::CampaignSummary;
use crate::table::counted;
use mbd_report::files;

pub use program::main;
pub use source::ResultSource;
pub use told::text;

/// What to disperse, and where the results go.
#[derive(Args, Clone, Debug)]
pub struct CampaignArgs {
    /// The campaign file: what is dispersed, what is read from every run, how it is run.
    file: PathBuf,
    /// Folder for the results [default: out/campaign/NAME of the campaign file].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Run a part of it alone, `3/8`; `/8` takes its number from SLURM_ARRAY_TASK_ID, HQ_TASK_ID or JOB_COMPLETION_INDEX.
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,
    /// On so many threads [default: all cores].
    #[arg(long, value_name = "NUMBER")]
    threads: Option<usize>,
    /// So many cases beside each other on each thread, in the lanes of one register, where the model has its equations over lanes at hand; the results
    /// do not depend on it [default: what the program is compiled for: 8 with AVX-512, 4 with AVX, else 1].
    #[arg(long, value_parser = PossibleValuesParser::new(["1", "4", "8"]).try_map(|lanes| lanes.parse::<usize>()))]
    lanes: Option<usize>,
    /// Go on with what is in the folder already.
    #[arg(long)]
    resume: bool,
}

impl CampaignArgs {
    /// The campaign file.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }
}

/// The results of all shards, put together.
#[derive(Args, Clone, Debug)]
pub struct GatherArgs {
    /// Folder with the results.
    pub folder: PathBuf,
    /// How many shards there were: those with missing blocks are named.
    #[arg(long, value_name = "NUMBER")]
    pub shards: Option<u64>,
}

/// Runs a campaign, or a shard of it, and tells what came out. Its runs begin in a scene, and go on in others `later` where events say so; `source` says where the
/// campaign of a file is from.
///
/// # Errors
/// What cannot be read, used or written; requirements that are not shown.
pub fn campaign(
    args: &CampaignArgs,
    (first, later): (Phase, Vec<Phase>),
    source: &dyn Fn(&Path) -> ResultSource,
) -> Result<String, Failure> {
    let has_lanes = first.model.beside().is_some();
    let campaign = Campaign::read_phases(&args.file, first, later)?;
    let folder = args.out.clone().unwrap_or_else(|| {
        let name = args.file.file_stem().unwrap_or_default();
        Path::new("out").join("campaign").join(name)
    });
    let shard = match &args.shard {
        None => Shard::WHOLE,
        Some(text) => Shard::find(text, |name| std::env::var(name).ok()).map_err(Failure::Usage)?,
    };
    let resources = Resources {
        threads: args.threads.unwrap_or_else(all_cores),
        lanes: args.lanes,
    };
    let done = blocks::run(
        &campaign,
        &folder,
        (shard, args.resume),
        resources,
        &mut ProgressLine::new(),
    )?;
    source(&args.file).write(&folder)?;
    let beyond: String = campaign
        .beyond()
        .iter()
        .map(|text| format!("{text}\n"))
        .collect();
    let told = format!(
        "{beyond}{} run, {} of them did not reach {}{}, {} {} there; written to {}\n{}",
        counted(done.cases, "case"),
        done.failed,
        if done.failed == 1 {
            "its end"
        } else {
            "their end"
        },
        doubtful(&done),
        done.skipped,
        if done.skipped == 1 { "was" } else { "were" },
        folder.display(),
        in_lanes(&done, args.lanes, has_lanes)
    );
    match shard {
        Shard::WHOLE => {
            let gathered = Gathered::of(&GatherArgs {
                folder,
                shards: None,
            })?;
            let accuracy = accuracy::accuracy(campaign, &gathered.results, resources);
            let told = format!(
                "{told}{}\n{}",
                text(&gathered.results, &gathered.summary),
                accuracy.text
            );
            match accuracy.is_large {
                true => Err(Failure::NotMet(told)),
                false => gathered.end(told),
            }
        }
        _ => Ok(format!(
            "{told}`gather` puts all shards together\n{}",
            accuracy::unestimated("a shard has a part of them only")
        )),
    }
}

/// Who estimates the error of cases that are there already.
const ELSEWHERE: &str =
    "`campaign` with this folder and `--resume` flies a few of them again and tells it";

fn all_cores() -> usize {
    available_parallelism().map_or(1, usize::from)
}

/// How many cases have what is no finite number, or a metric that is not resolved or of a part of its window, where some do.
fn doubtful(done: &Done) -> String {
    let told = [
        (
            done.not_finite,
            "a metric or an output that is no finite number",
        ),
        (
            done.unbalanced,
            "energy made or lost by its steps (`why` in cases.csv)",
        ),
        (
            done.unresolved,
            "a metric that is not resolved (`why` in cases.csv)",
        ),
        (
            done.partial,
            "a metric of a part of its window only (`why` in cases.csv)",
        ),
    ];
    let told = told.into_iter().filter(|(cases, _)| *cases > 0);
    told.map(|(cases, what)| format!(", {cases} reached it with {what}"))
        .collect()
}

/// What became of lanes that were asked for.
fn in_lanes(done: &Done, lanes: Option<usize>, has_lanes: bool) -> String {
    match lanes {
        None | Some(1) => String::new(),
        Some(_) if done.steps == 0 => String::new(),
        Some(lanes) if done.beside == 0 => {
            let why = match has_lanes {
                true => {
                    "none of its steps is one that is made in lanes (docs/campaigns.md says which are)"
                }
                false => {
                    "this model does not have its equations over lanes at hand: a scene file has them (`mbd convert` writes one), and a compiled model by `in_lanes`"
                }
            };
            format!("--lanes {lanes} had no effect, the numbers are the same: {why}\n")
        }
        Some(lanes) => {
            let share = 100.0 * done.beside as f64 / done.steps as f64;
            format!("{share:.0} % of all steps were made in {lanes} lanes\n")
        }
    }
}

/// What the results of a folder say.
struct Gathered {
    results: Results,
    summary: CampaignSummary,
    envelopes: Vec<crate::envelopes::Envelope>,
}

impl Gathered {
    /// Puts all shards together.
    fn of(args: &GatherArgs) -> Result<Self, Failure> {
        let envelopes = blocks::gather(&args.folder, args.shards)?;
        let results = Results::read(&args.folder)?;
        let file = args.folder.join("cases.parquet");
        files::write_whole(&file, |to| results.to_parquet(to))
            .map_err(|error| Failure::unwritten(&error))?;
        Ok(Gathered {
            summary: CampaignSummary::of(&results),
            results,
            envelopes,
        })
    }

    /// A text, as the requirements have it; nothing is shown by steps that make or lose energy.
    fn end(&self, told: String) -> Result<String, Failure> {
        let mut rows = self.results.rows.iter();
        let is_kept = !rows.any(|row| row.status == CaseRow::UNBALANCED);
        match self.summary.passes() && is_kept {
            true => Ok(told),
            false => Err(Failure::NotMet(told)),
        }
    }
}

/// Puts the results of a folder together, and tells what they say.
///
/// # Errors
/// Blocks are missing; requirements that are not shown.
pub fn gather(args: &GatherArgs) -> Result<String, Failure> {
    let gathered = Gathered::of(args)?;
    let told = text(&gathered.results, &gathered.summary);
    gathered.end(format!("{told}\n{}", accuracy::unestimated(ELSEWHERE)))
}

/// Puts the results of a folder together, keeps the histories that the campaign file chooses, and writes the page: `report.html`. `reopen` gives the
/// campaign of a source, of which the nominal and missing histories are flown again.
///
/// # Errors
/// Blocks are missing; a file cannot be written; requirements that are not shown. Where histories are missing that cannot be flown again the page is
/// written without them.
pub fn report(
    args: &GatherArgs,
    reopen: &dyn Fn(&ResultSource) -> Result<Campaign, Failure>,
) -> Result<String, Failure> {
    let folder = &args.folder;
    let gathered = Gathered::of(args)?;
    let source = ResultSource::read(folder);
    let results = &gathered.results;
    let chosen = results.manifest.told.histories.of(results);
    let opened = source.as_ref().map_err(Clone::clone).and_then(|source| {
        let campaign = reopen(source)?;
        campaign.manifest().find(folder)?;
        Ok((campaign, source.command.as_str()))
    });
    let kept = keep_histories(folder, results, &chosen, &opened);
    let nominal = match &opened {
        Ok((campaign, _)) => histories::flown_again((campaign, results), 0, folder),
        Err(why) => Err(why.to_string()),
    };
    let page = Page {
        folder,
        replay: source.as_ref().map_or("run FILE", |source| &source.command),
        envelopes: &gathered.envelopes,
        chosen: &chosen,
        nominal: nominal.as_ref().map(|(_, parts)| parts.as_slice()),
    };
    let written = page.write(results, &gathered.summary);
    let pictures = written.map_err(|error| Failure::unwritten(&error))?;
    let told = text(results, &gathered.summary);
    let told = format!(
        "{told}\nwritten to {}: report.html{}\n{}",
        folder.display(),
        pictures
            .iter()
            .map(|name| format!(", {name}"))
            .collect::<String>(),
        accuracy::unestimated(ELSEWHERE)
    );
    match kept {
        Err(Failure::Aborted(why)) => Err(Failure::Aborted(format!("{told}{why}\n"))),
        Err(other) => Err(other),
        Ok(()) => gathered.end(told),
    }
}

/// Flies the chosen cases again whose histories are not there.
fn keep_histories(
    folder: &Path,
    results: &Results,
    chosen: &[Chosen],
    opened: &Result<(Campaign, &str), Failure>,
) -> Result<(), Failure> {
    let missing = histories::missing(folder, results, chosen);
    if missing.is_empty() {
        return Ok(());
    }
    let (campaign, command) = opened.as_ref().map_err(|why| {
        Failure::Aborted(format!(
            "{} histories are missing, because the campaign cannot be flown again here: {why}",
            missing.len()
        ))
    })?;
    histories::write(
        (campaign, results),
        &missing,
        (folder, command),
        all_cores(),
        &mut ProgressLine::new(),
    )
}
