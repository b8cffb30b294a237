//! Derivatives a model does not answer by itself, by running the laws on dual numbers: of the anchors, and by parameters that reach the
//! lines of nodes through their effective numbers.

use mbd_scene::laws::{self, Numbers, Scratch};
use mbd_scene::{At, Dual, Float, Model, Quantity, Variable};

const PASS: usize = 8;
type Slope<T> = Dual<T, PASS>;

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
                    && k.value != T::zero()
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
    mut pass: impl FnMut(&dyn Model<T>, usize, usize, &mut [Slope<T>]),
) {
    let (rows, columns) = (model.layout().len(what), model.layout().variables(variable));
    if out.len() != rows * columns {
        return;
    }
    let mut result = vec![Dual::constant(T::zero()); rows];
    for first in (0..columns).step_by(PASS) {
        let last = columns.min(first + PASS);
        result.fill(Dual::constant(T::zero()));
        pass(model, first, last, &mut result);
        for (row, value) in out.chunks_exact_mut(columns).zip(&result) {
            row[first..last].copy_from_slice(&value.slopes[..last - first]);
        }
    }
}

fn run<T: Float>(
    model: &dyn Model<T>,
    what: Quantity,
    numbers: &Numbers<Slope<T>>,
    time: T,
    lists: &Lists<T>,
    out: &mut [Slope<T>],
) {
    let at = At {
        time: Dual::constant(time),
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
struct Lists<T> {
    state: Vec<Slope<T>>,
    nodes: Vec<Slope<T>>,
    effective: Vec<Slope<T>>,
    hold: Vec<Slope<T>>,
    ends: Vec<Slope<T>>,
    inputs: Vec<Slope<T>>,
}

impl<T: Float> Lists<T> {
    fn new(at: &At<'_, T>) -> Self {
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

fn constants<T: Float>(list: &[T]) -> Vec<Slope<T>> {
    list.iter().copied().map(Dual::constant).collect()
}

/// Makes the numbers first … last − 1 variables 0, 1, …, all others constants.
fn seed<T: Float>(list: &mut [Slope<T>], first: usize, last: usize) {
    for (index, number) in list.iter_mut().enumerate() {
        *number = if (first..last).contains(&index) {
            Dual::variable(number.value, index - first)
        } else {
            Dual::constant(number.value)
        };
    }
}
