//! A pole on a cart, held upright by an optimal controller that samples at 100 Hz.
//!
//! Linear about upright, with x along the rail and θ from the vertical, l from the pin to the centre of mass and J about it:
//! `(M + m) ẍ + m l θ̈ = u`, `m l ẍ + (J + m l²) θ̈ = m g l θ`.

use mbd_runtime::{Options, RunError, Simulation, StateSpace, TrimError, model, trim};
use nalgebra::{DMatrix, DVector, RowDVector};

use crate::Outcome;

model! {
    /// A pole of a metre on a cart of a kilogram.
    model CartPole {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        input push: force = 0 N;
        body cart { mass: 1.0 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body pole {
            mass: 0.1 kg,
            inertia: diag(0.008, 0.008, 0.0001) kg*m^2,
            frame foot at [0.0, 0.0, -0.5] m,
        }
        joint rail: prismatic from world to cart.com { axis: x, force: push }
        joint pin: hinge from cart.com to pole.foot { axis: y, start: 0.2 rad }
    }
}

/// Between two samples [s].
const PERIOD: f64 = 0.01;

/// The linear system about upright, s = [x, θ, ẋ, θ̇].
fn upright(model: &CartPole) -> Result<StateSpace, TrimError> {
    let still = trim(model).fix("rail.slide", 0.0).fix("pin.angle", 0.0);
    Ok(still.solve()?.space)
}

/// The gain K of u = −K s that minimises Σ sᵀQs + r u², and the cost P: Riccati's equation, iterated until it stands.
fn optimal(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: f64,
) -> (RowDVector<f64>, DMatrix<f64>) {
    let mut p = q.clone();
    loop {
        let weight = r + (b.transpose() * &p * b)[(0, 0)];
        let gain = b.transpose() * &p * a / weight;
        let next = q + a.transpose() * &p * (a - b * &gain);
        let change = (&next - &p).amax() / next.amax();
        p = next;
        if change < 1e-14 {
            return (gain.row(0).into_owned(), p);
        }
    }
}

/// The gain for Σ x² + 10 θ² + (ẋ² + θ̇²)/10 + u²/100, and what it stands on: A_d, B_d, P.
fn design(model: &CartPole) -> Result<(RowDVector<f64>, [DMatrix<f64>; 3]), TrimError> {
    let [a, b] = upright(model)?.sampled(PERIOD).expect("a period");
    let weights = DMatrix::from_diagonal(&DVector::from_row_slice(&[1.0, 10.0, 0.1, 0.1]));
    let (gain, cost) = optimal(&a, &b, &weights, 0.01);
    Ok((gain, [a, b, cost]))
}

/// A run from the declared lean, or from this one [rad], under the controller.
fn held(
    model: &CartPole,
    gain: &RowDVector<f64>,
    lean: Option<f64>,
) -> Result<Simulation<f64>, RunError> {
    let mut simulation = Simulation::new(model, Options::tsit5(1e-10))?;
    if let Some(lean) = lean {
        simulation.set_joints(&[("pin.angle", lean)])?;
    }
    let gain = gain.clone();
    simulation.control_every(PERIOD, move |sample, inputs: &mut CartPoleInputs| {
        let at = sample.coordinates();
        let state = [
            at.rail_slide,
            at.pin_angle,
            at.rail_slide_rate,
            at.pin_angle_rate,
        ];
        inputs.push = -gain.iter().zip(state).map(|(k, s)| k * s).sum::<f64>();
    })?;
    Ok(simulation)
}

/// Cart and pole of a run: x [m], θ [rad] and their rates.
fn seen(simulation: &Simulation<f64>) -> [f64; 4] {
    let state = CartPoleState::from_slice(simulation.state()).expect("the state of this model");
    let (cart, pole) = (state.cart(), state.pole());
    [
        cart.position[0],
        pole.angle,
        cart.velocity[0],
        pole.angular_velocity,
    ]
}

/// Prints the gain, the closed loop and how the pole is caught.
pub fn run() -> Outcome {
    let model = CartPole::new(CartPoleParams::default())?;
    let (gain, [a, b, _]) = design(&model)?;
    println!("gain                    {:.3?}", gain.as_slice());
    for pole in (a - b * &gain).complex_eigenvalues().iter() {
        println!("closed-loop eigenvalue  {pole:.4}");
    }
    let mut simulation = held(&model, &gain, None)?;
    println!("time [s]  cart [m]  pole [rad]");
    for second in 0..=6 {
        simulation.run(f64::from(second))?;
        let [x, lean, ..] = seen(&simulation);
        println!("{second:8}  {x:8.4}  {lean:10.6}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CART: f64 = 1.0;
    const POLE: f64 = 0.1;
    const L: f64 = 0.5;
    /// About the pin.
    const INERTIA: f64 = 0.008 + POLE * L * L;

    #[test]
    fn the_linear_system_is_the_closed_form() {
        let space = upright(&CartPole::new(CartPoleParams::default()).unwrap()).unwrap();
        let names: Vec<&str> = space.states.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(
            names,
            [
                "rail.slide",
                "pin.angle",
                "rail.slide_rate",
                "pin.angle_rate"
            ]
        );
        let whole = (CART + POLE) * INERTIA - (POLE * L).powi(2);
        let weight = POLE * 9.81 * L;
        let mut a = DMatrix::zeros(4, 4);
        (a[(0, 2)], a[(1, 3)]) = (1.0, 1.0);
        a[(2, 1)] = -POLE * L * weight / whole;
        a[(3, 1)] = (CART + POLE) * weight / whole;
        let b = DMatrix::from_row_slice(4, 1, &[0.0, 0.0, INERTIA / whole, -POLE * L / whole]);
        assert!((&space.a - a).amax() < 1e-10, "{}", space.a);
        assert!((&space.b - b).amax() < 1e-10, "{}", space.b);
    }

    #[test]
    fn the_gain_is_optimal() {
        let model = CartPole::new(CartPoleParams::default()).unwrap();
        let (gain, [a, b, cost]) = design(&model).unwrap();
        let loops = &a - &b * &gain;
        assert!(loops.complex_eigenvalues().iter().all(|z| z.norm() < 1.0));
        // sᵀ P s is what the whole future costs under this gain, and more under any other.
        let spent = |gain: &RowDVector<f64>| {
            let mut state = DVector::from_row_slice(&[0.1, 0.2, 0.0, 0.0]);
            let mut sum = 0.0;
            for _ in 0..20_000 {
                let push = -(gain * &state)[0];
                let weighed: f64 = [1.0, 10.0, 0.1, 0.1]
                    .iter()
                    .zip(&state)
                    .map(|(q, s)| q * s * s)
                    .sum();
                sum += weighed + 0.01 * push * push;
                state = &a * &state + &b * push;
            }
            sum
        };
        let start = DVector::from_row_slice(&[0.1, 0.2, 0.0, 0.0]);
        let least = start.dot(&(cost * &start));
        assert!((spent(&gain) / least - 1.0).abs() < 1e-9);
        for entry in 0..4 {
            let mut other = gain.clone();
            other[entry] *= 1.01;
            assert!(spent(&other) > least * (1.0 + 1e-7), "{entry}");
        }
    }

    #[test]
    fn small_deviations_are_those_of_the_sampled_system() {
        let model = CartPole::new(CartPoleParams::default()).unwrap();
        let (gain, [a, b, _]) = design(&model).unwrap();
        let loops = a - b * &gain;
        let lean = 1e-4;
        let mut simulation = held(&model, &gain, Some(lean)).unwrap();
        let mut state = DVector::from_row_slice(&[0.0, lean, 0.0, 0.0]);
        for sample in 1..=100 {
            simulation.run(f64::from(sample) * PERIOD).unwrap();
            state = &loops * state;
            for (seen, linear) in seen(&simulation).iter().zip(&state) {
                // What is left out is of third order in the deviation.
                assert!((seen - linear).abs() < 1e-9, "{sample}: {seen} {linear}");
            }
        }
    }

    #[test]
    fn it_swings_back_from_the_declared_lean() {
        let model = CartPole::new(CartPoleParams::default()).unwrap();
        let (gain, _) = design(&model).unwrap();
        let mut simulation = held(&model, &gain, None).unwrap();
        simulation.start().unwrap();
        assert!((seen(&simulation)[1] - 0.2).abs() < 1e-12);
        simulation.run(15.0).unwrap();
        assert!(
            seen(&simulation).iter().all(|x| x.abs() < 1e-4),
            "{:?}",
            seen(&simulation)
        );
    }
}
