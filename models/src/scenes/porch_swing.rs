//! Porch swing: lines, equilibrium points and joints in one scene.
//!
//! A seat hangs on two ropes; each parts at a knot, which has no mass, into a front and a rear line. A rider sits fixed on the seat (rigid joint),
//! two legs swing from its front edge (hinges). The knots follow from the balance of their lines at every instant, the legs from the rows of
//! their joints.

mbd_runtime::model! {
    /// Porch swing: seat on ropes with massless knots, a rider fixed on it, two legs on hinges.
    pub model PorchSwing<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        /// Stiffness of every line.
        param k = 30 kN/m in 1 kN/m ..= 100 kN/m;
        /// Mass of the rider without legs.
        param m_rider = 45 kg in 5 kg ..= 100 kg;
        world { frame beam[i in 0..2] at [0.0, 0.6 * (2 * i - 1), 2.2] m }

        body seat {
            mass: 8 kg,
            inertia: diag(0.8, 0.15, 0.9) kg*m^2,
            frame front[i in 0..2] at [0.2, 0.5 * (2 * i - 1), 0.02] m,
            frame rear[i in 0..2] at [-0.2, 0.5 * (2 * i - 1), 0.02] m,
            frame edge[i in 0..2] at [0.22, 0.12 * (2 * i - 1), 0.0] m,
            frame place at [-0.05, 0.0, 0.02] m,
        }
        body rider {
            mass: m_rider,
            inertia: diag(2.5, 2.5, 1.2) kg*m^2,
            frame hip at [0.0, 0.0, -0.28] m,
        }
        body leg[i in 0..2] {
            mass: 4 kg,
            inertia: diag(0.07, 0.07, 0.005) kg*m^2,
            frame knee at [0.0, 0.0, 0.2] m,
            frame foot at [0.0, 0.0, -0.25] m,
        }
        point knot[i in 0..2] { equilibrium: static }

        joint seat_free: free from world to seat.com;
        joint sits: rigid from seat.place to rider.hip;
        joint knee[i in 0..2]: hinge from seat.edge[i] to leg[i].knee { axis: y }
        line rope[i in 0..2] from world.beam[i] to knot[i] { free_length: 1.19 m, stiffness: k }
        line front[i in 0..2] from seat.front[i] to knot[i] { free_length: 0.562 m, stiffness: k }
        line rear[i in 0..2] from seat.rear[i] to knot[i] { free_length: 0.562 m, stiffness: k }

        /// Place of the seat.
        output seat_place = seat.position;
        /// Angles of the legs at the knees; both move alike.
        output leg_angle[i in 0..2] = knee[i].angle in deg;
        /// Height of the feet.
        output foot[i in 0..2] = leg[i].foot.position.z;
    }
}

/// Hanging down, pushed to 1.5 m/s.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "6 s"
tolerance = 1e-9
every = "10 ms"
instants = ["0 s", "0.25 s", "0.5 s", "1.25 s", "1.75 s"]

[run.start]
seat.z = "0.45 m"
seat.vx = "1.5 m/s"
rider.x = "-0.05 m"
rider.z = "0.75 m"
rider.vx = "1.5 m/s"
"leg[0]".x = "0.22 m"
"leg[0]".y = "-0.12 m"
"leg[0]".z = "0.25 m"
"leg[0]".vx = "1.5 m/s"
"leg[1]".x = "0.22 m"
"leg[1]".y = "0.12 m"
"leg[1]".z = "0.25 m"
"leg[1]".vx = "1.5 m/s"
"knot[0]".y = "-0.55 m"
"knot[0]".z = "1 m"
"knot[1]".y = "0.55 m"
"knot[1]".z = "1 m"
"#,
    )
}
