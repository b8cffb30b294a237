//! `mbd extremes`: what runs keep, or refuse, where scenes become extreme.

use std::path::PathBuf;

use clap::Args;

use super::failure::CommandFailure;
use super::run::unwritten;
use crate::extremes::{cases, publish, run};

/// How much is run.
#[derive(Args, Debug)]
pub struct ExtremesArgs {
    /// Leave out what runs for long.
    #[arg(long)]
    reduced: bool,
    /// Folder for table and report.
    #[arg(long, value_name = "DIR", default_value = "out/extremes")]
    out: PathBuf,
}

/// Runs all cases, and tells how many promises were not kept.
pub fn extremes(args: &ExtremesArgs) -> Result<String, CommandFailure> {
    let cases = cases(args.reduced);
    let (table, broken) = run(&cases);
    publish(&table, &args.out).map_err(|error| unwritten(&error))?;
    let told = format!(
        "{}\n{} of {} promises kept; written to {}: report.html, extremes.csv\n",
        table.text(),
        cases.len() - broken,
        cases.len(),
        args.out.display()
    );
    match broken {
        0 => Ok(told),
        _ => Err(CommandFailure::Inaccurate(told)),
    }
}
