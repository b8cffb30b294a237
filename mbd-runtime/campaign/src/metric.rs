//! Numbers that are read from the history of every case, and what they have to be.
//!
//! A metric without a value (an event that did not happen, an effort that nothing determines)
//! is NaN here and an empty cell in the results; where something is required of it, it counts as not met.

use mbd_compiler::read_number;
use mbd_runtime::scene::Scene;
use mbd_runtime::scene::metrics::Take;
use mbd_runtime::scene::similar::did_you_mean;
use mbd_runtime::scene::twelve_digits;
use mbd_runtime::{
    Content, MetricReader, MetricValue, MissingMetric, Name, Trajectory, switch_names,
};
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::columns;
use crate::dispersion::{WrittenMetric, WrittenRequirement};
use crate::phases::{SharedMetric, shared_metrics};
use crate::results::{ITS_SCENE, LARGE_ERROR, THE_RUN, counts_up_to, left_before, no_value};
use crate::run::CampaignMistakes;
use crate::run::names::{PlanError, column_name, wrong};
use crate::run::number::{not_bare, number};
use crate::sampling::CaseSampling;
use crate::statistics::shows;

/// A number that is read from the history of every case.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignMetric {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What to know of its quantity, `not unique`; mostly empty.
    pub remark: String,
    /// What it has to be.
    pub require: Option<Requirement>,
    reader: MetricReader,
    /// The scenes that a run may come to in which it counts, by index.
    scenes: Vec<usize>,
}

/// What a metric has to be, in which part of all cases, shown with which confidence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Requirement {
    /// The largest value that is allowed, in the unit of the metric.
    pub below: Option<f64>,
    /// The smallest value that is allowed.
    pub above: Option<f64>,
    /// The part of all cases, 0 … 1.
    pub share: f64,
    /// The confidence, 0 … 1; `None` of a grid: its points are no random sample, and their share alone is judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
}

impl Requirement {
    /// Whether a value meets it; NaN does not.
    #[must_use]
    pub fn meets(&self, value: f64) -> bool {
        let below = self.below.is_none_or(|bound| value <= bound);
        let above = self.above.is_none_or(|bound| value >= bound);
        !value.is_nan() && below && above
    }

    /// Whether so many misses among so many cases show it; of a grid, whether enough of its points keep it.
    #[must_use]
    pub fn is_shown(&self, missed: u64, of: u64) -> bool {
        match self.confidence {
            Some(confidence) => shows(missed, of, self.share, confidence),
            // 0.55 of 20 points are 11 of them, whatever the last bit of the product.
            None => of > 0 && (of - missed) as f64 >= self.share * of as f64 * (1.0 - 1e-12),
        }
    }

    /// How far a value is inside the nearer bound, in the unit of the metric; negative outside, NaN of NaN.
    #[must_use]
    pub fn margin(&self, value: f64) -> f64 {
        let below = self.below.map(|bound| bound - value);
        let above = self.above.map(|bound| value - bound);
        let nearest = below.into_iter().chain(above).reduce(f64::min);
        nearest.unwrap_or(f64::NAN)
    }
}

/// The metrics of a campaign with what a history must hold for them.
#[derive(Clone, Debug)]
pub struct Metrics {
    /// They, in the order of their names.
    pub list: Vec<CampaignMetric>,
    /// What a history must hold.
    pub content: Content,
}

impl Metrics {
    /// The metrics of the declarations of the models that a run comes to, and those of a campaign file. Of one that is declared, the file may say what it has
    /// to be, which `sampling` has a part in. Histories hold `content`, and what metrics need besides.
    ///
    /// # Errors
    /// Those that cannot be read from a history of these models, or that two of them declare differently.
    pub(crate) fn new<'m>(
        (written, sampling): (
            impl Iterator<Item = (&'m String, &'m WrittenMetric)> + Clone,
            CaseSampling,
        ),
        (models, content): (&columns::Models<'_>, Content),
    ) -> Result<Self, CampaignMistakes> {
        let mut mistakes = CampaignMistakes::default();
        let mut metrics = Metrics {
            list: Vec::new(),
            content,
        };
        let scenes: Vec<&Scene> = models.iter().map(|model| model.scene()).collect();
        let all = all_declared(&scenes)?;
        let of_declared = all.iter().filter(|own| own.metric.output.is_some());
        for SharedMetric { metric, .. } in of_declared {
            let setting = format!("metrics.{}", metric.name);
            let held = columns::include(&mut metrics.content, &metric.column(), (&setting, models));
            mistakes.note(held);
        }
        let is_declared = |name: &str| all.iter().any(|own| own.metric.name == name);
        let mut own = Vec::new();
        for (name, metric) in written.clone().filter(|(name, _)| !is_declared(name)) {
            let setting = format!("metrics.{name}");
            let mut columns = metric.columns();
            let held = columns.try_for_each(|column| {
                columns::include(&mut metrics.content, column, (&setting, models))
            });
            own.extend(mistakes.note(held).map(|()| (name, metric)));
        }
        let names = columns::names(models, metrics.content);
        for shared in &all {
            let Some(mut declared) = mistakes.note(declared(shared, &names)) else {
                continue;
            };
            if let Some((name, written)) = written.clone().find(|(it, _)| **it == declared.name) {
                let reader = MetricTextReader::new(name, written, (&names, sampling));
                let require = mistakes.note(reader.of_declared(&declared.unit));
                declared.require = require.flatten();
            }
            metrics.list.push(declared);
        }
        for (name, written) in own {
            let reader = MetricTextReader::new(name, written, (&names, sampling));
            let metric = reader.metric((models, metrics.content));
            metrics.list.extend(mistakes.note(metric));
        }
        mistakes.unless(Some(metrics))
    }

    /// What histories have to measure.
    #[must_use]
    pub fn readers(&self) -> Vec<MetricReader> {
        let readers = self.list.iter().map(|metric| metric.reader.clone());
        readers.collect()
    }

    /// The metrics of a history that measured them.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> Vec<f64> {
        self.list
            .iter()
            .map(|metric| metric.read(history))
            .collect()
    }

    /// Those that no scene of a run declares, as a run tells its own.
    #[must_use]
    pub fn besides(&self, scenes: &[&Scene], history: &Trajectory) -> Vec<MetricValue> {
        let told = self.others(scenes).map(|metric| metric.value_in(history));
        told.collect()
    }

    fn others<'s>(&'s self, scenes: &'s [&Scene]) -> impl Iterator<Item = &'s CampaignMetric> {
        let all = || scenes.iter().flat_map(|scene| &scene.runs.metrics);
        let declared = move |name: &str| all().any(|it| it.name == name);
        self.list
            .iter()
            .filter(move |metric| !declared(&metric.name))
    }

    /// A sentence on each that measures what changes faster than it can be followed, so that more than a hundredth of it stays open.
    #[must_use]
    pub fn unresolved(&self, history: &Trajectory) -> Vec<String> {
        let values = self.list.iter().map(|metric| metric.value_in(history));
        let told = values.filter_map(|value| {
            let part = value.unresolved_part().filter(|part| *part > LARGE_ERROR)?;
            Some(value.off_by(part))
        });
        told.collect()
    }

    /// A sentence on each whose window a run left before its end, so that its value is that of a part of it.
    #[must_use]
    pub fn partial(&self, history: &Trajectory) -> Vec<String> {
        let told = self
            .list
            .iter()
            .filter_map(|metric| metric.partial(history));
        told.collect()
    }

    /// A sentence on each that has no value because its scene was not reached, or ended before its window.
    #[must_use]
    pub fn unreached(&self, history: &Trajectory) -> Vec<String> {
        let told = self
            .list
            .iter()
            .filter_map(|metric| metric.unreached(history));
        told.collect()
    }

    /// A sentence on each that no scene declares, and whose window a run left before its end.
    #[must_use]
    pub fn partial_besides(&self, scenes: &[&Scene], history: &Trajectory) -> Vec<String> {
        let told = self
            .others(scenes)
            .filter_map(|metric| metric.partial(history));
        told.collect()
    }

    /// A sentence on each whose quantity, or which itself, is no finite number in a history that measured it.
    #[must_use]
    pub fn not_finite(&self, history: &Trajectory) -> Vec<String> {
        let told = self.list.iter().filter_map(|metric| {
            let missing = metric.measured(history).err()?;
            missing
                .is_not_finite()
                .then(|| no_value(&metric.name) + &missing.to_string())
        });
        told.collect()
    }
}

/// Whether a run that ends then [s] does so before something counts [s].
pub(crate) fn ends_before(from: f64, end: f64) -> bool {
    twelve_digits(from) >= twelve_digits(end)
}

/// Whether a run that ends then [s] leaves a part of a window up to `to` [s] open; an end that an event made has rounding in its last digits.
pub(crate) fn is_cut(to: f64, end: f64) -> bool {
    twelve_digits(to) > twelve_digits(end)
}

impl WrittenMetric {
    fn takes(&self) -> impl Iterator<Item = (Take, &String)> {
        let of = |take| match take {
            Take::Max => &self.max,
            Take::Min => &self.min,
            Take::Final => &self.last,
            Take::Mean => &self.mean,
            Take::Rms => &self.rms,
            Take::Integral => &self.integral,
            Take::TimeAbove => &self.time_above,
            Take::FirstAbove => &self.first_above,
            Take::Value => &self.value,
            Take::TimeOf => &self.time_of,
        };
        let takes = Take::ALL.into_iter();
        takes.filter_map(move |take| Some((take, of(take).as_ref()?)))
    }

    /// The columns it asks for.
    fn columns(&self) -> impl Iterator<Item = &String> {
        let takes = self.takes().filter(|(take, _)| *take != Take::TimeOf);
        takes.map(|(_, column)| column)
    }
}

/// The metrics that scenes declare, each once.
fn all_declared<'s>(scenes: &[&'s Scene]) -> Result<Vec<SharedMetric<'s>>, PlanError> {
    let all = shared_metrics(scenes);
    for (at, own) in all.iter().enumerate() {
        let mut before = all[..at].iter();
        if let Some(other) = before.find(|other| other.metric.name == own.metric.name) {
            let text = format!(
                "`{}` declares `{}`, and `{}` declares `{}`: give one of them another name",
                other.scene.name,
                other.text(),
                own.scene.name,
                own.text()
            );
            return Err(wrong(format!("metric {}", own.metric.name), text));
        }
    }
    Ok(all)
}

/// A metric of the declaration, read from histories with these columns.
fn declared(shared: &SharedMetric<'_>, names: &[Name]) -> Result<CampaignMetric, PlanError> {
    let SharedMetric {
        metric,
        scene,
        scenes,
    } = shared;
    let reader = MetricReader::new(metric, scene, names).map_err(|_| {
        let why = "its quantity is in no history: this model does not emit its outputs";
        wrong(format!("metric {}", metric.name), why)
    })?;
    Ok(CampaignMetric {
        name: metric.name.clone(),
        unit: metric.unit(scene),
        remark: remark(&reader, names),
        require: None,
        reader,
        scenes: scenes.clone(),
    })
}

/// What to know of the quantity that a metric is made of.
fn remark(reader: &MetricReader, names: &[Name]) -> String {
    let quantity = names
        .get(reader.column)
        .filter(|_| reader.take != Take::TimeOf);
    quantity.map_or_else(String::new, |name| name.remark.clone())
}

struct MetricTextReader<'r> {
    setting: String,
    name: &'r str,
    written: &'r WrittenMetric,
    names: &'r [Name],
    is_grid: bool,
}

impl<'r> MetricTextReader<'r> {
    fn new(
        name: &'r str,
        written: &'r WrittenMetric,
        (names, sampling): (&'r [Name], CaseSampling),
    ) -> Self {
        MetricTextReader {
            setting: format!("metrics.{name}"),
            name,
            written,
            names,
            is_grid: sampling == CaseSampling::Grid,
        }
    }

    fn wrong(&self, text: impl Into<String>) -> PlanError {
        wrong(&*self.setting, text)
    }

    /// What a declared metric has to be; nothing else can be said of it again.
    fn of_declared(&self, unit: &str) -> Result<Option<Requirement>, PlanError> {
        let only = WrittenMetric {
            require: self.written.require.clone(),
            ..WrittenMetric::default()
        };
        if *self.written != only {
            return Err(self
                .wrong("the declaration has this metric: only `require` can be said of it here"));
        }
        let require = self.written.require.as_ref();
        require.map(|it| self.requirement(it, unit)).transpose()
    }

    fn metric(
        &self,
        (models, content): (&columns::Models<'_>, Content),
    ) -> Result<CampaignMetric, PlanError> {
        let written = self.written;
        let mut given = written.takes();
        let (Some((take, of)), None) = (given.next(), given.next()) else {
            return Err(self.wrong(format!(
                "say one thing to read: {} = \"riser.tension\"",
                Take::ALL.map(Take::keyword).join(", ")
            )));
        };
        if take.has_level() != written.level.is_some() {
            return Err(
                self.wrong("`level` goes with `time_above` and `first_above`, and they need it")
            );
        }
        if (take == Take::Value) != written.at.is_some() {
            return Err(
                self.wrong("`value` needs the event `at` which it is read, and nothing else does")
            );
        }
        let column = column_name(of);
        let found = self.names.iter().position(|known| known.name == column);
        let own = found.and_then(|at| self.names.get(at));
        let own = own.map_or("", |name| &name.unit);
        let level = self.in_unit("level", written.level.as_ref(), own)?;
        let event = match take {
            Take::Value => self.event(models, written.at.as_deref().unwrap_or_default())?,
            Take::TimeOf => self.event(models, of)?,
            _ => String::new(),
        };
        let unit = take.unit(own);
        let second = |name: &str, value: &Option<Value>, free: f64| match value {
            Some(value) => number(&format!("{}.{name}", self.setting), value, "s"),
            None => Ok(free),
        };
        let window = [
            second("from", &written.from, f64::NEG_INFINITY)?,
            second("to", &written.to, f64::INFINITY)?,
        ];
        if window[0] >= window[1] {
            return Err(self.wrong("`from` must be before `to`"));
        }
        let require = written
            .require
            .as_ref()
            .map(|it| self.requirement(it, &unit))
            .transpose()?;
        let reader = MetricReader {
            take,
            column: found.unwrap_or(0),
            level,
            event,
            window,
        };
        // Events are those of all scenes: they are told beside the time, which all have.
        let column = match take {
            Take::TimeOf => 0,
            _ => reader.column,
        };
        let scenes = columns::models_with(models, content, column);
        if scenes.is_empty() {
            let text = "`phase` counts the scenes of a run, and is a quantity of none: take the `time_of` the event that lets one go on";
            return Err(self.wrong(text));
        }
        Ok(CampaignMetric {
            name: self.name.to_owned(),
            unit,
            remark: remark(&reader, self.names),
            require,
            reader,
            scenes,
        })
    }

    /// A number in a unit that a column has.
    fn in_unit(
        &self,
        name: &str,
        value: Option<&Value>,
        unit: &str,
    ) -> Result<Option<f64>, PlanError> {
        let Some(value) = value else {
            return Ok(None);
        };
        // `N s` of an integral is written `N*s`.
        let written = unit.replace(' ', "*");
        let factor = match written.as_str() {
            "" => 1.0,
            unit => read_number(&format!("1 {unit}")).map_or(1.0, |(factor, _)| factor),
        };
        let setting = format!("{}.{name}", self.setting);
        not_bare(&setting, value, &written)?;
        Ok(Some(number(&setting, value, &written)? / factor))
    }

    fn requirement(
        &self,
        written: &WrittenRequirement,
        unit: &str,
    ) -> Result<Requirement, PlanError> {
        let inside = |x: f64| x > 0.0 && x < 1.0;
        let all_points = self.is_grid && written.share == 1.0;
        if !(inside(written.share) || all_points) || !written.confidence.is_none_or(inside) {
            return Err(self.wrong("`share` and `confidence` of `require` lie between 0 and 1: share = 0.99865, confidence = 0.9"));
        }
        if written.confidence.is_none() && !self.is_grid {
            return Err(self.wrong("`require` needs the confidence with which it is shown: confidence = 0.9 (a grid alone has none)"));
        }
        if written.below.is_none() && written.above.is_none() {
            return Err(self.wrong("`require` needs `below` or `above`"));
        }
        let [below, above] = [
            self.in_unit("require.below", written.below.as_ref(), unit)?,
            self.in_unit("require.above", written.above.as_ref(), unit)?,
        ];
        if let (Some(below), Some(above)) = (below, above)
            && below < above
        {
            let [below, above] =
                [below, above].map(|bound| format!("{} {unit}", twelve_digits(bound)));
            let text = format!(
                "`require`: no value is below {below} and above {above}: the larger of them is `below`"
            );
            return Err(self.wrong(text));
        }
        Ok(Requirement {
            below,
            above,
            share: written.share,
            confidence: written.confidence.filter(|_| !self.is_grid),
        })
    }

    /// An event as histories name it: a declared one, or `riser: taut`.
    fn event(&self, models: &columns::Models<'_>, name: &str) -> Result<String, PlanError> {
        let events = models.iter().flat_map(|model| &model.scene().events);
        let declared = events.map(|event| event.name.clone());
        let switches = models.iter().flat_map(|model| switch_names(*model));
        let [declared, switches]: [Vec<String>; 2] = [declared.collect(), switches.collect()];
        let all = || declared.iter().chain(&switches).map(String::as_str);
        if all().any(|known| known == name) {
            return Ok(name.to_owned());
        }
        let near = did_you_mean(name, all());
        let own = match declared.is_empty() {
            true => "it declares none".to_owned(),
            false => format!("it has {}", declared.join(", ")),
        };
        let told = switches.first().map_or_else(
            || "; it has no line and no stop whose switches are told".to_owned(),
            |switch| format!("; what lines and stops become is told as `{switch}`"),
        );
        Err(self.wrong(format!(
            "this scene has no event `{name}`{near} ({own}{told})"
        )))
    }
}

impl CampaignMetric {
    /// The event that it waits for, as histories name it.
    pub(crate) fn event(&self) -> Option<&str> {
        let waits = matches!(self.reader.take, Take::Value | Take::TimeOf);
        waits.then_some(self.reader.event.as_str())
    }

    /// What did not happen in a run that came to its scene and has no value of it; empty where there always is one. `locates`: whether runs locate events;
    /// `untold`: why they do not tell its event.
    pub(crate) fn waits_for(&self, locates: bool, untold: Option<String>) -> String {
        match self.reader.take {
            Take::Value | Take::TimeOf if !locates => {
                format!("`{}` is not located (`locate = false`)", self.reader.event)
            }
            Take::Value | Take::TimeOf => {
                let event = &self.reader.event;
                match untold {
                    Some(why) => format!("`{event}` is not told ({why})"),
                    None => format!("`{event}` did not happen{}", self.outside()),
                }
            }
            Take::FirstAbove => format!("the level was not passed{}", self.outside()),
            _ => String::new(),
        }
    }

    /// That what did not happen may have happened where nothing counts.
    fn outside(&self) -> String {
        let seconds = self.reader.window.map(twelve_digits);
        match seconds.map(f64::is_finite) {
            [false, false] => String::new(),
            [true, false] => format!(", or not from {} s on,", seconds[0]),
            [false, true] => format!(", or not up to {} s,", seconds[1]),
            [true, true] => format!(", or not between {} s and {} s,", seconds[0], seconds[1]),
        }
    }

    /// Its value in a history that measured it, and what that may be off by.
    fn measured(&self, history: &Trajectory) -> Result<[f64; 2], MissingMetric> {
        history.measured_in(&self.reader, &|scene| self.scenes.contains(&scene))
    }

    /// When the last of its scenes ended [s]; not a number where the run came to none.
    fn end(&self, history: &Trajectory) -> f64 {
        history.end_in(&self.reader, &|scene| self.scenes.contains(&scene))
    }

    /// That its window reaches beyond the end of a run that has a value of it, or of its scene in that run.
    fn partial(&self, history: &Trajectory) -> Option<String> {
        let end = self.end(history);
        let to = self.counts_up_to().filter(|to| is_cut(*to, end))?;
        let what = if end < history.end() {
            ITS_SCENE
        } else {
            THE_RUN
        };
        let (counts, end) = (counts_up_to(&self.name), twelve_digits(end));
        self.measured(history).is_ok().then(|| {
            format!("{counts}{to} s, and {what} ends at {end} s: it is told of what lies before")
        })
    }

    /// Why it has no value in a run that did not come to its scene, or left it before its window.
    fn unreached(&self, history: &Trajectory) -> Option<String> {
        let missing = self.measured(history).err()?;
        let why = no_value(&self.name);
        if missing == MissingMetric::NotReached {
            return Some(format!("{why}{missing}"));
        }
        let end = self.end(history);
        let from = self.counts_from().filter(|from| ends_before(*from, end))?;
        (end < history.end()).then(|| format!("{why}{}", left_before(from, end)))
    }

    /// From when on a run counts [s], where something before does not.
    pub(crate) fn counts_from(&self) -> Option<f64> {
        let [from, _] = self.reader.window;
        from.is_finite().then_some(from)
    }

    /// Up to when a run counts [s], where something does not count any more; `None` also of what happens first, which nothing later changes.
    pub(crate) fn counts_up_to(&self) -> Option<f64> {
        let [_, to] = self.reader.window;
        let is_settled = matches!(
            self.reader.take,
            Take::Value | Take::TimeOf | Take::FirstAbove
        );
        (to.is_finite() && !is_settled).then_some(to)
    }

    /// It with its value in a history that measured it, as a run tells those of its scene.
    fn value_in(&self, history: &Trajectory) -> MetricValue {
        let read = self.measured(history);
        MetricValue {
            name: self.name.clone(),
            doc: String::new(),
            take: self.reader.take,
            unit: self.unit.clone(),
            unresolved: read.as_ref().map_or(0.0, |[_, unresolved]| *unresolved),
            value: read.map(|[value, _]| value),
        }
    }

    /// Its value in a history that measured it; NaN where it has none.
    #[must_use]
    pub fn read(&self, history: &Trajectory) -> f64 {
        let value = self.measured(history);
        value.map_or(f64::NAN, |[value, _]| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_grid_are_counted_as_they_are() {
        let require = |share| Requirement {
            below: Some(3.0),
            above: None,
            share,
            confidence: None,
        };
        // 0.55 · 20 is more than 11 in its last bit.
        for (share, of, allowed) in [(0.9, 10, 1), (0.55, 20, 9), (1.0, 7, 0), (0.99, 22, 0)] {
            assert!(require(share).is_shown(allowed, of), "{share}");
            assert!(!require(share).is_shown(allowed + 1, of), "{share}");
        }
        assert!(
            !require(0.5).is_shown(0, 0),
            "nothing is shown by no points"
        );
    }

    #[test]
    fn a_requirement_is_not_met_by_what_has_no_value() {
        let require = Requirement {
            below: Some(3.0),
            above: Some(1.0),
            share: 0.9,
            confidence: Some(0.9),
        };
        assert!(require.meets(1.0) && require.meets(3.0) && !require.meets(3.1));
        assert!(!require.meets(0.9) && !require.meets(f64::NAN));
        assert_eq!(
            [1.5, 2.75, 4.0, 0.0].map(|x| require.margin(x)),
            [0.5, 0.25, -1.0, -1.0]
        );
        assert!(require.margin(f64::NAN).is_nan());
    }
}
