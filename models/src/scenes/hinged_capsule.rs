//! Parachute with a hinged capsule pair: the scene of the main job, its capsule parted into a backshell and a lander that hangs from it.
//!
//! Canopy, riser and bridle are those of `mbd parachute` (B. Raiszadeh, AAS 03-163, 2003, with the assumed numbers listed there). The confluence
//! is an equilibrium point whose velocity follows from the balance of its damped lines. A hinge couples the lander to the backshell: the pendulum
//! below rocks what hangs on the lines above.

mbd_runtime::model! {
    /// Parachute with a hinged pair of backshell and lander below an equilibrium point; dropped on Mars with slack in the riser.
    pub model HingedCapsule<T> {
        gravity: [0.0, 0.0, -3.71] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        /// Density of the atmosphere, uniform.
        const RHO = 0.014 kg/m^3;
        /// Reference area of the canopy.
        const S_REF = 178.8 m^2;
        /// Drag coefficient of the canopy.
        param cd = 0.46 in 0.3 ..= 0.7;
        /// Mass of the backshell.
        param m_backshell = 400 kg in 100 kg ..= 1000 kg;
        /// Mass of the lander.
        param m_lander = 361 kg in 100 kg ..= 1000 kg;

        body chute {
            mass: 16 kg,
            inertia: diag(700.0, 700.0, 220.0) kg*m^2,
            frame riser_end at [0.0, 0.0, -22.0] m,
            frame cp at [0.0, 0.0, 1.57] m,
        }
        body backshell {
            mass: m_backshell,
            inertia: diag(150.0, 145.0, 200.0) kg*m^2,
            frame bridle[i in 0..3] at polar(0.6 m, 20 deg + i * 120 deg, 0.8 m),
            frame pivot at [0.0, 0.0, -0.7] m,
        }
        body lander {
            mass: m_lander,
            inertia: diag(110.0, 105.0, 120.0) kg*m^2,
            frame top at [0.0, 0.0, 0.6] m,
        }
        point confluence { equilibrium: rate }

        joint chute_free: free from world to chute.com;
        joint backshell_free: free from world to backshell.com;
        joint pair: hinge from backshell.pivot to lander.top { axis: y }
        line riser from chute.riser_end to confluence {
            free_length: 4 m,
            stiffness: 60 kN/m,
            damping: 600 N*s/m,
        }
        line leg[i in 0..3] from backshell.bridle[i] to confluence {
            free_length: 1.5 m,
            stiffness: 47 kN/m,
            damping: 470 N*s/m,
        }

        load drag on chute at cp = -0.5 * RHO * cd * S_REF * norm(chute.velocity) * chute.velocity;

        /// Inclination of the backshell.
        output backshell_tilt = angle(backshell.z, world.z) in deg;
        /// Angle of the hinge.
        output hinge_angle = pair.angle in deg;
        /// Speed of the backshell.
        output speed = norm(backshell.velocity);
    }
}

/// Dropped at rest with 1 cm of slack in the riser, the pair moving sideways with 1 m/s and bent by 10°.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "12 s"
tolerance = 1e-8
every = "10 ms"
instants = ["0 s", "3 s", "6 s"]

[run.figures]
Tilt = ["backshell_tilt", "hinge_angle"]

[run.start]
chute.z = "28.1647726 m"
backshell.vx = "1 m/s"
lander.x = "-0.10418890660015819 m"
lander.z = "-1.2908846518073249 m"
lander.qw = 0.9961946980917455
lander.qy = 0.08715574274765817
lander.vx = "1 m/s"
"#,
    )
}
