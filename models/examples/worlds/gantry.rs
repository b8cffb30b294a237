//! A gantry whose hook and load swing as two pendulums, moved by a command that is given in four steps so that nothing swings afterwards.
//!
//! With a_h, L on the hook (its centre of mass and the sling below the trolley), b the load below the sling, rotated by θ, φ from the vertical:
//! `M = [J_h + m_h a_h² + m_l L², m_l L b; m_l L b, J_l + m_l b²]`, `K = g diag(m_h a_h + m_l L, m_l b)`, det(K − ω² M) = 0.
//! A step given half at once and half after π/ω leaves nothing of the motion at ω; done for both frequencies it is four steps (N. C. Singer,
//! W. P. Seering, J. Dyn. Sys. Meas. Control 112, 1990).

use std::f64::consts::PI;

use mbd_runtime::{Options, Quantity, RunError, Simulation, TrimError, model, trim};

use crate::Outcome;

model! {
    /// Five tonnes on a sling under a hook block on 8 m of rope.
    model Gantry {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        input place: length = 0 m;
        body trolley { mass: 2 tonne, inertia: diag(500, 500, 500) kg*m^2 }
        body hook {
            mass: 300 kg,
            inertia: diag(20, 20, 20) kg*m^2,
            frame top at [0, 0, 8] m,
            frame bottom at [0, 0, -0.5] m,
        }
        body cargo {
            mass: 5 tonne,
            inertia: diag(4000, 4000, 4000) kg*m^2,
            frame eye at [0, 0, 3] m,
        }
        joint rail: prismatic from world to trolley.com { axis: x, motor: place, filter: 0.3 s }
        joint rope: hinge from trolley.com to hook.top { axis: y }
        joint sling: hinge from hook.bottom to cargo.eye { axis: y }
        output sway = rope.angle in deg;
        output energy = energy.total in kJ;
    }
}

/// Where the crane is to go [m].
const WAY: f64 = 1.0;

/// Frequencies of both swings [rad/s], slow and fast.
fn frequencies(model: &Gantry) -> Result<[f64; 2], TrimError> {
    let space = trim(model).solve()?.space;
    let mut swings: Vec<f64> = space
        .vibrations()
        .iter()
        .filter(|vibration| vibration.imaginary > 0.1)
        .map(|vibration| vibration.frequency())
        .collect();
    swings.sort_by(f64::total_cmp);
    Ok([swings[0], swings[1]])
}

/// When the parts of the command are given [s]: all at once, or in four.
fn steps(frequencies: [f64; 2]) -> [f64; 4] {
    let [slow, fast] = frequencies.map(|omega| PI / omega);
    [0.0, fast, slow, slow + fast]
}

/// A run through these steps and the time that the filter needs; what still swings in it [J].
fn moved(model: &Gantry, steps: [f64; 4]) -> Result<(Simulation<f64>, f64), RunError> {
    let mut simulation = Simulation::new(model, Options::tsit5(1e-9))?;
    for (number, step) in steps.into_iter().enumerate() {
        simulation.run(step)?;
        let place = WAY * (number + 1) as f64 / 4.0;
        simulation.set_inputs(&GantryInputs { place })?;
    }
    simulation.run(steps[3] + 8.0)?;
    let mut outputs = [0.0; 2];
    simulation.evaluate(Quantity::Outputs, &mut outputs)?;
    let hanging = -9.81 * (300.0 * 8.0 + 5000.0 * (8.5 + 3.0));
    Ok((simulation, 1e3 * outputs[1] - hanging))
}

/// Prints the swings that two ways of commanding leave.
pub fn run() -> Outcome {
    let model = Gantry::new(GantryParams::default())?;
    let frequencies = frequencies(&model)?;
    println!(
        "swings: {:.4} and {:.4} rad/s",
        frequencies[0], frequencies[1]
    );
    for (name, steps) in [("one step", [0.0; 4]), ("four steps", steps(frequencies))] {
        let (_, left) = moved(&model, steps)?;
        println!("{name:10}  {left:10.4} J still swing");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_swings_have_the_frequencies_of_the_double_pendulum() {
        let model = Gantry::new(GantryParams::default()).unwrap();
        let found = frequencies(&model).unwrap();
        let (hook, load, rope, below) = (300.0_f64, 5000.0, 8.5, 3.0);
        let masses = [
            20.0 + hook * 64.0 + load * rope * rope,
            load * rope * below,
            4000.0 + load * below * below,
        ];
        let weights = [9.81 * (hook * 8.0 + load * rope), 9.81 * load * below];
        // det(K − x M) = 0 with x = ω².
        let a = masses[0] * masses[2] - masses[1] * masses[1];
        let b = masses[0] * weights[1] + masses[2] * weights[0];
        let c = weights[0] * weights[1];
        let root = (b * b - 4.0 * a * c).sqrt();
        let want = [(b - root) / (2.0 * a), (b + root) / (2.0 * a)].map(f64::sqrt);
        for (found, want) in found.iter().zip(want) {
            assert!((found / want - 1.0).abs() < 1e-9, "{found} is not {want}");
        }
    }

    #[test]
    fn a_command_in_four_steps_leaves_nothing_swinging() {
        let model = Gantry::new(GantryParams::default()).unwrap();
        let at_once = moved(&model, [0.0; 4]).unwrap().1;
        let (simulation, left) = moved(&model, steps(frequencies(&model).unwrap())).unwrap();
        // What is left is of the amplitude that the frequencies depend on, to the fourth power.
        assert!(at_once > 100.0, "{at_once} J");
        assert!(
            left < 1e-3 * at_once && left > -1e-3,
            "{left} J of {at_once} J"
        );
        let state = GantryState::from_slice(simulation.state()).expect("the state of this model");
        assert!((state.trolley().position[0] - WAY).abs() < 1e-6);
    }
}
