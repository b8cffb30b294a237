//! A quarter of a car on a road: what of the road reaches the body and the strut.
//!
//! With d = k_s + c s, from the road z to the body: `H = k_t d / ((m_b s² + d)(m_w s² + d + k_t) − d²)`.

use mbd_runtime::{Options, Simulation, StateSpace, TrimError, model, trim};
use nalgebra::Complex;

use crate::Outcome;

model! {
    /// A wheel on a tyre, and a quarter of the body on a strut.
    model QuarterCar {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        const tyre = 180 kN/m;
        param strut_damping = 1.5 kN*s/m in 0 kN*s/m ..= 10 kN*s/m;
        /// Height of the road under the wheel.
        input road: length = 0 m;
        body wheel { mass: 40 kg, inertia: diag(1, 1, 1) kg*m^2 }
        body chassis { mass: 320 kg, inertia: diag(100, 100, 100) kg*m^2 }
        joint hub: prismatic from world to wheel.com { axis: z }
        joint strut: prismatic from wheel.com to chassis.com {
            axis: z,
            stiffness: 20 kN/m,
            damping: strut_damping,
        }
        load contact on wheel = [0.0, 0.0, tyre * (road - hub.slide)];
        output height = chassis.position.z;
        output comfort = chassis.acceleration.z;
        output travel = strut.slide in mm;
    }
}

/// The linear system about standing on a flat road.
fn standing(model: &QuarterCar) -> Result<StateSpace, TrimError> {
    Ok(trim(model).solve()?.space)
}

/// From the road to an output at a frequency [Hz].
fn response(space: &StateSpace, output: &str, frequency: f64) -> Complex<f64> {
    let response = space.response(std::f64::consts::TAU * frequency);
    let response = response.expect("no pole on the imaginary axis: the strut is damped");
    response[(space.output(output).expect("a declared output"), 0)]
}

/// The largest height over that of the road, on waves of 1 cm, once the start is forgotten.
fn driven(model: &QuarterCar, frequency: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let mut simulation = Simulation::new(model, Options::tsit5(1e-9))?;
    let rest = trim(model).solve()?;
    simulation.set_state(0.0, &rest.state)?;
    simulation.control(move |sample, inputs: &mut QuarterCarInputs| {
        inputs.road = 0.01 * (std::f64::consts::TAU * frequency * sample.time).sin();
    })?;
    let height = |simulation: &Simulation<f64>| {
        let state =
            QuarterCarState::from_slice(simulation.state()).expect("the state of this model");
        state.chassis().position[2]
    };
    let sag = height(&simulation);
    simulation.run(8.0)?;
    let mut most = 0.0_f64;
    for sample in 1..=200 {
        simulation.run(8.0 + f64::from(sample) / 200.0 / frequency)?;
        most = most.max(height(&simulation) - sag);
    }
    Ok(most / 0.01)
}

/// Prints what of the road reaches the body.
pub fn run() -> Outcome {
    let model = QuarterCar::new(QuarterCarParams::default())?;
    let space = standing(&model)?;
    for mode in space.vibrations() {
        println!("{:6.2} Hz, damping {:.2}", mode.hertz(), mode.damping());
    }
    println!("road [Hz]  body/road  the same, driven  comfort [m/s² per m]  travel [mm per m]");
    for frequency in [0.5, 1.0, 1.25, 2.0, 5.0, 10.0] {
        let [height, comfort, travel] = ["height", "comfort", "travel"]
            .map(|output| response(&space, output, frequency).norm());
        println!(
            "{frequency:9}  {height:9.3}  {:16.3}  {comfort:20.1}  {travel:17.0}",
            driven(&model, frequency)?
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f64 = 9.81;
    const BODY: f64 = 320.0;
    const WHEEL: f64 = 40.0;
    const STRUT: f64 = 20e3;
    const TYRE: f64 = 180e3;

    fn car(strut_damping: f64) -> QuarterCar {
        QuarterCar::new(QuarterCarParams { strut_damping }).unwrap()
    }

    /// Height of body and of wheel over that of the road.
    fn closed_form(damping: f64, frequency: f64) -> [Complex<f64>; 2] {
        let s = Complex::new(0.0, std::f64::consts::TAU * frequency);
        let strut = s * damping + STRUT;
        let body = s * s * BODY + strut;
        let whole = body * (s * s * WHEEL + strut + TYRE) - strut * strut;
        [strut * TYRE / whole, body * TYRE / whole]
    }

    #[test]
    fn it_stands_where_springs_carry_it() {
        let rest = trim(&car(1500.0)).solve().unwrap();
        let sag = -(BODY + WHEEL) * G / TYRE;
        assert!((rest.value("hub.slide").unwrap() - sag).abs() < 1e-10);
        assert!((rest.value("strut.slide").unwrap() + BODY * G / STRUT).abs() < 1e-10);
    }

    #[test]
    fn the_responses_are_the_closed_forms() {
        for damping in [100.0, 1500.0, 8000.0] {
            let space = standing(&car(damping)).unwrap();
            for frequency in [0.1, 0.5, 1.0, 1.25, 3.0, 10.0, 12.0, 50.0] {
                let [body, wheel] = closed_form(damping, frequency);
                let omega = std::f64::consts::TAU * frequency;
                let wanted = [
                    ("height", body),
                    ("comfort", -body * omega * omega),
                    ("travel", (body - wheel) * 1e3),
                ];
                for (output, wanted) in wanted {
                    let found = response(&space, output, frequency);
                    assert!(
                        (found - wanted).norm() < 1e-9 * wanted.norm().max(1.0),
                        "{output} at {frequency} Hz: {found} {wanted}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_run_on_waves_has_the_amplitude_of_the_linear_system() {
        let [body, _] = closed_form(1500.0, 2.0);
        let driven = driven(&car(1500.0), 2.0).unwrap();
        // 200 samples a wave find the crest to (π/200)²/2.
        assert!((driven / body.norm() - 1.0).abs() < 2e-4, "{driven} {body}");
    }
}
