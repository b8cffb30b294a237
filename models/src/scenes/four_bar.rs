//! Four-bar linkage: a closed loop in a plane, held by four parallel hinges.
//!
//! Grashof's crank-rocker: the shortest and the longest side together are shorter than the other two, so the crank turns all the way round.
//! Three bodies have 18 freedoms, four hinges forbid 20: in a plane mechanism three of the five rows of one hinge repeat the others.

mbd_runtime::model! {
    /// Four-bar linkage of four parallel hinges, driven at its crank; three of its twenty rows are redundant.
    pub model FourBar<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        const CRANK = 0.3 m;
        const COUPLER = 0.9 m;
        const ROCKER = 0.8 m;
        /// Distance of the two pivots on the ground.
        const GROUND = 1.0 m;
        /// Mass of a metre of bar.
        const DENSITY = 1.6 kg/m;
        /// Speed at which the drive gives no torque; negative: from x to z.
        param speed = -6 rad/s in -20 rad/s ..= 20 rad/s;
        /// Torque of the drive over the speed that is missing.
        param drive_gain = 2 N*m*s in 0 N*m*s ..= 10 N*m*s;
        world { frame pivot at [GROUND, 0.0, 0.0] }

        body crank {
            mass: DENSITY * CRANK,
            inertia: diag(1e-5 kg*m^2, DENSITY * CRANK^3 / 12, DENSITY * CRANK^3 / 12),
            frame left at [-CRANK / 2, 0.0, 0.0],
            frame right at [CRANK / 2, 0.0, 0.0],
        }
        body coupler {
            mass: DENSITY * COUPLER,
            inertia: diag(1e-5 kg*m^2, DENSITY * COUPLER^3 / 12, DENSITY * COUPLER^3 / 12),
            frame left at [-COUPLER / 2, 0.0, 0.0],
            frame right at [COUPLER / 2, 0.0, 0.0],
        }
        body rocker {
            mass: DENSITY * ROCKER,
            inertia: diag(1e-5 kg*m^2, DENSITY * ROCKER^3 / 12, DENSITY * ROCKER^3 / 12),
            frame left at [-ROCKER / 2, 0.0, 0.0],
            frame right at [ROCKER / 2, 0.0, 0.0],
        }
        joint crank_pin: hinge from world to crank.left { axis: y }
        joint coupler_pin: hinge from crank.right to coupler.left { axis: y }
        joint rocker_pin: hinge from coupler.right to rocker.right { axis: y }
        joint ground_pin: hinge from world.pivot to rocker.left { axis: y }

        load drive on crank = [0.0, drive_gain * (speed - crank.omega_body.y), 0.0];

        /// Speed of the crank about the hinge axis.
        output crank_speed = crank_pin.angle_rate;
        /// Angle of the crank at its pin; negative: from x to z.
        output crank_angle = crank_pin.angle in deg;
        /// Angle of the rocker at its pin.
        output rocker_angle = ground_pin.angle in deg;
    }
}

/// At rest, the crank at 60°; the drive starts it.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "5 s"
tolerance = 1e-9
every = "10 ms"
instants = ["0 s", "3 s", "3.2 s", "3.4 s", "3.6 s", "3.8 s"]

[run.start]
crank.x = "0.075 m"
crank.z = "0.129904 m"
crank.qw = 0.866025
crank.qy = -0.5
coupler.x = "0.513454 m"
coupler.z = "0.52514 m"
coupler.qw = 0.950704
coupler.qy = -0.310101
rocker.x = "0.938454 m"
rocker.z = "0.395237 m"
rocker.qw = 0.650436
rocker.qy = -0.759561
"#,
    )
}
