//! The motion base of a simulator: a platform on six legs, whose lengths a controller commands every 10 ms.
//!
//! The controller sees where the platform is, adds up how far it is from its course, and commands the leg lengths of the course so moved,
//! `|p + R a_i − b_i|` for the joints a_i of the platform at p with attitude R and b_i of the base. Each leg follows its command c through the
//! filter l̈ = (c − l)/τ² − 2 l̇/τ, which over a period T at a held command has the closed form
//! `l − c = (l₀ − c + (l̇₀ + (l₀ − c)/τ) T) exp(−T/τ)`.

use mbd_runtime::{Options, RunError, Simulation, model};
use nalgebra::Vector3;

use crate::Outcome;

model! {
    /// A cabin of 400 kg on six electric legs of two bodies each.
    model MotionBase {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [derivative, outputs];
        input command[i in 0..6]: length = 1.1 m;
        world { frame foot[i in 0..6] at polar(0.7 m, (60 * i + 10 * (-1)^i) * 1 deg, 0 m) }
        body cabin {
            mass: 400 kg,
            inertia: diag(90, 110, 130) kg*m^2,
            frame corner[i in 0..6] at polar(0.4 m, (60 * i + 30 * (-1)^i) * 1 deg, 0 m),
            start at [0.0, 0.0, 1.0] m,
        }
        body cylinder[i in 0..6] {
            mass: 12 kg,
            inertia: diag(0.4, 0.4, 0.03) kg*m^2,
            frame foot at [0.0, 0.0, -0.25] m,
        }
        body rod[i in 0..6] {
            mass: 5 kg,
            inertia: diag(0.1, 0.1, 0.005) kg*m^2,
            frame head at [0.0, 0.0, 0.25] m,
        }
        joint foot[i in 0..6]: universal from world.foot[i] to cylinder[i].foot { axes: [x, y] }
        joint leg[i in 0..6]: prismatic from cylinder[i].foot to rod[i].head {
            axis: z,
            motor: command[i],
            filter: 10 ms,
        }
        joint ball[i in 0..6]: spherical from rod[i].head to cabin.corner[i];
        output thrust[i in 0..6] = leg[i].motor_force in kN;
    }
}

/// Between two samples [s].
const PERIOD: f64 = 0.01;

/// A corner of the platform about its centre, or of the base.
fn corner(radius: f64, apart: f64, i: usize) -> Vector3<f64> {
    let side = if i.is_multiple_of(2) { apart } else { -apart };
    let (sin, cos) = (60.0 * i as f64 + side).to_radians().sin_cos();
    radius * Vector3::new(cos, sin, 0.0)
}

/// Lengths of the legs for a level platform at a place [m].
fn legs(place: Vector3<f64>) -> [f64; 6] {
    std::array::from_fn(|i| (place + corner(0.4, 30.0, i) - corner(0.7, 10.0, i)).norm())
}

/// Where the cabin is to be [m]: it goes to one place and then to another.
fn wanted(time: f64) -> Vector3<f64> {
    match time {
        0.0..1.0 => Vector3::new(0.05, -0.03, 1.04),
        _ => Vector3::new(-0.04, 0.02, 0.98),
    }
}

/// Where the cabin is [m].
fn place(state: &MotionBaseState) -> Vector3<f64> {
    state.cabin().position.into()
}

/// The base under its controller.
fn controlled() -> Result<Simulation<f64>, RunError> {
    let model = MotionBase::new(MotionBaseParams::default()).expect("defaults in their ranges");
    let mut simulation = Simulation::new(&model, Options::rk4(2e-3))?;
    let mut missed = Vector3::zeros();
    simulation.control_every(PERIOD, move |sample, inputs: &mut MotionBaseInputs| {
        let goal = wanted(sample.time);
        missed += 0.1 * (goal - place(&sample.state()));
        inputs.command = legs(goal + missed);
    })?;
    Ok(simulation)
}

/// Prints the place of the cabin and what its legs push.
pub fn run() -> Outcome {
    let mut simulation = controlled()?;
    println!("time [s]  x [m]     y [m]     z [m]     from its place [m]  leg 0 [kN]");
    let mut outputs = [0.0; 6];
    for tenth in 0..=20 {
        simulation.run(0.1 * f64::from(tenth))?;
        let state =
            MotionBaseState::from_slice(simulation.state()).expect("the state of this model");
        let apart = (place(&state) - wanted(simulation.time())).norm();
        let [x, y, z] = state.cabin().position;
        simulation.evaluate(mbd_runtime::Quantity::Outputs, &mut outputs)?;
        println!(
            "{:8.1}  {x:8.5}  {y:8.5}  {z:8.5}  {apart:18.1e}  {:10.4}",
            simulation.time(),
            outputs[0]
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The time of the filters [s].
    const TAU: f64 = 0.01;

    fn seen(simulation: &Simulation<f64>) -> MotionBaseState {
        MotionBaseState::from_slice(simulation.state()).expect("the state of this model")
    }

    /// Length and rate of every leg, from where its ends are.
    fn measured(simulation: &Simulation<f64>) -> [[f64; 2]; 6] {
        let cabin = seen(simulation).cabin();
        let [w, x, y, z] = cabin.orientation;
        let attitude =
            nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let omega = attitude * Vector3::from(cabin.angular_velocity);
        std::array::from_fn(|i| {
            let arm = attitude * corner(0.4, 30.0, i);
            let leg = Vector3::from(cabin.position) + arm - corner(0.7, 10.0, i);
            let velocity = Vector3::from(cabin.velocity) + omega.cross(&arm);
            [leg.norm(), leg.dot(&velocity) / leg.norm()]
        })
    }

    #[test]
    fn every_leg_follows_what_it_is_commanded_as_its_filter_does() {
        let mut simulation = controlled().unwrap();
        simulation.run(0.0).unwrap();
        let mut legs = measured(&simulation);
        for sample in 0..40 {
            simulation.run(PERIOD * f64::from(sample + 1)).unwrap();
            let commands = simulation.held_inputs().to_vec();
            let now = measured(&simulation);
            // What is held at the end of a period was commanded at its start.
            for ((leg, now), command) in legs.iter_mut().zip(now).zip(commands) {
                let [length, rate] = *leg;
                let (from, decay) = (length - command, (-PERIOD / TAU).exp());
                let slope = rate + from / TAU;
                let want = [
                    command + (from + slope * PERIOD) * decay,
                    (slope - (from + slope * PERIOD) / TAU) * decay,
                ];
                assert!(
                    (now[0] - want[0]).abs() < 1e-6,
                    "{sample}: {now:?} {want:?}"
                );
                assert!(
                    (now[1] - want[1]).abs() < 1e-4,
                    "{sample}: {now:?} {want:?}"
                );
                *leg = now;
            }
        }
    }

    #[test]
    fn the_cabin_comes_to_rest_where_it_is_to_be() {
        let mut simulation = controlled().unwrap();
        for time in [1.0, 2.0] {
            simulation.run(time - 1e-9).unwrap();
            let apart = (place(&seen(&simulation)) - wanted(time - 0.5)).norm();
            assert!(apart < 1e-4, "{time}: {apart}");
        }
        simulation.run(4.0).unwrap();
        let state = seen(&simulation);
        assert!((place(&state) - wanted(4.0)).norm() < 1e-8);
        assert!(
            state
                .cabin()
                .velocity
                .iter()
                .all(|speed| speed.abs() < 1e-7)
        );
        // Where nothing moves the legs carry the weight, and no more.
        let mut thrusts = [0.0; 6];
        simulation
            .evaluate(mbd_runtime::Quantity::Outputs, &mut thrusts)
            .unwrap();
        let lengths = measured(&simulation);
        let lift: f64 = (0..6)
            .map(|i| {
                let leg = place(&state) + corner(0.4, 30.0, i) - corner(0.7, 10.0, i);
                1e3 * thrusts[i] * leg.z / lengths[i][0]
            })
            .sum();
        // The rods' ends carry part of the legs.
        assert!(lift > 400.0 * 9.81 && lift < 510.0 * 9.81, "{lift}");
    }
}
