//! A motor with a permanent magnet that starts under a voltage: current is a state of its own beside the mechanics.
//!
//! `L di/dt = u − R i − k ω`, `J dω/dt = k i − b ω`: with the poles p of `(L s + R)(J s + b) + k² = 0` and the final speed ω∞,
//! `ω = ω∞ (1 + (p₂ e^{p₁t} − p₁ e^{p₂t})/(p₁ − p₂))`.

use mbd_runtime::{Options, Simulation, model};

use crate::Outcome;

model! {
    /// A motor on 24 V.
    model Motor {
        gravity: none;
        const R = 1.2 ohm;
        const L = 3 mH;
        const k = 0.05 N*m/A;
        input voltage: V = 24 V;
        body rotor { mass: 0.5 kg, inertia: diag(1e-4, 1e-4, 2e-4) kg*m^2 }
        joint shaft: hinge from world to rotor.com {
            axis: z,
            damping: 1e-4 N*m*s,
            force: k * current,
        }
        state current = 0 A { rate: (voltage - R * current - k * shaft.angle_rate) / L }
        output speed = shaft.angle_rate in rpm;
        output torque = k * current in mN*m;
    }
}

/// Speed [rad/s] and current [A] of a run.
fn seen(simulation: &Simulation<f64>) -> [f64; 2] {
    let state = MotorState::from_slice(simulation.state()).expect("the state of this model");
    [state.rotor().angular_velocity[2], state.current()]
}

/// Prints how it starts, and how it stops when its terminals are joined.
pub fn run() -> Outcome {
    let model = Motor::new(MotorParams::default())?;
    let mut simulation = Simulation::new(&model, Options::tsit5(1e-9))?;
    println!("time [ms]  speed [rad/s]  current [A]");
    for step in 0..=20 {
        if step == 10 {
            simulation.set_inputs(&MotorInputs { voltage: 0.0 })?;
        }
        simulation.run(f64::from(step) * 0.05)?;
        let [speed, current] = seen(&simulation);
        println!("{:9}  {speed:13.3}  {current:11.4}", step * 50);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: f64 = 1.2;
    const L: f64 = 3e-3;
    const K: f64 = 0.05;
    const J: f64 = 2e-4;
    const B: f64 = 1e-4;

    /// Speed and current at a time after the voltage is switched on.
    fn closed_form(voltage: f64, time: f64) -> [f64; 2] {
        let sum = R / L + B / J;
        let product = (R * B + K * K) / (L * J);
        let root = (sum * sum / 4.0 - product).sqrt();
        let [p1, p2] = [-sum / 2.0 + root, -sum / 2.0 - root];
        let last = K * voltage / (R * B + K * K);
        let [e1, e2] = [(p1 * time).exp(), (p2 * time).exp()];
        let speed = last * (1.0 + (p2 * e1 - p1 * e2) / (p1 - p2));
        let acceleration = last * p1 * p2 * (e1 - e2) / (p1 - p2);
        [speed, (J * acceleration + B * speed) / K]
    }

    #[test]
    fn it_starts_as_the_closed_form() {
        for voltage in [24.0, -6.0] {
            let model = Motor::new(MotorParams::default()).unwrap();
            let mut simulation = Simulation::new(&model, Options::tsit5(1e-11)).unwrap();
            simulation.set_inputs(&MotorInputs { voltage }).unwrap();
            for time in [1e-3, 3e-3, 0.01, 0.05, 0.2, 1.0] {
                simulation.run(time).unwrap();
                let (found, wanted) = (seen(&simulation), closed_form(voltage, time));
                assert!(
                    (found[0] - wanted[0]).abs() < 1e-7,
                    "speed at {time}: {found:?} {wanted:?}"
                );
                assert!(
                    (found[1] - wanted[1]).abs() < 1e-7,
                    "current at {time}: {found:?} {wanted:?}"
                );
            }
        }
    }
}
