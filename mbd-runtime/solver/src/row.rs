//! A row of a history: the numbers of its columns at a state.

use mbd_scene::{Float, LINE_NUMBERS, Layout, Model, Quantity, Scene};

use crate::columns::{Name, carried_names, joint_name, line_name, node_name, remark, state_names};
use crate::content::Content;
use crate::error::StepError;
use crate::linearise::output_names;
use crate::simulation::beside::Attempt;
use crate::system::{LINES, OUTPUTS, System, WORKS};

/// Columns of a body in space.
const NUMBERS_OF_A_BODY: usize = 13;

/// Where a row is made.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RowPlace {
    /// So long after the last accepted step [s].
    After(f64),
    /// At the end of the attempted step, whose nodes are solved.
    End,
    /// Right before the events at the end of the attempted step, at this time, so long after the last accepted step [s].
    Before(f64, f64),
}

/// Makes rows with some content.
#[derive(Clone, Debug)]
pub(crate) struct RowMaker {
    pub content: Content,
    /// The last row, its time first.
    pub row: Vec<f64>,
    /// Where in it the quaternions begin of bodies that joint coordinates place: both signs are one attitude.
    attitudes: Vec<usize>,
    /// Which of its numbers are measured; `None` of a column that it has not.
    pub picked: Vec<Option<usize>>,
}

/// What they make, not what they made last.
impl PartialEq for RowMaker {
    fn eq(&self, other: &Self) -> bool {
        self.content == other.content && self.picked == other.picked
    }
}

impl RowMaker {
    /// Of rows with this content, which have so many columns.
    pub(crate) fn new(content: Content, columns: usize) -> Self {
        RowMaker {
            content,
            row: Vec::with_capacity(columns),
            attitudes: Vec::with_capacity(columns / NUMBERS_OF_A_BODY),
            picked: Vec::new(),
        }
    }

    /// Gives every quaternion of the row the sign with which it goes on from the last row of a history.
    pub(crate) fn go_on_from(&mut self, columns: &[Vec<f64>]) {
        for &at in &self.attitudes {
            let last = columns.iter().skip(at).filter_map(|column| column.last());
            let own = self.row.get_mut(at..at + 4).unwrap_or_default();
            let along: f64 = last.zip(&*own).map(|(a, b)| a * b).sum();
            if along < 0.0 {
                own.iter_mut().for_each(|x| *x = -*x);
            }
        }
    }

    /// Writes what is measured of the row at a state.
    pub(crate) fn pick<T: Float>(
        &mut self,
        system: &mut System<T>,
        (time, place): (f64, RowPlace),
        (state, scratch): (&[T], &mut [T]),
        out: &mut [f64],
    ) -> Result<(), StepError> {
        self.make(system, (time, place), state, scratch)?;
        for (out, column) in out.iter_mut().zip(&self.picked) {
            let value = column.and_then(|column| self.row.get(column));
            *out = value.copied().unwrap_or(f64::NAN);
        }
        Ok(())
    }

    /// Whether its rows hold nothing but outputs and lines, which are known as lists.
    pub(crate) fn is_of_lists(&self) -> bool {
        let lists = Content {
            lines: true,
            outputs: true,
            ..Content::TIME
        };
        self.content.and(lists) == lists
    }

    /// Writes what is measured of such a row at the end of a step that was made elsewhere.
    pub(crate) fn pick_received<T: Float>(
        &self,
        model: &dyn Model<T>,
        attempt: &dyn Attempt<T>,
        out: &mut [f64],
    ) {
        let of_lines = match self.content.lines {
            true => 2 * model.layout().lines.len(),
            false => 0,
        };
        for (out, column) in out.iter_mut().zip(&self.picked) {
            *out = match column.and_then(|column| column.checked_sub(1)) {
                None => f64::NAN,
                Some(line) if line < of_lines => {
                    // Tension and stretch begin what is told of each.
                    let index = LINE_NUMBERS * (line / 2) + 2 * (line % 2);
                    attempt.number(LINES, index).to_f64()
                }
                Some(other) => attempt.number(OUTPUTS, other - of_lines).to_f64(),
            };
        }
    }

    /// Makes the row at a state; whether something of it has no value because rows of joints lose rank.
    pub(crate) fn make<T: Float>(
        &mut self,
        system: &mut System<T>,
        (time, place): (f64, RowPlace),
        state: &[T],
        scratch: &mut [T],
    ) -> Result<bool, StepError> {
        let (content, row) = (self.content, &mut self.row);
        let told = time;
        let (time, span) = match place {
            RowPlace::After(span) => (time, Some(span)),
            RowPlace::Before(time, span) => (time, Some(span)),
            RowPlace::End => (time, None),
        };
        match span {
            Some(span) => system.look(time, span, state)?,
            None => system.look_at_end(time, state)?,
        }
        let state_alone = state.get(..system.nx).unwrap_or_default();
        let forces = content.reactions || content.outputs || content.energy;
        // Where rows lose rank for longer than an instant some multipliers have no value, and what hangs on them none either.
        let anew = match forces {
            true => system.look_anew(time, state_alone),
            false => None,
        };
        let determined = anew
            .as_ref()
            .map(|[_, determined, rates]| [determined.as_slice(), rates.as_slice()]);
        row.clear();
        self.attitudes.clear();
        row.push(told);
        if content.state {
            let model = system.model.clone();
            let layout = model.layout();
            row.extend(system.in_world(time, state));
            let bodies = read(system, (Quantity::Bodies, None), time, state, scratch);
            for (own, numbers) in layout
                .bodies
                .iter()
                .zip(bodies.chunks_exact(layout.directions.motion()))
            {
                if own.is_none() {
                    let attitude = row.len() + layout.directions.translations().len();
                    row.extend(numbers.iter().map(|x| x.to_f64()));
                    if layout.directions.plane.is_none() {
                        self.attitudes.push(attitude);
                    }
                }
            }
            row.push(system.drift);
            for what in [Quantity::Constraint, Quantity::ConstraintRate] {
                let rows = read(system, (what, None), time, state, scratch);
                let sizes = rows.iter().map(|x| x.to_f64().abs());
                row.extend(sizes.reduce(f64::max));
            }
        }
        if content.nodes {
            row.extend(system.nodes_in_world(time, system.seen_nodes().nodes()));
        }
        if content.lines {
            let lines = read(system, (Quantity::Lines, None), time, state, scratch);
            for line in lines.chunks_exact(LINE_NUMBERS) {
                row.extend(line.iter().step_by(2).take(2).map(|x| x.to_f64()));
            }
        }
        if content.reactions {
            let what = (Quantity::Reactions, determined);
            let reactions = read(system, what, time, state, scratch);
            row.extend(reactions.iter().map(|x| x.to_f64()));
        }
        if content.outputs {
            // Most outputs have nothing to do with multipliers: the model's own are taken to the bit.
            let asks = system.model.layout().asks_efforts(Quantity::Outputs);
            let what = (Quantity::Outputs, determined.filter(|_| asks));
            let outputs = read(system, what, time, state, scratch);
            row.extend(outputs.iter().map(|x| x.to_f64()));
        }
        let undetermined = anew.is_some() && row.iter().any(|x| x.is_nan());
        if content.energy {
            let model = system.model.clone();
            let driven = model.layout().joints.iter().any(|slots| slots.driven);
            // The power of prescribed motions is the same for every solution.
            let all = anew.as_ref().map(|[all, ..]| [all.as_slice(), &[]]);
            let what = (Quantity::Energy, all.filter(|_| driven));
            let energy = read(system, what, time, state, scratch);
            row.extend(energy.iter().take(3).map(|x| x.to_f64()));
            row.push(energy.iter().take(3).map(|x| x.to_f64()).sum());
            row.extend(energy.iter().skip(3).map(|x| x.to_f64()));
            let works = state.iter().skip(system.nx).map(|x| x.to_f64());
            row.extend(works.chain([f64::NAN; WORKS]).take(WORKS));
            if acts(model.scene()) {
                row.push(system.action_work);
            }
        }
        Ok(undetermined)
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

/// Whether events change what is run.
fn acts(scene: &Scene) -> bool {
    scene.events.iter().any(|event| event.actions.changes())
}

/// The columns of rows.
pub(crate) fn names(scene: &Scene, layout: &Layout, content: Content) -> Vec<Name> {
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
            let ambiguous = layout.redundancy.ambiguous_components(joint);
            let vectors = [("force", "N"), ("torque", "N*m")].into_iter();
            for ((kind, unit), ambiguous) in vectors.zip(ambiguous.chunks(3)) {
                let owner = format!("{}.{kind}", joint_name(scene, joint));
                let axes = ["x", "y", "z"].iter().zip(ambiguous);
                names.extend(axes.map(|(axis, ambiguous)| Name {
                    remark: remark(*ambiguous),
                    ..Name::new(&owner, axis, unit)
                }));
            }
        }
    }
    if content.outputs {
        names.extend(output_names(scene, layout));
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
