//! Slider-crank: hinge, spherical, universal and prismatic joint in one loop without a redundant row.
//!
//! Crank, rod and piston have 18 freedoms; 5 + 3 + 4 + 5 rows leave one. With hinges at both ends of the rod three rows would repeat others: a real
//! engine, too, leaves play there. The way of the piston is known from the angle θ of the crank:
//!
//! ```text
//! s = r cos θ + √(l² − r² sin² θ)                                                                        (1)
//! ```

mbd_runtime::model! {
    /// Slider-crank with a spherical crank pin and a universal wrist pin, driven at its crank; its way compared with the closed form.
    pub model SliderCrank<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        const CRANK = 10 cm;
        const ROD = 35 cm;
        /// Speed at which the drive gives no torque; negative: from x to z.
        param speed = -30 rad/s in -100 rad/s ..= 100 rad/s;
        /// Torque of the drive over the speed that is missing.
        param drive_gain = 0.2 N*m*s in 0 N*m*s ..= 10 N*m*s;
        /// Mass of the piston.
        param m_piston = 0.8 kg in 0.1 kg ..= 5 kg;

        body crank {
            mass: 2 kg,
            inertia: diag(2e-3, 1e-2, 1e-2) kg*m^2,
            frame bearing at [-CRANK / 2, 0.0, 0.0],
            frame pin at [CRANK / 2, 0.0, 0.0],
        }
        body rod {
            mass: 0.5 kg,
            inertia: diag(1e-4, 6e-3, 6e-3) kg*m^2,
            frame big_end at [-ROD / 2, 0.0, 0.0],
            frame small_end at [ROD / 2, 0.0, 0.0],
        }
        body piston {
            mass: m_piston,
            inertia: diag(1e-3, 1e-3, 1e-3) kg*m^2,
        }
        joint bearing: hinge from world to crank.bearing { axis: y }
        joint crank_pin: spherical from crank.pin to rod.big_end;
        joint wrist_pin: universal from piston.com to rod.small_end { axes: [z, y] }
        joint cylinder: prismatic from world to piston.com { axis: x }

        load drive on crank = [0.0, drive_gain * (speed - crank.omega_body.y), 0.0];

        /// Speed of the crank about the hinge axis.
        output crank_speed = bearing.angle_rate;
        /// Way of the piston from the bearing of the crank.
        output slide = cylinder.slide;
        /// The same by (1) from the angle of the crank.
        output closed_form =
            CRANK * cos(bearing.angle) + sqrt(ROD^2 - CRANK^2 * sin(bearing.angle)^2);
    }
}

/// At rest, the crank at 60°; the drive starts it.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "2 s"
tolerance = 1e-9
every = "5 ms"
instants = ["0 s", "1 s", "1.03 s", "1.06 s", "1.09 s"]

[run.figures]
"Way of the piston" = ["slide", "closed_form"]

[run.start]
crank.x = "0.025 m"
crank.z = "0.0433012701892219 m"
crank.qw = 0.8660254037844387
crank.qy = -0.5
rod.x = "0.219558249578132 m"
rod.z = "0.0433012701892219 m"
rod.qw = 0.9921956166259781
rod.qy = 0.12469105159631597
piston.x = "0.38911649915626345 m"
"#,
    )
}
