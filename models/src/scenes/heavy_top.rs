//! Heavy top: a spherical joint, and a motion known in closed form.
//!
//! A symmetric top on its tip, inclined by θ, precesses steadily at Ω where the moment of its weight turns its angular momentum:
//!
//! ```text
//! I1 cos θ Ω² − I3 ω3 Ω + m g l = 0          I1 about the tip, ω3 the whole spin about the axis        (1)
//! ```
//!
//! The smaller root is the slow precession; the figure *Precession* compares the horizontal components of the axis with it.
//! Goldstein, Classical Mechanics, The heavy symmetrical top with one point fixed.

mbd_runtime::model! {
    /// Heavy top on a spherical joint, in slow steady precession; compared with its closed form.
    pub model HeavyTop<T> {
        gravity: [0.0, 0.0, -G] m/s^2;
        const G = 9.81;
        const MASS = 1.2 kg;
        /// From the tip to the centre of mass.
        const LENGTH = 0.25 m;
        /// Moment of inertia about a transverse axis through the tip.
        const I1 = 0.09 kg*m^2;
        /// Moment of inertia about the axis.
        const I3 = 0.02 kg*m^2;
        /// Inclination of the axis.
        const NUTATION = 35 deg;
        /// Spin about the axis, precession included.
        const SPIN = 80 rad/s;
        /// The smaller root of (1).
        const PRECESSION = (
            I3 * SPIN - sqrt(I3^2 * SPIN^2 - 4 * I1 * cos(NUTATION) * MASS * (G * 1 m/s^2) * LENGTH)
        )
            / (2 * I1 * cos(NUTATION));

        body top {
            mass: MASS,
            inertia: diag(I1 - MASS * LENGTH^2, I1 - MASS * LENGTH^2, I3),
            frame tip at [0.0, 0.0, -LENGTH],
        }
        joint stand: spherical from world to top.tip;

        /// Inclination of the axis.
        output nutation = angle(top.z, world.z) in deg;
        /// Horizontal components of the axis.
        output axis_x = top.z.x;
        /// Horizontal components of the axis.
        output axis_y = top.z.y;
        /// The same by the closed form.
        output closed_form_x = -sin(NUTATION) * sin(PRECESSION * time);
        /// The same by the closed form.
        output closed_form_y = sin(NUTATION) * cos(PRECESSION * time);
    }
}

/// Starts on the steady motion: the velocity of the centre of mass and the rates are those of precession and spin.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "4 s"
tolerance = 1e-10
every = "10 ms"
instants = ["0 s", "0.4 s", "0.8 s", "1.2 s", "1.6 s", "2 s"]

[run.figures]
Precession = ["axis_x", "closed_form_x", "axis_y", "closed_form_y"]

[run.start]
top.y = "0.1433941090877615 m"
top.z = "0.20478801107224795 m"
top.qw = 0.9537169507482269
top.qx = -0.30070579950427306
top.vx = "-0.29095862804167477 m/s"
top.omega_body_y = "-1.163834512166699 rad/s"
top.omega_body_z = "80 rad/s"
"#,
    )
}
