//! A double wishbone seen from the front: camber and track over the travel of the wheel.
//!
//! The upper ball joint is where a circle about the lower ball joint, as far as the upright reaches, meets one about the upper pivot.

use mbd_runtime::{Options, RunError, Simulation, model};

use crate::Outcome;

model! {
    /// Two arms of different length, and an upright between them.
    model DoubleWishbone {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: yz;
        world { frame low at [0.0, 0.30, 0.20] m, frame high at [0.0, 0.35, 0.50] m }
        body lower_arm {
            mass: 4 kg,
            inertia: diag(0.06, 0.01, 0.06) kg*m^2,
            frame inner at [0.0, -0.2, 0.0] m,
            frame outer at [0.0, 0.2, 0.0] m,
        }
        body upper_arm {
            mass: 2 kg,
            inertia: diag(0.02, 0.01, 0.02) kg*m^2,
            frame inner at [0.0, -0.15, 0.0] m,
            frame outer at [0.0, 0.15, 0.0] m,
        }
        body upright {
            mass: 25 kg,
            inertia: diag(0.9, 0.6, 0.9) kg*m^2,
            frame lower at [0.0, 0.025, -0.15] m,
            frame upper at [0.0, -0.025, 0.15] m,
            frame contact at [0.0, 0.1, -0.45] m,
        }
        joint lower: hinge from world.low to lower_arm.inner { axis: x }
        joint upper: hinge from world.high to upper_arm.inner { axis: x }
        joint lower_ball: hinge from lower_arm.outer to upright.lower { axis: x }
        joint upper_ball: hinge from upper_arm.outer to upright.upper { axis: x }
        output contact = upright.contact.position;
    }
}

/// Camber [rad], positive where the wheel leans outwards, and lateral and vertical place of its contact [m] with the lower arm at an angle.
fn wheel(simulation: &mut Simulation<f64>, angle: f64) -> Result<[f64; 3], RunError> {
    simulation.set_joints(&[("lower.angle", angle)])?;
    let state =
        DoubleWishboneState::from_slice(simulation.state()).expect("the state of this model");
    let upright = state.upright();
    let (sin, cos) = upright.angle.sin_cos();
    let contact = [
        upright.position[0] + 0.1 * cos + 0.45 * sin,
        upright.position[1] + 0.1 * sin - 0.45 * cos,
    ];
    Ok([-upright.angle, contact[0], contact[1]])
}

fn suspension() -> Result<Simulation<f64>, RunError> {
    let model =
        DoubleWishbone::new(DoubleWishboneParams::default()).expect("defaults in their ranges");
    Simulation::new(&model, Options::tsit5(1e-9))
}

/// Prints camber and half track over the travel.
pub fn run() -> Outcome {
    let mut simulation = suspension()?;
    let [_, y0, z0] = wheel(&mut simulation, 0.0)?;
    println!("travel [mm]  camber [deg]  half track [mm]");
    for degrees in [-12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0_f64] {
        let [camber, y, z] = wheel(&mut simulation, degrees.to_radians())?;
        println!(
            "{:11.1}  {:12.3}  {:15.2}",
            1e3 * (z - z0),
            camber.to_degrees(),
            1e3 * (y - y0)
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Camber and contact from the intersection of two circles.
    fn circles(angle: f64) -> [f64; 3] {
        let lower = [0.30 + 0.4 * angle.cos(), 0.20 + 0.4 * angle.sin()];
        let high = [0.35, 0.50];
        let (reach, arm) = (f64::hypot(0.05, 0.30), 0.3);
        let between = [lower[0] - high[0], lower[1] - high[1]];
        let distance = between[0].hypot(between[1]);
        let along = (arm * arm - reach * reach + distance * distance) / (2.0 * distance);
        let across = (arm * arm - along * along).sqrt();
        let unit = between.map(|x| x / distance);
        // Of the two intersections the outer one.
        let upper = [
            high[0] + along * unit[0] - across * unit[1],
            high[1] + along * unit[1] + across * unit[0],
        ];
        let up = [upper[0] - lower[0], upper[1] - lower[1]];
        let tilt = up[1].atan2(up[0]) - 0.30_f64.atan2(-0.05);
        let (sin, cos) = tilt.sin_cos();
        // The contact is 0.075 m outside of the lower ball joint and 0.3 m below it.
        [
            -tilt,
            lower[0] + 0.075 * cos + 0.3 * sin,
            lower[1] + 0.075 * sin - 0.3 * cos,
        ]
    }

    #[test]
    fn the_wheel_goes_where_two_circles_meet() {
        let mut simulation = suspension().unwrap();
        for step in -12..=12 {
            let angle = f64::from(step).to_radians();
            let (seen, want) = (wheel(&mut simulation, angle).unwrap(), circles(angle));
            for (seen, want) in seen.iter().zip(want) {
                assert!(
                    (seen - want).abs() < 1e-10,
                    "{step} deg: {seen} is not {want}"
                );
            }
        }
        // Upward travel turns the top of the wheel inwards.
        assert!(circles(0.2)[0] < -0.005 && circles(0.0)[0].abs() < 1e-12);
    }
}
