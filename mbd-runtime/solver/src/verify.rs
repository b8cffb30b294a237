//! What `verify;` in a declaration tests: generated code against the laws, and the laws against physics.

use mbd_scene::laws::origin::NUMBERS;
use mbd_scene::{Arguments, Gravity, Model, PointSlots, Quantity};

use crate::Generic;

/// Places at which a model is compared.
const PLACES: usize = 10;

/// Compares a model with the laws run on numbers, its derivatives with dual numbers, and asks that M is symmetric and positive definite.
///
/// # Errors
/// What differs, by how much and where.
pub fn verify(model: &dyn Model<f64>) -> Result<(), String> {
    let generic =
        Generic::new(model.scene().clone(), model.params()).map_err(|error| error.to_string())?;
    let mut seed = 1;
    for _ in 0..PLACES {
        let place = random_place(model, &mut seed);
        for what in model.layout().quantities() {
            compare(model, &generic, what, &place)?;
        }
        check_mass_matrix(model, &place)?;
        check_power(model, &place)?;
    }
    Ok(())
}

fn evaluate(model: &dyn Model<f64>, what: Quantity, place: &Arguments<f64>) -> Vec<f64> {
    let mut out = vec![0.0; model.layout().len(what)];
    model.evaluate(what, &place.at(), &mut model.work(), &mut out);
    out
}

fn compare(
    model: &dyn Model<f64>,
    generic: &Generic<f64>,
    what: Quantity,
    place: &Arguments<f64>,
) -> Result<(), String> {
    let (got, want) = (evaluate(model, what, place), evaluate(generic, what, place));
    let scale = want.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
    // These two solve with H, which may be ill-conditioned at a random place.
    let solved = matches!(
        what,
        Quantity::NodeByAnchor(_) | Quantity::CondensedStiffness(_)
    );
    let tolerance = if solved { 1e-9 } else { 1e-12 };
    for (index, (a, b)) in got.iter().zip(&want).enumerate() {
        let near = (a - b).abs() <= tolerance * scale;
        if !near && a.to_bits() != b.to_bits() {
            return Err(format!(
                "{what:?}[{index}]: generated {a}, by the laws {b}, scale {scale}"
            ));
        }
    }
    Ok(())
}

/// Symmetric to rounding, and positive definite by Cholesky.
fn check_mass_matrix(model: &dyn Model<f64>, place: &Arguments<f64>) -> Result<(), String> {
    let n = model.layout().nv;
    let values = evaluate(model, Quantity::MassMatrix, place);
    let m = nalgebra::DMatrix::from_row_slice(n, n, &values);
    let asymmetry = (&m - m.transpose()).amax();
    if asymmetry > 1e-12 * m.amax() {
        return Err(format!("the mass matrix is not symmetric: {asymmetry}"));
    }
    if n > 0 && m.cholesky().is_none() {
        return Err("the mass matrix is not positive definite".to_owned());
    }
    Ok(())
}

/// The energy changes by the power of loads, dampers and prescribed motions: d(T + V + E)/dt = P + λᵀ Φ̇, along ẋ (Φ̇ is not zero at a
/// random place). For scenes without nodes (their velocity is not free) whose gravity is known.
fn check_power(model: &dyn Model<f64>, place: &Arguments<f64>) -> Result<(), String> {
    if !model.layout().nodes.is_empty() || model.scene().gravity == Gravity::Field {
        return Ok(());
    }
    let mut free = place.clone();
    let modes = free.hold.iter_mut().take(model.layout().holds());
    modes.for_each(|mode| *mode = 0.0);
    let rates = evaluate(model, Quantity::Derivative, &free);
    let moved = |by: f64| {
        let mut moved = free.clone();
        moved.time += by;
        moved
            .state
            .iter_mut()
            .zip(&rates)
            .for_each(|(x, rate)| *x += by * rate);
        evaluate(model, Quantity::Energy, &moved)[..3]
            .iter()
            .sum::<f64>()
    };
    let energy = evaluate(model, Quantity::Energy, &free);
    let fastest = rates
        .iter()
        .fold(1.0_f64, |scale, rate| scale.max(rate.abs()));
    let step = 1e-5 / fastest;
    let change = (moved(step) - moved(-step)) / (2.0 * step);
    let multipliers = evaluate(model, Quantity::Multipliers, &free);
    let slips = evaluate(model, Quantity::ConstraintRate, &free);
    let slipping = multipliers
        .iter()
        .zip(&slips)
        .map(|(force, rate)| force * rate);
    let power = energy[3] + energy[4] + energy[5] + slipping.sum::<f64>();
    let largest = energy.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
    if (change - power).abs() > 1e-4 * (power.abs() + largest * fastest * 1e-4) {
        return Err(format!(
            "the energy changes by {change} W, loads, dampers and prescribed motions give {power} W"
        ));
    }
    Ok(())
}

/// Unit quaternions or any angle, everything else within ±1; a stiffness where one is expected.
fn random_place(model: &dyn Model<f64>, seed: &mut u64) -> Arguments<f64> {
    let layout = model.layout();
    let mut list = |count: usize| -> Vec<f64> { (0..count).map(|_| random(seed)).collect() };
    let mut state = list(layout.nx());
    for first in layout.quaternions() {
        let turn = first..first + 4;
        let norm = state[turn.clone()]
            .iter()
            .map(|x| x * x)
            .sum::<f64>()
            .sqrt();
        state[turn].iter_mut().for_each(|x| *x /= norm.max(1e-3));
    }
    for (index, slots) in layout.points.iter().enumerate() {
        if let PointSlots::Mass(slots) = slots {
            state[slots.q] += index as f64;
        }
    }
    let stiffness = |(index, x): (usize, f64)| if index % 2 == 0 { 1e3 * (2.0 + x) } else { 0.5 };
    Arguments {
        nodes: list(3 * layout.nodes.len()),
        effective: list(layout.effective_numbers)
            .into_iter()
            .enumerate()
            .map(stiffness)
            .collect(),
        hold: list(layout.holds())
            .into_iter()
            .map(|x| (1.4 * x).round())
            .chain(list(layout.turns.len()))
            .chain(list(model.scene().runs.origin.map_or(0, |_| NUMBERS)))
            .collect(),
        ends: list(layout.len(Quantity::AnchorStates))
            .into_iter()
            .map(|x| 3.0 * x)
            .collect(),
        inputs: list(layout.ni),
        rows: list(layout.nc),
        time: 0.3,
        state,
    }
}

/// A number in (−1, 1), the same in every run.
fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
