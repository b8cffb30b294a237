//! A wind turbine at constant speed: the torque that the generator has to brake with, and how the speed settles.
//!
//! The rotor takes `P = ½ ρ π R² c_P(λ) v³` from the wind v at the tip speed ratio `λ = ω R/v`.

use mbd_runtime::{Options, Simulation, TrimError, Trimmed, model, trim};

use crate::Outcome;

model! {
    /// A rotor of 63 m on a gear of 97.
    model Turbine {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        const R = 63 m;
        const rho = 1.225 kg/m^3;
        table power = { 0: 0.0, 4: 0.22, 6: 0.42, 7.5: 0.48, 9: 0.45, 12: 0.2 };
        input wind: speed = 9 m/s;
        /// Torque of the generator on its fast shaft.
        input brake: torque;
        let ratio = slow.angle_rate * R / wind;
        let aerodynamic = 0.5 * rho * pi * R^2 * wind^3 * power(ratio) / slow.angle_rate;
        body rotor { mass: 110e3 kg, inertia: diag(3.5e7, 1.8e7, 1.8e7) kg*m^2 }
        body generator { mass: 5e3 kg, inertia: diag(530, 530, 530) kg*m^2 }
        joint slow: hinge from world to rotor.com { axis: x, force: aerodynamic, start_rate: 8 rpm }
        joint fast: hinge from world to generator.com { axis: x, force: -brake }
        joint gearbox: gear from slow.angle to fast.angle { ratio: 97 }
        output electric = brake * fast.angle_rate in MW;
    }
}

/// Steady at a wind [m/s] and a tip speed ratio: what the generator brakes with, and the linear system there.
fn steady(model: &Turbine, wind: f64, ratio: f64) -> Result<Trimmed, TrimError> {
    let asked = trim(model).input("wind", wind).free_input("brake");
    asked.rate("slow.angle", ratio * wind / 63.0).solve()
}

/// Of the rotor [rad/s].
fn speed(simulation: &Simulation<f64>) -> f64 {
    let state = TurbineState::from_slice(simulation.state()).expect("the state of this model");
    state.rotor().angular_velocity[0]
}

/// Prints steady operation at some winds, and how the speed follows a gust at this torque.
pub fn run() -> Outcome {
    let model = Turbine::new(TurbineParams::default())?;
    println!("wind [m/s]  ratio  brake [kN m]  power [MW]  pole [1/s]");
    for (wind, ratio) in [(6.0, 7.0), (9.0, 7.0), (9.0, 8.0), (11.0, 8.0)] {
        let steady = steady(&model, wind, ratio)?;
        let (brake, pole) = (steady.inputs[1], steady.space.a[(1, 1)]);
        let power = brake * 97.0 * ratio * wind / 63.0;
        println!(
            "{wind:10}  {ratio:5}  {:12.3}  {:10.3}  {pole:10.4}",
            brake / 1e3,
            power / 1e6
        );
    }
    let steady = steady(&model, 9.0, 8.0)?;
    let mut simulation = Simulation::new(&model, Options::tsit5(1e-9))?;
    simulation.set_state(0.0, &steady.state)?;
    println!("time [s]  rotor [rpm]");
    for step in 0..=6 {
        simulation.set_inputs(&TurbineInputs {
            wind: if step > 1 { 9.5 } else { 9.0 },
            brake: steady.inputs[1],
        })?;
        simulation.run(f64::from(step) * 10.0)?;
        println!(
            "{:8}  {:11.4}",
            simulation.time(),
            speed(&simulation) * 30.0 / std::f64::consts::PI
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Both shafts, seen from the slow one [kg m²].
    const INERTIA: f64 = 3.5e7 + 530.0 * 97.0 * 97.0;

    /// c_P and its slope at a tip speed ratio between 6 and 9.
    fn coefficient(ratio: f64) -> [f64; 2] {
        match ratio < 7.5 {
            true => [0.42 + 0.04 * (ratio - 6.0), 0.04],
            false => [0.48 - 0.02 * (ratio - 7.5), -0.02],
        }
    }

    const CASES: [[f64; 2]; 4] = [[6.0, 7.0], [9.0, 7.0], [9.0, 8.0], [11.0, 8.5]];

    #[test]
    fn the_generator_takes_what_the_rotor_does() {
        let model = Turbine::new(TurbineParams::default()).unwrap();
        for [wind, ratio] in CASES {
            let steady = steady(&model, wind, ratio).unwrap();
            let omega = ratio * wind / 63.0;
            let power = 0.5 * 1.225 * PI * (63.0 * 63.0) * wind.powi(3) * coefficient(ratio)[0];
            let brake = power / (97.0 * omega);
            assert!(
                (steady.inputs[1] / brake - 1.0).abs() < 1e-9,
                "{steady:?} {brake}"
            );
            assert!((steady.value("slow.angle_rate").unwrap() - omega).abs() < 1e-12);
        }
    }

    #[test]
    fn the_speed_settles_with_the_pole_of_the_closed_form() {
        let model = Turbine::new(TurbineParams::default()).unwrap();
        for [wind, ratio] in CASES {
            let space = steady(&model, wind, ratio).unwrap().space;
            let omega = ratio * wind / 63.0;
            let [value, slope] = coefficient(ratio);
            let whole = 0.5 * 1.225 * PI * (63.0 * 63.0) * wind.powi(3);
            let pole = whole * (slope * 63.0 / wind / omega - value / (omega * omega)) / INERTIA;
            assert!(
                (space.a[(1, 1)] / pole - 1.0).abs() < 1e-9,
                "{} {pole}",
                space.a
            );
            let by_brake = space.b[(1, space.input("brake").unwrap())];
            assert!(
                (by_brake * INERTIA / -97.0 - 1.0).abs() < 1e-9,
                "{by_brake}"
            );
        }
    }

    #[test]
    fn a_run_stays_steady() {
        let model = Turbine::new(TurbineParams::default()).unwrap();
        let steady = steady(&model, 9.0, 8.0).unwrap();
        let mut simulation = Simulation::new(&model, Options::tsit5(1e-10)).unwrap();
        simulation.set_state(0.0, &steady.state).unwrap();
        let brake = steady.inputs[1];
        simulation
            .set_inputs(&TurbineInputs { wind: 9.0, brake })
            .unwrap();
        simulation.run(60.0).unwrap();
        assert!((speed(&simulation) * 63.0 / 9.0 - 8.0).abs() < 1e-9);
    }
}
