//! The history of a run: named columns with units.

use std::io::{self, Write};
use std::ops::Range;

use mbd_scene::metrics::Take;
use mbd_scene::{Float, FromSolution, Layout, Model, Scene, plain};

use crate::columns::Name;
use crate::content::Content;
use crate::dropped_here::DroppedHere;
use crate::error::{Statistics, StepError};
use crate::identity;
use crate::measure::{MeasuredRun, MeasuredStep, Measures};
use crate::metric::{MetricReader, MissingMetric};
use crate::row::{RowMaker, RowPlace, names};
use crate::simulation::beside::Attempt;
use crate::system::System;

mod joined;

pub use joined::Joined;

/// When a row is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Sampling {
    /// At the start and after every accepted step, located events included; where an event acts, a row before it and one after it.
    Steps,
    /// Every so many seconds from the first row on, by the interpolant of the method, and where a run stops; where it goes on that last row is dropped,
    /// unless it is one of the others.
    Every(f64),
    /// At these times, increasing [s]; none of them before the start of the run, so that row k is that of time k.
    At(Vec<f64>),
}

impl Sampling {
    /// The same for a run that begins at a time [s]: of a list without the times before it.
    #[must_use]
    pub fn from_time(mut self, begins: f64) -> Self {
        if let Sampling::At(times) = &mut self {
            times.retain(|due| !is_past(*due, begins));
        }
        self
    }
}

/// A column of a history that is infinite or not a number in some rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotFinite<'a> {
    /// The column.
    pub name: &'a str,
    /// The time of the first such row [s].
    pub time: f64,
    /// How many there are.
    pub rows: usize,
    /// Whether it is made of what joints carry, and rows of joints lost rank in the run: then nothing determines it.
    pub undetermined: bool,
}

/// Named columns over time. Angular velocities, positions and forces are those of the state and the declaration: world axes unless named `body`.
///
/// ```
/// use mbd_runtime::{Content, Options, PointState, Sampling, Simulation, Trajectory, model};
///
/// model! {
///     /// A stone that is thrown.
///     model Throw {
///         gravity: [0.0, 0.0, -10.0] m/s^2;
///         emit: [derivative, outputs];
///         point stone { mass: 1.0 kg }
///         output height = stone.position.z;
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let throw = Throw::new(ThrowParams::default())?;
/// let mut start = ThrowState::at_origin();
/// start.set_stone(PointState { position: [0.0; 3], velocity: [3.0, 0.0, 10.0] });
/// let mut simulation = Simulation::new(&throw, Options::rk4(0.1))?;
/// simulation.set_state(0.0, &start.to_vec())?;
///
/// let mut history = Trajectory::new(&throw, Sampling::Every(0.5), Content::RESULTS);
/// simulation.record(2.0, &mut history)?;
///
/// // Up to 5 m in the first second, and back.
/// assert_eq!(history.times().len(), 5);
/// let height = history.column("height").expect("a declared output");
/// assert!((height[2] - 5.0).abs() < 1e-12 && height[4].abs() < 1e-12);
///
/// let mut csv = Vec::new();
/// history.to_csv(&mut csv)?;
/// assert!(String::from_utf8(csv)?.starts_with("time [s],height [m]\n"));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Of which model's runs it takes rows.
    model: u64,
    names: Vec<Name>,
    /// Which of them are declared outputs, and in which rows.
    outputs: Vec<(usize, Range<usize>)>,
    /// The columns that are made of what joints carry.
    efforts: Vec<usize>,
    columns: Vec<Vec<f64>>,
    maker: DroppedHere<RowMaker>,
    sampling: Sampling,
    first: f64,
    /// Rows written, and the index of the next grid time.
    next: usize,
    /// Whether the last row is where a run stopped beside the grid.
    beside: bool,
    /// When the run ended [s]; NaN: it did not.
    end: f64,
    /// The metrics that the scene declares, by name, and how each is read.
    pub(crate) declared: Vec<(String, Result<MetricReader, MissingMetric>)>,
    measures: DroppedHere<Measures>,
    /// What was measured in the parts of a [joined](Joined::join) history; of another one nothing.
    parts: Vec<MeasuredRun>,
    /// Rows of what is measured at instants, and over steps.
    measured: DroppedHere<RowMaker>,
    inside: DroppedHere<RowMaker>,
    /// Rows at which some reactions or efforts of motors have no value, because rows of joints lose rank, and not in passing: they are not
    /// numbers there, and their cells in CSV are empty. In passing they have the value they tend to.
    pub undetermined: u64,
    /// Whether the run that is recorded locates events.
    pub(crate) locates: bool,
    /// Located events: time [s] and name (`chute_open`, `riser: taut`).
    pub events: Vec<(f64, String)>,
    /// Counters of the run at its last row.
    pub statistics: Statistics,
}

impl Trajectory {
    /// The most numbers of a history, rows times columns: 1.6 GB, and some 4 GB as text. A run that asks for more ends with
    /// [`StepError::LongHistory`].
    pub const MOST_NUMBERS: f64 = 2e8;

    /// Drops the rows and the events after a time [s].
    pub(crate) fn cut(&mut self, time: f64) {
        let kept = self.times().partition_point(|row| *row <= time);
        if kept < self.times().len() {
            self.drop_end();
        }
        self.measures.cut(time);
        self.end = f64::NAN;
        self.next = self.next.saturating_sub(self.times().len() - kept);
        for column in &mut self.columns {
            column.truncate(kept);
        }
        self.events.retain(|(at, _)| *at <= time);
    }

    /// An empty history of a model.
    #[must_use]
    pub fn new<T: Float>(
        model: &(impl Model<T> + ?Sized),
        sampling: Sampling,
        content: Content,
    ) -> Self {
        Self::of(model.scene(), model.layout(), sampling, content)
    }

    fn of(scene: &Scene, layout: &Layout, sampling: Sampling, content: Content) -> Self {
        let before = content.groups().filter(|it| !it.outputs && !it.energy);
        let before = names(scene, layout, before.fold(Content::TIME, Content::and)).len();
        // Those that hold the quantities of metrics stand behind the declared ones.
        let metrics = scene.runs.metrics.iter().filter_map(|metric| metric.output);
        let declared = metrics.min().unwrap_or(scene.outputs.len());
        let declared = scene.outputs.iter().take(declared);
        let columns: usize = declared.map(|output| output.components).sum();
        let outputs = match content.outputs {
            true => before..before + columns,
            false => 0..0,
        };
        let outputs = outputs.map(|column| (column, 0..usize::MAX)).collect();
        let all = scene.outputs.iter();
        let all = all.flat_map(|output| std::iter::repeat_n(output, output.components));
        let efforts = (before..).zip(all.filter(|_| content.outputs));
        let efforts = efforts.filter(|(_, output)| {
            let asked = FromSolution::by(scene, std::iter::once(&output.value));
            asked.multipliers || asked.reactions
        });
        let efforts = efforts.map(|(column, _)| column).collect();
        let names = names(scene, layout, content);
        let mut history = Trajectory {
            model: identity::of_columns(scene, layout),
            columns: vec![Vec::new(); names.len()],
            maker: DroppedHere::new(RowMaker::new(content, names.len())),
            names,
            outputs,
            efforts,
            sampling,
            first: f64::NAN,
            next: 0,
            beside: false,
            end: f64::NAN,
            declared: Vec::new(),
            measures: DroppedHere::new(Measures::default()),
            parts: Vec::new(),
            measured: DroppedHere::new(RowMaker::new(Content::TIME, 0)),
            inside: DroppedHere::new(RowMaker::new(Content::TIME, 0)),
            undetermined: 0,
            locates: true,
            events: Vec::new(),
            statistics: Statistics::default(),
        };
        let declared = scene.runs.metrics.iter().map(|metric| {
            let reader = MetricReader::new(metric, scene, &history.names);
            (metric.name.clone(), reader)
        });
        history.declared = declared.collect();
        let readers = history.declared.iter();
        let readers = readers.filter_map(|(_, reader)| reader.clone().ok());
        history.measure_columns((scene, layout), readers.collect());
        history
    }

    /// Measures these metrics in the runs that are recorded from now on, in place of those that the declaration has; none where the list is empty.
    /// What a history measures costs some evaluations of the quantities at every step.
    #[must_use]
    pub fn measure<T: Float>(
        mut self,
        model: &(impl Model<T> + ?Sized),
        readers: &[MetricReader],
    ) -> Self {
        self.measure_columns((model.scene(), model.layout()), readers.to_vec());
        self
    }

    fn measure_columns(&mut self, scene: (&Scene, &Layout), readers: Vec<MetricReader>) {
        let those = |ask: &dyn Fn(&MetricReader) -> bool| -> Vec<usize> {
            let asked = readers.iter().filter(|reader| ask(reader));
            asked.map(|reader| reader.column).collect()
        };
        let mut columns = those(&|reader| reader.take != Take::TimeOf);
        columns.sort_unstable();
        columns.dedup();
        let over_time = those(&MetricReader::is_over_time);
        *self.measured = self.rows_with(scene, &columns, &columns);
        *self.inside = self.rows_with(scene, &over_time, &columns);
        let readers = readers.into_iter().map(|reader| {
            let column = columns.binary_search(&reader.column).unwrap_or(0);
            (reader, column)
        });
        *self.measures = Measures::new(readers.collect(), columns.len());
    }

    /// Makes rows of those groups of columns that one of `needed` is in; picks `columns` of them, of those that are in none nothing.
    fn rows_with(
        &self,
        (scene, layout): (&Scene, &Layout),
        needed: &[usize],
        columns: &[usize],
    ) -> RowMaker {
        let (mut content, mut kept, mut begins) = (Content::TIME, vec![0], 1);
        for group in self.maker.content.groups() {
            let count = names(scene, layout, group).len() - 1;
            let own = begins..begins + count;
            if needed.iter().any(|column| own.contains(column)) {
                content = content.and(group);
                kept.extend(own);
            }
            begins += count;
        }
        let place = |column: &usize| kept.iter().position(|own| own == column);
        let mut maker = RowMaker::new(content, kept.len());
        maker.picked = columns.iter().map(place).collect();
        maker
    }

    /// The value of a metric that this history measures, and what it may be off by because the quantity was not resolved, both in its unit.
    ///
    /// # Errors
    /// It is not measured, or has no value: [`MissingMetric`].
    pub fn measured(&self, reader: &MetricReader) -> Result<[f64; 2], MissingMetric> {
        self.measured_in(reader, &|_| true)
    }

    /// The same over those parts of a [joined](Joined::join) history whose models `counts`, by their indices; of another history over all of it.
    ///
    /// # Errors
    /// As [`Trajectory::measured`]; the run came to none of these models.
    pub fn measured_in(
        &self,
        reader: &MetricReader,
        counts: &dyn Fn(usize) -> bool,
    ) -> Result<[f64; 2], MissingMetric> {
        let value = match self.parts.is_empty() {
            true => self.measures.value(reader),
            false => Some(MeasuredRun::of_all(&self.parts, reader, counts).0),
        };
        match value.unwrap_or(Err(MissingMetric::NotRecorded)) {
            Err(MissingMetric::NoEvent) if !self.locates => Err(MissingMetric::NotLocated),
            Err(MissingMetric::NotANumber { time }) if self.is_undetermined(reader.column) => {
                Err(MissingMetric::Undetermined { time })
            }
            value => value,
        }
    }

    /// When the last part of a [joined](Joined::join) history ended whose model `counts` and that measures a metric [s]; of another history its end. Not a
    /// number where the run came to none.
    #[must_use]
    pub fn end_in(&self, reader: &MetricReader, counts: &dyn Fn(usize) -> bool) -> f64 {
        match self.parts.is_empty() {
            true => self.end,
            false => {
                let (_, end) = MeasuredRun::of_all(&self.parts, reader, counts);
                end.unwrap_or(f64::NAN)
            }
        }
    }

    /// When the recorded run ended [s], whether there is a row or not; not a number where it did not come to an end.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Drops all rows and events, for another run of the same scene; the memory stays.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.events.clear();
        (self.first, self.next, self.undetermined) = (f64::NAN, 0, 0);
        self.beside = false;
        self.end = f64::NAN;
        self.measures.clear();
        self.statistics = Statistics::default();
    }

    /// Whether it takes declared outputs, or what metrics measure.
    pub(crate) fn takes_outputs(&self) -> bool {
        !self.outputs.is_empty() || !self.declared.is_empty()
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether nothing was recorded yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column `time`, or any other by name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.names.iter().position(|column| column.name == name)?;
        self.columns.get(index).map(Vec::as_slice)
    }

    /// Names and units of the columns, in order.
    #[must_use]
    pub fn names(&self) -> &[Name] {
        &self.names
    }

    /// The time of every row [s].
    #[must_use]
    pub fn times(&self) -> &[f64] {
        self.columns.first().map_or(&[], Vec::as_slice)
    }

    /// A column by its place among [`Trajectory::names`]; empty where there is none.
    #[must_use]
    pub fn values(&self, index: usize) -> &[f64] {
        self.columns.get(index).map_or(&[], Vec::as_slice)
    }

    /// The columns of declared outputs that are infinite or not a number in some row, such as `v / norm(v)` of what is at rest; of a
    /// [joined](Joined::join) history in some row of a model that has them. Metrics tell by themselves where they have no value.
    #[must_use]
    pub fn not_finite(&self) -> Vec<NotFinite<'_>> {
        let columns = self.names.iter().zip(&self.columns).enumerate();
        let found = columns.filter_map(|(index, (name, column))| {
            let own = self.outputs.iter().filter(|(output, _)| *output == index);
            let rows = own.flat_map(|(_, rows)| rows.start..rows.end.min(column.len()));
            let mut without = rows.filter(|row| column.get(*row).is_some_and(|x| !x.is_finite()));
            let first = without.next()?;
            Some(NotFinite {
                name: &name.name,
                time: self.times().get(first).copied()?,
                rows: 1 + without.count(),
                undetermined: self.is_undetermined(index),
            })
        });
        found.collect()
    }

    /// Whether a column without a value has none because rows of joints lost rank.
    fn is_undetermined(&self, column: usize) -> bool {
        self.statistics.rows_chosen > 0 && self.efforts.contains(&column)
    }

    /// When its rows are written.
    #[must_use]
    pub fn sampling(&self) -> &Sampling {
        &self.sampling
    }

    /// Writes comma-separated values; the header holds names with units and remarks, `riser.tension [N]`, `close.force.x [N; not unique]`. A
    /// number that there is not is an empty cell.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_csv(&self, mut to: impl Write) -> io::Result<()> {
        for (index, column) in self.names.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            write!(to, "{comma}{}", column.heading())?;
        }
        writeln!(to)?;
        for row in 0..self.len() {
            for (index, column) in self.columns.iter().enumerate() {
                if index > 0 {
                    write!(to, ",")?;
                }
                let value = column.get(row).copied().unwrap_or(f64::NAN);
                let size = value.abs();
                if value.is_nan() {
                    continue;
                }
                if value == 0.0 {
                    write!(to, "0")?;
                } else if (1e-4..1e15).contains(&size) {
                    write!(to, "{value}")?;
                } else {
                    write!(to, "{value:e}")?;
                }
            }
            writeln!(to)?;
        }
        to.flush()
    }

    /// The next time a row is due, if rows follow a grid.
    pub(crate) fn due(&self) -> Option<f64> {
        match &self.sampling {
            Sampling::Steps => None,
            Sampling::Every(interval) => Some(self.first + self.next as f64 * interval),
            Sampling::At(times) => Some(times.get(self.next).copied().unwrap_or(f64::INFINITY)),
        }
    }

    /// Whether a row is due inside a step from a time on of a size [s], and not just at its end.
    pub(crate) fn is_due_inside(&self, [time, step]: [f64; 2]) -> bool {
        let end = time + step;
        self.due().is_some_and(|due| end - due > resolution(end))
    }

    /// Refuses what cannot be recorded of a run of a model from one time until another.
    pub(crate) fn check(&self, model: u64, [time, until]: [f64; 2]) -> Result<(), StepError> {
        if model != self.model {
            return Err(StepError::Unsupported {
                what: "a history of another model".into(),
                instead: "make one with `Trajectory::new` of the model that runs".into(),
            });
        }
        // Of a run that failed or was cancelled it ends with its last row.
        let end = self
            .times()
            .last()
            .map_or(self.end, |row| self.end.max(*row));
        if end - time > resolution(time) {
            return Err(StepError::Unsupported {
                what: format!(
                    "a history of a run until {} s for one that stands at {} s",
                    plain(end, 10),
                    plain(time, 10)
                ),
                instead: "`clear` it before another run, or make a new one".into(),
            });
        }
        let invalid = |value: f64| {
            let slot =
                "sampling interval or time (finite, increasing, as far apart as time resolves)";
            let slot = slot.into();
            StepError::InvalidInput { slot, value }
        };
        match &self.sampling {
            Sampling::Steps => Ok(()),
            Sampling::Every(interval) if !(*interval > 0.0 && interval.is_finite()) => {
                Err(invalid(*interval))
            }
            Sampling::Every(interval) => {
                self.fits((until - time) / interval)?;
                // Closer rows would repeat each other, and never reach the next step.
                let closest = resolution(time).max(resolution(until));
                match *interval > closest {
                    true => Ok(()),
                    false => Err(invalid(*interval)),
                }
            }
            Sampling::At(times) => {
                let not_after = times
                    .windows(2)
                    .find(|pair| !pair.is_sorted_by(|a, b| a < b));
                let not_after = not_after.and_then(|pair| pair.last());
                let bad = times.iter().find(|time| !time.is_finite()).or(not_after);
                bad.map_or(Ok(()), |time| Err(invalid(*time)))?;
                // Left out, it would part the indices of times and rows.
                match times.get(self.next).filter(|due| is_past(**due, time)) {
                    None => Ok(()),
                    Some(due) => Err(StepError::Unsupported {
                        what: format!(
                            "a row at {} s of a run that stands at {} s",
                            plain(*due, 10),
                            plain(time, 10)
                        ),
                        instead: "leave out the times before it (`Sampling::from_time`), or let the run stand at the first of them (`set_state`)".into(),
                    }),
                }
            }
        }
    }

    /// Prepares for a run that starts at `time`; grid times before it are skipped. True when a row is due at the start.
    pub(crate) fn open(&mut self, time: f64) -> bool {
        self.drop_end();
        if self.first.is_nan() {
            self.first = time;
        }
        if let Sampling::Every(interval) = &self.sampling {
            let passed = ((time - self.first) / interval).floor() - 1.0;
            self.next = self.next.max(passed as usize);
        }
        while self.due().is_some_and(|due| is_past(due, time)) {
            self.next += 1;
        }
        match self.due() {
            Some(due) => due <= time + resolution(time),
            None => self.times().last() != Some(&time),
        }
    }

    /// Refuses so many more rows where memory has no room for them.
    fn fits(&self, more: f64) -> Result<(), StepError> {
        let (rows, columns) = (self.len() as f64 + more, self.columns.len());
        match rows * columns as f64 <= Self::MOST_NUMBERS {
            true => Ok(()),
            false => Err(StepError::LongHistory { rows, columns }),
        }
    }

    /// Adds a row at a state.
    pub(crate) fn push<T: Float>(
        &mut self,
        system: &mut System<T>,
        (time, place): (f64, RowPlace),
        state: &[T],
        scratch: &mut [T],
    ) -> Result<(), StepError> {
        self.fits(1.0)?;
        let undetermined = self.maker.make(system, (time, place), state, scratch)?;
        self.undetermined += u64::from(undetermined);
        self.maker.go_on_from(&self.columns);
        for (column, value) in self.columns.iter_mut().zip(&self.maker.row) {
            column.push(*value);
        }
        self.next += 1;
        self.statistics = system.statistics();
        Ok(())
    }

    /// The last row, where every step is one, is of this time [s], which is one with its own.
    pub(crate) fn put_last_at(&mut self, time: f64) {
        let times = self
            .columns
            .first_mut()
            .filter(|_| self.sampling == Sampling::Steps);
        if let Some(last) = times.and_then(|times| times.last_mut()) {
            *last = time;
        }
    }

    /// The run ended here. A history whose grid has no row at this time gets one; where the run goes on it is dropped.
    pub(crate) fn push_end<T: Float>(
        &mut self,
        system: &mut System<T>,
        time: f64,
        state: &[T],
        scratch: &mut [T],
    ) -> Result<(), StepError> {
        self.end = time;
        let last = self.times().last().copied().unwrap_or(f64::NEG_INFINITY);
        if !matches!(self.sampling, Sampling::Every(_)) || last >= time - resolution(time) {
            return Ok(());
        }
        self.push(system, (time, RowPlace::After(0.0)), state, scratch)?;
        self.next -= 1;
        self.beside = true;
        Ok(())
    }

    fn drop_end(&mut self) {
        if std::mem::take(&mut self.beside) {
            for column in &mut self.columns {
                column.pop();
            }
        }
    }

    /// Whether a row is due in a step from a time on of a size [s] or at its end, or what is measured of it is more than its lists.
    pub(crate) fn reads_end_of(&self, [time, step]: [f64; 2]) -> bool {
        let end = time + step;
        let row = self.due().is_none_or(|due| due <= end + resolution(end));
        row || !(self.inside.is_of_lists() && self.measures.goes_on_from(time))
    }

    /// Measures a step by the lists that are known at its end.
    pub(crate) fn measure_received<T: Float>(
        &mut self,
        step: MeasuredStep<'_>,
        model: &dyn Model<T>,
        attempt: &dyn Attempt<T>,
    ) {
        if self.measures.is_empty() {
            return;
        }
        let inside = &self.inside;
        // Reading lists does not fail.
        let _ = self.measures.step(step, &mut |_, out| {
            inside.pick_received(model, attempt, out);
            Ok(())
        });
    }

    /// Whether anything is measured over every step.
    pub(crate) fn measures_steps(&self) -> bool {
        self.measures.is_over_time()
    }

    /// What is read at the end of every step, to be measured.
    pub(crate) fn looks_at(&self) -> Content {
        match self.measures.is_over_time() {
            true => self.inside.content,
            false => Content::TIME,
        }
    }

    /// What is measured, and how rows of it are made at instants, and over steps.
    pub(crate) fn measuring(&mut self) -> Option<(&mut Measures, [&mut RowMaker; 2])> {
        let any = !self.measures.is_empty();
        any.then(|| {
            (
                &mut *self.measures,
                [&mut *self.measured, &mut *self.inside],
            )
        })
    }

    /// Adds an event that was located at a time, at the last instant that was measured, and had passed at another [s].
    pub(crate) fn tell(&mut self, [time, passed]: [f64; 2], event: String) {
        self.measures.happens(passed, &event);
        self.events.push((time, event));
    }
}

/// Whether a row is due before the time at which a run stands.
fn is_past(due: f64, time: f64) -> bool {
    due < time - resolution(time)
}

/// How much later than a time formulas see another one, whose time is a number of the run [s].
pub(crate) fn told_apart<T: Float>(time: f64) -> f64 {
    resolution(time).max(2.0 * T::EPSILON.to_f64() * time.abs())
}

/// Times closer than this are the same time.
pub(crate) fn resolution(time: f64) -> f64 {
    16.0 * f64::EPSILON * time.abs().max(1e-6)
}
