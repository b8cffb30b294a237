//! N four-bar windows in a row: problem A02 of the IFToMM library of multibody benchmarks, with repeated bodies and joints.
//!
//! Equal bars of 1 m and 1 kg; N + 1 cranks stand on the ground, a metre apart, N couplers join their upper ends. All couplers stay parallel to
//! the ground, so the whole is one pendulum of the angle φ of a crank:
//!
//! ```text
//! ½ a φ̇² + b sin φ = const      a = (N + 1) m l²/3 + N m l²,  b = (N + 1) m g l/2 + N m g l              (1)
//! ```
//!
//! Twice a turn all bars lie on one line and the mechanism could leave its motion. A coupler's far end is a point on a line, which forbids just
//! what a plane loop needs: no row repeats another. Near the flat positions the forces in single joints are nearly undetermined and peak.

use std::fmt::Write;

mbd_runtime::model! {
    /// Two four-bar windows side by side (IFToMM A02), declared by repetition; passes flat positions where it could branch.
    pub model NFourBar<T> {
        gravity: [0.0, -9.81, 0.0] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        /// Number of windows.
        const WINDOWS = 2;
        const LENGTH = 1 m;
        const MASS = 1 kg;
        world { frame pivot[i in 0..=WINDOWS] at [i * LENGTH, 0.0, 0.0] }

        body crank[i in 0..=WINDOWS] {
            mass: MASS,
            inertia: diag(1e-3 kg*m^2, MASS * LENGTH^2 / 12, MASS * LENGTH^2 / 12),
            frame root at [-LENGTH / 2, 0.0, 0.0],
            frame tip at [LENGTH / 2, 0.0, 0.0],
        }
        body coupler[i in 0..WINDOWS] {
            mass: MASS,
            inertia: diag(1e-3 kg*m^2, MASS * LENGTH^2 / 12, MASS * LENGTH^2 / 12),
            frame left at [-LENGTH / 2, 0.0, 0.0],
            frame right at [LENGTH / 2, 0.0, 0.0],
        }
        joint ground[i in 0..=WINDOWS]: hinge from world.pivot[i] to crank[i].root { axis: z }
        joint left[i in 0..WINDOWS]: hinge from crank[i].tip to coupler[i].left { axis: z }
        joint right[i in 0..WINDOWS]: point_on_line from coupler[i].right to crank[i + 1].tip {
            axis: z,
        }

        /// Tip of the first crank, the point the benchmark asks for.
        output tip = crank[0].tip.position;
        /// Inclination of each coupler; zero on the branch of the benchmark.
        output inclination[i in 0..WINDOWS] = angle(coupler[i].x, world.x) in deg;
    }
}

/// Upright, the tips moving with 1 m/s along x, as the benchmark starts, for as many windows as are declared.
#[must_use]
pub fn run() -> String {
    let mut text = String::from(
        "[run]\nuntil = \"10 s\"\ntolerance = 1e-10\nevery = \"20 ms\"\ninstants = [\"0 s\", \"0.6 s\", \"0.8 s\", \"1 s\", \"1.2 s\"]\n\n[run.start]\n",
    );
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for body in &NFourBar::<f64>::scene().bodies {
        let (word, index) = body.name.split_once('[').unwrap_or((&body.name, "0]"));
        let place = index.trim_end_matches(']');
        // Writing into a text cannot fail.
        let _ = match word {
            "crank" => writeln!(
                text,
                "\"{0}\".x = \"{place} m\"\n\"{0}\".y = \"0.5 m\"\n\"{0}\".qw = {half}\n\"{0}\".qz = {half}\n\"{0}\".vx = \"0.5 m/s\"\n\"{0}\".omega_body_z = \"-1 rad/s\"",
                body.name
            ),
            _ => writeln!(
                text,
                "\"{0}\".x = \"{place}.5 m\"\n\"{0}\".y = \"1 m\"\n\"{0}\".vx = \"1 m/s\"",
                body.name
            ),
        };
    }
    text
}
