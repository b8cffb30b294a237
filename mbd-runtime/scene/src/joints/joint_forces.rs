//! The fields of a joint coordinate: a spring, a damper, friction, stops, a force, a motor. The law of what pushes is in
//! [`crate::laws::joint_forces`], that of the motor, which is a row, in `rows/motor.rs`.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Field, Rule};
use crate::{Dimension, Formula, Function};

/// What acts along one coordinate of a joint. What is absent, or zero by declaration, costs nothing.
///
/// An angle of a joint lies in (−π, π] and does not count turns (that of a screw does): a spring pulls to the nearer side of its rest until
/// the angle passes half a turn, and there its torque jumps by 2π K. A run counts the steps in which that happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct JointForces {
    /// Which coordinate of the joint.
    pub coordinate: usize,
    /// Stiffness of the spring [N/m or N m/rad], ≥ 0. Of an angle within half a turn of zero, see above.
    pub stiffness: Option<Formula>,
    /// Where the spring is at rest [m or rad]; 0 if it is not given.
    pub rest: Option<Formula>,
    /// Damping [N s/m or N m s/rad], ≥ 0.
    pub damping: Option<Formula>,
    /// Level of Coulomb friction [N or N m], ≥ 0.
    pub friction: Option<Formula>,
    /// The rate over which friction turns its sign [m/s or rad/s], > 0.
    pub friction_rate: Option<Formula>,
    /// The low and the high stop [m or rad].
    pub stops: [Option<Formula>; 2],
    /// Stiffness of the stops [N/m or N m/rad], > 0.
    pub stop_stiffness: Option<Formula>,
    /// Damping of the stops [N s/m or N m s/rad], ≥ 0; none if it is not given.
    pub stop_damping: Option<Formula>,
    /// A force on the coordinate [N or N m]: any quantity of the scene may stand in it.
    pub force: Option<Formula>,
    /// The course of the coordinate, to which a motor holds it: a function of time [m or rad], or a [`Formula::Vector`] of the coordinate, its
    /// rate and its acceleration, each of inputs, states and time.
    pub motor: Option<Formula>,
    /// The filter through which the motor follows a command, where it does: then `motor` names the states of the filter.
    pub filter: Option<CommandFilter>,
}

/// The critically damped filter of second order between a command and the course of a motor, two states of the scene:
/// ċ = w, ẇ = (command − c)/τ² − 2 w/τ; the motor holds its coordinate to c, with the rate w and the acceleration ẇ.
///
/// Its response to a step is 1 − (1 + t/τ) exp(−t/τ).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CommandFilter {
    /// What it follows [m or rad]: inputs, states and time.
    pub command: Formula,
    /// Its time τ [s], > 0.
    pub time: Formula,
    /// The state c, index into [`Scene::states`](crate::Scene::states); w is the next.
    pub state: usize,
}

/// What a number of [`JointForces`] measures, by the coordinate it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// The coordinate itself.
    Value,
    /// Its rate.
    Rate,
    /// Its second rate.
    Acceleration,
    /// The generalised force on it.
    Force,
    /// Force over coordinate.
    Stiffness,
    /// Force over rate.
    Damping,
}

/// A number among the fields of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointForceField {
    /// The keyword of the field.
    pub name: &'static str,
    /// What it measures.
    pub measured: Measured,
    /// What it must obey.
    pub rule: Rule,
    /// The field without which it has no meaning.
    pub needs: Option<&'static str>,
}

const fn field(
    name: &'static str,
    measured: Measured,
    rule: Rule,
    needs: Option<&'static str>,
) -> JointForceField {
    JointForceField {
        name,
        measured,
        rule,
        needs,
    }
}

/// The keyword of the stops, and what their places obey.
pub const STOPS: JointForceField = field(
    "stops",
    Measured::Value,
    Rule::Finite,
    Some("stop_stiffness"),
);
/// The keyword of the force.
pub const FORCE: JointForceField = field("force", Measured::Force, Rule::Finite, None);
/// The keyword of the motor.
pub const MOTOR: JointForceField = field("motor", Measured::Value, Rule::Finite, None);
/// The rate of the course of a motor, where it is given.
pub const MOTOR_RATE: JointForceField = field("motor rate", Measured::Rate, Rule::Finite, None);
/// The acceleration of the course of a motor, where it is given.
pub const MOTOR_ACCELERATION: JointForceField = field(
    "motor acceleration",
    Measured::Acceleration,
    Rule::Finite,
    None,
);
/// The keyword of the time of the filter before a motor.
pub const FILTER: &str = "filter";

/// The keyword of where a coordinate starts.
pub const START: JointForceField = field("start", Measured::Value, Rule::Finite, None);
/// The keyword of the rate at which it starts.
pub const START_RATE: JointForceField = field("start_rate", Measured::Rate, Rule::Finite, None);

/// The numbers of [`JointForces`], in the order of [`JointForces::numbers`].
pub const NUMBERS: [JointForceField; 7] = [
    field("stiffness", Measured::Stiffness, Rule::NotNegative, None),
    field("rest", Measured::Value, Rule::Finite, Some("stiffness")),
    field("damping", Measured::Damping, Rule::NotNegative, None),
    field(
        "friction",
        Measured::Force,
        Rule::NotNegative,
        Some("friction_rate"),
    ),
    field(
        "friction_rate",
        Measured::Rate,
        Rule::Positive,
        Some("friction"),
    ),
    field(
        "stop_stiffness",
        Measured::Stiffness,
        Rule::Positive,
        Some("stops"),
    ),
    field(
        "stop_damping",
        Measured::Damping,
        Rule::NotNegative,
        Some("stops"),
    ),
];

impl JointForceField {
    /// The field for one coordinate.
    #[must_use]
    pub const fn of(&self, coordinate: &Coordinate) -> Field {
        Field {
            name: self.name,
            dimension: self.measured.of(coordinate),
            rule: self.rule,
        }
    }
}

impl Measured {
    /// The dimension for one coordinate: power is force times rate.
    #[must_use]
    pub const fn of(self, coordinate: &Coordinate) -> Dimension {
        let value = coordinate.dimension();
        let force = Dimension {
            mass: 2,
            length: 4 - value.length,
            time: -4,
            current: 0,
        };
        match self {
            Measured::Value => value,
            Measured::Rate => coordinate.rate_dimension(),
            Measured::Acceleration => Dimension { time: -4, ..value },
            Measured::Force => force,
            Measured::Stiffness => Dimension {
                length: force.length - value.length,
                ..force
            },
            Measured::Damping => Dimension {
                length: force.length - value.length,
                time: -2,
                ..force
            },
        }
    }
}

impl Measured {
    /// The unit for one coordinate, with the radians that a dimension does not show.
    #[must_use]
    pub const fn unit(self, coordinate: &Coordinate) -> &'static str {
        match (self, coordinate.is_angle()) {
            (Measured::Value, false) => "m",
            (Measured::Value, true) => "rad",
            (Measured::Rate, false) => "m/s",
            (Measured::Rate, true) => "rad/s",
            (Measured::Acceleration, false) => "m/s^2",
            (Measured::Acceleration, true) => "rad/s^2",
            (Measured::Force, false) => "N",
            (Measured::Force, true) => "N*m",
            (Measured::Stiffness, false) => "N/m",
            (Measured::Stiffness, true) => "N*m/rad",
            (Measured::Damping, false) => "N*s/m",
            (Measured::Damping, true) => "N*m*s/rad",
        }
    }
}

impl JointForces {
    /// What the motor is declared to follow: the command before its filter, or its course.
    #[must_use]
    pub fn declared_motor(&self) -> Option<&Formula> {
        let command = self.filter.as_ref().map(|filter| &filter.command);
        command.or(self.motor.as_ref())
    }

    /// Its numbers, in the order of [`NUMBERS`].
    #[must_use]
    pub fn numbers(&self) -> [&Option<Formula>; 7] {
        [
            &self.stiffness,
            &self.rest,
            &self.damping,
            &self.friction,
            &self.friction_rate,
            &self.stop_stiffness,
            &self.stop_damping,
        ]
    }

    /// Every formula of it: its numbers, its stops, its force and what its motor follows.
    pub fn formulas(&self) -> impl Iterator<Item = &Formula> {
        let own = self.numbers().into_iter().chain(&self.stops);
        let own = own.chain([&self.force, &self.motor]).flatten();
        own.chain(self.filter.iter().map(|filter| &filter.command))
    }

    /// The same, to be changed.
    pub fn numbers_mut(&mut self) -> [&mut Option<Formula>; 7] {
        [
            &mut self.stiffness,
            &mut self.rest,
            &mut self.damping,
            &mut self.friction,
            &mut self.friction_rate,
            &mut self.stop_stiffness,
            &mut self.stop_damping,
        ]
    }

    /// The same law with those of its terms as a `force` whose spring, damper or friction `changes` in a run: −K (x − x0), −C u or −F u/√(u² + w²) of
    /// coordinate `joint`, by (1) of the laws of joint forces.
    ///
    /// Numbers are taken once, before a run; what changes has no elastic energy of its own, and its power is that of a drive.
    #[must_use]
    pub fn with_changing_terms_as_force(
        mut self,
        joint: usize,
        changes: impl Fn(&Formula) -> bool,
    ) -> Self {
        let apply = |function, arguments: &[&Formula]| {
            Formula::Apply(function, arguments.iter().copied().cloned().collect())
        };
        let any = |numbers: &[&Option<Formula>]| numbers.iter().copied().flatten().any(&changes);
        let value = Formula::Coordinate(joint, self.coordinate);
        let rate = Formula::CoordinateRate(joint, self.coordinate);
        let mut terms = Vec::new();
        if any(&[&self.stiffness, &self.rest])
            && let Some(stiffness) = self.stiffness.take()
        {
            let deflection = match self.rest.take() {
                Some(rest) => apply(Function::Sub, &[&value, &rest]),
                None => value,
            };
            terms.push(apply(Function::Mul, &[&stiffness, &deflection]));
        }
        if any(&[&self.damping])
            && let Some(damping) = self.damping.take()
        {
            terms.push(apply(Function::Mul, &[&damping, &rate]));
        }
        if any(&[&self.friction])
            && let (Some(level), Some(width)) = (self.friction.take(), self.friction_rate.take())
        {
            let [square, of_width] = [&rate, &width].map(|u| apply(Function::Mul, &[u, u]));
            let size = apply(
                Function::Sqrt,
                &[&apply(Function::Add, &[&square, &of_width])],
            );
            let direction = apply(Function::Div, &[&rate, &size]);
            terms.push(apply(Function::Mul, &[&level, &direction]));
        }
        for term in terms {
            self.force = Some(match self.force.take() {
                Some(force) => apply(Function::Sub, &[&force, &term]),
                None => apply(Function::Neg, &[&term]),
            });
        }
        self
    }

    /// Every formula, to be changed.
    pub fn formulas_mut(&mut self) -> impl Iterator<Item = &mut Formula> {
        let JointForces {
            coordinate: _,
            stiffness,
            rest,
            damping,
            friction,
            friction_rate,
            stops: [low, high],
            stop_stiffness,
            stop_damping,
            force,
            motor,
            filter,
        } = self;
        let filter = filter.iter_mut();
        let filter = filter.flat_map(|filter| [&mut filter.command, &mut filter.time]);
        [
            stiffness,
            rest,
            damping,
            friction,
            friction_rate,
            low,
            high,
            stop_stiffness,
            stop_damping,
            force,
            motor,
        ]
        .into_iter()
        .flatten()
        .chain(filter)
    }

    /// Whether nothing is declared.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let mut given = self.numbers().into_iter().chain(&self.stops);
        given.all(Option::is_none) && self.force.is_none() && self.motor.is_none()
    }
}

/// What two stops obey, in words to follow "it must be".
pub const STOP_ORDER: &str = "a low stop below a high stop";

/// Whether two stops are in order: one that is left open always is.
#[must_use]
pub fn in_order(stops: [Option<f64>; 2]) -> bool {
    match stops {
        [Some(low), Some(high)] => low < high,
        _ => true,
    }
}

/// A side of the range between two stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Side {
    /// The stop at the low end: it pushes upwards.
    Low,
    /// The stop at the high end: it pushes downwards.
    High,
}

impl Side {
    /// The place of its stop in [`JointForces::stops`].
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Side::Low => 0,
            Side::High => 1,
        }
    }

    /// Its word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Side::Low => "low",
            Side::High => "high",
        }
    }
}
