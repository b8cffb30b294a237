//! The command line of campaigns: what can be typed, for `mbd` and for a user's own model alike.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::thread::available_parallelism;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use mbd_runtime::{Model, ParamError};

use crate::blocks::{self, Shard};
use crate::campaign::{Campaign, Resources};
use crate::failure::Failure;
use crate::page::page;
use crate::progress::Progress;
use crate::results::{Results, head};
use crate::run::Settings;
use crate::summary::{CONFIDENCE, Summary, Told};
use crate::table::heading;
use mbd_report::files;

/// Where a folder says how its cases are repeated.
const REPLAY: &str = "replay.txt";

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

/// The results of all shards, put together.
#[derive(Args, Clone, Debug)]
pub struct GatherArgs {
    /// Folder with the results.
    folder: PathBuf,
    /// How many shards there were: those with missing blocks are named.
    #[arg(long, value_name = "NUMBER")]
    shards: Option<u64>,
}

/// Runs a campaign, or a shard of it, and tells what came out. `replay` gives the command that repeats a case of a campaign file, without its number.
///
/// # Errors
/// What cannot be read, used or written; requirements that are not shown.
pub fn campaign(
    args: &CampaignArgs,
    model: Arc<dyn Model<f64>>,
    settings: Settings,
    replay: &dyn Fn(&Path) -> String,
) -> Result<String, Failure> {
    let campaign = Campaign::read(&args.file, model, settings)?;
    let folder = args.out.clone().unwrap_or_else(|| {
        let name = args.file.file_stem().unwrap_or_default();
        Path::new("out").join("campaign").join(name)
    });
    let shard = match &args.shard {
        None => Shard::WHOLE,
        Some(text) => Shard::find(text, |name| std::env::var(name).ok()).map_err(Failure::Usage)?,
    };
    let all_cores = available_parallelism().map_or(1, usize::from);
    let resources = Resources {
        threads: args.threads.unwrap_or(all_cores),
        lanes: args.lanes,
    };
    let done = blocks::run(
        &campaign,
        &folder,
        (shard, args.resume),
        resources,
        &mut Progress::new(),
    )?;
    let written = files::write_shared(&folder.join(REPLAY), &(replay(&args.file) + "\n"));
    written.map_err(|error| Failure::unwritten(&error))?;
    let told = format!(
        "{} cases run, {} of them did not reach their end, {} were there; written to {}\n",
        done.cases,
        done.failed,
        done.skipped,
        folder.display()
    );
    match shard {
        Shard::WHOLE => {
            let gathered = gather(&GatherArgs {
                folder,
                shards: None,
            });
            match gathered {
                Ok(text) => Ok(told + &text),
                Err(Failure::NotMet(text)) => Err(Failure::NotMet(told + &text)),
                Err(other) => Err(other),
            }
        }
        _ => Ok(told + "`gather` puts all shards together\n"),
    }
}

/// Puts the results of a folder together, and writes their page: `report.html` in it.
///
/// # Errors
/// Blocks are missing; the page cannot be written; requirements that are not shown.
pub fn report(args: &GatherArgs) -> Result<String, Failure> {
    let told = gather(args);
    let (Ok(text) | Err(Failure::NotMet(text))) = &told else {
        return told;
    };
    let results = Results::read(&args.folder)?;
    let path = args.folder.join("report.html");
    let page = page(
        &results,
        &Summary::of(&results),
        &replay_command(&args.folder),
    );
    page.write(&path)
        .map_err(|error| Failure::unwritten(&error))?;
    let text = format!("{text}\nwritten to {}\n", path.display());
    match told {
        Ok(_) => Ok(text),
        Err(_) => Err(Failure::NotMet(text)),
    }
}

/// The command that repeats a case of the campaign of a folder, without its number.
fn replay_command(folder: &Path) -> String {
    let known = std::fs::read_to_string(folder.join(REPLAY)).unwrap_or_default();
    match known.trim() {
        "" => "run FILE".to_owned(),
        known => known.to_owned(),
    }
}

/// Puts the results of a folder together, and tells what they say.
///
/// # Errors
/// Blocks are missing; requirements that are not shown.
pub fn gather(args: &GatherArgs) -> Result<String, Failure> {
    blocks::gather(&args.folder, args.shards)?;
    let results = Results::read(&args.folder)?;
    let summary = Summary::of(&results);
    let told = text(&results, &summary);
    match summary.passes() {
        true => Ok(told),
        false => Err(Failure::NotMet(told)),
    }
}

/// A summary as a text.
#[must_use]
pub fn text(results: &Results, summary: &Summary) -> String {
    let mut text = format!(
        "{}: {} cases beside the nominal; percentiles by order statistics, with intervals of {:.0} % confidence\n",
        results.manifest.model,
        summary.cases,
        100.0 * CONFIDENCE
    );
    for told in &summary.metrics {
        text += &metric(results, told);
    }
    for failures in &summary.failures {
        let first = failures.cases.first().copied().unwrap_or(0);
        text += &format!(
            "\n{} × {}: case {first}: {}\n",
            failures.cases.len(),
            failures.status,
            failures.why
        );
    }
    text
}

fn metric(results: &Results, told: &Told) -> String {
    let [mean, deviation] = told.moments;
    let mut text = format!(
        "\n{}\n  nominal {}, mean {}, standard deviation {}\n",
        heading(&told.name, &told.unit),
        digits(Some(told.nominal)),
        digits(Some(mean)),
        digits(Some(deviation))
    );
    if told.without > 0 {
        text += &format!(
            "  {} cases have no value and are left out of what follows\n",
            told.without
        );
    }
    for percentile in &told.percentiles {
        text += &format!(
            "  {:>8} %  {:>12}   from {} to {}\n",
            percent(percentile.part),
            digits(Some(percentile.value)),
            digits(percentile.low),
            digits(percentile.high)
        );
    }
    if let Some([low, high]) = told.ends
        && let (Some(smallest), Some(largest)) = (told.sorted.first(), told.sorted.last())
    {
        text += &format!(
            "  smallest {} (case {low}), largest {} (case {high})\n",
            digits(Some(*smallest)),
            digits(Some(*largest))
        );
    }
    if let Some(verdict) = &told.verdict {
        text += &format!("  {}\n", verdict.sentence(&told.name, &told.unit));
    }
    let drivers = told.drivers.iter().take(5).map(|driver| {
        let name = results
            .manifest
            .dispersed
            .get(driver.number)
            .map_or("", |column| &column.name);
        let share = driver.index.map(|index| format!(" {:.0} %", 100.0 * index));
        let share = share.unwrap_or_default();
        format!("{name} {:+.2}{share}", driver.correlation)
    });
    let drivers: Vec<String> = drivers.collect();
    match drivers.is_empty() {
        true => text,
        false => {
            text + &format!(
                "  driven by (rank correlation, share of the variance): {}\n",
                drivers.join(", ")
            )
        }
    }
}

impl crate::summary::Verdict {
    /// The requirement and what became of it, in one sentence.
    #[must_use]
    pub fn sentence(&self, name: &str, unit: &str) -> String {
        let bounds = [(self.require.below, "below"), (self.require.above, "above")];
        let bounds = bounds
            .into_iter()
            .filter_map(|(bound, word)| Some(format!("{word} {} {unit}", digits(Some(bound?)))));
        let bounds: Vec<String> = bounds.map(|text| text.trim_end().to_owned()).collect();
        let what = format!(
            "{name} {} in {} % of all cases with {} % confidence: {} of {} cases miss it",
            bounds.join(" and "),
            percent(self.require.share),
            percent(self.require.confidence),
            self.missed,
            self.of
        );
        let allowed = (1.0 - self.require.share) * self.of as f64;
        if self.shown {
            format!("shown: {what}")
        } else if self.missed as f64 > allowed {
            format!("NOT MET: {what}")
        } else {
            let needed = self.needed;
            format!(
                "NOT ENOUGH CASES: {what}, and {needed} cases with no more misses would show it"
            )
        }
    }
}

/// A part as percent, without rounding noise.
#[must_use]
fn percent(part: f64) -> String {
    let text = format!("{:.4}", 100.0 * part);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Five digits; `not enough cases` where there is no number.
fn digits(value: Option<f64>) -> String {
    match value {
        None => "(not enough cases)".to_owned(),
        Some(value) if value.is_nan() => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) => {
            let places = (4 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
            match (1e-4..1e7).contains(&value.abs()) {
                true => format!("{value:.places$}"),
                false => format!("{value:.4e}"),
            }
        }
    }
}

#[derive(Debug, Parser)]
#[command(
    after_help = "Exit codes: 0 ok, 1 usage, 2 model, params or campaign file invalid, 3 a requirement is not shown, 4 results are missing."
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the params: name, value, unit, range, what it is.
    List,
    /// Run one case of a campaign file again: its row, and its history as a file.
    Run(RunArgs),
    /// Run a campaign, or a shard of it.
    Campaign(CampaignArgs),
    /// Put the results of all shards together and tell what they say.
    Gather(GatherArgs),
    /// Write the page of a campaign: requirements, percentiles, histograms, drivers, failures.
    Report(GatherArgs),
}

#[derive(Args, Debug)]
struct RunArgs {
    /// The campaign file.
    file: PathBuf,
    /// The case; 0 is the nominal.
    #[arg(long, default_value_t = 0)]
    case: u64,
    /// Folder for history.csv [default: out/case].
    #[arg(long, value_name = "DIR", default_value = "out/case")]
    out: PathBuf,
}

/// The command line of a compiled model: the whole `main` of a program that runs campaigns of it.
///
/// ```no_run
/// use mbd_runtime::model;
///
/// model! {
///     /// A stone that falls.
///     model Stone {
///         gravity: [0.0, 0.0, -9.81] m/s^2;
///         param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
///         point stone { mass: mass, start at [0.0, 0.0, 100.0] m }
///         load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
///         output speed = norm(stone.velocity);
///     }
/// }
///
/// fn main() -> std::process::ExitCode {
///     mbd_campaign::main(Stone::new(StoneParams::default()))
/// }
/// ```
///
/// `program campaign dispersions.toml --out results --threads 8` then runs it, `program run dispersions.toml --case 17` repeats one case of it.
///
/// Of a model over any scalar, `model Stone<T> { … }`, cases are run beside each other in the lanes of one register, compiled for a processor that has them
/// (`RUSTFLAGS="-C target-cpu=native"`), where its equations are put at hand: `mbd_campaign::main(Stone::new(StoneParams::default()).map(InLanes::in_lanes))`
/// with [`mbd_runtime::InLanes`].
pub fn main(model: Result<impl Model<f64>, ParamError>) -> ExitCode {
    let told = model
        .map_err(|error| Failure::Invalid(error.to_string()))
        .and_then(|model| answer(std::env::args_os(), &model));
    // The exit code tells of the failure when a stream cannot.
    let (written, code) = match &told {
        Ok(text) => (write!(std::io::stdout(), "{text}"), 0),
        Err(Failure::NotMet(text)) => (write!(std::io::stdout(), "{text}"), 3),
        Err(failure) => (
            writeln!(std::io::stderr(), "{}", failure.to_string().trim_end()),
            failure.code(),
        ),
    };
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::from(1),
        _ => ExitCode::from(code),
    }
}

fn answer(
    arguments: impl IntoIterator<Item = OsString>,
    model: &dyn Model<f64>,
) -> Result<String, Failure> {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return Err(Failure::Usage(error.to_string())),
        Err(help) => return Ok(help.to_string()),
    };
    match cli.command {
        Command::List => Ok(params(model)),
        Command::Run(args) => run(&args, model.share()),
        Command::Campaign(args) => {
            let program = std::env::args().next().unwrap_or_default();
            let replay = |file: &Path| format!("{program} run {}", file.display());
            campaign(&args, model.share(), Settings::default(), &replay)
        }
        Command::Gather(args) => gather(&args),
        Command::Report(args) => report(&args),
    }
}

fn params(model: &dyn Model<f64>) -> String {
    let params = model.scene().params.iter().zip(model.params());
    let lines = params.map(|(param, value)| {
        let unit = &param.unit;
        let range = param
            .range
            .map_or(String::new(), |range| format!(", {range:?} in SI"));
        format!(
            "{} = {} {}{range}  {}\n",
            param.name,
            value / unit.factor,
            unit.text,
            param.doc.trim()
        )
    });
    lines.collect()
}

fn run(args: &RunArgs, model: Arc<dyn Model<f64>>) -> Result<String, Failure> {
    let campaign = Campaign::read(&args.file, model, Settings::default())?;
    let invalid = |error: crate::run::PlanError| {
        Failure::Invalid(format!("{}: {error}", args.file.display()))
    };
    let (row, history) = campaign.replay(args.case).map_err(invalid)?;
    let path = args.out.join("history.csv");
    files::make_folder(&args.out)
        .and_then(|()| files::write_whole(&path, |to| history.to_csv(to)))
        .map_err(|error| Failure::unwritten(&error))?;
    let told = format!(
        "{}\n{}\nwritten to {}\n",
        head(&campaign.manifest()),
        row.line(),
        path.display()
    );
    match row.status.as_str() {
        "ok" => Ok(told),
        _ => Err(Failure::Aborted(told)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_numbers_are_told_with_the_digits_they_have() {
        assert_eq!(
            [0.99865, 0.5, 0.00135].map(percent),
            ["99.865", "50", "0.135"]
        );
        assert_eq!(digits(Some(12345.678)), "12346");
        assert_eq!(digits(Some(-0.012_345_678)), "-0.012346");
        assert_eq!(digits(Some(1.5e9)), "1.5000e9");
        assert_eq!(digits(None), "(not enough cases)");
    }
}
