//! A kite on two bridles and a tether in a steady wind: force, bridle knot and tether stand in one line.
//!
//! At rest the tether rises by `atan((L − W)/D)` and pulls `√(D² + (L − W)²)`, for lift L across the wind, drag D along it and the weight W.

use mbd_runtime::{TrimError, Trimmed, model, trim};

use crate::Outcome;

model! {
    /// A kite of 12 m² with a knot below it, where two bridles meet the tether.
    model Kite {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        input wind: speed = 10 m/s;
        const rho = 1.225 kg/m^3;
        const area = 12 m^2;
        let flow = [wind, 0.0, 0.0] - kite.velocity;
        let pressure = 0.5 * rho * area * norm(flow);
        body kite {
            mass: 4 kg,
            inertia: diag(2, 3, 4) kg*m^2,
            frame nose at [-0.6, 0.0, 0.0] m,
            frame tail at [0.6, 0.0, 0.0] m,
            start at [22.0, 0.0, 82.5] m rotated rpy(0.0, 15 deg, 0.0),
        }
        joint fly: free from world to kite.com;
        point knot { equilibrium: static }
        line tether from world to knot { free_length: 80 m, stiffness: 20 kN/m }
        line front from knot to kite.nose { free_length: 4.0 m, stiffness: 50 kN/m }
        line rear from knot to kite.tail { free_length: 4.1 m, stiffness: 50 kN/m }
        load lift on kite = 0.8 * pressure * [-flow.z, 0.0, flow.x];
        load drag on kite = 0.2 * pressure * flow;
        output pull = tether.tension in N;
    }
}

/// The kite at rest in a wind [m/s].
fn still(model: &Kite, wind: f64) -> Result<Trimmed, TrimError> {
    trim(model)
        .input("wind", wind)
        .nodes(&[20.8, 0.0, 78.5])
        .solve()
}

/// How high the knot stands over the ground, as an angle [rad], and its distance from the anchor [m].
fn tether(found: &Trimmed) -> [f64; 2] {
    let [x, z] = [found.nodes[0], found.nodes[2]];
    [z.atan2(x), z.hypot(x)]
}

/// Prints how steep the tether is for several winds.
pub fn run() -> Outcome {
    let model = Kite::new(KiteParams::default())?;
    println!("wind [m/s]  tether [deg]  pull [N]");
    for wind in [6.0, 8.0, 10.0, 12.0] {
        let found = still(&model, wind)?;
        let [angle, length] = tether(&found);
        let pull = 20e3 * (length - 80.0);
        println!("{wind:10}  {:12.3}  {pull:8.1}", angle.to_degrees());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tether_rises_along_the_force() {
        let model = Kite::new(KiteParams::default()).unwrap();
        for wind in [6.0, 10.0, 12.0] {
            let found = still(&model, wind).unwrap();
            let pressure = 0.5 * 1.225 * 12.0 * wind * wind;
            let [up, along] = [0.8 * pressure - 4.0 * 9.81, 0.2 * pressure];
            let [angle, length] = tether(&found);
            assert!((angle - up.atan2(along)).abs() < 1e-9, "{wind}: {angle}");
            let pull = up.hypot(along);
            assert!(
                (20e3 * (length - 80.0) - pull).abs() < 1e-5,
                "{wind}: {length}"
            );
            // No couple acts on the kite: its centre of mass stands behind the knot on the same line.
            let at = |name| found.value(name).unwrap();
            let aside = found.nodes[0] * at("kite.z") - found.nodes[2] * at("kite.x");
            assert!(aside.abs() < 1e-6, "{wind}: {aside}");
        }
    }
}
