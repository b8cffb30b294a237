//! Kinks: places at which a scene has a linear system on either side, and not one; and places at which something has no derivative at all.
//!
//! ```text
//! Δ(ε) = J(s + ε d, u + ε d) − J(s − ε d, u − ε d),   J = [A B; C D] along s: the derivatives of ẋ and of the outputs                 (1)
//! |J(± 4 ε) − J(± ε)| ≪ |Δ(ε)| at a kink, ≈ 3/2 |Δ(ε)| elsewhere                                                             (2)
//! J(ε)/J(4 ε) = J(4 ε)/J(16 ε) between 1 and 4, |J(0)| ≫ |J(ε)| or ≪ |J(ε)|, where J has no bound on a side                   (3)
//! ```
//!
//! d is a direction in which every coordinate, rate, state and input changes, by another amount each: it crosses whatever passes through the place. Derived.
//! s at the places beside is along the joints, and along unit quaternions, as they are there: what turns at an end of its domain, as an arc cosine does at 1,
//! divides what the way bends by what it has gone. What is continuous has derivatives that grow by less than 1/ε towards the place; that of a root at zero itself
//! is finite by rule alone ([`Real::sqrt`]), or that of the other side.
//!
//! [`Real::sqrt`]: mbd_scene::Real::sqrt

use nalgebra::{DMatrix, DVector};

use super::LinearisationError;
use super::chart::Chart;
use super::moment::SceneMoment;
use super::space::{Along, StateSpace, motors_follow, output_names};
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
/// How often a derivative without bound beside the place is that at the place itself, or the other way round; what grows by less from look to look has
/// a bound, and two that differ by more parts are no power of the distance.
const UNBOUNDED: f64 = 10.0;
const GROWS: f64 = 1.1;
const ALIKE: f64 = 0.05;

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

/// The kinks at a moment whose linear system, in a chart, this is: of every rate and output that has one, the derivative that changes most. None where the
/// neighbourhood has no linear systems that could be compared.
///
/// # Errors
/// A derivative that there is not, by (3).
pub(super) fn kinks(
    moment: &mut SceneMoment,
    chart: &Chart,
    space: &StateSpace,
) -> Result<Vec<Kink>, LinearisationError> {
    let here = Along::new(moment, chart)?.all();
    let sides = |share: f64| [-share, share].map(|share| beside(moment, chart, space, share));
    let near = sides(1.0);
    let unlike = unlike(&here, &near);
    let changed = match &near {
        [Some(before), Some(behind)] => changed([before, behind]),
        _ => Vec::new(),
    };
    if unlike.is_empty() && changed.is_empty() {
        return Ok(Vec::new());
    }
    let far = sides(FURTHER);
    let names = Names::new(moment, space);
    if !unlike.is_empty() {
        let furthest = sides(FURTHER * FURTHER);
        let mut unbounded = unlike.into_iter();
        if let Some(at) = unbounded.find(|&at| grows(at, [&near, &far, &furthest])) {
            return Err(LinearisationError::NoDerivative {
                of: names.of[at.0].name.clone(),
                is_rate: at.0 < names.rates,
                by: names.by[at.1].name.clone(),
            });
        }
    }
    let ([Some(before), Some(behind)], [Some(further_before), Some(further_behind)]) =
        (&near, &far)
    else {
        return Ok(Vec::new());
    };
    let sides = [[before, behind], [further_before, further_behind]];
    Ok(told(changed, sides, &names))
}

/// Of what and by what J has derivatives.
struct Names<'a> {
    of: Vec<Name>,
    by: Vec<&'a Name>,
    /// How many of the first are rates; the others are outputs.
    rates: usize,
}

impl<'a> Names<'a> {
    fn new(moment: &SceneMoment, space: &'a StateSpace) -> Self {
        let rates = state_names(moment.scene(), moment.layout()).into_iter();
        let count = rates.len();
        let rates = rates.map(|name| Name {
            unit: a_second(&name.unit),
            ..name
        });
        let outputs = output_names(moment.scene(), moment.layout());
        Names {
            of: rates.chain(outputs).collect(),
            by: space.states.iter().chain(&space.inputs).collect(),
            rates: count,
        }
    }
}

/// J at the places before and behind, of those that have a linear system.
type Sides = [Option<DMatrix<f64>>; 2];

/// The derivatives that are far from those on a side.
fn unlike(here: &DMatrix<f64>, near: &Sides) -> Vec<(usize, usize)> {
    let mut places = Vec::new();
    for side in near.iter().flatten() {
        let all = COUNTS[1] * side.amax();
        for row in 0..here.nrows() {
            let least = all.max(COUNTS[0] * side.row(row).amax());
            places.extend((0..here.ncols()).map(|by| (row, by)).filter(|&at| {
                let [own, beside] = [here, side].map(|one| one[at].abs());
                beside > least && (own > UNBOUNDED * beside || beside > UNBOUNDED * own)
            }));
        }
    }
    places
}

/// Whether a derivative grows towards the place on a side by a power of the distance, and by less than its inverse.
fn grows(at: (usize, usize), sides: [&Sides; 3]) -> bool {
    let [near, far, furthest] = sides.map(|sides| sides.each_ref().map(Option::as_ref));
    let on_side = |side: usize| {
        let [near, far, furthest] = [near[side]?, far[side]?, furthest[side]?].map(|one| one[at]);
        let growth = [near / far, far / furthest];
        let is_power = (growth[0] - growth[1]).abs() < ALIKE * growth[0];
        Some(is_power && growth.iter().all(|&by| by > GROWS && by < FURTHER))
    };
    (0..2).any(|side| on_side(side) == Some(true))
}

/// The kinks among what changes from side to side, by (2).
fn told(
    changed: Vec<(usize, usize)>,
    [near, far]: [[&DMatrix<f64>; 2]; 2],
    names: &Names<'_>,
) -> Vec<Kink> {
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
        of: names.of[at.0].clone(),
        is_rate: at.0 < names.rates,
        by: names.by[at.1].clone(),
        sides: [0, 1].map(|side| {
            let [near, far] = [near[side][at], far[side][at]];
            // The further one has more digits of what is small beside the place, the nearer one less of what bends.
            match (far - near).abs() > CHANGES * change(at) {
                true => far,
                false => near,
            }
        }),
    });
    told.collect()
}

/// The places at which the derivatives of two sides are not alike, row by row.
fn changed([before, behind]: [&DMatrix<f64>; 2]) -> Vec<(usize, usize)> {
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

/// J of (1) at a share of ε. None where there is no linear system, and where the coordinates turn back so near that what is said along them changes by itself.
fn beside(
    moment: &SceneMoment,
    chart: &Chart,
    space: &StateSpace,
    share: f64,
) -> Option<DMatrix<f64>> {
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
    let mut beside = moment.beside(&moves, inputs.collect()).ok()?;
    let mut chart = chart.clone();
    let inverse = chart.inverse.clone();
    chart.refresh(&mut beside).ok()?;
    if (&chart.inverse - &inverse).amax() > CHANGES * inverse.amax() {
        return None;
    }
    Some(Along::new(&mut beside, &chart).ok()?.all())
}
