//! The figures of a run: histories of outputs and tensions, forces in the joints, drift, energy.

use std::f64::consts::TAU;

use mbd_runtime::scene::{Gravity, Scene};
use mbd_runtime::{Layout, Name, Trajectory};

use super::figure::Figure;
use super::look::Look;
use super::series::Series;

/// Forces of more joints than this are not told apart: those with the largest forces are drawn.
const JOINTS: usize = 8;

/// Curves that share a plot.
#[derive(Clone, Debug)]
pub struct PlotGroup<'a> {
    pub(super) name: String,
    axis: String,
    unit: String,
    caption: String,
    curves: Vec<Curve<'a>>,
    logarithmic: bool,
}

/// A curve: recorded, or made of recorded ones.
#[derive(Clone, Debug)]
enum Curve<'a> {
    Column(&'a str, &'a [f64]),
    Made(String, Vec<f64>),
}

impl<'a> PlotGroup<'a> {
    fn of(name: &str, axis: &str, columns: &[&'a Name], trajectory: &'a Trajectory) -> Self {
        let curves = columns
            .iter()
            .filter_map(|name| Some(Curve::Column(&name.name, trajectory.column(&name.name)?)));
        PlotGroup {
            name: name.to_string(),
            axis: axis.to_string(),
            unit: columns
                .first()
                .map_or_else(String::new, |name| name.unit.clone()),
            caption: String::new(),
            curves: curves.collect(),
            logarithmic: false,
        }
    }

    /// The same curves in as many plots as it takes for each to have a look of its own.
    fn told_apart(self) -> Vec<PlotGroup<'a>> {
        let (all, most) = (self.curves.len(), Look::ALL.len());
        if all <= most {
            return vec![self];
        }
        let count = all.div_ceil(most);
        let mut curves = self.curves.into_iter();
        let part = |k: usize| PlotGroup {
            name: format!("{} ({} of {count})", self.name, k + 1),
            axis: self.axis.clone(),
            unit: self.unit.clone(),
            caption: self.caption.clone(),
            curves: curves.by_ref().take(all.div_ceil(count)).collect(),
            logarithmic: self.logarithmic,
        };
        (0..count).map(part).collect()
    }

    /// The picture over these times.
    #[must_use]
    pub fn figure(&'a self, times: &'a [f64]) -> Figure<'a> {
        let mut figure = Figure::new(&self.name)
            .x("time", "s")
            .y(&self.axis, &self.unit)
            .caption(&self.caption);
        if self.logarithmic {
            figure = figure.log_y();
        }
        self.curves.iter().fold(figure, |figure, curve| {
            let (name, values) = match curve {
                Curve::Column(name, values) => (*name, *values),
                Curve::Made(name, values) => (name.as_str(), values.as_slice()),
            };
            let series = Series::new(name, times, values);
            figure.series(match period(&self.unit, values) {
                Some(period) => series.periodic(period),
                None => series,
            })
        })
    }
}

/// All figures of a run: those that are asked for, one for each other output and for the tensions of each line, then joints and energy.
///
/// `figures`: titles, and the columns each shows.
#[must_use]
pub fn groups<'a>(
    scene: &Scene,
    figures: &[(String, Vec<String>)],
    trajectory: &'a Trajectory,
) -> Vec<PlotGroup<'a>> {
    let find = |column: &String| trajectory.names().iter().find(|name| name.name == *column);
    let mut groups: Vec<PlotGroup<'a>> = figures
        .iter()
        .map(|(title, columns)| {
            let columns: Vec<&Name> = columns.iter().filter_map(find).collect();
            PlotGroup::of(title, title, &columns, trajectory)
        })
        .collect();
    let shown = |name: &Name| figures.iter().any(|(_, list)| list.contains(&name.name));
    for (owner, axis, columns) in histories(scene, trajectory.names()) {
        let title = format!("{owner} {axis}");
        let mut columns: Vec<&Name> = columns.into_iter().filter(|name| !shown(name)).collect();
        if scene.planar.is_some() {
            // What a vector has across the plane is no curve.
            let zero = |name: &&Name| {
                let column = trajectory.column(&name.name).unwrap_or_default();
                column.iter().all(|x| *x == 0.0)
            };
            if !columns.iter().all(zero) {
                columns.retain(|name| !zero(name));
            }
        }
        if !columns.is_empty() {
            let axis = if axis.is_empty() { owner } else { axis };
            groups.push(PlotGroup::of(title.trim(), axis, &columns, trajectory));
        }
    }
    groups.extend(reactions(scene, trajectory));
    groups.extend(drift(trajectory));
    groups.extend(energy(scene, trajectory));
    groups.into_iter().flat_map(PlotGroup::told_apart).collect()
}

/// What an angle is periodic by, where all its values lie in one turn: `None` of other quantities and of angles that count turns.
pub(super) fn period(unit: &str, values: &[f64]) -> Option<f64> {
    let period = match unit {
        "rad" => TAU,
        "deg" => 360.0,
        _ => return None,
    };
    let (low, high) = values
        .iter()
        .filter(|x| x.is_finite())
        .fold((0.0_f64, 0.0_f64), |(low, high), x| {
            (low.min(*x), high.max(*x))
        });
    let slack = 1e-6 * period;
    let signed = low >= -0.5 * period - slack && high <= 0.5 * period + slack;
    let positive = low >= -slack && high <= period + slack;
    (signed || positive).then_some(period)
}

/// The word of a name without its index: `leg[2]` → `leg`.
fn base(name: &str) -> &str {
    name.split('[').next().unwrap_or(name)
}

/// Each output, each declared state and the tensions of each line: owner, quantity, columns; repeated ones share a figure.
fn histories<'s, 'n>(
    scene: &'s Scene,
    names: &'n [Name],
) -> Vec<(&'s str, &'static str, Vec<&'n Name>)> {
    let outputs = scene.outputs.iter().map(|output| {
        let of_a_metric = scene.output_column(output) != output.name;
        let what = if of_a_metric { "quantity" } else { "" };
        (base(&output.name), what)
    });
    let states = scene.states.iter().map(|state| (base(&state.name), ""));
    let lines = scene.lines.iter().map(|line| (base(&line.name), "tension"));
    let mut groups: Vec<(&str, &str, Vec<&Name>)> = Vec::new();
    for (owner, what) in outputs.chain(states).chain(lines) {
        if groups
            .iter()
            .any(|group| (group.0, group.1) == (owner, what))
        {
            continue;
        }
        let is_part = !what.is_empty();
        let belongs = |name: &&Name| match name.name.rsplit_once('.') {
            Some((line, part)) if is_part => part == what && base(line) == owner,
            Some((output, _)) => !is_part && base(output) == owner,
            None => !is_part && base(&name.name) == owner,
        };
        groups.push((owner, what, names.iter().filter(belongs).collect()));
    }
    groups
}

/// Sizes of the forces in the joints.
fn reactions<'a>(scene: &Scene, trajectory: &Trajectory) -> Option<PlotGroup<'a>> {
    let size = |joint: &str| -> Option<Vec<f64>> {
        let [x, y, z] =
            ["x", "y", "z"].map(|part| trajectory.column(&format!("{joint}.force.{part}")));
        let parts = x?.iter().zip(y?).zip(z?);
        Some(parts.map(|((x, y), z)| x.hypot(*y).hypot(*z)).collect())
    };
    let joints = scene.joints.iter().filter(|joint| joint.law.rows() > 0);
    let mut curves: Vec<(String, Vec<f64>)> = joints
        .filter_map(|joint| Some((joint.name.clone(), size(&joint.name)?)))
        .collect();
    let all = curves.len();
    if all == 0 {
        return None;
    }
    let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    if all > JOINTS {
        curves.sort_by(|(_, a), (_, b)| most(b).total_cmp(&most(a)));
        curves.truncate(JOINTS);
    }
    let mut caption = "Size of the force of each joint on its child. Components and torques are columns of history.csv.".to_string();
    if all > JOINTS {
        caption += &format!(" The {JOINTS} largest of {all}.");
    }
    let ambiguous = Layout::new(scene).redundancy.ambiguous;
    if ambiguous
        .iter()
        .any(|of| of.components[..3].contains(&true))
    {
        caption += " Rows repeat each other, so some of these forces are one choice of many; `mbd check` marks them.";
    }
    Some(PlotGroup {
        name: "Joints: force".to_string(),
        axis: "force".to_string(),
        unit: "N".to_string(),
        caption,
        curves: curves
            .into_iter()
            .map(|(name, values)| Curve::Made(name, values))
            .collect(),
        logarithmic: false,
    })
}

/// How far the joints are open.
fn drift<'a>(trajectory: &Trajectory) -> Option<PlotGroup<'a>> {
    // A logarithmic axis has no zero.
    let visible = |column: &[f64]| column.iter().map(|x| x.abs().max(1e-18)).collect();
    let position = visible(trajectory.column("joint_drift")?);
    let rate = visible(trajectory.column("joint_drift_rate")?);
    Some(PlotGroup {
        name: "Joints: drift".to_string(),
        axis: "drift".to_string(),
        unit: "m, m/s".to_string(),
        caption: "Largest row of Φ [m] and of its rate [m/s], rows without unit counted as metres; zero is drawn at 1e-18.".to_string(),
        curves: vec![
            Curve::Made("|Φ|".to_string(), position),
            Curve::Made("|dΦ/dt|".to_string(), rate),
        ],
        logarithmic: true,
    })
}

/// The parts of the energy, and what the balance leaves.
fn energy<'a>(scene: &Scene, trajectory: &'a Trajectory) -> Vec<PlotGroup<'a>> {
    let parts: Vec<&Name> = trajectory
        .names()
        .iter()
        .filter(|name| name.name.starts_with("energy.") && name.unit == "J")
        .filter(|name| {
            let column = trajectory.column(&name.name).unwrap_or_default();
            column.iter().any(|x| *x != 0.0)
        })
        .collect();
    let mut groups = Vec::new();
    if !parts.is_empty() {
        groups.push(PlotGroup::of("Energy", "energy", &parts, trajectory));
    }
    if scene.gravity != Gravity::Field
        && let Some(left) = trajectory.energy_surplus()
    {
        groups.push(PlotGroup {
            name: "Energy balance".to_string(),
            axis: "balance".to_string(),
            unit: "J".to_string(),
            caption:
                "E − E(0) − work of loads, dampers and prescribed motions: what the steps of the run lose or gain."
                    .to_string(),
            curves: vec![Curve::Made("balance".to_string(), left)],
            logarithmic: false,
        });
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_one_turn_wrap_and_those_that_count_turns_do_not() {
        assert_eq!(period("rad", &[-3.1, 3.1]), Some(TAU));
        assert_eq!(period("deg", &[1.0, 359.0]), Some(360.0));
        assert_eq!(period("rad", &[0.0, 3.0, 7.0, 9.0]), None);
        assert_eq!(period("m", &[-3.1, 3.1]), None);
    }

    #[test]
    fn a_plot_has_no_two_curves_of_one_look() {
        let group = PlotGroup {
            name: "legs tension".into(),
            axis: "tension".into(),
            unit: "N".into(),
            caption: String::new(),
            curves: (0..20)
                .map(|k| Curve::Made(format!("leg[{k}]"), vec![0.0]))
                .collect(),
            logarithmic: false,
        };
        let parts = group.told_apart();
        let counts: Vec<usize> = parts.iter().map(|part| part.curves.len()).collect();
        assert_eq!(counts, [7, 7, 6]);
        assert_eq!(parts[2].name, "legs tension (3 of 3)");
    }
}
