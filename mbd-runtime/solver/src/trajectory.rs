//! The history of a run: named columns with units.

use std::io::{self, Write};

use mbd_scene::{Float, Layout, Model, Quantity, Scene};

use crate::columns::{Name, carried_names, joint_name, line_name, node_name, state_names};
use crate::error::{Statistics, StepError};
use crate::system::{System, WORKS};

mod joined;

pub use joined::Joined;
use joined::JoinedPart;

/// When a row is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Sampling {
    /// At the start and after every accepted step, located events included; where an event acts, a row before it and one after it.
    Steps,
    /// Every so many seconds from the first row on, by the interpolant of the method.
    Every(f64),
    /// At these times, increasing [s].
    At(Vec<f64>),
}

/// What a row holds besides the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// All coordinates of the state; what the quaternions, and in a scene with joints Φ and Φ̇, are off by: the largest row, rows without unit
    /// counted as metres.
    pub state: bool,
    /// Positions of nodes that are not part of the state, velocities of `rate` nodes.
    pub nodes: bool,
    /// Tension [N] and stretch [m] of every line.
    pub lines: bool,
    /// Force [N] and torque [N m] of every joint on its child at the origin of its frame there, world axes. Where rows repeat others they are
    /// not unique, and the column says so: the rows that were left out carry nothing.
    pub reactions: bool,
    /// The declared outputs.
    pub outputs: bool,
    /// Kinetic, gravitational and elastic energy and their sum [J], power of loads, dampers and prescribed
    /// motions [W], and their work [J] when the run integrates it; in a scene whose events change something also the work of these actions [J].
    pub energy: bool,
}

impl Content {
    /// Everything.
    pub const ALL: Content = Content {
        state: true,
        nodes: true,
        lines: true,
        reactions: true,
        outputs: true,
        energy: true,
    };
    /// Line tensions and declared outputs only.
    pub const RESULTS: Content = Content {
        state: false,
        nodes: false,
        lines: true,
        reactions: false,
        outputs: true,
        energy: false,
    };
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
    names: Vec<Name>,
    columns: Vec<Vec<f64>>,
    row: Vec<f64>,
    content: Content,
    sampling: Sampling,
    first: f64,
    /// Rows written, and the index of the next grid time.
    next: usize,
    /// Rows at which some reactions or efforts of motors have no value, because rows of joints lose rank, and not in passing: they are not
    /// numbers there, and their cells in CSV are empty. In passing they have the value they tend to.
    pub undetermined: u64,
    /// Located events: time [s] and name (`chute_open`, `riser: taut`).
    pub events: Vec<(f64, String)>,
    /// Counters of the run at its last row.
    pub statistics: Statistics,
    /// Of a history that was put together, its parts; empty of the history of one model.
    parts: Vec<JoinedPart>,
}

impl Trajectory {
    /// Drops the rows and the events after a time [s].
    pub(crate) fn cut(&mut self, time: f64) {
        let kept = self.times().partition_point(|row| *row <= time);
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
        let names = names(scene, layout, content);
        Trajectory {
            columns: vec![Vec::new(); names.len()],
            row: Vec::with_capacity(names.len()),
            names,
            content,
            sampling,
            first: f64::NAN,
            next: 0,
            undetermined: 0,
            events: Vec::new(),
            statistics: Statistics::default(),
            parts: Vec::new(),
        }
    }

    /// Drops all rows and events, for another run of the same scene; the memory stays.
    pub fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.events.clear();
        (self.first, self.next, self.undetermined) = (f64::NAN, 0, 0);
        self.statistics = Statistics::default();
        self.parts.clear();
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

    /// Prepares for a run that starts at `time`; grid times before it are skipped. True when a row is due at the start.
    pub(crate) fn open(&mut self, time: f64) -> Result<bool, StepError> {
        let invalid = match &self.sampling {
            Sampling::Every(interval) => Some(*interval).filter(|x| !(*x > 0.0 && x.is_finite())),
            Sampling::At(times) => {
                let ordered = times
                    .windows(2)
                    .find(|pair| !pair.is_sorted_by(|a, b| a < b));
                let bad = times.iter().find(|time| !time.is_finite());
                bad.copied()
                    .or(ordered.and_then(|pair| pair.last().copied()))
            }
            Sampling::Steps => None,
        };
        if let Some(value) = invalid {
            let slot = "sampling interval or time (finite, increasing)".into();
            return Err(StepError::InvalidInput { slot, value });
        }
        if self.first.is_nan() {
            self.first = time;
        }
        while self.due().is_some_and(|due| due < time - resolution(time)) {
            self.next += 1;
        }
        Ok(match self.due() {
            Some(due) => due <= time + resolution(time),
            None => self.times().last() != Some(&time),
        })
    }

    /// Adds a row at the state that `system` looks at.
    pub(crate) fn push<T: Float>(
        &mut self,
        system: &mut System<T>,
        time: f64,
        span: f64,
        state: &[T],
        scratch: &mut [T],
    ) -> Result<(), StepError> {
        system.look(time, span, state)?;
        let model = system.model.clone();
        let layout = model.layout();
        let state_alone = state.get(..layout.nx()).unwrap_or_default();
        let forces = self.content.reactions || self.content.outputs || self.content.energy;
        // Where rows lose rank for longer than an instant some multipliers have no value, and what hangs on them none either.
        let anew = (forces && system.needs_anew(time, state_alone))
            .then(|| system.read_anew(time, state_alone));
        let determined = anew
            .as_ref()
            .map(|[_, determined, rates]| [determined.as_slice(), rates.as_slice()]);
        self.row.clear();
        self.row.push(time);
        if self.content.state {
            self.row.extend(system.in_world(time, state));
            let bodies = read(system, (Quantity::Bodies, None), time, state, scratch);
            for (own, numbers) in layout
                .bodies
                .iter()
                .zip(bodies.chunks_exact(layout.directions.motion()))
            {
                if own.is_none() {
                    self.row.extend(numbers.iter().map(|x| x.to_f64()));
                }
            }
            self.row.push(system.drift);
            for what in [Quantity::Constraint, Quantity::ConstraintRate] {
                let rows = read(system, (what, None), time, state, scratch);
                let sizes = rows.iter().map(|x| x.to_f64().abs());
                self.row.extend(sizes.reduce(f64::max));
            }
        }
        if self.content.nodes {
            self.row
                .extend(system.nodes_in_world(time, system.probe.nodes()));
        }
        if self.content.lines {
            let lines = read(system, (Quantity::Lines, None), time, state, scratch);
            for line in lines.chunks_exact(10) {
                self.row
                    .extend(line.iter().step_by(2).take(2).map(|x| x.to_f64()));
            }
        }
        if self.content.reactions {
            let what = (Quantity::Reactions, determined);
            let reactions = read(system, what, time, state, scratch);
            self.row.extend(reactions.iter().map(|x| x.to_f64()));
        }
        if self.content.outputs {
            // Most outputs have nothing to do with multipliers: the model's own are taken to the bit.
            let asks = layout.asks_efforts(Quantity::Outputs);
            let what = (Quantity::Outputs, determined.filter(|_| asks));
            let outputs = read(system, what, time, state, scratch);
            self.row.extend(outputs.iter().map(|x| x.to_f64()));
        }
        if anew.is_some() && self.row.iter().any(|x| x.is_nan()) {
            self.undetermined += 1;
        }
        if self.content.energy {
            let driven = layout.joints.iter().any(|slots| slots.driven);
            // The power of prescribed motions is the same for every solution.
            let all = anew.as_ref().map(|[all, ..]| [all.as_slice(), &[]]);
            let what = (Quantity::Energy, all.filter(|_| driven));
            let energy = read(system, what, time, state, scratch);
            self.row.extend(energy.iter().take(3).map(|x| x.to_f64()));
            self.row
                .push(energy.iter().take(3).map(|x| x.to_f64()).sum());
            self.row.extend(energy.iter().skip(3).map(|x| x.to_f64()));
            let works = state.iter().skip(layout.nx()).map(|x| x.to_f64());
            self.row.extend(works.chain([f64::NAN; WORKS]).take(WORKS));
            if acts(model.scene()) {
                self.row.push(system.action_work);
            }
        }
        for (column, value) in self.columns.iter_mut().zip(&self.row) {
            column.push(*value);
        }
        self.next += 1;
        self.statistics = system.statistics();
        Ok(())
    }
}

/// A quantity at the state that `system` looked at last; with multipliers and accelerations that were found apart from the model, if there are any.
fn read<'s, T: Float>(
    system: &mut System<T>,
    (what, found): (Quantity, Option<[&[f64]; 2]>),
    time: f64,
    state: &[T],
    scratch: &'s mut [T],
) -> &'s [T] {
    let layout = system.model.layout();
    let (length, own) = (layout.len(what), state.get(..layout.nx()));
    let list = scratch.get_mut(..length).unwrap_or_default();
    match found {
        Some(found) => system.by_multipliers(what, (time, own.unwrap_or_default()), found, list),
        None => system.seen(what, time, state, list),
    }
    list
}

/// Times closer than this are the same time.
pub(crate) fn resolution(time: f64) -> f64 {
    16.0 * f64::EPSILON * time.abs().max(1e-6)
}

/// Whether events change what is run.
fn acts(scene: &Scene) -> bool {
    scene.events.iter().any(|event| event.actions.changes())
}

fn names(scene: &Scene, layout: &Layout, content: Content) -> Vec<Name> {
    let mut names = vec![Name::new("time", "", "s")];
    if content.state {
        names.extend(state_names(scene, layout));
        names.extend(carried_names(scene, layout));
        names.push(Name::new("quaternion_drift", "", ""));
        if layout.nc > 0 {
            names.push(Name::new("joint_drift", "", "m"));
            names.push(Name::new("joint_drift_rate", "", "m/s"));
        }
    }
    if content.nodes {
        for node in &layout.nodes {
            let (components, unit) = match node.z {
                None => (["x", "y", "z"], "m"),
                Some(_) => (["vx", "vy", "vz"], "m/s"),
            };
            let owner = node_name(scene, node.point);
            names.extend(components.map(|component| Name::new(owner, component, unit)));
        }
    }
    if content.lines {
        for line in 0..scene.lines.len() {
            names.push(Name::new(line_name(scene, line), "tension", "N"));
            names.push(Name::new(line_name(scene, line), "stretch", "m"));
        }
    }
    if content.reactions && layout.len(Quantity::Reactions) > 0 {
        for joint in 0..scene.joints.len() {
            for (kind, unit) in [("force", "N"), ("torque", "N m")] {
                let owner = format!("{}.{kind}", joint_name(scene, joint));
                let remark = match layout.redundancy.is_unique(joint) {
                    true => "",
                    false => "not unique",
                };
                names.extend(["x", "y", "z"].map(|c| Name {
                    remark: remark.to_owned(),
                    ..Name::new(&owner, c, unit)
                }));
            }
        }
    }
    if content.outputs {
        for output in &scene.outputs {
            let unit = &output.unit.text;
            match output.components {
                1 => names.push(Name::new(&output.name, "", unit)),
                _ => names.extend(["x", "y", "z"].map(|c| Name::new(&output.name, c, unit))),
            }
        }
    }
    if content.energy {
        names.extend(
            ["kinetic", "gravitational", "elastic", "total"]
                .map(|kind| Name::new("energy", kind, "J")),
        );
        let kinds = ["loads", "dampers", "drives"];
        names.extend(kinds.map(|kind| Name::new("power", kind, "W")));
        names.extend(kinds.map(|kind| Name::new("work", kind, "J")));
        if acts(scene) {
            names.push(Name::new("work", "actions", "J"));
        }
    }
    names
}
