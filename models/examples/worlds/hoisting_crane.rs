//! A crane that hoists while its load swings: the rope is let out and drawn in as inputs say, length and rate together.
//!
//! A rope of free length L(t) without mass, stiffness K and damping C, a load of mass m at the distance r and the angle θ:
//! `m r̈ = m r θ̇² + m g cos θ − K (r − L) − C (ṙ − L̇)`, `r θ̈ = −2 ṙ θ̇ − g sin θ`. Where K is large, r = L: the pendulum of varying length,
//! `L θ̈ = −2 L̇ θ̇ − g sin θ`. A load that is drawn up swings wider.

use mbd_runtime::{Options, PointState, RunError, Simulation, model};

use crate::Outcome;

model! {
    /// Two tonnes on a steel rope; the winch is told length and rate.
    model HoistingCrane {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        input paid_out: length = 20 m;
        input paying_out: speed;
        point hook { mass: 2000 kg }
        line rope from world to hook {
            free_length: [paid_out, paying_out],
            stiffness: 5e6 N/m,
            damping: 50 kN*s/m,
        }
        output pull = rope.tension in kN;
    }
}

/// Free length of the rope and its rate: down to 8 m and up again.
fn course(time: f64) -> [f64; 2] {
    let (sin, cos) = (0.2 * time).sin_cos();
    [14.0 + 6.0 * cos, -1.2 * sin]
}

/// What it starts with: the angle [rad].
const LEAN: f64 = 0.1;

/// How far the rope stretches under the load, hanging at an angle, at rest along itself [m].
fn stretch(angle: f64) -> f64 {
    2000.0 * 9.81 * angle.cos() / 5e6
}

/// The crane at the start of its course.
fn hoisting() -> Result<Simulation<f64>, RunError> {
    let model =
        HoistingCrane::new(HoistingCraneParams::default()).expect("defaults in their ranges");
    let mut simulation = Simulation::new(&model, Options::tsit5(1e-10))?;
    let [length, _] = course(0.0);
    let at = length + stretch(LEAN);
    let mut start = HoistingCraneState::at_origin();
    start.set_hook(PointState {
        position: [at * LEAN.sin(), -at * LEAN.cos()],
        velocity: [0.0; 2],
    });
    simulation.set_state(0.0, &start.to_vec())?;
    simulation.control(|now, inputs: &mut HoistingCraneInputs| {
        [inputs.paid_out, inputs.paying_out] = course(now.time);
    })?;
    Ok(simulation)
}

/// Distance from the drum [m] and angle [rad].
fn seen(simulation: &Simulation<f64>) -> [f64; 2] {
    let state =
        HoistingCraneState::from_slice(simulation.state()).expect("the state of this model");
    let [x, z] = state.hook().position;
    [x.hypot(z), x.atan2(-z)]
}

/// Prints length and swing.
pub fn run() -> Outcome {
    let mut simulation = hoisting()?;
    println!("time [s]  rope [m]  swing [deg]");
    for step in 0..=16 {
        simulation.run(2.0 * f64::from(step))?;
        let [length, angle] = seen(&simulation);
        println!(
            "{:8.1}  {length:8.3}  {:11.4}",
            simulation.time(),
            angle.to_degrees()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f64 = 9.81;

    /// A system of first order by the classical method with steps so small that rounding is what is left.
    fn solved<const N: usize>(
        mut x: [f64; N],
        until: f64,
        rates: impl Fn(f64, [f64; N]) -> [f64; N],
    ) -> [f64; N] {
        let steps = 400_000;
        let h = until / f64::from(steps);
        for step in 0..steps {
            let t = h * f64::from(step);
            let along = |k: [f64; N], part: f64| std::array::from_fn(|i| x[i] + part * h * k[i]);
            let a = rates(t, x);
            let b = rates(t + 0.5 * h, along(a, 0.5));
            let c = rates(t + 0.5 * h, along(b, 0.5));
            let d = rates(t + h, along(c, 1.0));
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        }
        x
    }

    #[test]
    fn the_load_swings_as_a_mass_on_an_elastic_rope_of_varying_length() {
        let until = 20.0;
        let start = [20.0 + stretch(LEAN), LEAN, 0.0, 0.0];
        let [r, angle, ..] = solved(start, until, |t, [r, angle, along, turning]| {
            let [length, rate] = course(t);
            let pull = 5e6 * (r - length) + 5e4 * (along - rate);
            [
                along,
                turning,
                r * turning * turning + G * angle.cos() - pull / 2000.0,
                -(2.0 * along * turning + G * angle.sin()) / r,
            ]
        });
        let mut simulation = hoisting().unwrap();
        simulation.run(until).unwrap();
        let [length, swing] = seen(&simulation);
        assert!((length - r).abs() < 1e-7, "{length} against {r}");
        assert!((swing - angle).abs() < 1e-8, "{swing} against {angle}");
    }

    #[test]
    fn on_a_stiff_rope_it_is_the_pendulum_of_varying_length() {
        let mut simulation = hoisting().unwrap();
        for time in [4.0, 8.0, 12.0, 16.0] {
            simulation.run(time).unwrap();
            let [angle, _] = solved([LEAN, 0.0], time, |t, [angle, turning]| {
                let [length, rate] = course(t);
                [turning, -(2.0 * rate * turning + G * angle.sin()) / length]
            });
            let [_, swing] = seen(&simulation);
            // The rope is longer by 4 mm in 8 m: half of that is the phase it loses in a second of 1.1 rad/s.
            let bound = 2.0 * LEAN * 1.1 * time * 0.25e-3;
            assert!(
                (swing - angle).abs() < bound,
                "{time}: {swing} against {angle}"
            );
        }
    }

    #[test]
    fn a_load_that_is_drawn_up_swings_wider_and_one_that_is_let_down_narrower() {
        let mut simulation = hoisting().unwrap();
        let mut widest = [0.0_f64; 2];
        for step in 0..=320 {
            simulation.run(0.1 * f64::from(step)).unwrap();
            let [_, swing] = seen(&simulation);
            // The rope is shortest at 5 π s, and as long as at first at 10 π s.
            let near = [5.0, 10.0].map(|at| simulation.time() - std::f64::consts::PI * at);
            for (widest, near) in widest.iter_mut().zip(near) {
                if (-4.5..0.6).contains(&near) {
                    *widest = widest.max(swing.abs());
                }
            }
        }
        // Adiabatic: θ² √(g L³) stays, so that 8 m of 20 m swing (20/8)^(3/4) times as wide.
        let want = LEAN * (20.0_f64 / 8.0).powf(0.75);
        assert!((widest[0] / want - 1.0).abs() < 0.15, "{widest:?}, {want}");
        assert!((widest[1] / LEAN - 1.0).abs() < 0.15, "{widest:?}");
    }
}
