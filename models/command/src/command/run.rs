//! `mbd run`: flies a scene and writes what came out.

use std::path::{Component, Path, PathBuf};

use clap::Args;
use mbd_campaign::progress::ProgressLine;
use mbd_campaign::run::GivenSettings;
use mbd_campaign::{Campaign, Metrics};
use mbd_report::ReportTable;
use mbd_runtime::scene::Scene;
use mbd_runtime::{Content, Method, MetricValue};
use toml::{Table, Value};

use super::failure::CommandFailure;
use super::list;
use super::phases::{MOST, Phases};
use super::scene_file::SceneFile;
use crate::describe::warnings_of_reactions;
use crate::run::{
    CampaignMistakes, Phase, RunOutcome, RunPlan, Segment, Settings, cut_of_campaign, cut_windows,
    cut_windows_of_all, doubt, doubt_of_all, fly_measuring, fly_phases, not_finite, phases_json,
    publish, publish_gltf, publish_phases, regularised, short_of_digits, summary_json, warning,
    warning_of_handover, warnings_of_unkept,
};

/// What to run, and how; flags go before the `[run]` table of the file.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// A ready scene (`mbd list`) or a scene file.
    scene: PathBuf,
    /// Folder for history, figures, report and summary [default: out/NAME of a ready scene, out/PATH of a file without its extension].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The integrator: rk4 (fixed steps), rattle (fixed steps, long runs), tsit5, vern7 (tight tolerances), rodas5p (stiff), auto [default: rk4 with --dt, else tsit5].
    #[arg(long, value_name = "METHOD")]
    method: Option<String>,
    /// Fixed step of RK4 or Rattle, with unit (`0.01s`, `5 ms`) or in seconds [default: 0.001 s if an equilibrium point is stepwise].
    #[arg(long, alias = "step", value_name = "STEP", conflicts_with = "tol")]
    dt: Option<String>,
    /// Relative tolerance of adaptive steps [default: 1e-8 if no equilibrium point is stepwise].
    #[arg(long, alias = "tolerance", value_name = "NUMBER")]
    tol: Option<String>,
    /// End of the run, with unit or in seconds.
    #[arg(long, alias = "end", value_name = "TIME")]
    until: Option<String>,
    /// Distance of the rows of the history, with unit or in seconds [default: every step].
    #[arg(long, value_name = "TIME")]
    every: Option<String>,
    /// The most steps, accepted and rejected, before the run is given up [default: 10000000 of fixed steps, 1000000 of adaptive methods].
    #[arg(long, value_name = "NUMBER")]
    max_steps: Option<u64>,
    /// Value of a param with its unit, `riser_k=50kN/m`; may be repeated. `mbd check` shows the params with their ranges.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// An input with another value for the whole run, `push=5N`, `wind="[8, 0, 0] m/s"`; may be repeated.
    #[arg(long = "input", value_name = "NAME=VALUE")]
    input: Vec<String>,
    /// Leave out the second, finer run that tells the error of the first.
    #[arg(long)]
    no_estimate: bool,
    /// Run a case of this campaign file as the campaign does, with its params, inputs and start.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["method", "dt", "tol", "until", "every", "max_steps", "set", "input"])]
    campaign: Option<PathBuf>,
    /// Which case; 0 is the nominal.
    #[arg(
        long,
        value_name = "NUMBER",
        default_value_t = 0,
        requires = "campaign"
    )]
    case: u64,
    /// Write the run as an animated glTF file, too: `motion.glb`, for viewers and Blender.
    #[arg(long)]
    gltf: bool,
    /// Print the summary as JSON instead of a table.
    #[arg(long)]
    json: bool,
}

impl RunArgs {
    /// The scene as it was typed.
    pub fn scene(&self) -> &Path {
        &self.scene
    }

    /// Everything that the run is made of: the scene file, what it names, what these name; the campaign with its tables. Whether the scenes can be read.
    pub fn files(&self) -> (Vec<PathBuf>, bool) {
        let (mut files, mut whole, mut next) = (vec![self.scene.clone()], true, 0);
        while let Some(file) = files.get(next) {
            let (named, read) = SceneFile::names(file);
            whole &= read;
            for file in named {
                // Scenes may lead back to each other.
                if !files.contains(&file) && files.len() < MOST {
                    files.push(file);
                }
            }
            next += 1;
        }
        if let Some(campaign) = &self.campaign {
            files.extend(Campaign::tables(campaign));
            files.push(campaign.clone());
        }
        (files, whole)
    }

    /// The folder that the run is written into.
    pub fn folder(&self) -> PathBuf {
        let named = || Path::new("out").join(folder_name(&self.scene));
        self.out.clone().unwrap_or_else(named)
    }
}

/// A run that came to an end, or stopped early.
#[derive(Debug)]
pub struct FinishedRun {
    /// What was run.
    pub scene: Scene,
    /// How.
    pub plan: RunPlan,
    /// What came out.
    pub outcome: RunOutcome,
    /// What was noticed when the scene was read.
    pub remarks: Vec<String>,
}

/// Runs a scene and writes nothing.
pub fn flown(args: &RunArgs) -> Result<FinishedRun, CommandFailure> {
    fly(args, SceneFile::find_alone(&args.scene, "compare")?)
}

fn fly(args: &RunArgs, file: SceneFile) -> Result<FinishedRun, CommandFailure> {
    let settings = with_flags(file.settings.clone(), args)?;
    let invalid = |error: &dyn std::fmt::Display| {
        CommandFailure::Invalid(format!("{}: {error}", args.scene.display()))
    };
    let (plan, metrics) = match &args.campaign {
        Some(campaign) => {
            let (plan, metrics) = case_of(&file, settings, campaign, args.case)?;
            (plan, Some(metrics))
        }
        None => {
            let plan = RunPlan::new(&file.scene, &settings).map_err(|error| file.misset(&error))?;
            (plan, None)
        }
    };
    let model = file
        .model(&plan.params)
        .map_err(|error| match args.campaign {
            Some(_) => invalid(&error),
            None => file.misparam(&error, &names(&args.set)),
        })?;
    let outcome = fly_measuring(&*model, &plan, metrics.as_ref(), &mut ProgressLine::new());
    Ok(FinishedRun {
        scene: file.scene,
        plan,
        outcome,
        remarks: file.remarks,
    })
}

/// Runs a scene, and what its events let go on, and writes everything.
pub fn run(args: &RunArgs) -> Result<String, CommandFailure> {
    let phases = Phases::of(SceneFile::find(&args.scene)?, &args.scene)?;
    match phases.is_one() {
        true => phases
            .files
            .into_iter()
            .next()
            .map_or_else(|| Ok(String::new()), |file| run_one(args, file)),
        false => run_all(args, &phases),
    }
}

/// Runs several scenes one after the other.
fn run_all(args: &RunArgs, phases: &Phases) -> Result<String, CommandFailure> {
    if args.gltf {
        return Err(CommandFailure::Usage(
            "--gltf takes a scene that flies alone: an event of this one lets another scene go on"
                .into(),
        ));
    }
    let Some(first) = phases.files.first() else {
        return Ok(String::new());
    };
    let (plans, (besides, partial)) = plans(args, phases)?;
    let mut warnings = phases.decided(&names(&args.set))?;
    let mut all = Vec::with_capacity(plans.len());
    for ((file, plan), next) in phases.files.iter().zip(&plans).zip(&phases.next) {
        let model = file.model(&plan.params);
        all.push(Phase {
            model: model
                .map_err(|error| CommandFailure::Invalid(format!("{}: {error}", file.name)))?,
            settings: file.settings.clone(),
            next: next.clone(),
        });
    }
    let run = fly_phases(&all, &plans, &mut ProgressLine::new());
    let segments = &run.segments;
    let folder = args.folder();
    let flown = (all.as_slice(), &run);
    let tables = publish_phases(flown, &besides, &folder).map_err(|error| unwritten(&error))?;
    let off = doubt_of_all(&all, &run);
    let mut doubtful = off.is_some();
    warnings.extend(off);
    for (segment, phase) in segments
        .iter()
        .filter_map(|segment| Some((segment, all.get(segment.phase)?)))
    {
        let doubt = doubt(phase.model.scene(), &segment.plan, &segment.outcome);
        doubtful |= doubt.is_some();
        warnings.extend(warning(
            phase.model.scene(),
            &segment.plan,
            &segment.outcome,
        ));
        warnings.extend(warning_of_handover(phase.model.scene(), segment));
        warnings.extend(warnings_of_unkept(phase.model.scene(), segment));
        warnings.extend(warnings_of_reactions(phase.model.scene()));
        warnings.extend(undefined(&segment.outcome));
        warnings.extend(regularised(phase.model.scene(), &segment.outcome));
        warnings.extend(short_of_digits(
            phase.model.scene(),
            &segment.plan,
            &segment.outcome,
        ));
        warnings.extend(doubt);
    }
    warnings.extend(cut_windows_of_all(&all, segments));
    warnings.extend(partial.iter().map(|text| cut_of_campaign(text)));
    if let Some((last, first)) = segments.last().zip(segments.first())
        && last.outcome.error.is_none()
    {
        warnings.extend(first.plan.beyond(last.outcome.time));
    }
    let told = if args.json {
        warnings.iter().for_each(|warning| eprintln!("{warning}"));
        phases_json(flown, &besides).map_err(|error| unwritten(&error))?
    } else {
        let remarks = phases.files.iter().flat_map(|file| &file.remarks);
        let remarks = remarks.chain(&warnings);
        let remarks: String = remarks.map(|remark| format!("{remark}\n")).collect();
        let files = "report.html, history.csv, summary.json, and a folder a phase";
        let tables: Vec<String> = tables.iter().map(ReportTable::text).collect();
        format!(
            "{remarks}{}\nwritten to {}: {files}\n",
            tables.join("\n"),
            folder.display()
        )
    };
    let error = segments
        .last()
        .and_then(|segment: &Segment| segment.outcome.error.as_ref());
    match error {
        None if doubtful => Err(CommandFailure::Inaccurate(told)),
        None => Ok(told),
        Some(error) => Err(CommandFailure::Aborted(format!(
            "{told}\n{}: {error}",
            first.scene.name
        ))),
    }
}

/// The warning of outputs that have no finite value somewhere.
fn undefined(outcome: &RunOutcome) -> Option<String> {
    not_finite(&outcome.trajectory).map(|told| format!("warning: {told}"))
}

/// The metrics of a campaign that no scene declares, and a sentence on each of which only a part of its window was flown.
type BesideMetrics = (Vec<MetricValue>, Vec<String>);

/// How each of several scenes is flown, and what a campaign reads of the run besides.
fn plans(args: &RunArgs, phases: &Phases) -> Result<(Vec<RunPlan>, BesideMetrics), CommandFailure> {
    if let Some(file) = &args.campaign {
        let (first, later) = phases.of_many()?;
        let campaign = Campaign::read_phases(file, first, later)?;
        let plans = campaign.plans(args.case);
        let both = plans.and_then(|plans| Ok((plans, campaign.besides(args.case)?)));
        return both
            .map_err(|error| CommandFailure::Invalid(format!("{}: {error}", file.display())));
    }
    let first = phases.files.first().map(|file| file.settings.clone());
    let settings = with_flags(first.unwrap_or_default(), args)?;
    let given = GivenSettings {
        method: args.method.is_some() || args.dt.is_some() || args.tol.is_some(),
        every: args.every.is_some(),
        max_steps: args.max_steps.is_some(),
        params: names(&args.set),
        inputs: names(&args.input),
    };
    Ok((phases.planned(&settings, &given)?, BesideMetrics::default()))
}

/// The names that flags give a value.
fn names(given: &[String]) -> Vec<String> {
    let parts = given.iter().filter_map(|written| written.split_once('='));
    parts.map(|(name, _)| name.trim().to_owned()).collect()
}

/// A warning as lines above what is printed.
pub fn above(warning: Option<String>) -> String {
    warning.map_or(String::new(), |warning| warning + "\n")
}

/// Runs a scene that flies alone.
fn run_one(args: &RunArgs, file: SceneFile) -> Result<String, CommandFailure> {
    let FinishedRun {
        scene,
        plan,
        outcome,
        remarks,
    } = fly(args, file)?;
    let folder = args.folder();
    let tables = publish(&scene, &plan, &outcome, &folder).map_err(|error| unwritten(&error))?;
    let unmoved = args.gltf
        && !publish_gltf(&scene, &plan, &outcome, &folder).map_err(|error| unwritten(&error))?;
    let unmoved = unmoved
        .then(|| "warning: nothing of this scene has a place: no motion.glb is written".to_owned());
    let warning = warning(&scene, &plan, &outcome);
    let doubt = doubt(&scene, &plan, &outcome);
    let many = warnings_of_reactions(&scene);
    let warning = warning.into_iter().chain(many).chain(undefined(&outcome));
    let warning = warning.chain(regularised(&scene, &outcome));
    let warning = warning.chain(short_of_digits(&scene, &plan, &outcome));
    let warning = warning.chain(doubt.clone()).chain(unmoved);
    let short = match outcome.error {
        None => [
            cut_windows(&scene, &plan, &outcome),
            plan.beyond(outcome.time),
        ]
        .concat(),
        Some(_) => Vec::new(),
    };
    let warning = warning.chain(short);
    let warning: Vec<String> = warning.collect();
    let told = if args.json {
        for warning in &warning {
            eprintln!("{warning}");
        }
        summary_json(&scene, &plan, &outcome).map_err(|error| unwritten(&error))?
    } else {
        let remarks = remarks.iter().chain(&warning);
        let remarks: String = remarks.map(|remark| format!("{remark}\n")).collect();
        let tables: Vec<String> = tables.iter().map(ReportTable::text).collect();
        let tables = tables.join("\n");
        format!("{remarks}{tables}\n{}", written(&outcome, &folder))
    };
    match &outcome.error {
        None if doubt.is_some() => Err(CommandFailure::Inaccurate(told)),
        None => Ok(told),
        Some(error) => Err(CommandFailure::Aborted(format!(
            "{told}\n{}: {error}",
            scene.name
        ))),
    }
}

/// The plan of a case of a campaign, and what is read of its run.
fn case_of(
    file: &SceneFile,
    settings: Settings,
    campaign: &Path,
    case: u64,
) -> Result<(RunPlan, Metrics), CommandFailure> {
    let model = super::campaign::nominal(file)?;
    let all = Campaign::read(campaign, model, settings)?;
    let invalid = |mistakes: CampaignMistakes| CommandFailure::Invalid(mistakes.of_file(campaign));
    let plan = all.plan(case).map_err(|error| invalid(error.into()))?;
    let metrics = all.metrics_in(Content::ALL).map_err(invalid)?;
    Ok((plan, metrics))
}

/// Whether a method of this name has a fixed step.
fn is_fixed(word: &str) -> bool {
    let mut fixed = Method::FIXED.iter();
    fixed.any(|known| known.eq_ignore_ascii_case(word))
}

fn with_flags(mut settings: Settings, args: &RunArgs) -> Result<Settings, CommandFailure> {
    if args.dt.is_some() || args.tol.is_some() {
        (settings.step, settings.tolerance) = (value(&args.dt), value(&args.tol));
        // The method of the file stays where it has what is given.
        let fixed = |word: &String| is_fixed(word);
        settings.method = settings
            .method
            .filter(|word| fixed(word) == args.dt.is_some());
    }
    if let Some(word) = &args.method {
        // A step or a tolerance of the file belongs to its own method.
        match is_fixed(word) {
            true if args.tol.is_none() => settings.tolerance = None,
            false if args.dt.is_none() => settings.step = None,
            _ => {}
        }
        settings.method = Some(word.clone());
    }
    settings.until = value(&args.until).or(settings.until);
    settings.every = value(&args.every).or(settings.every);
    settings.max_steps = args.max_steps.or(settings.max_steps);
    if args.no_estimate {
        settings.estimate = Some(false);
    }
    assign(&mut settings.params, SET, &args.set)?;
    assign(&mut settings.inputs, INPUT, &args.input)?;
    Ok(settings)
}

/// A flag that gives a name a value, and how it is written.
pub(super) type Flag = (&'static str, &'static str);
pub(super) const SET: Flag = ("--set", "riser_k=50kN/m");
pub(super) const INPUT: Flag = ("--input", "push=5N");

/// Puts what a flag gives in place of what a table of `[run]` has.
pub(super) fn assign(
    table: &mut Table,
    flag: Flag,
    given: &[String],
) -> Result<(), CommandFailure> {
    let mut names: Vec<&str> = Vec::new();
    for written in given {
        let (name, value) = assigned(flag, written)?;
        if names.contains(&name) {
            let text = format!("{} gives `{name}` twice: leave one of them out", flag.0);
            return Err(CommandFailure::Usage(text));
        }
        names.push(name);
        // A text even where it is a bare number: what a person types carries its unit.
        table.insert(name.to_owned(), Value::String(value.to_owned()));
    }
    Ok(())
}

/// The name and the value that a flag gives.
pub(super) fn assigned(
    (flag, example): Flag,
    written: &str,
) -> Result<(&str, &str), CommandFailure> {
    let parts = written
        .split_once('=')
        .map(|(name, value)| (name.trim(), value.trim()));
    let whole = parts.filter(|(name, value)| !name.is_empty() && !value.is_empty());
    whole.ok_or_else(|| {
        let text = format!("{flag} `{written}`: write it as NAME=VALUE, such as {example}");
        CommandFailure::Usage(text)
    })
}

pub(super) fn value(flag: &Option<String>) -> Option<Value> {
    flag.as_deref().map(typed)
}

/// A bare number, or a text that carries its unit.
fn typed(text: &str) -> Value {
    let text = text.trim();
    text.parse()
        .map_or_else(|_| Value::String(text.to_string()), Value::Float)
}

/// The folder of a scene in `out`: the name of a ready scene, or where a file lies, so that no two scenes share one. The extension is left out
/// unless it tells the file from a ready scene, or from another file beside it.
pub(super) fn folder_name(given: &Path) -> PathBuf {
    let here = std::env::current_dir().unwrap_or_default();
    let path = given.strip_prefix(&here).unwrap_or(given);
    let parts = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name),
        _ => None,
    });
    let folder: PathBuf = parts.collect();
    let short = folder.with_extension("");
    let is_ready = short
        .to_str()
        .is_some_and(|name| list::ready(name).is_some());
    let others = ["toml", "mbd"].map(|extension| given.with_extension(extension));
    let beside = others.iter().any(|other| other != given && other.is_file());
    if given.is_file() && (is_ready || beside) {
        let name = folder.to_string_lossy().replace('.', "_");
        return PathBuf::from(name);
    }
    if short == Path::new("parachute") {
        // The main job has that one.
        return PathBuf::from("parachute_scene");
    }
    short
}

pub(super) fn unwritten(error: &std::io::Error) -> CommandFailure {
    CommandFailure::Usage(format!("cannot write {error}"))
}

/// A positive number with two digits or more: `0.048`, `3.4`, `1523`.
fn rounded(number: f64) -> String {
    let digits = (1.0 - number.log10().floor()).clamp(0.0, 9.0);
    format!("{number:.0$}", digits as usize)
}

fn written(outcome: &RunOutcome, folder: &Path) -> String {
    let speed = if outcome.time > 0.0 && outcome.wall_s > 0.0 {
        format!(
            "{} simulated seconds a second; ",
            rounded(outcome.time / outcome.wall_s)
        )
    } else {
        String::new()
    };
    format!(
        "{speed}written to {}: report.html, history.csv, summary.json\n",
        folder.display()
    )
}
