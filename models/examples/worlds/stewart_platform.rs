//! A Stewart platform in position control: six motors take their legs to the lengths of the inverse kinematics.
//!
//! Leg i is `|p + R a_i − b_i|` long, for the joints a_i of the platform at p with attitude R and b_i of the base.

use mbd_runtime::{Options, RunError, Simulation, model};
use nalgebra::Vector3;

use crate::Outcome;

model! {
    /// A platform that circles, heaves and turns about the vertical, on six legs of two bodies each.
    model StewartPlatform {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [derivative];
        let turn = 0.1 * sin(2 rad/s * time);
        let place = [
            0.1 m * (1 - cos(2 rad/s * time)),
            0.1 m * sin(2 rad/s * time),
            0.9 m + 0.05 m * sin(3 rad/s * time),
        ];
        let top[i in 0..6] = polar(0.4 m, (60 * i + 30 * (-1)^i) * 1 deg + turn, 0 m);
        let base[i in 0..6] = polar(0.7 m, (60 * i + 10 * (-1)^i) * 1 deg, 0 m);
        world { frame foot[i in 0..6] at polar(0.7 m, (60 * i + 10 * (-1)^i) * 1 deg, 0 m) }
        body platform {
            mass: 40 kg,
            inertia: diag(2, 2, 4) kg*m^2,
            frame corner[i in 0..6] at polar(0.4 m, (60 * i + 30 * (-1)^i) * 1 deg, 0 m),
            start at [0.0, 0.0, 0.9] m,
        }
        body cylinder[i in 0..6] {
            mass: 5 kg,
            inertia: diag(0.1, 0.1, 0.01) kg*m^2,
            frame foot at [0.0, 0.0, -0.25] m,
        }
        body rod[i in 0..6] {
            mass: 3 kg,
            inertia: diag(0.06, 0.06, 0.003) kg*m^2,
            frame head at [0.0, 0.0, 0.25] m,
        }
        joint foot[i in 0..6]: universal from world.foot[i] to cylinder[i].foot { axes: [x, y] }
        joint leg[i in 0..6]: prismatic from cylinder[i].foot to rod[i].head {
            axis: z,
            motor: norm(place + top[i] - base[i]),
        }
        joint ball[i in 0..6]: spherical from rod[i].head to platform.corner[i];
    }
}

/// Where the platform is to be, and how far it is rotated.
fn wanted(time: f64) -> (Vector3<f64>, f64) {
    let (sin, cos) = (2.0 * time).sin_cos();
    let height = 0.9 + 0.05 * (3.0 * time).sin();
    (
        Vector3::new(0.1 * (1.0 - cos), 0.1 * sin, height),
        0.1 * sin,
    )
}

/// Where the platform is, and its quaternion.
fn seen(simulation: &Simulation<f64>) -> ([f64; 3], [f64; 4]) {
    let state = StewartPlatformState::from_slice(simulation.state());
    let platform = state.expect("the state of this model").platform();
    (platform.position, platform.orientation)
}

fn started() -> Result<Simulation<f64>, RunError> {
    let model =
        StewartPlatform::new(StewartPlatformParams::default()).expect("defaults in their ranges");
    Simulation::new(&model, Options::rk4(5e-3))
}

/// Prints where the platform is beside where it is to be.
pub fn run() -> Outcome {
    let mut simulation = started()?;
    println!("time [s]  x [m]     y [m]     z [m]     from the course [m]");
    for tenth in (0..=10).step_by(2) {
        simulation.run(0.1 * f64::from(tenth))?;
        let (place, _) = seen(&simulation);
        let apart = (Vector3::from(place) - wanted(simulation.time()).0).norm();
        let [x, y, z] = place;
        println!(
            "{:8.1}  {x:8.5}  {y:8.5}  {z:8.5}  {apart:.1e}",
            simulation.time()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_platform_goes_where_its_legs_are_to_take_it() {
        let mut simulation = started().unwrap();
        for tenth in 0..=10 {
            simulation.run(0.1 * f64::from(tenth)).unwrap();
            let (place, attitude) = seen(&simulation);
            let (want, turn) = wanted(simulation.time());
            assert!(
                (Vector3::from(place) - want).norm() < 1e-8,
                "{tenth}: {place:?} is not {want}"
            );
            let sign = attitude[0].signum();
            let half = [(0.5 * turn).cos(), 0.0, 0.0, (0.5 * turn).sin()];
            for (got, want) in attitude.iter().zip(half) {
                assert!((sign * got - want).abs() < 1e-8, "{tenth}: {attitude:?}");
            }
        }
    }
}
