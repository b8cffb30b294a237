//! The main job: the parachute, flown with every model of its confluence.

use std::path::PathBuf;

use clap::Args;
use mbd_campaign::progress::ProgressLine;
use models::parachute::{self, scene, study, summary};

use super::failure::CommandFailure;

/// Where the results of the main job go.
#[derive(Args, Debug)]
pub struct ParachuteArgs {
    /// Folder for report, figures, histories and summary.
    #[arg(long, value_name = "DIR", default_value = "out/parachute")]
    out: PathBuf,
}

impl Default for ParachuteArgs {
    fn default() -> Self {
        ParachuteArgs {
            out: PathBuf::from("out/parachute"),
        }
    }
}

/// What is about to happen, for someone who typed `mbd` alone.
pub fn announced(args: &ParachuteArgs) -> String {
    format!(
        "mbd: flying the parachute with every model of its confluence, half a minute or less, results in {}; `mbd --help` shows what else there is",
        args.out.display()
    )
}

/// Flies the study, writes it and tells its table.
pub fn parachute(args: &ParachuteArgs) -> Result<String, CommandFailure> {
    let mut progress = ProgressLine::new();
    let study = study::study(|what, share| progress.show(share, what))
        .map_err(|error| CommandFailure::Aborted(error.to_string()))?;
    progress.clear();
    let folder = args.out.display();
    let all = scene::PROVENANCE.len();
    let assumed = scene::PROVENANCE
        .iter()
        .filter(|[.., source]| !source.starts_with("paper"))
        .count();
    let found = parachute::write(&study, &args.out)
        .map_err(|error| CommandFailure::Usage(format!("cannot write {error}")))?;
    Ok(format!(
        "{}\n{}\nSteady riser force over the weight of the capsule: {:.6}\nOf the numbers of the scene, {assumed} of {all} groups are assumed or recalled because the copy of the paper lost them; the report lists each with its source.\nWritten to {folder}: report.html, figures, histories, summary.json\n",
        summary::table(&study).text(),
        summary::ratios(&study).text(),
        found.steady_over_weight
    ))
}
