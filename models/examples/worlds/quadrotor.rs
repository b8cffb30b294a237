//! A quadrotor with a load on a sling: the thrusts at which it hovers, and how the load swings under it.
//!
//! Each rotor carries a quarter of the weight. At fixed attitude the load swings against the vehicle with `ω² = g (M + m)/(M L)`.

use mbd_runtime::{Options, Simulation, TrimError, Trimmed, model, trim};

use crate::Outcome;

model! {
    /// Four rotors on arms of 25 cm, and a load on a rod under the centre of mass.
    model Quadrotor {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        const arm = 0.25 m;
        const drag = 0.016 m;
        param m_load = 0.5 kg in 0.1 kg ..= 1.0 kg;
        param sling = 1.5 m in 0.5 m ..= 5 m;
        input thrust[i in 0..4]: force;
        body drone {
            mass: 1.2 kg,
            inertia: diag(0.012, 0.012, 0.021) kg*m^2,
            frame rotor[i in 0..4] at polar(arm, i * 90 deg, 0 m),
            start at [0.0, 0.0, 10.0] m,
        }
        point cargo { mass: m_load, start at [0 m, 0 m, 10 m - sling] }
        joint flight: free from world to drone.com;
        joint rope: distance from drone.com to cargo { length: sling }
        load lift[i in 0..4] on drone at rotor[i] = thrust[i] * drone.z;
        load twist[i in 0..4] on drone = (-1)^i * drag * thrust[i] * drone.z;
    }
}

/// Hover at the declared place, with the nose where it is.
fn hover(model: &Quadrotor) -> Result<Trimmed, TrimError> {
    let mut asked = trim(model);
    for place in ["drone.x", "drone.y", "drone.z", "drone.turn_z"] {
        asked = asked.hold(place);
    }
    for rotor in 0..4 {
        asked = asked.free_input(&format!("thrust[{rotor}]"));
    }
    asked.solve()
}

/// Hover with the load pushed sideways: the thrusts stay what they are.
fn pushed(model: &Quadrotor, velocity: f64) -> Result<Simulation<f64>, Box<dyn std::error::Error>> {
    let hover = hover(model)?;
    let mut state = QuadrotorState::from_slice(&hover.state).expect("the state of this model");
    let mut cargo = state.cargo();
    cargo.velocity[0] = velocity;
    state.set_cargo(cargo);
    let mut simulation = Simulation::new(model, Options::tsit5(1e-11))?;
    simulation.set_state(0.0, &state.to_vec())?;
    let thrust = hover.inputs.as_slice().try_into()?;
    simulation.set_inputs(&QuadrotorInputs { thrust })?;
    Ok(simulation)
}

/// How far the load is ahead of the vehicle [m].
fn ahead(simulation: &Simulation<f64>) -> f64 {
    let state = QuadrotorState::from_slice(simulation.state()).expect("the state of this model");
    state.cargo().position[0] - state.drone().position[0]
}

/// Prints hover, the modes about it, and a swing of the load.
pub fn run() -> Outcome {
    let model = Quadrotor::new(QuadrotorParams::default())?;
    let hover = hover(&model)?;
    println!("thrusts {:.4?} N", hover.inputs);
    for mode in hover
        .space
        .vibrations()
        .iter()
        .filter(|mode| mode.frequency() > 0.1)
    {
        println!("a swing at {:.4} Hz", mode.hertz());
    }
    let mut simulation = pushed(&model, 0.3)?;
    println!("time [s]  load ahead by [m]");
    for step in 0..=8 {
        simulation.run(f64::from(step) * 0.25)?;
        println!("{:8.2}  {:17.4}", simulation.time(), ahead(&simulation));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRONE: f64 = 1.2;
    const G: f64 = 9.81;

    fn cases() -> impl Iterator<Item = (Quadrotor, [f64; 2])> {
        let all = [[0.5, 1.5], [0.2, 0.8], [1.0, 4.0]];
        all.into_iter().map(|[m_load, sling]| {
            let params = QuadrotorParams { m_load, sling };
            (Quadrotor::new(params).unwrap(), [m_load, sling])
        })
    }

    /// How fast the load swings against the vehicle [rad/s].
    fn swing([load, length]: [f64; 2]) -> f64 {
        (G * (DRONE + load) / (DRONE * length)).sqrt()
    }

    #[test]
    fn each_rotor_carries_a_quarter_and_the_load_hangs_below() {
        for (model, [load, length]) in cases() {
            let hover = hover(&model).unwrap();
            for thrust in &hover.inputs {
                assert!((thrust - (DRONE + load) * G / 4.0).abs() < 1e-9, "{thrust}");
            }
            let state = QuadrotorState::from_slice(&hover.state).unwrap();
            assert_eq!(state.drone().position, [0.0, 0.0, 10.0]);
            let hangs = state.cargo().position;
            assert!((hangs[2] - 10.0 + length).abs() < 1e-9 && hangs[0].hypot(hangs[1]) < 1e-9);
        }
    }

    #[test]
    fn the_load_swings_in_two_modes_and_nothing_else_does() {
        for (model, numbers) in cases() {
            let modes = hover(&model).unwrap().space.vibrations();
            let swings = modes.iter().filter(|mode| mode.frequency() > 0.1);
            let swings: Vec<f64> = swings.map(|mode| mode.imaginary).collect();
            assert_eq!(swings.len(), 2);
            for found in swings {
                assert!((found - swing(numbers)).abs() < 1e-9, "{found}");
            }
        }
    }

    #[test]
    fn thrusts_lift_tilt_and_turn() {
        for (model, [load, _]) in cases() {
            let space = hover(&model).unwrap().space;
            let by = |state: &str, rotor: usize| space.b[(space.state(state).unwrap(), rotor)];
            for rotor in 0..4 {
                // On x, y, −x, −y: lever arms give turns about y and x; drag alternates about z.
                let [along_x, along_y] =
                    [[1.0, 0.0, -1.0, 0.0][rotor], [0.0, 1.0, 0.0, -1.0][rotor]];
                let hand = [1.0, -1.0, 1.0, -1.0][rotor];
                let wanted = [
                    ("drone.vz", 1.0 / (DRONE + load)),
                    ("drone.omega_body_x", 0.25 * along_y / 0.012),
                    ("drone.omega_body_y", -0.25 * along_x / 0.012),
                    ("drone.omega_body_z", 0.016 * hand / 0.021),
                ];
                for (state, wanted) in wanted {
                    assert!(
                        (by(state, rotor) - wanted).abs() < 1e-10,
                        "{state} by {rotor}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_small_swing_is_that_of_the_mode() {
        for (model, numbers) in cases() {
            let (velocity, omega) = (0.01, swing(numbers));
            let mut simulation = pushed(&model, velocity).unwrap();
            for time in [0.3, 1.0, 2.2, 5.0] {
                simulation.run(time).unwrap();
                let linear = velocity / omega * (omega * time).sin();
                // Of third order in an angle of some milliradians, which add up over two periods.
                assert!(
                    (ahead(&simulation) - linear).abs() < 1e-4 * velocity,
                    "{time}"
                );
            }
        }
    }
}
