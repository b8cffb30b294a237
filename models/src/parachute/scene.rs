//! The scene of AAS 03-163, test cases 2 and 3: a capsule under a parachute, one riser, three bridle legs, meeting at the confluence.
//!
//! One text, four declarations: only the confluence and the damping of its lines differ. Which numbers are the paper's and which are
//! assumed: [`PROVENANCE`].

/// The scene with its confluence and the damping of its lines left open.
macro_rules! parachute {
    (
        $(#[$doc:meta])*
        $name:ident { point: { $($confluence:tt)* } riser: { $($riser_damping:tt)* } leg: { $($leg_damping:tt)* } params: { $($params:tt)* } }
    ) => {
        mbd_runtime::model! {
            $(#[$doc])*
            pub model $name<T> {
                coordinates: absolute;
                angular_velocity: body;
                // Mars as a point mass, seen from a local origin: planet-centred positions would cost 2.8e-5 N in the riser.
                gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };

                /// Density of the atmosphere, uniform.
                const RHO = 0.014 kg/m^3;
                /// Reference area of the canopy.
                const S_REF = 178.8 m^2;
                /// Drag coefficient of the canopy.
                param cd = 0.46 in 0.3 ..= 0.7;
                /// Mass of the canopy.
                param m_chute = 16.0 kg in 5.0 kg ..= 50.0 kg;
                /// Mass of the capsule.
                param m_capsule = 761.0 kg in 300.0 kg ..= 2000.0 kg;
                /// Stiffness of the riser.
                param riser_k = 60 kN/m in 1 kN/m ..= 1000 kN/m;
                /// Stiffness of a bridle leg.
                param leg_k = 47 kN/m in 1 kN/m ..= 1000 kN/m;
                $($params)*

                body chute {
                    mass: m_chute,
                    inertia: diag(700.0, 700.0, 220.0) kg*m^2,
                    frame riser_end at [0.0, 0.0, -22.0] m,
                    frame cp at [0.0, 0.0, 1.57] m,
                }
                body capsule {
                    mass: m_capsule,
                    inertia: diag(235.0, 225.0, 290.0) kg*m^2,
                    frame bridle[i in 0..3] at polar(0.6 m, 20 deg + i * 120 deg, 1.23 m),
                }
                joint chute_free: free from world to chute.com;
                joint capsule_free: free from world to capsule.com;

                $($confluence)*
                line riser from chute.riser_end to confluence { free_length: 4.0 m, stiffness: riser_k $($riser_damping)* }
                line leg[i in 0..3] from capsule.bridle[i] to confluence { free_length: 1.5 m, stiffness: leg_k $($leg_damping)* }

                load drag on chute at cp = -0.5 * RHO * cd * S_REF * norm(chute.velocity) * chute.velocity;

                output riser_force = riser.tension;
            }
        }
    };
}

parachute! {
    /// The confluence as a point with mass, the model of earlier simulations.
    ParachuteMass {
        point: { point confluence { mass: m_point } }
        riser: { , damping: riser_c }
        leg: { , damping: leg_c }
        params: {
            /// Mass given to the confluence.
            param m_point = 0.1 kg in 1 g ..= 100 kg;
            /// Damping of the riser.
            param riser_c = 600 N*s/m in 0 N*s/m ..= 10000 N*s/m;
            /// Damping of a bridle leg.
            param leg_c = 470 N*s/m in 0 N*s/m ..= 10000 N*s/m;
        }
    }
}

parachute! {
    /// The confluence as an equilibrium point of undamped lines, solved again at every stage.
    ParachuteStatic {
        point: { point confluence { equilibrium: static } }
        riser: {}
        leg: {}
        params: {}
    }
}

parachute! {
    /// The confluence as an equilibrium point with damping by differences from step to step, the paper's idea with the corrected clamp.
    ParachuteStepwise {
        point: { point confluence { equilibrium: stepwise { formula: bdf2, clamp: positive } } }
        riser: { , damping: riser_c }
        leg: { , damping: leg_c }
        params: {
            /// Damping of the riser.
            param riser_c = 600 N*s/m in 0 N*s/m ..= 10000 N*s/m;
            /// Damping of a bridle leg.
            param leg_c = 470 N*s/m in 0 N*s/m ..= 10000 N*s/m;
        }
    }
}

parachute! {
    /// The same with the first-order difference.
    ParachuteEuler {
        point: { point confluence { equilibrium: stepwise { formula: euler, clamp: positive } } }
        riser: { , damping: riser_c }
        leg: { , damping: leg_c }
        params: {
            /// Damping of the riser.
            param riser_c = 600 N*s/m in 0 N*s/m ..= 10000 N*s/m;
            /// Damping of a bridle leg.
            param leg_c = 470 N*s/m in 0 N*s/m ..= 10000 N*s/m;
        }
    }
}

parachute! {
    /// The paper's formula taken literally: slack lines pull. For comparison only.
    ParachuteLiteral {
        point: { point confluence { equilibrium: stepwise { formula: euler, clamp: literal } } }
        riser: { , damping: riser_c }
        leg: { , damping: leg_c }
        params: {
            /// Damping of the riser.
            param riser_c = 600 N*s/m in 0 N*s/m ..= 10000 N*s/m;
            /// Damping of a bridle leg.
            param leg_c = 470 N*s/m in 0 N*s/m ..= 10000 N*s/m;
        }
    }
}

parachute! {
    /// A capsule under a parachute, its confluence an equilibrium point whose velocity follows from the balance of its damped lines.
    ParachuteRate {
        point: { point confluence { equilibrium: rate } }
        riser: { , damping: riser_c }
        leg: { , damping: leg_c }
        params: {
            /// Damping of the riser.
            param riser_c = 600 N*s/m in 1 N*s/m ..= 10000 N*s/m;
            /// Damping of a bridle leg.
            param leg_c = 470 N*s/m in 1 N*s/m ..= 10000 N*s/m;
        }
    }
}

/// Where a number of the scene comes from: quantity, value, source.
pub const PROVENANCE: &[[&str; 3]] = &[
    [
        "riser stiffness, damping",
        "60 000 N/m, 600 N s/m",
        "paper, table 1",
    ],
    [
        "bridle stiffness, damping, each of 3",
        "47 000 N/m, 470 N s/m",
        "paper, table 1",
    ],
    ["mass of chute, capsule", "16 kg, 761 kg", "paper, table 3"],
    [
        "drag coefficient; height of the centre of pressure",
        "0.46; 1.57 m",
        "paper; datum assumed to be the chute's centre of mass",
    ],
    [
        "riser slack; case-3 speed; altitude",
        "0.01 m; 1 m/s; 8.4 km",
        "paper",
    ],
    [
        "rotation of the planet, J terms",
        "none",
        "paper: gravity is a point mass",
    ],
    [
        "capsule: centre of mass to bridle plane",
        "1.23 m",
        "assumed (reading of a figure)",
    ],
    [
        "gravitational parameter; radius of Mars",
        "4.2828e13 m³/s²; 3 396 190 m",
        "recalled; exponents from the paper",
    ],
    [
        "reference area",
        "178.8 m²",
        "assumed (15.09 m disk, Mars Exploration Rover)",
    ],
    [
        "density, uniform",
        "0.014 kg/m³",
        "assumed; agrees with 0.7 s of slack and the 60 s to terminal speed",
    ],
    [
        "free length of riser; bridle leg",
        "4.0 m; 1.5 m",
        "assumed",
    ],
    [
        "riser attachment below the chute's centre of mass",
        "22 m",
        "assumed",
    ],
    [
        "bridle attachment: radius; azimuths",
        "0.60 m; 20°, 140°, 260°",
        "assumed (no plane of symmetry on purpose)",
    ],
    [
        "inertia of chute (transverse, roll)",
        "700, 700, 220 kg m²",
        "assumed",
    ],
    [
        "inertia of capsule (transverse, roll)",
        "235, 225, 290 kg m²",
        "assumed",
    ],
    [
        "mass of the confluence where it has mass",
        "0.1 kg, 1 kg",
        "assumed",
    ],
];

/// How the scene is run by itself: test case 2.
#[must_use]
pub fn run() -> String {
    let SceneInstant { q, point, .. } = SceneInstant::start(TestCase::Two);
    format!(
        r#"[run]
until = "10 s"
tolerance = 1e-8
every = "10 ms"

[run.start]
chute.z = "{} m"
confluence.z = "{} m"
"#,
        q[2], point[2]
    )
}

/// The two test cases that are repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TestCase {
    /// Dropped from rest with 1 cm of slack in the riser.
    Two,
    /// The same with 1 m/s of horizontal speed of the capsule (and of the confluence, where it has mass).
    Three,
}

impl TestCase {
    /// 2 or 3.
    #[must_use]
    pub fn number(self) -> u32 {
        match self {
            TestCase::Two => 2,
            TestCase::Three => 3,
        }
    }

    /// Horizontal speed of the capsule at the start [m/s].
    #[must_use]
    pub fn speed(self) -> f64 {
        match self {
            TestCase::Two => 0.0,
            TestCase::Three => 1.0,
        }
    }
}

/// Height of the confluence above the capsule's centre of mass when the bridle legs are just straight [m].
fn straight_bridle() -> f64 {
    1.23 + (1.5f64 * 1.5 - 0.6 * 0.6).sqrt()
}

/// The confluence at the start: 1 mm below the point where the bridle is straight, so that no line starts exactly at zero stretch [m].
#[must_use]
pub fn confluence_start() -> [f64; 3] {
    [0.0, 0.0, straight_bridle() - 0.001]
}

/// The scene at an instant, whatever the model of the confluence.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneInstant {
    /// Time [s].
    pub time: f64,
    /// Coordinates of chute and capsule.
    pub q: [f64; 14],
    /// Speeds of chute and capsule.
    pub v: [f64; 12],
    /// Position of the confluence [m].
    pub point: [f64; 3],
    /// Velocity of the confluence [m/s].
    pub velocity: [f64; 3],
}

impl SceneInstant {
    /// The start of a test case: attitudes along the world axes, the capsule's centre of mass at the origin, 1 cm of slack in the riser.
    #[must_use]
    pub fn start(case: TestCase) -> Self {
        let chute = straight_bridle() + 4.0 - 0.01 + 22.0;
        let mut v = [0.0; 12];
        v[6] = case.speed();
        SceneInstant {
            time: 0.0,
            q: [
                0.0, 0.0, chute, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
            ],
            v,
            point: confluence_start(),
            velocity: [case.speed(), 0.0, 0.0],
        }
    }
}
