//! The commands of `mbd`: what can be typed, and which file answers it.

mod campaign;
mod check;
mod compare;
mod convert;
mod expand;
mod extremes;
mod failure;
mod fmt;
mod grammar;
mod linearise;
mod list;
mod mistakes;
mod parachute;
mod phases;
mod run;
mod scene_file;
mod trade;
mod watch;

use std::ffi::OsString;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use campaign::SceneCampaignArgs;
use check::CheckArgs;
use compare::CompareArgs;
use convert::ConvertArgs;
use extremes::ExtremesArgs;
use failure::CommandFailure;
use fmt::FmtArgs;
use linearise::LineariseArgs;
use list::ListArgs;
use mbd_campaign::GatherArgs;
use mistakes::Paint;
use parachute::ParachuteArgs;
use run::RunArgs;
use trade::TradeArgs;
use watch::WatchArgs;

/// Multibody dynamics compiled from a declaration. Without a command it flies the parachute, the main job.
#[derive(Debug, Parser)]
#[command(
    name = "mbd",
    version,
    after_help = "Exit codes: 0 ok, 1 usage, 2 model or params invalid, 3 run done but less accurate than 1 %, or a requirement of a campaign is not shown, 4 run aborted."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Fly the parachute with every model of its confluence: report, figures, histories, summary (the default).
    Parachute(ParachuteArgs),
    /// List the ready scenes, or what can be asked of a scene.
    List(ListArgs),
    /// Run a scene: history, figures, report and summary.
    Run(RunArgs),
    /// Run several scenes, or one in several ways, and show on one page what differs.
    Compare(CompareArgs),
    /// Serve the page of a scene file on this machine, and run it again whenever the file is saved.
    Watch(WatchArgs),
    /// Linearise a scene about its start or its rest: minimal coordinates, eigenvalues with frequency and damping.
    Linearise(LineariseArgs),
    /// Race methods, tolerances and models of equilibrium points: error of a quantity against cost, and what to run for it.
    Trade(TradeArgs),
    /// What to run for a wanted accuracy: the advice of `trade` alone.
    Advise(TradeArgs),
    /// Run what is extreme: every number is right within its bound, or refused by a typed error.
    Extremes(ExtremesArgs),
    /// Run many cases of a scene with dispersed params, starts and inputs, or a shard of them.
    Campaign(SceneCampaignArgs),
    /// Put the results of all shards of a campaign together and tell what they say.
    Gather(GatherArgs),
    /// Write the page of a campaign: requirements, percentiles, histograms, drivers, failures.
    Report(GatherArgs),
    /// Check a scene and say what it contains: bodies, freedoms, nodes, operations.
    Check(CheckArgs),
    /// Print the Rust that `model!` makes of a scene.
    Expand(SceneArgs),
    /// Format scene files, and the declarations in files of Rust: blanks and ends of lines, nothing else.
    Fmt(FmtArgs),
    /// Print the language as a TextMate grammar, for editors.
    Grammar,
    /// Print a scene as TOML or as the text of a declaration, with the settings of its run.
    Convert(ConvertArgs),
}

/// A scene.
#[derive(Args, Debug)]
struct SceneArgs {
    /// A ready scene (`mbd list`), or a file: `.toml`, `.urdf`, or the text of a `model!` declaration in a file of any other name.
    scene: PathBuf,
}

/// Reads the arguments, does what they say, and tells how it went.
pub fn main() -> ExitCode {
    let text = answer(std::env::args_os());
    let Err(failure) = text.and_then(|text| print(&text, &mut std::io::stdout())) else {
        return ExitCode::SUCCESS;
    };
    // The exit code tells of the failure when a stream cannot.
    let _ = match &failure {
        CommandFailure::Told(text) | CommandFailure::Inaccurate(text) => {
            writeln!(std::io::stdout(), "{}", text.trim_end())
        }
        CommandFailure::Mistakes(mistakes) => {
            let colours = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
            let paint = Paint::of(std::io::stderr().is_terminal() && colours);
            writeln!(std::io::stderr(), "{}", mistakes.text(paint).trim_end())
        }
        failure => writeln!(std::io::stderr(), "{}", failure.to_string().trim_end()),
    };
    ExitCode::from(failure.code())
}

/// Writes the whole text. Nobody reading any more (`mbd list | head`) is no error; a full disk is.
fn print(text: &str, stream: &mut impl Write) -> Result<(), CommandFailure> {
    let written = stream
        .write_all(text.as_bytes())
        .and_then(|()| stream.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CommandFailure::Usage(format!(
            "cannot write the result to the standard output: {error}"
        ))),
        _ => Ok(()),
    }
}

/// The text a command prints.
fn answer(arguments: impl IntoIterator<Item = OsString>) -> Result<String, CommandFailure> {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return Err(CommandFailure::Usage(error.to_string())),
        Err(help) => return Ok(help.to_string()),
    };
    let command = cli.command.unwrap_or_else(|| {
        let args = ParachuteArgs::default();
        // Nobody reading it is no reason not to fly.
        let _ = writeln!(std::io::stderr(), "{}", parachute::announced(&args));
        Command::Parachute(args)
    });
    match command {
        Command::Parachute(args) => parachute::parachute(&args),
        Command::List(args) => list::list(&args),
        Command::Run(args) => run::run(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Watch(args) => watch::watch(&args),
        Command::Linearise(args) => linearise::linearise(&args),
        Command::Extremes(args) => extremes::extremes(&args),
        Command::Trade(args) => trade::trade(&args, false),
        Command::Advise(args) => trade::trade(&args, true),
        Command::Campaign(args) => campaign::campaign(&args),
        Command::Gather(args) => campaign::gather(&args),
        Command::Report(args) => campaign::report(&args),
        Command::Check(args) => check::check(&args),
        Command::Expand(args) => expand::expand(&args.scene),
        Command::Fmt(args) => fmt::fmt(&args),
        Command::Grammar => Ok(grammar::grammar()),
        Command::Convert(args) => convert::convert(&args),
    }
}

#[cfg(test)]
mod tests;
