//! What the declared loads are at the rows of a history, which does not hold them: evaluated again at the states that it holds.

use mbd_runtime::scene::{Formula, Load, LoadKind, Output, Quantity, Scene, Starts, Unit};
use mbd_runtime::{Generic, Layout, Options, RunError, Simulation, Trajectory, state_names};

/// Loads are evaluated at about this many rows; between them they are straight.
const ROWS: usize = 400;

/// The loads that are shown.
#[derive(Debug, Default)]
pub(super) struct Loads {
    /// Each by its index, with a vector a row, world axes [N or N m].
    pub shown: Vec<(usize, Vec<[f64; 3]>)>,
    /// Why others are not.
    pub says: Option<String>,
}

/// The loads of a run at `rows` of its history. `inputs`: what the caller held all the time, if that is known.
pub(super) fn loads(
    (scene, params): (&Scene, &[f64]),
    inputs: Option<&[f64]>,
    (trajectory, rows): (&Trajectory, &[usize]),
) -> Loads {
    let formulas: Vec<(usize, &Load, &Formula)> = (scene.loads.iter().enumerate())
        .filter_map(|(index, load)| match &load.kind {
            LoadKind::Force(formula) | LoadKind::Torque(formula) => Some((index, load, formula)),
            LoadKind::External => None,
        })
        .collect();
    let outside = |part: &Formula| matches!(part, Formula::Input(_));
    let known = |formula: &Formula| inputs.is_some() || !scene.contains(formula, outside);
    let shown: Vec<_> = formulas
        .iter()
        .filter(|(.., f)| known(f))
        .copied()
        .collect();
    let refuse = |says: &str| Loads {
        shown: Vec::new(),
        says: Some(says.to_owned()),
    };
    if scene.loads.is_empty() || rows.is_empty() {
        return Loads::default();
    }
    if scene.events.iter().any(|event| event.actions.changes()) {
        return refuse("Loads are not shown: events of this scene change what is run.");
    }
    let left_out = scene.loads.len() - shown.len();
    let says = (left_out > 0).then(|| {
        let loads = if left_out == 1 { "load" } else { "loads" };
        format!("{left_out} {loads} of the caller, or of inputs that are not known: not shown.")
    });
    match evaluated((scene, params), inputs, (trajectory, rows), &shown) {
        Ok(values) => {
            let indices = shown.iter().map(|(index, ..)| *index);
            Loads {
                shown: indices.zip(values).collect(),
                says,
            }
        }
        Err(LoadsUnavailable::NoState) => {
            refuse("Loads are not shown: the history does not hold the state.")
        }
        Err(LoadsUnavailable::Run(error)) => refuse(&format!("Loads are not shown: {error}")),
    }
}

/// Why loads cannot be evaluated.
enum LoadsUnavailable {
    NoState,
    Run(RunError),
}

impl From<RunError> for LoadsUnavailable {
    fn from(error: RunError) -> Self {
        LoadsUnavailable::Run(error)
    }
}

/// A vector a load and row: the formulas as outputs of a model that is nothing else but asked for them.
fn evaluated(
    (scene, params): (&Scene, &[f64]),
    inputs: Option<&[f64]>,
    (trajectory, rows): (&Trajectory, &[usize]),
    shown: &[(usize, &Load, &Formula)],
) -> Result<Vec<Vec<[f64; 3]>>, LoadsUnavailable> {
    let output = |(_, load, formula): &(usize, &Load, &Formula)| Output {
        name: load.name.clone(),
        doc: String::new(),
        value: (*formula).clone(),
        components: 3,
        unit: Unit::default(),
    };
    let asked = Scene {
        outputs: shown.iter().map(output).collect(),
        events: Vec::new(),
        starts: Starts::default(),
        ..scene.clone()
    };
    let layout = Layout::new(&asked);
    let names = state_names(&asked, &layout);
    let columns = names.iter().map(|name| trajectory.column(&name.name));
    let columns: Vec<&[f64]> = columns
        .collect::<Option<_>>()
        .ok_or(LoadsUnavailable::NoState)?;
    let model = Generic::<f64>::new(asked, params).map_err(|_| LoadsUnavailable::NoState)?;
    let mut run = Simulation::new(&model, Options::rk4(1e-3))?;
    if let Some(inputs) = inputs {
        run.set_inputs(&inputs.to_vec())?;
    }
    let step = rows.len().div_ceil(ROWS).max(1);
    let mut seen: Vec<(usize, Vec<f64>)> = Vec::new();
    let last = rows.len() - 1;
    for at in (0..last).step_by(step).chain([last]) {
        let row = rows[at];
        let state: Vec<f64> = columns.iter().map(|column| column[row]).collect();
        let mut out = vec![0.0; 3 * shown.len()];
        run.set_state(trajectory.times()[row], &state)?;
        run.start()?;
        run.evaluate(Quantity::Outputs, &mut out)?;
        seen.push((at, out));
    }
    let value = |load: usize, at: usize| {
        let next = seen
            .partition_point(|(there, _)| *there < at)
            .min(seen.len() - 1);
        let (before, after) = (&seen[next.saturating_sub(1)], &seen[next]);
        let span = (after.0 - before.0).max(1) as f64;
        let share = at.saturating_sub(before.0) as f64 / span;
        [0, 1, 2].map(|k| {
            let [a, b] = [&before.1, &after.1].map(|list| list[3 * load + k]);
            a + share * (b - a)
        })
    };
    let each = |load: usize| (0..rows.len()).map(|at| value(load, at)).collect();
    Ok((0..shown.len()).map(each).collect())
}

#[cfg(test)]
mod tests {
    use mbd_runtime::{Content, Sampling, model};

    use super::*;

    model! {
        /// A stone in air, with a push that grows and one that the caller supplies.
        model Pushed {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input thrust: force;
            point stone { mass: 2 kg, start at [0.0, 0.0, 1.0] m velocity [3.0, 0.0, 0.0] m/s }
            load air on stone = -0.1 kg/s * stone.velocity;
            load growing on stone = [0, 0, 2] N/s * time;
            load push on stone = [0, 1, 0] * thrust;
        }
    }

    fn flown() -> (Pushed, Trajectory) {
        let stone = Pushed::new(PushedParams::default()).expect("no params");
        let mut history = Trajectory::new(&stone, Sampling::Every(1e-3), Content::ALL);
        let mut run = Simulation::new(&stone, Options::tsit5(1e-9)).expect("a model that runs");
        run.set_inputs(&vec![5.0]).expect("one input");
        run.record(2.0, &mut history).expect("a run that ends");
        (stone, history)
    }

    #[test]
    fn loads_are_what_the_declaration_says_at_the_states_of_the_history() {
        let (_, history) = flown();
        let scene = Pushed::scene();
        let rows: Vec<usize> = (0..history.times().len()).collect();
        let found = loads((&scene, &[]), Some(&[5.0]), (&history, &rows));
        assert_eq!((found.shown.len(), &found.says), (3, &None));
        let speed = history.column("stone.vx").expect("a speed");
        for (row, time) in history.times().iter().enumerate() {
            let [air, growing, push] = [0, 1, 2].map(|load| found.shown[load].1[row]);
            assert!((air[0] + 0.1 * speed[row]).abs() < 1e-6, "{row}");
            assert!((growing[2] - 2.0 * time).abs() < 1e-9, "{row}");
            assert!((push[1] - 5.0).abs() < 1e-12, "{row}");
        }
    }

    #[test]
    fn loads_that_depend_on_what_nobody_told_are_left_out_and_it_is_said() {
        let (_, history) = flown();
        let found = loads((&Pushed::scene(), &[]), None, (&history, &[0, 5]));
        assert_eq!(found.shown.len(), 2);
        assert!(found.says.is_some_and(|says| says.starts_with("1 load of")));
    }
}
