//! Kinks: places at which a scene has a linear system on either side, and not one.
//!
//! ```text
//! Δ(ε) = J(s + ε d, u + ε d) − J(s − ε d, u − ε d),   J = [A B; C D] along s: the derivatives of ẋ and of the outputs                 (1)
//! |J(± 4 ε) − J(± ε)| ≪ |Δ(ε)| at a kink, ≈ 3/2 |Δ(ε)| elsewhere                                                             (2)
//! ```
//!
//! d is a direction in which every coordinate, rate, state and input changes, by another amount each: it crosses whatever passes through the place. Derived.

use nalgebra::{DMatrix, DVector};

use super::LinearisationError;
use super::moment::{SceneMoment, dense};
use super::space::{StateSpace, motors_follow, output_names};
use crate::columns::{Name, a_second, state_names};

/// ε [m, rad, and the units of rates, states and inputs].
const NEAR: f64 = 1e-7;
/// ε, by the size of a number, where digits would be lost otherwise.
const RESOLVED: f64 = 1e-14;
/// How much further the second look is.
const FURTHER: f64 = 4.0;
/// Between the two of (2); rounding is like the second.
const STAYS: f64 = 0.1;
/// Parts of a derivative by which it changes at a kink that is told.
const CHANGES: f64 = 1e-3;
/// The same of the largest in its row, and of all, below which it is rounding.
const COUNTS: [f64; 2] = [1e-9, 1e-13];

/// A derivative that is one on this side of a place and another on that: of a line that is just straight, of a stop that is just touched, of a choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Kink {
    /// What is differentiated: a number of the state x, with the unit of its rate, or an output column.
    pub of: Name,
    /// Whether it is the rate of that.
    pub is_rate: bool,
    /// By what: one of [`StateSpace::states`] or [`StateSpace::inputs`].
    pub by: Name,
    /// Its value on either side, in the units of the two.
    pub sides: [f64; 2],
}

/// The kinks at a moment whose linear system this is: of every rate and output that has one, the derivative that changes most. None where the neighbourhood
/// has no linear systems that could be compared.
pub(super) fn kinks(moment: &SceneMoment, space: &StateSpace) -> Vec<Kink> {
    find(moment, space).unwrap_or_default()
}

fn find(moment: &SceneMoment, space: &StateSpace) -> Result<Vec<Kink>, LinearisationError> {
    let sides = |share: f64| -> Result<_, LinearisationError> {
        let [before, behind] = [-share, share].map(|share| derivatives(moment, space, share));
        Ok([before?, behind?])
    };
    let near = sides(1.0)?;
    let changed = changed(&near);
    if changed.is_empty() {
        return Ok(Vec::new());
    }
    let far = sides(FURTHER)?;
    let rates = state_names(moment.scene(), moment.layout()).into_iter();
    let count = rates.len();
    let rates = rates.map(|name| Name {
        unit: a_second(&name.unit),
        ..name
    });
    let of: Vec<_> = rates
        .chain(output_names(moment.scene(), moment.layout()))
        .collect();
    let by: Vec<_> = space.states.iter().chain(&space.inputs).collect();
    let change = |at: (usize, usize)| (near[1][at] - near[0][at]).abs();
    let stay = changed.into_iter().filter(|&at| {
        let mut sides = near.iter().zip(&far);
        sides.all(|(near, far)| (far[at] - near[at]).abs() <= STAYS * change(at))
    });
    let mut most: Vec<(usize, usize)> = Vec::new();
    for at in stay {
        match most.last_mut() {
            Some(known) if known.0 == at.0 => {
                if change(at) > change(*known) {
                    *known = at;
                }
            }
            _ => most.push(at),
        }
    }
    let told = most.into_iter().map(|at| Kink {
        of: of[at.0].clone(),
        is_rate: at.0 < count,
        by: by[at.1].clone(),
        sides: near.each_ref().map(|side| side[at]),
    });
    Ok(told.collect())
}

/// The places at which the derivatives of two sides are not alike, row by row.
fn changed([before, behind]: &[DMatrix<f64>; 2]) -> Vec<(usize, usize)> {
    let size = |row: usize| before.row(row).amax().max(behind.row(row).amax());
    let all = before.amax().max(behind.amax());
    let rows = (0..before.nrows()).map(|row| (row, (COUNTS[0] * size(row)).max(COUNTS[1] * all)));
    let places =
        rows.flat_map(|(row, least)| (0..before.ncols()).map(move |column| ((row, column), least)));
    let changed = places.filter(|&(at, least)| {
        let change = (behind[at] - before[at]).abs();
        change > least && change > CHANGES * before[at].abs().max(behind[at].abs())
    });
    changed.map(|(at, _)| at).collect()
}

/// J of (1) at a share of ε.
fn derivatives(
    moment: &SceneMoment,
    space: &StateSpace,
    share: f64,
) -> Result<DMatrix<f64>, LinearisationError> {
    // Another amount each: nothing that two of them make together stays as it is.
    let amount = |index: usize| share * NEAR * (1.0 + (index as f64 * 0.618_034).fract());
    let along = DVector::from_fn(space.states.len(), |index, _| amount(index));
    let mut moves = &space.tangent * along;
    let resolved = |x: f64| 1.0_f64.max(RESOLVED / NEAR * x.abs());
    for (change, x) in moves.iter_mut().zip(&moment.state) {
        *change *= resolved(*x);
    }
    // Where motors follow inputs these move bodies, too.
    let held = motors_follow(moment.scene());
    let inputs = moment
        .inputs
        .iter()
        .enumerate()
        .map(|(index, u)| match held {
            true => *u,
            false => u + amount(index) * resolved(*u),
        });
    let linear = moment.beside(&moves, inputs.collect())?.linearise()?;
    let (by_state, by_input) = (
        [dense(linear.state()), dense(linear.outputs_by_state())],
        [dense(linear.input()), dense(linear.outputs_by_input())],
    );
    let rows = by_state[0].nrows() + by_state[1].nrows();
    let [states, inputs] = [space.tangent.ncols(), by_input[0].ncols()];
    let mut all = DMatrix::zeros(rows, states + inputs);
    let mut first = 0;
    for (by_state, by_input) in by_state.iter().zip(&by_input) {
        let count = by_state.nrows();
        let along = by_state * &space.tangent;
        all.view_mut((first, 0), (count, states)).copy_from(&along);
        all.view_mut((first, states), (count, inputs))
            .copy_from(by_input);
        first += count;
    }
    Ok(all)
}
