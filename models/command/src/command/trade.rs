//! `mbd trade` and `mbd advise`: what accuracy of a quantity costs, and what to run for it.

use std::path::{Path, PathBuf};

use clap::Args;
use mbd_campaign::progress::ProgressLine;
use mbd_compiler::{mixes_turns, read_number};

use super::failure::CommandFailure;
use super::run::{above, folder_name, unwritten};
use super::scene_file::SceneFile;
use crate::run::{RunPlan, fly, shown, warning_before};
use crate::trade::{advice, publish, race, table, unit, usual};

/// What is asked of every run.
#[derive(Args, Debug)]
pub struct TradeArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    /// The column of the history that counts: an output, `riser.tension`, `capsule.z`.
    #[arg(long, value_name = "COLUMN")]
    output: String,
    /// From when to when it counts, in seconds: `0..10` [default: the whole run].
    #[arg(long, value_name = "FROM..TO")]
    window: Option<String>,
    /// The error that is wanted (rms over the window), with a unit, such as "1 mm", or a number in the unit of the column [default: a thousandth of its
    /// largest value].
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    within: Option<String>,
    /// Folder for table, figure and report [default: out/NAME of a ready scene, out/PATH of a file without its extension].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Races methods, tolerances, models of nodes and coordinates over one question: the whole table, or the advice alone.
pub fn trade(args: &TradeArgs, advice_alone: bool) -> Result<String, CommandFailure> {
    let SceneFile {
        scene, settings, ..
    } = SceneFile::find_alone(&args.scene, "trade")?;
    let window = args.window.as_deref().map(window).transpose()?;
    let wrong = |error: &dyn std::fmt::Display| {
        CommandFailure::Invalid(format!("{}: {error}", args.scene.display()))
    };
    // A column that there is not has no unit either, and that it is not there is what to tell.
    let unit = unit(&scene, &args.output).map_err(|error| wrong(&error))?;
    let within = args.within.as_deref();
    let within = within.map(|text| wanted(text, &unit)).transpose()?;
    // It is shown, not judged.
    let plan = RunPlan {
        estimate: false,
        ..RunPlan::new(&scene, &settings).map_err(|error| wrong(&error))?
    };
    let moved = above(warning_before(&scene, &plan));
    let race = race(&scene, &settings, &args.output, window).map_err(|error| wrong(&error))?;
    let told = advice(&race, &unit, within.unwrap_or_else(|| usual(&race)));
    if advice_alone {
        return Ok(format!("{moved}{told}\n"));
    }
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| Path::new("out").join(folder_name(&args.scene)));
    let outcome = fly(&scene, &plan, &mut ProgressLine::silent()).map_err(|error| wrong(&error))?;
    publish(
        &race,
        (&told, &unit),
        &shown(&scene, &plan, &outcome),
        &folder,
    )
    .map_err(|error| unwritten(&error))?;
    Ok(format!(
        "{moved}{}\n{told}\nwritten to {}: trade.html, trade.svg, trade.csv\n",
        table(&race, &unit).text(),
        folder.display()
    ))
}

/// An error in the unit of the column: a bare number, or one with any unit of the same kind.
fn wanted(text: &str, unit: &str) -> Result<f64, CommandFailure> {
    let wrong = |why: String| CommandFailure::Usage(format!("--within {text}: {why}"));
    let (value, given) = read_number(text).map_err(wrong)?;
    let own = match unit {
        "" => None,
        // `N m` of a torque is written `N*m`.
        unit => read_number(&format!("1 {}", unit.replace(' ', "*"))).ok(),
    };
    let mixed = own
        .as_ref()
        .is_some_and(|(_, own)| mixes_turns(own, &given));
    let (factor, dimension) =
        own.map_or((1.0, None), |(factor, own)| (factor, Some(own.dimension)));
    let value = match (given.text.is_empty(), dimension) {
        (true, _) => value,
        (false, Some(dimension)) if dimension == given.dimension && !mixed => value / factor,
        (false, Some(_)) => {
            return Err(wrong(format!(
                "the column is in {unit}: give an error in a unit of that kind"
            )));
        }
        (false, None) => {
            return Err(wrong("the column has no unit: give a bare number".into()));
        }
    };
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(wrong("give an error above zero".into())),
    }
}

/// `0..10`, with or without units.
fn window(text: &str) -> Result<[f64; 2], CommandFailure> {
    let wrong = || {
        CommandFailure::Usage(format!(
            "--window `{text}`: write two times in seconds, the first one earlier, such as 0..10"
        ))
    };
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let seconds = |text: &str| -> Result<f64, CommandFailure> {
        let text = text.trim();
        let text = text.strip_suffix('s').unwrap_or(text).trim();
        text.parse().map_err(|_| wrong())
    };
    let window = [seconds(from)?, seconds(to)?];
    match window {
        [from, to] if from < to && from >= 0.0 && to.is_finite() => Ok(window),
        _ => Err(wrong()),
    }
}
