//! Double pendulum in space: a hinge and a universal joint.
//!
//! The upper link swings in a plane; the lower one hangs on a universal joint, so it also sways out of that plane: three freedoms, and chaotic.
//! Nothing takes or gives energy.

mbd_runtime::model! {
    /// Double pendulum in space: the upper link on a hinge, the lower one on a universal joint.
    pub model DoublePendulum<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        /// Mass of the upper link.
        param m_upper = 2 kg in 0.1 kg ..= 10 kg;
        /// Mass of the lower link.
        param m_lower = 1.5 kg in 0.1 kg ..= 10 kg;
        body upper {
            mass: m_upper,
            inertia: diag(0.17, 0.17, 0.002) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame tip at [0.0, 0.0, -0.5] m,
        }
        body lower {
            mass: m_lower,
            inertia: diag(0.0305, 0.0305, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.25] m,
            frame tip at [0.0, 0.0, -0.25] m,
        }
        joint shoulder: hinge from world to upper.top { axis: y }
        joint elbow: universal from upper.tip to lower.top { axes: [x, y] }

        /// Inclination of the upper link to the vertical.
        output upper_angle = angle(upper.z, world.z) in deg;
        /// Inclination of the lower link to the vertical.
        output lower_angle = angle(lower.z, world.z) in deg;
        /// Place of the free end.
        output free_end = lower.tip.position;
    }
}

/// At rest, the upper link 10° above the horizontal, the lower one bent sideways by 0.4 rad.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "6 s"
tolerance = 1e-10
every = "10 ms"
instants = ["0 s", "0.15 s", "0.3 s", "0.45 s", "0.6 s", "0.75 s"]

[run.start]
upper.x = "-0.49240387650610395 m"
upper.z = "0.08682408883346515 m"
upper.qw = 0.6427876096865394
upper.qy = 0.766044443118978
lower.x = "-1.2115747549850011 m"
lower.y = "0.09735458557716262 m"
lower.z = "0.21363331844910338 m"
lower.qw = 0.6299746529042384
lower.qx = 0.12770218425978178
lower.qy = 0.7507745558419164
lower.qz = -0.1521895368737227
"#,
    )
}
