//! Derivatives a model does not answer by itself, by running the laws on dual numbers: of the anchors, and by parameters that reach the
//! lines of nodes through their effective numbers.

use mbd_scene::laws::{self, Numbers, Scratch};
use mbd_scene::{At, Dual, Float, Model, Quantity, Variable};

const PASS: usize = 8;
/// In `f64` whatever the scalar of the model: exact enough for both, and compiled once.
type Slope = Dual<f64, PASS>;

/// ∂(quantity)/∂(state) or ∂(quantity)/∂(parameter) at fixed node unknowns, dense, row by row, with K_e and L_e fixed.
pub(super) fn by<T: Float>(
    model: &dyn Model<T>,
    what: Quantity,
    variable: Variable,
    at: &At<'_, T>,
    out: &mut [T],
) {
    match variable {
        Variable::Parameter => by_parameter(model, what, at, out),
        Variable::State | Variable::Node => {
            let numbers = Numbers::new(model.scene(), &constants(model.params()));
            let mut lists = Lists::new(at);
            passes(model, what, variable, out, |model, first, last, result| {
                let list = match variable {
                    Variable::Node => &mut lists.nodes,
                    _ => &mut lists.state,
                };
                seed(list, first, last);
                run(model, what, &numbers, at.time, &lists, result);
            });
        }
    }
}

/// ∂(quantity)/∂(parameter): K_e − K and L_e − L0 of the lines of nodes stay fixed; lines of slack networks (K_e = 0) carry nothing.
pub(super) fn by_parameter<T: Float>(
    model: &dyn Model<T>,
    what: Quantity,
    at: &At<'_, T>,
    out: &mut [T],
) {
    let mut lists = Lists::new(at);
    passes(
        model,
        what,
        Variable::Parameter,
        out,
        |model, first, last, result| {
            let mut params = constants(model.params());
            seed(&mut params, first, last);
            let numbers = Numbers::new(model.scene(), &params);
            for (slots, line) in model.layout().lines.iter().zip(&numbers.lines) {
                if let Some(effective) = slots.effective
                    && let Some([k, l]) = lists.effective.get_mut(2 * effective..2 * effective + 2)
                    && k.value != 0.0
                {
                    k.slopes = line.stiffness.slopes;
                    l.slopes = line.free_length.slopes;
                }
            }
            run(model, what, &numbers, at.time, &lists, result);
        },
    );
}

/// Runs `pass` for every [`PASS`] columns and files the slopes.
fn passes<T: Float>(
    model: &dyn Model<T>,
    what: Quantity,
    variable: Variable,
    out: &mut [T],
    mut pass: impl FnMut(&dyn Model<T>, usize, usize, &mut [Slope]),
) {
    let (rows, columns) = (model.layout().len(what), model.layout().variables(variable));
    if out.len() != rows * columns {
        return;
    }
    let mut result = vec![Dual::constant(0.0); rows];
    for first in (0..columns).step_by(PASS) {
        let last = columns.min(first + PASS);
        result.fill(Dual::constant(0.0));
        pass(model, first, last, &mut result);
        for (row, value) in out.chunks_exact_mut(columns).zip(&result) {
            for (to, slope) in row[first..last].iter_mut().zip(value.slopes) {
                *to = T::from_f64(slope);
            }
        }
    }
}

fn run<T: Float>(
    model: &dyn Model<T>,
    what: Quantity,
    numbers: &Numbers<Slope>,
    time: T,
    lists: &Lists,
    out: &mut [Slope],
) {
    let at = At {
        time: Dual::constant(time.to_f64()),
        state: &lists.state,
        nodes: &lists.nodes,
        effective: &lists.effective,
        hold: &lists.hold,
        ends: &lists.ends,
        inputs: &lists.inputs,
        rows: &[],
    };
    let scene = model.scene();
    let mut scratch = Scratch::new(model.layout());
    laws::evaluate(what, scene, model.layout(), numbers, &at, &mut scratch, out);
}

/// The arguments of an evaluation as dual numbers.
struct Lists {
    state: Vec<Slope>,
    nodes: Vec<Slope>,
    effective: Vec<Slope>,
    hold: Vec<Slope>,
    ends: Vec<Slope>,
    inputs: Vec<Slope>,
}

impl Lists {
    fn new<T: Float>(at: &At<'_, T>) -> Self {
        Lists {
            state: constants(at.state),
            nodes: constants(at.nodes),
            effective: constants(at.effective),
            hold: constants(at.hold),
            ends: constants(at.ends),
            inputs: constants(at.inputs),
        }
    }
}

fn constants<T: Float>(list: &[T]) -> Vec<Slope> {
    list.iter().map(|x| Dual::constant(x.to_f64())).collect()
}

/// Makes the numbers first … last − 1 variables 0, 1, …, all others constants.
fn seed(list: &mut [Slope], first: usize, last: usize) {
    for (index, number) in list.iter_mut().enumerate() {
        *number = if (first..last).contains(&index) {
            Dual::variable(number.value, index - first)
        } else {
            Dual::constant(number.value)
        };
    }
}
