//! Instants: complete arguments of an evaluation, random or at the edges where derivatives tend to break.

use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::laws::origin::NUMBERS;
use mbd_scene::{Differentiated, Model, PointSlots, Quantity, Scene, Variable};

use crate::mechanism::layout;
use crate::oracle::Oracle;
use crate::random::Random;

/// Everything an evaluation depends on besides the parameters, on one scalar.
pub use mbd_scene::Arguments as Instant;

/// A random instant: positions within ±3 m, unit quaternions or any angle, speeds within ±2, lines slack and taut, every mode of hold, what may be detached so or not.
#[must_use]
pub fn random_instant(scene: &Scene, random: &mut Random) -> Instant<f64> {
    let layout = layout(scene);
    let mut state: Vec<f64> = (0..layout.nx())
        .map(|_| random.uniform(-2.0, 2.0))
        .collect();
    let moves = layout.directions.translations().len();
    for (_, slots) in layout.own_bodies() {
        state[slots.q..slots.q + moves].copy_from_slice(&random.vector(3.0)[..moves]);
    }
    for upright in layout.quaternions() {
        state[upright..upright + 4].copy_from_slice(&random.attitude());
    }
    for slots in &layout.points {
        if let PointSlots::Mass(slots) = slots {
            state[slots.q..slots.q + moves].copy_from_slice(&random.vector(3.0)[..moves]);
        }
    }
    let mut list = |n: usize, size: f64| {
        (0..n)
            .map(|_| random.uniform(-size, size))
            .collect::<Vec<f64>>()
    };
    let (nodes, ends, inputs, rows) = (
        list(3 * layout.nodes.len(), 3.0),
        list(layout.len(Quantity::AnchorStates), 3.0),
        list(layout.ni, 5.0),
        list(layout.nc, 1.0),
    );
    let turns = list(layout.turns.len(), 20.0);
    let origin = list(scene.runs.origin.map_or(0, |_| NUMBERS), 4.0);
    let effective = (0..layout.effective_lines)
        .flat_map(|_| [random.decades(2.0, 4.0), random.uniform(0.2, 3.0)]);
    let mut effective: Vec<f64> = effective.collect();
    let velocities = layout.effective_numbers - effective.len();
    effective.extend((0..velocities).map(|_| random.uniform(-3.0, 3.0)));
    let detachable = |at: usize| match layout.lines.get(at) {
        Some(slots) => slots.detachable,
        None => at >= layout.one_way(),
    };
    let hold = (0..layout.holds())
        .map(|at| match detachable(at) {
            true => -2.0 * random.below(2) as f64,
            false => random.below(3) as f64 - 1.0,
        })
        .chain(turns)
        .chain(origin)
        .collect();
    Instant {
        time: random.uniform(0.0, 10.0),
        state,
        nodes,
        effective,
        hold,
        ends,
        inputs,
        rows,
    }
}

/// A quantity of a model at an instant.
pub fn value(model: &dyn Model<f64>, what: Quantity, instant: &Instant<f64>) -> Vec<f64> {
    let mut out = vec![0.0; model.layout().len(what)];
    model.evaluate(what, &instant.at(), &mut model.work(), &mut out);
    out
}

/// ∂(quantity)/∂(variable) by the oracle: the laws run on the dual numbers of another library, one variable at a time.
#[must_use]
pub fn partial_by_oracle(
    scene: &Scene,
    params: &[f64],
    of: Differentiated,
    by: Variable,
    instant: &Instant<f64>,
) -> Vec<f64> {
    let layout = layout(scene);
    let (rows, columns) = (layout.len(of.quantity()), layout.variables(by));
    let mut jacobian = vec![0.0; rows * columns];
    let mut params: Vec<Oracle> = params.iter().copied().map(Oracle::constant).collect();
    let mut numbers = Numbers::new(scene, &params);
    let mut scratch = Scratch::new(&layout);
    for column in 0..columns {
        let mut instant = instant.map(Oracle::constant);
        let slot = match by {
            Variable::State => &mut instant.state[column],
            Variable::Node => &mut instant.nodes[column],
            Variable::Parameter => &mut params[column],
            Variable::Input => &mut instant.inputs[column],
        };
        let value = slot.0.re;
        *slot = Oracle::variable(value);
        if by == Variable::Parameter {
            numbers = Numbers::new(scene, &params);
            params[column] = Oracle::constant(value);
        }
        let mut out = vec![Oracle::constant(0.0); rows];
        mbd_scene::evaluate(
            of.quantity(),
            scene,
            &layout,
            &numbers,
            &instant.at(),
            &mut scratch,
            &mut out,
        );
        for (row, number) in out.iter().enumerate() {
            jacobian[row * columns + column] = number.0.eps;
        }
    }
    jacobian
}
