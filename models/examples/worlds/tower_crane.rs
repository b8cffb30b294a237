//! A load under the trolley of a tower crane, brought 5 m along the jib in one and a half periods of its pendulum, so that it does not swing afterwards.
//!
//! The trolley follows `x = X/2 (1 − cos w t)`, the load `l θ̈ = −g sin θ − ẍ cos θ`. Where w is a third of the frequency of small swings,
//! `θ = −c (cos w t − cos 3 w t)` with `c = X/16 l`, up to terms of third order: nothing sways when the trolley arrives at w t = π.

use mbd_runtime::{Options, RunError, Simulation, model};

use crate::Outcome;

model! {
    /// Two tonnes on 20 m of rope under a trolley of half a tonne.
    model TowerCrane {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        const rope_length = 20 m;
        const way = 5 m;
        let pace = sqrt(9.81 m/s^2 / rope_length) / 3;
        body trolley { mass: 500 kg, inertia: diag(100, 100, 100) kg*m^2 }
        point hook { mass: 2000 kg, start at [0.0, 0.0, -20.0] m }
        joint jib: prismatic from world to trolley.com {
            axis: x,
            motor: 0.5 * way * (1 - cos(pace * time)),
        }
        joint rope: distance from trolley.com to hook { length: rope_length }
        output drive = jib.motor_force in kN;
    }
}

/// A third of the frequency of small swings [rad/s].
fn pace() -> f64 {
    (9.81_f64 / 20.0).sqrt() / 3.0
}

/// How far the rope leans against the vertical [rad] at the end of a run.
fn lean(simulation: &Simulation<f64>) -> f64 {
    let state = TowerCraneState::from_slice(simulation.state()).expect("the state of this model");
    let (trolley, hook) = (state.trolley().position, state.hook().position);
    (hook[0] - trolley[0]).atan2(trolley[1] - hook[1])
}

fn crane() -> Result<Simulation<f64>, RunError> {
    let model = TowerCrane::new(TowerCraneParams::default()).expect("defaults in their ranges");
    Simulation::new(&model, Options::tsit5(1e-10))
}

/// Prints trolley and sway on the way.
pub fn run() -> Outcome {
    let mut simulation = crane()?;
    println!("time [s]  trolley [m]  sway [deg]");
    let arrival = std::f64::consts::PI / pace();
    for part in 0..=8 {
        simulation.run(arrival * f64::from(part) / 8.0)?;
        let state =
            TowerCraneState::from_slice(simulation.state()).expect("the state of this model");
        let trolley = state.trolley().position[0];
        println!(
            "{:8.3}  {trolley:11.4}  {:10.4}",
            simulation.time(),
            lean(&simulation).to_degrees()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// θ of l θ̈ = −g sin θ − ẍ cos θ by the classical method with small steps.
    fn pendulum(until: f64) -> f64 {
        let rate = |t: f64, [angle, speed]: [f64; 2]| {
            let trolley = 2.5 * pace() * pace() * (pace() * t).cos();
            [speed, -(9.81 * angle.sin() + trolley * angle.cos()) / 20.0]
        };
        let (steps, mut x) = (20_000, [0.0; 2]);
        let h = until / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            let along = |k: [f64; 2], part: f64| [x[0] + part * h * k[0], x[1] + part * h * k[1]];
            let a = rate(t, x);
            let b = rate(t + 0.5 * h, along(a, 0.5));
            let c = rate(t + 0.5 * h, along(b, 0.5));
            let d = rate(t + h, along(c, 1.0));
            x = [0, 1].map(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        x[0]
    }

    #[test]
    fn the_load_sways_as_a_pendulum_on_a_trolley() {
        let mut simulation = crane().unwrap();
        let turn = std::f64::consts::TAU / pace();
        for part in 1..=8 {
            let time = turn * f64::from(part) / 8.0;
            simulation.run(time).unwrap();
            let (seen, want) = (lean(&simulation), pendulum(time));
            assert!((seen - want).abs() < 1e-8, "{time}: {seen} is not {want}");
        }
    }

    #[test]
    fn small_sways_follow_their_closed_form() {
        let mut simulation = crane().unwrap();
        let c = 5.0 / (16.0 * 20.0);
        for part in 1..=8 {
            let phase = std::f64::consts::FRAC_PI_4 * f64::from(part);
            simulation.run(phase / pace()).unwrap();
            let want = -c * (phase.cos() - (3.0 * phase).cos());
            let seen = lean(&simulation);
            // What is left out is of third order.
            assert!(
                (seen - want).abs() < 8.0 * c.powi(3) * phase,
                "{phase}: {seen} is not {want}"
            );
        }
    }
}
