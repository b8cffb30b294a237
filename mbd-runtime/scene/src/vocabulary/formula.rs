//! Formulas: the expressions a declaration writes for a mass, a load, an output or an event.
//!
//! A formula is checked for shape and dimension when it is read; here it holds plain SI numbers and indices into the [`Scene`](crate::Scene).

use serde::{Deserialize, Serialize};

/// A place on a body, on the world or at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Place {
    /// A frame of the world: index into `Scene::world_frames`.
    World(usize),
    /// The origin of a body's frame: body index, frame index. Frame 0 of every body is `com`.
    Body(usize, usize),
    /// A point: index into `Scene::points`.
    Point(usize),
}

/// A function of a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Function {
    /// a + b, of two scalars or two vectors.
    Add,
    /// a − b, of two scalars or two vectors.
    Sub,
    /// a · b, scalar times scalar, or scalar times vector in either order.
    Mul,
    /// a / b, b a scalar.
    Div,
    /// −a.
    Neg,
    /// a to the power n; the second argument is a whole [`Formula::Number`].
    Power,
    /// √(a·a) of a vector.
    Norm,
    /// a·b of two vectors.
    Dot,
    /// a × b.
    Cross,
    /// The smaller of two scalars.
    Min,
    /// The larger of two scalars.
    Max,
    /// |a| of a scalar.
    Abs,
    /// e to the power a; a has no dimension.
    Exp,
    /// √a of a scalar ≥ 0.
    Sqrt,
    /// Sine of an angle.
    Sin,
    /// Cosine of an angle.
    Cos,
    /// The angle between two vectors [rad], 0 … π.
    Angle,
    /// The angle of the vector (b, a) of two scalars [rad], in (−π, π].
    Atan2,
    /// Hyperbolic tangent of a number.
    Tanh,
    /// The natural logarithm of a number > 0.
    Ln,
    /// The largest whole number that is not above a.
    Floor,
    /// c where a < b, d elsewhere; c and d of one shape.
    IfLess,
    /// c where a ≤ b, d elsewhere; c and d of one shape.
    IfAtMost,
}

impl Function {
    /// How it is called in a declaration; empty for an operator, and for a choice.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Function::Norm => "norm",
            Function::Dot => "dot",
            Function::Cross => "cross",
            Function::Min => "min",
            Function::Max => "max",
            Function::Abs => "abs",
            Function::Exp => "exp",
            Function::Sqrt => "sqrt",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Angle => "angle",
            Function::Atan2 => "atan2",
            Function::Tanh => "tanh",
            Function::Ln => "ln",
            Function::Floor => "floor",
            Function::Add | Function::Sub | Function::Mul | Function::Div => "",
            Function::Neg | Function::Power | Function::IfLess | Function::IfAtMost => "",
        }
    }
}

/// Energies of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum EnergyKind {
    /// Of motion.
    Kinetic,
    /// Of gravity, lines, springs and stops.
    Potential,
    /// Both.
    Total,
}

impl EnergyKind {
    /// Every energy.
    pub const ALL: [EnergyKind; 3] = [
        EnergyKind::Kinetic,
        EnergyKind::Potential,
        EnergyKind::Total,
    ];

    /// How it is called in a declaration, behind `energy.`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            EnergyKind::Kinetic => "kinetic",
            EnergyKind::Potential => "potential",
            EnergyKind::Total => "total",
        }
    }
}

/// An expression over the scene, in SI units, world axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Formula {
    /// A number.
    Number(f64),
    /// A declared `const`: index into `Scene::consts`. Folds into generated code.
    Const(usize),
    /// A declared `param`: index into `Scene::params`. Stays a live field.
    Param(usize),
    /// A declared `input`: index into `Scene::inputs`.
    Input(usize),
    /// A declared `state`: index into `Scene::states`.
    State(usize),
    /// Time [s].
    Time,
    /// Position of a place from the world origin [m].
    Position(Place),
    /// Velocity of a place [m/s].
    Velocity(Place),
    /// Unit vector along axis 0, 1 or 2 of a frame (rotation of the frame included; the axes of the world for a world frame).
    Axis(Place, usize),
    /// Angular velocity of a body [rad/s], in world axes.
    AngularVelocityWorld(usize),
    /// Angular velocity of a body [rad/s], in its own axes.
    AngularVelocityBody(usize),
    /// The rotation of a body from the axes of the world as a vector: the axis times the angle [rad], up to half a turn; in a plane the normal
    /// times the angle of the state, which counts turns.
    Orientation(usize),
    /// An energy of the whole scene [J]. It holds what every line and joint stores, so that no force may contain it.
    Energy(EnergyKind),
    /// Tension of a line [N], ≥ 0 for a `line`, either sign for a `spring`.
    Tension(usize),
    /// Length of a line, from end to end [m].
    Length(usize),
    /// Length minus free length of a line [m].
    Stretch(usize),
    /// Rate of the stretch of a line [m/s]: of its length, less that of its free length where it is wound.
    StretchRate(usize),
    /// A coordinate of a joint [m or rad]: joint, number of the coordinate.
    Coordinate(usize, usize),
    /// The rate of a coordinate of a joint [m/s or rad/s]: joint, number of the coordinate.
    CoordinateRate(usize, usize),
    /// The force or torque of a motor along a coordinate of a joint [N or N m]: joint, number of the coordinate. It follows from the
    /// accelerations, so that nothing they depend on may contain it.
    MotorEffort(usize, usize),
    /// The rate of the velocity of a place [m/s²], world axes: what a body at rest in free fall has is g. As [`Formula::MotorEffort`].
    Acceleration(Place),
    /// The rate of the angular velocity of a body [rad/s²], world axes. As [`Formula::MotorEffort`].
    AngularAcceleration(usize),
    /// The second rate of a coordinate of a joint [m/s² or rad/s²]: joint, number of the coordinate. As [`Formula::MotorEffort`].
    CoordinateAcceleration(usize, usize),
    /// The force of a joint on its child [N], world axes. As [`Formula::MotorEffort`].
    ReactionForce(usize),
    /// The torque of a joint on its child about the origin of frame 2 [N m], world axes. As [`Formula::MotorEffort`].
    ReactionTorque(usize),
    /// A vector of three scalars.
    Vector(Vec<Formula>),
    /// Component 0, 1 or 2 of a vector; the list holds the one vector.
    Component(Vec<Formula>, usize),
    /// A function of its arguments.
    Apply(Function, Vec<Formula>),
    /// A declared `let`: index into `Scene::lets`.
    Let(usize),
    /// A table: index into `Scene::tables`; the list holds its arguments, one or two.
    Lookup(usize, Vec<Formula>),
}

impl Formula {
    /// Calls `visit` on this formula and on everything in it; of a `let` on its name alone
    /// ([`Scene::walk`](crate::Scene::walk) goes into it).
    pub fn walk(&self, visit: &mut impl FnMut(&Formula)) {
        visit(self);
        match self {
            Formula::Vector(parts)
            | Formula::Apply(_, parts)
            | Formula::Component(parts, _)
            | Formula::Lookup(_, parts) => {
                parts.iter().for_each(|part| part.walk(visit));
            }
            _ => {}
        }
    }
}

/// One number or a vector of three, known before a run [SI].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fixed {
    /// One number.
    Scalar(f64),
    /// Three numbers, world components.
    Vector([f64; 3]),
}

impl Fixed {
    /// The number, if it is one.
    #[must_use]
    pub fn scalar(self) -> Option<f64> {
        match self {
            Fixed::Scalar(value) => Some(value),
            Fixed::Vector(_) => None,
        }
    }

    /// The vector, if it is one.
    #[must_use]
    pub fn vector(self) -> Option<[f64; 3]> {
        match self {
            Fixed::Vector(value) => Some(value),
            Fixed::Scalar(_) => None,
        }
    }

    /// As a formula of numbers.
    #[must_use]
    pub fn formula(self) -> Formula {
        match self {
            Fixed::Scalar(value) => Formula::Number(value),
            Fixed::Vector(parts) => Formula::Vector(parts.map(Formula::Number).to_vec()),
        }
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        match self {
            Fixed::Scalar(value) => value.is_finite(),
            Fixed::Vector(parts) => parts.iter().all(|part| part.is_finite()),
        }
    }
}

impl From<f64> for Formula {
    fn from(value: f64) -> Self {
        Formula::Number(value)
    }
}
