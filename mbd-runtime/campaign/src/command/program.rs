//! The command line of a user's own compiled model.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use clap::{Args, Parser, Subcommand};
use mbd_runtime::{Model, ParamError};

use super::{CampaignArgs, GatherArgs, ResultSource, campaign, gather, report};
use crate::campaign::Campaign;
use crate::failure::Failure;
use crate::results::head;
use crate::run::{Phase, Settings};
use mbd_report::files;

#[derive(Debug, Parser)]
#[command(
    after_help = "Exit codes: 0 ok, 1 usage, 2 model, params or campaign file invalid, 3 a requirement is not shown, 4 results are missing."
)]
struct CampaignCli {
    #[command(subcommand)]
    command: CampaignCommand,
}

#[derive(Debug, Subcommand)]
enum CampaignCommand {
    /// List the params: name, value, unit, range, what it is.
    List,
    /// Run one case of a campaign file again: its row, and its history as a file.
    Run(CaseArgs),
    /// Run a campaign, or a shard of it.
    Campaign(CampaignArgs),
    /// Put the results of all shards together and tell what they say.
    Gather(GatherArgs),
    /// Write the page of a campaign, with the histories and pages of the cases that the campaign file chooses.
    Report(GatherArgs),
}

#[derive(Args, Debug)]
struct CaseArgs {
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
///
/// Campaigns are flown in `f64`. A model over `f32` does not compile here; its numbers have seven digits, which single runs may be content with:
///
/// ```compile_fail,E0277
/// use mbd_runtime::model;
///
/// model! {
///     model Stone<T> {
///         point stone { mass: 1.0 kg, start at [0.0, 0.0, 100.0] m }
///     }
/// }
///
/// fn main() -> std::process::ExitCode {
///     mbd_campaign::main(Stone::<f32>::new(StoneParams::default()))
/// }
/// ```
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
    let cli = match CampaignCli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return Err(Failure::Usage(error.to_string())),
        Err(help) => return Ok(help.to_string()),
    };
    match cli.command {
        CampaignCommand::List => Ok(params(model)),
        CampaignCommand::Run(args) => run(&args, model.share()),
        CampaignCommand::Campaign(args) => {
            let program = std::env::args().next().unwrap_or_default();
            let source = |file: &Path| ResultSource {
                command: format!("{program} run {}", file.display()),
                scene: None,
                campaign: file.to_owned(),
            };
            let alone = Phase::alone(model.share(), Settings::default());
            campaign(&args, (alone, Vec::new()), &source)
        }
        CampaignCommand::Gather(args) => gather(&args),
        CampaignCommand::Report(args) => report(&args, &|source| {
            Campaign::read(&source.campaign, model.share(), Settings::default())
        }),
    }
}

fn params(model: &dyn Model<f64>) -> String {
    let params = model.scene().params.iter().zip(model.params());
    let lines = params.map(|(param, value)| {
        let unit = &param.unit;
        let range = param.range.map_or(String::new(), |[low, high]| {
            format!(" in {} ..= {}", unit.told(low), unit.told(high))
        });
        let (value, doc) = (unit.told(*value), param.doc.trim());
        format!("{} = {value}{range}  {doc}\n", param.name)
    });
    lines.collect()
}

fn run(args: &CaseArgs, model: Arc<dyn Model<f64>>) -> Result<String, Failure> {
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
    match row.reached_end() {
        true => Ok(told),
        false => Err(Failure::Aborted(told)),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use mbd_compiler::read_text;
    use mbd_runtime::Generic;

    use super::*;

    /// A stone that is thrown up: it is highest at v²/2g.
    const STONE: &str = "model Stone {
        gravity: [0.0, 0.0, -10.0] m/s^2;
        /// How fast it is thrown.
        param speed = 10 m/s in 1 m/s ..= 30 m/s;
        point stone { mass: 1 kg, start at [0, 0, 0] m velocity [0, 0, speed] }
        metric top = max stone.position.z;
    }";

    const FILE: &str = "seed = 5
cases = 30
block = 8
[params]
speed = { dist = \"uniform\", low = \"8 m/s\", high = \"12 m/s\" }
[metrics]
top = { require = { below = \"7.3 m\", share = 0.9, confidence = 0.9 } }
[histories]
largest = { top = 1 }
[run]
until = \"2 s\"
tolerance = 1e-9
";

    #[test]
    fn a_program_of_ones_own_lists_flies_shards_gathers_flies_again_and_reports() {
        let folder = std::env::temp_dir().join(format!("mbd_program_{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        let model = Generic::<f64>::with_defaults(read_text(STONE).scene.expect("a scene"));
        let model = model.expect("valid");
        let file = folder.join("dispersions.toml");
        fs::write(&file, FILE).expect("room");
        let [out, alone] = ["out", "alone"].map(|name| folder.join(name));
        let told = |words: &[&str]| {
            let replaced = words.iter().map(|word| match *word {
                "FILE" => file.clone().into(),
                "OUT" => out.clone().into(),
                "ALONE" => alone.clone().into(),
                word => OsString::from(word),
            });
            answer(
                std::iter::once(OsString::from("stone")).chain(replaced),
                &model,
            )
        };
        let list = told(&["list"]).expect("a list");
        assert_eq!(
            list,
            "speed = 10 m/s in 1 m/s ..= 30 m/s  How fast it is thrown.\n"
        );
        let shard = |shard: &str| told(&["campaign", "FILE", "--out", "OUT", "--shard", shard]);
        shard("2/2").expect("a shard");
        assert_eq!(
            told(&["gather", "OUT", "--shards", "2"])
                .expect_err("half")
                .code(),
            4
        );
        shard("1/2").expect("a shard");
        let gathered = told(&["gather", "OUT"]).expect("all of it");
        assert!(
            gathered.contains("shown: top below 7.3000 m in 90 %"),
            "{gathered}"
        );
        let cases = fs::read_to_string(out.join("cases.csv")).expect("cases");
        let rows: Vec<&str> = cases.lines().skip(1).collect();
        assert_eq!(rows.len(), 31);
        for row in &rows {
            let cells: Vec<&str> = row.split(',').collect();
            let [speed, top] = [3, 4].map(|at| cells[at].parse::<f64>().expect("a number"));
            assert!((top - speed * speed / 20.0).abs() < 1e-8, "{row}");
        }
        let again = told(&["run", "FILE", "--case", "17", "--out", "ALONE"]).expect("a case");
        assert!(again.lines().any(|line| line == rows[17]), "{again}");
        assert!(alone.join("history.csv").is_file());
        assert_eq!(
            told(&["run", "FILE", "--case", "31"])
                .expect_err("the last is 30")
                .code(),
            2
        );
        let page = told(&["report", "OUT"]).expect("a page");
        assert!(
            page.contains("report.html") && out.join("report.html").is_file(),
            "{page}"
        );
        // The largest of all is kept with its history.
        assert_eq!(
            fs::read_dir(out.join("histories"))
                .expect("histories")
                .count(),
            3
        );
        assert_eq!(told(&["fly"]).expect_err("no such command").code(), 1);
        let _ = fs::remove_dir_all(&folder);
    }
}
