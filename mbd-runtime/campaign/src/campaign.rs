//! A campaign: a model, how it is run, what is dispersed, what is read from every run; models that go on from it where its events say so.

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mbd_runtime::scene::metrics::COLUMNS_OF_RESULTS;
use mbd_runtime::scene::{Packed, fingerprint};
use mbd_runtime::{
    Batch, Case, Content, FailedCase, Finished, Joined, Method, Model, Moved, Onward, Options,
    RunError, Sampling, Simulation, StepError, StepSizes, Trajectory, switch_names, untold_switch,
};
use toml::{Table, Value};

use crate::columns;
use crate::dispersion::{CampaignFile, Dispersions, LaterScene, WrittenMetric, meant, sampling};
use crate::envelopes::Envelopes;
use crate::failure::Failure;
use crate::footprint::Footprint;
use crate::histories::Choice;
use crate::manifest::{Manifest, OWN_VERSION, ResultColumn, ResultOptions, build, target};
use crate::metric::Metrics;
use crate::results::{CaseRow, LARGE_ERROR};
use crate::run::always_mapped;
use crate::run::names::wrong;
use crate::run::plan::in_state_numbers;
use crate::run::{
    CampaignMistakes, Phase, PlanError, RunPlan, Settings, belongs_to_the_run, check_units, go_on,
};
use settled::{given, planned, settings_of};

mod replay;
mod settled;

pub(crate) use replay::CasePart;

/// Cases that share a file of results, where the campaign file says nothing.
const BLOCK: u64 = 100;

/// How many cases may share a file of results: they are in memory until it is written.
const MOST_A_BLOCK: u64 = 1 << 20;

/// A model, how it is run, what is dispersed, and what is read from every run.
pub struct Campaign {
    model: Arc<dyn Model<f64>>,
    settings: Settings,
    nominal: RunPlan,
    /// What its start moves.
    nominal_moved: Vec<Moved>,
    /// Everything that a run may come to, the model with its settings first.
    phases: Vec<Phase>,
    /// How those behind the first are run.
    later: Vec<RunPlan>,
    /// The columns of histories that come to several models.
    columns: Option<Joined>,
    dispersions: Dispersions,
    metrics: Metrics,
    written: BTreeMap<String, WrittenMetric>,
    envelopes: Option<Envelopes>,
    asked: ResultOptions,
    block: u64,
    /// Per case and scene that it comes to the steps that its own have to stay below.
    below: BTreeMap<u64, Vec<StepSizes>>,
}

/// What the judge of a case hands back.
struct Judged {
    /// When the run ended [s].
    end: f64,
    metrics: Vec<f64>,
    /// What is no finite number where it has to be one.
    not_finite: Vec<String>,
    /// What its run made or lost of the energy that moved.
    unbalanced: Vec<String>,
    /// Which metrics are not resolved.
    unresolved: Vec<String>,
    /// Which metrics are those of a part of their window.
    partial: Vec<String>,
    /// Which metrics have no value because their scene was not reached, or ended before their window.
    unreached: Vec<String>,
    /// Of the envelopes.
    numbers: Vec<f64>,
}

/// A case that was flown.
#[derive(Clone, Debug)]
pub struct FlownCase {
    /// Its row in the results.
    pub row: CaseRow,
    /// The columns of the envelopes at their instants, one column after the other; `None` where it did not reach its end.
    pub numbers: Option<Vec<f64>>,
    /// The time it took on the clock [s].
    pub seconds: f64,
    /// Its steps, and those of them that were tried beside those of other cases.
    pub steps: [u64; 2],
}

/// What a campaign may use of a machine; its results do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resources {
    /// Threads.
    pub threads: usize,
    /// Cases beside each other on each thread: 1, 4 or 8, or as [`Batch::lanes`] says.
    pub lanes: Option<usize>,
}

impl Campaign {
    /// The campaign of a file; `settings` say how the model is run where the file says nothing.
    ///
    /// # Errors
    /// The file cannot be read; what cannot be used in it, by name, each on a line of its own. How it is run comes first: the rest is asked of that run.
    pub fn read(
        file: &Path,
        model: Arc<dyn Model<f64>>,
        settings: Settings,
    ) -> Result<Self, Failure> {
        Campaign::read_phases(file, Phase::alone(model, settings), Vec::new())
    }

    /// The campaign of a file whose runs begin in a scene, and go on in others `later` where its events or theirs say so.
    ///
    /// # Errors
    /// As [`Campaign::read`].
    pub fn read_phases(file: &Path, first: Phase, later: Vec<Phase>) -> Result<Self, Failure> {
        let name = file.display();
        let text = fs::read_to_string(file)
            .map_err(|error| Failure::Usage(format!("cannot read {name}: {error}")))?;
        let written: CampaignFile = toml::from_str(&text).map_err(|error| {
            let mut hint = belongs_to_the_run(&error);
            if hint.is_empty() {
                hint = meant(&error);
            }
            Failure::Invalid(format!("{name}: {error}{hint}"))
        })?;
        let folder = file.parent().unwrap_or(Path::new(""));
        Campaign::new(&written, folder, first, later)
            .map_err(|mistakes| Failure::Invalid(mistakes.of_file(file)))
    }

    /// The tables of numbers that a campaign file names, as far as it can be read.
    #[must_use]
    pub fn tables(file: &Path) -> Vec<PathBuf> {
        let text = fs::read_to_string(file).unwrap_or_default();
        let folder = file.parent().unwrap_or(Path::new(""));
        let Ok(written) = toml::from_str::<CampaignFile>(&text) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for table in [&written.params, &written.start, &written.inputs] {
            named_files(table, folder, &mut found);
        }
        found
    }

    fn new(
        written: &CampaignFile,
        folder: &Path,
        mut first: Phase,
        later: Vec<Phase>,
    ) -> Result<Self, CampaignMistakes> {
        let mut mistakes = CampaignMistakes::default();
        let (own, given) = given(written, &mut mistakes);
        let model = first.model.clone();
        let mut scenes = std::iter::once(&first).chain(&later);
        mistakes.note(scenes.try_for_each(|phase| check_units(phase.model.scene(), &own)));
        first.settings = settings_of(own, &*model, first.settings);
        let phases: Vec<Phase> = std::iter::once(first).chain(later).collect();
        let planned = mistakes.note(planned(phases, &given));
        let (phases, mut plans) = mistakes.unless(planned)?;
        let models: Vec<&dyn Model<f64>> = phases.iter().map(|phase| &*phase.model).collect();
        let mut content = Content::TIME;
        let mut nominal = plans.remove(0);
        let settings = phases.first().map(|phase| phase.settings.clone());
        let mut settings = settings.unwrap_or_default();
        // By the names that dispersed numbers have, whatever is written: `pin` of `pin.angle`, `bob.velocity` of `bob.vx`.
        settings.start = in_state_numbers((model.scene(), model.layout()), &settings.start);
        let later: Vec<LaterScene<'_>> = models
            .iter()
            .enumerate()
            .skip(1)
            .zip(&plans)
            .map(|((place, model), plan)| LaterScene {
                scene: model.scene(),
                plan,
                mapped: always_mapped(&phases, place),
            })
            .collect();
        let scene = (model.scene(), model.layout());
        let run = ((&nominal, &settings), later.as_slice());
        let mut mistakes = CampaignMistakes::default();
        let dispersions = mistakes.note(Dispersions::new(written, scene, run, folder));
        let envelopes = written.envelopes.as_ref().and_then(|written| {
            mistakes.note(Envelopes::new(written, (&models, &nominal), &mut content))
        });
        // A sampling that there is not was told with the dispersions.
        let metrics = sampling(written).ok().and_then(|sampling| {
            let of_file = (written.metrics.iter(), sampling);
            mistakes.note(Metrics::new(of_file, (&models, content)))
        });
        let block = mistakes.note(block(written));
        let read = dispersions.zip(metrics);
        if let Some((dispersions, metrics)) = &read {
            mistakes.note(tell_apart(metrics, dispersions));
        }
        let asked = read.as_ref().and_then(|(dispersions, metrics)| {
            mistakes.note(asked(written, metrics, dispersions.cases))
        });
        let ((dispersions, metrics), (asked, block)) =
            mistakes.unless(read.zip(asked.zip(block)))?;
        let columns = models.len() > 1;
        let columns = columns.then(|| columns::joined(&models, metrics.content));
        // Work is integrated for those who ask for energy: no step with it is made in lanes.
        for plan in std::iter::once(&mut nominal).chain(&mut plans) {
            plan.options.work &= metrics.content.energy;
        }
        let nominal_moved = start_moved(&*model, &nominal);
        Ok(Campaign {
            settings,
            nominal,
            nominal_moved,
            later: plans,
            dispersions,
            metrics,
            written: written.metrics.clone(),
            envelopes,
            asked,
            block,
            below: BTreeMap::new(),
            columns,
            phases,
            model,
        })
    }

    /// One sentence on what its settings ask for beyond the end of its runs.
    #[must_use]
    pub fn beyond(&self) -> Vec<String> {
        self.nominal.beyond(self.nominal.until)
    }

    /// All cases, with the nominal, which is case 0.
    #[must_use]
    pub fn cases(&self) -> u64 {
        self.dispersions.cases + 1
    }

    /// The metrics, as they are read from histories of the model that hold at least this content.
    ///
    /// # Errors
    /// Those that cannot be read from such a history.
    pub fn metrics_in(&self, content: Content) -> Result<Metrics, CampaignMistakes> {
        Metrics::new(
            (self.written.iter(), self.dispersions.sampling),
            (&[&*self.model], content),
        )
    }

    /// What is dispersed.
    #[must_use]
    pub fn dispersions(&self) -> &Dispersions {
        &self.dispersions
    }

    /// What the results belong to.
    #[must_use]
    pub fn manifest(&self) -> Manifest {
        let hash = |text: String| format!("{:016x}", fingerprint(text.bytes()));
        let scenes = || self.phases.iter().map(|phase| phase.model.scene());
        let names: Vec<&str> = scenes().map(|scene| scene.name.as_str()).collect();
        let mut declaration: String = scenes().map(Packed::packed).collect();
        let mut settings = format!("{:?}", self.nominal);
        if !self.later.is_empty() {
            let next = self.phases.iter().map(|phase| &phase.next);
            declaration += &format!("{:?}", next.collect::<Vec<_>>());
            settings += &format!("{:?}", self.later);
        }
        let mut plans = std::iter::once(&self.nominal).chain(&self.later);
        let locates = plans.all(|plan| plan.options.locate);
        let dispersed = self.dispersions.varied.iter().map(|varied| ResultColumn {
            name: varied.known.name.clone(),
            unit: varied.known.unit.clone(),
            require: None,
            waits_for: String::new(),
            remark: String::new(),
            from: None,
            to: None,
        });
        let metrics = self.metrics.list.iter().map(|metric| ResultColumn {
            name: metric.name.clone(),
            unit: metric.unit.clone(),
            require: metric.require,
            waits_for: metric
                .waits_for(locates, metric.event().and_then(|event| self.untold(event))),
            remark: metric.remark.clone(),
            from: metric.counts_from(),
            to: metric.counts_up_to(),
        });
        Manifest {
            model: names.join(" → "),
            declaration: hash(declaration),
            dispersions: hash(format!("{:?} {:?}", self.dispersions, self.metrics)),
            settings: hash(settings),
            version: OWN_VERSION.to_owned(),
            build: build(),
            target: target(),
            sampling: self.dispersions.sampling,
            seed: self.dispersions.seed,
            cases: self.cases(),
            block: self.block,
            dispersed: dispersed.collect(),
            correlated: self.dispersions.correlated(),
            metrics: metrics.collect(),
            envelopes: self.envelopes.clone(),
            told: self.asked.clone(),
        }
    }

    /// Why no scene of the nominal case tells a switch of its lines.
    fn untold(&self, switch: &str) -> Option<String> {
        let plans = std::iter::once(&self.nominal).chain(&self.later);
        let models = self.phases.iter().zip(plans).filter_map(|(phase, plan)| {
            let model = phase.model.with_params(&plan.params).ok()?;
            let has = switch_names(&*model).iter().any(|name| name == switch);
            has.then_some(model)
        });
        let whys = models.map(|model| untold_switch(&*model, switch));
        let whys: Option<Vec<String>> = whys.collect();
        whys?.into_iter().next()
    }

    fn check(&self, case: u64) -> Result<(), PlanError> {
        match case < self.cases() {
            true => Ok(()),
            false => {
                let text = format!("there is no case {case}: the last is {}", self.cases() - 1);
                Err(wrong("case", text))
            }
        }
    }

    /// The plan of a case.
    ///
    /// # Errors
    /// There is no such case; its start cannot be, or is not what is drawn; no draw of it obeys the constraints.
    pub fn plan(&self, case: u64) -> Result<RunPlan, PlanError> {
        self.check(case)?;
        // Its coordinates are found by what it is begun with, and may not be what it can be begun with.
        if case == 0 {
            return Ok(self.nominal.clone());
        }
        let values = self.dispersions.values(case)?;
        let scene = (self.model.scene(), self.model.layout());
        let plan = self
            .dispersions
            .plan((&self.nominal, &self.settings), scene, &values)?;
        if self.model.layout().nc > 0 && self.dispersions.has_starts() {
            let moved = start_moved(&*self.model, &plan);
            self.dispersions
                .check_start(&values, [&moved, &self.nominal_moved])?;
        }
        Ok(plan)
    }

    /// The plans of a case in all scenes that its run may come to.
    ///
    /// # Errors
    /// As [`Campaign::plan`].
    pub fn plans(&self, case: u64) -> Result<Vec<RunPlan>, PlanError> {
        let all = 0..self.phases.len();
        all.map(|phase| self.plan_in(case, phase)).collect()
    }

    /// The scenes that runs may come to.
    #[must_use]
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// How the nominal is integrated.
    pub(crate) fn method(&self) -> Method {
        self.nominal.options.method
    }

    /// Whether its settings ask for an estimate of the error.
    pub(crate) fn estimates(&self) -> bool {
        self.nominal.estimate
    }

    /// The same for some of its cases with a quarter of the step, or a tenth of the tolerance and steps below those that they have here, as a run is flown
    /// again; `None` where nothing finer is told apart from rounding.
    pub(crate) fn finer(mut self, cases: &[u64]) -> Option<Campaign> {
        let plans = || std::iter::once(&self.nominal).chain(&self.later);
        let is_adaptive = plans().any(|plan| plan.options.method.fixed_step().is_none());
        let finer: Option<Vec<Options>> = plans().map(|plan| plan.options.finer()).collect();
        let finer = finer?;
        if is_adaptive {
            let sizes = cases.iter().map(|case| (*case, self.step_sizes(*case)));
            self.below = sizes.collect();
        }
        let plans = std::iter::once(&mut self.nominal).chain(&mut self.later);
        plans
            .zip(finer)
            .for_each(|(plan, options)| plan.options = options);
        Some(self)
    }

    /// Keeps a part of a case below the steps that it has to stay below.
    fn refine(&self, case: u64, part: usize, run: &mut Simulation<f64>) {
        let sizes = self.below.get(&case).and_then(|parts| parts.get(part));
        sizes.into_iter().for_each(|sizes| run.refine(sizes));
    }

    /// When what acts with time alone on the nominal is hidden from its fixed steps [s].
    pub(crate) fn hidden_from_steps(&self) -> Option<f64> {
        let model = self.model.with_params(&self.nominal.params).ok()?;
        let mut run = Simulation::new(&*model, self.nominal.options).ok()?;
        self.nominal.begin(&mut run).ok()?;
        // That is known before the first step.
        let until = self.nominal.until;
        run.run_while(until, None, &mut |_: f64| false).ok();
        run.hidden_from_steps()
    }

    /// The plan of a case in a scene that its run may come to.
    fn plan_in(&self, case: u64, phase: usize) -> Result<RunPlan, PlanError> {
        let later = phase.checked_sub(1).and_then(|at| self.later.get(at));
        let (Some(nominal), Some(own)) = (later, self.phases.get(phase)) else {
            return self.plan(case);
        };
        if case == 0 {
            return Ok(nominal.clone());
        }
        let values = self.dispersions.values(case)?;
        let scene = (own.model.scene(), own.model.layout());
        self.dispersions
            .plan_later((nominal, &own.settings), scene, &values)
    }

    /// Runs so many cases, whose numbers `number` says by their place, and hands them to `deliver`, in order.
    pub fn run(
        &self,
        count: usize,
        number: &(dyn Fn(usize) -> u64 + Sync),
        resources: Resources,
        mut deliver: impl FnMut(FlownCase) -> ControlFlow<()>,
    ) {
        let judge = |history: &Trajectory| self.judge(history);
        self.judged((count, number), resources, judge, |finished| {
            deliver(self.flight(number(finished.case), finished))
        });
    }

    /// The same, with something else made of each history.
    fn judged<R: Send>(
        &self,
        (count, number): (usize, &(dyn Fn(usize) -> u64 + Sync)),
        resources: Resources,
        judge: impl Fn(&Trajectory) -> R + Sync,
        deliver: impl FnMut(Finished<R>) -> ControlFlow<()>,
    ) {
        let readers = self.metrics.readers();
        let first = match &self.columns {
            Some(columns) => columns.readers(0, &readers),
            None => readers.clone(),
        };
        let mut batch = Batch::new(&*self.model, self.nominal.options, self.nominal.until);
        if let Some(lanes) = resources.lanes {
            batch = batch.lanes(lanes);
        }
        if let Some(columns) = &self.columns {
            batch = batch.then(columns, |case, ended| {
                let (case, part) = (number(case.number()), ended.before + 1);
                let goes = go_on(&self.phases, ended, &|phase| self.plan_in(case, phase))?;
                Ok(goes.map(|mut goes| {
                    self.refine(case, part, &mut goes.run);
                    let model = goes.run.model().clone();
                    let sampling = self.sampling().from_time(goes.run.time());
                    let history = Trajectory::new(&*model, sampling, self.metrics.content);
                    let own = columns.readers(goes.phase, &readers);
                    Onward {
                        model: goes.phase,
                        history: history.measure(&*model, &own),
                        run: goes.run,
                    }
                }))
            });
        }
        batch
            .cases((0..count).map(|place| self.params(number(place))))
            .threads(resources.threads)
            .record(self.sampling(), self.metrics.content)
            .measure(first)
            .prepare(|case, run| self.begin(number(case.number()), run))
            .each(|_, history| judge(history), deliver);
    }

    /// Only the params: the rest of the start is found on the thread of the case.
    fn params(&self, number: u64) -> Case {
        match self.dispersions.values(number) {
            Ok(values) => {
                let mut params = self.nominal.params.clone();
                self.dispersions.set_params(&values, &mut params);
                Case::new().params(params)
            }
            // Told by `begin`.
            Err(_) => Case::new(),
        }
    }

    fn begin(&self, number: u64, run: &mut Simulation<f64>) -> Result<(), RunError> {
        let plan = self.plan(number).map_err(|error| RunError {
            cause: StepError::Refused {
                setting: error.setting,
                why: error.text,
            },
            progress: Box::default(),
        })?;
        plan.begin(run)?;
        self.refine(number, 0, run);
        Ok(())
    }

    /// Metrics need no rows: histories have those that envelopes are read from.
    fn sampling(&self) -> Sampling {
        let instants = self.envelopes.iter().flat_map(Envelopes::instants);
        Sampling::At(instants.collect())
    }

    fn judge(&self, history: &Trajectory) -> Judged {
        let end = history.end();
        let envelopes = self.envelopes.as_ref();
        let mut not_finite = self.metrics.not_finite(history);
        not_finite.extend(envelopes.iter().flat_map(|it| it.not_finite(history)));
        Judged {
            end,
            metrics: self.metrics.read(history),
            not_finite,
            unbalanced: Vec::new(),
            unresolved: self.metrics.unresolved(history),
            partial: self.metrics.partial(history),
            unreached: self.metrics.unreached(history),
            numbers: envelopes.map_or(Vec::new(), |envelopes| envelopes.read(history)),
        }
    }

    fn flight(&self, case: u64, finished: Finished<Judged>) -> FlownCase {
        let Finished {
            result,
            seconds,
            statistics,
            imbalance,
            beside,
            ..
        } = finished;
        let (result, numbers) = match result {
            Ok(mut judged) => {
                let numbers = std::mem::take(&mut judged.numbers);
                let lost = imbalance.filter(|part| *part > LARGE_ERROR);
                judged.unbalanced.extend(lost.map(made_or_lost));
                (Ok(judged), Some(numbers))
            }
            Err(failed) => (Err(failed), None),
        };
        let tried = statistics.steps + statistics.rejected + statistics.redone;
        FlownCase {
            row: self.row(case, result),
            numbers,
            seconds,
            // A run that went back to before a mistake has the counters of there.
            steps: [tried.max(beside), beside],
        }
    }

    fn row(&self, case: u64, result: Result<Judged, FailedCase>) -> CaseRow {
        // Where nothing was drawn there is nothing to tell.
        let nothing = || vec![f64::NAN; self.dispersions.varied.len()];
        let drawn = self.dispersions.values(case);
        let mut values = drawn.unwrap_or_else(|_| nothing());
        let scene = self.model.scene();
        if self.dispersions.gives_way(scene, &self.settings)
            && let Ok(plan) = self.plan(case)
        {
            let scene = (scene, self.model.layout());
            self.dispersions.take(scene, &plan, &mut values);
        }
        let values = self.dispersions.in_units(&values);
        match result {
            Ok(judged) => {
                let said = [
                    judged.not_finite,
                    judged.unbalanced,
                    judged.unresolved,
                    judged.partial,
                ];
                let mut statuses = CaseRow::DOUBTFUL.into_iter().zip(&said);
                let doubtful = statuses.find(|(_, told)| !told.is_empty());
                let status = doubtful.map_or(CaseRow::OK, |(status, _)| status);
                CaseRow {
                    case,
                    status: status.to_owned(),
                    time: judged.end,
                    values,
                    metrics: judged.metrics,
                    why: [said.concat(), judged.unreached].concat().join("; "),
                }
            }
            Err(failed) => CaseRow {
                case,
                status: failed.why.status().to_owned(),
                time: failed.time,
                values,
                metrics: vec![f64::NAN; self.metrics.list.len()],
                why: failed.to_string(),
            },
        }
    }
}

/// That a run made or lost this part of the energy that moved.
fn made_or_lost(part: f64) -> String {
    format!(
        "its steps made or lost {:.1} % of the energy that moved",
        100.0 * part
    )
}

/// What the start of a run as planned moves so that joints hold; nothing where it cannot begin, which the run itself tells.
fn start_moved(model: &dyn Model<f64>, plan: &RunPlan) -> Vec<Moved> {
    let begun = model.with_params(&plan.params).ok().and_then(|model| {
        let mut run = Simulation::new(&*model, plan.options).ok()?;
        plan.begin(&mut run).and_then(|()| run.start()).ok()?;
        Some(run)
    });
    begun.map_or_else(Vec::new, |run| run.start_moved().to_vec())
}

/// What the file asks to be told beside the metrics.
fn asked(
    written: &CampaignFile,
    metrics: &Metrics,
    last: u64,
) -> Result<ResultOptions, CampaignMistakes> {
    let mut mistakes = CampaignMistakes::default();
    let histories = written.histories.clone().unwrap_or_default();
    let histories = mistakes.note(Choice::new(&histories, &metrics.list, last));
    let mut footprints = Vec::new();
    for (at, footprint) in written.footprint.iter().enumerate() {
        let footprint = Footprint::new(footprint, &metrics.list, &format!("footprint[{at}]"));
        footprints.extend(mistakes.note(footprint));
    }
    mistakes.unless(histories.map(|histories| ResultOptions {
        histories,
        footprints,
    }))
}

/// How many cases share a file of results.
fn block(written: &CampaignFile) -> Result<u64, PlanError> {
    let block = written.block.unwrap_or(BLOCK);
    match (1..=MOST_A_BLOCK).contains(&block) {
        true => Ok(block),
        false => {
            let text = format!("a file of results holds from 1 to {MOST_A_BLOCK} cases");
            Err(wrong("block", text))
        }
    }
}

/// Every `file` of distributions, however deep they stand.
fn named_files(table: &Table, folder: &Path, found: &mut Vec<PathBuf>) {
    for (key, value) in table {
        match value {
            Value::String(file) if key == "file" => found.push(folder.join(file)),
            Value::Table(inner) => named_files(inner, folder, found),
            _ => {}
        }
    }
}

/// Refuses metrics that have the name of another column.
fn tell_apart(metrics: &Metrics, dispersions: &Dispersions) -> Result<(), CampaignMistakes> {
    let dispersed = dispersions.varied.iter();
    let mut taken: Vec<&str> = dispersed.map(|varied| varied.known.name.as_str()).collect();
    taken.extend(COLUMNS_OF_RESULTS);
    let names = metrics.list.iter().map(|metric| metric.name.as_str());
    let mut mistakes = CampaignMistakes::default();
    for name in names.filter(|name| taken.contains(name)) {
        mistakes.note::<()>(Err(wrong(
            format!("metrics.{name}"),
            "another column of the results has this name: give it one of its own",
        )));
    }
    mistakes.unless(Some(()))
}
