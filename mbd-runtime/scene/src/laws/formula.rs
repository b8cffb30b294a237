//! Formulas, evaluated: the expressions of a declaration on any scalar.

use nalgebra::Vector3;

use crate::{EnergyKind, Fixed, Formula, Function, Place, Real, Scene, Triple};

/// What the leaves of a formula are worth. Whatever a context does not know is NaN; the reader of a declaration has refused it before.
pub trait Context<S: Real> {
    /// The declaration.
    fn scene(&self) -> &Scene;
    /// A live parameter.
    fn param(&self, index: usize) -> Option<S>;
    /// The value of a `let`: [`of_let`], or that kept from before.
    fn named(&self, index: usize) -> Option<Value<S>>;
    /// Components of a declared input.
    fn input(&self, _index: usize) -> Option<Value<S>> {
        None
    }
    /// A declared state.
    fn state(&self, _index: usize) -> Option<S> {
        None
    }
    /// Time [s].
    fn time(&self) -> Option<S> {
        None
    }
    /// What the difference of two formulas is where it has more digits than they have.
    fn apart(&self, _formulas: [&Formula; 2]) -> Option<Value<S>> {
        None
    }
    /// Position of a place [m].
    fn position(&self, _place: Place) -> Option<Vector3<S>> {
        None
    }
    /// Velocity of a place [m/s].
    fn velocity(&self, _place: Place) -> Option<Vector3<S>> {
        None
    }
    /// Unit vector along an axis of a frame, world components.
    fn axis(&self, _place: Place, _axis: usize) -> Option<Vector3<S>> {
        None
    }
    /// Angular velocity of a body in world axes [rad/s].
    fn omega_world(&self, _body: usize) -> Option<Vector3<S>> {
        None
    }
    /// Angular velocity of a body in body axes [rad/s].
    fn omega_body(&self, _body: usize) -> Option<Vector3<S>> {
        None
    }
    /// The rotation of a body as a vector, world axes [rad].
    fn orientation(&self, _body: usize) -> Option<Vector3<S>> {
        None
    }
    /// Kinetic and potential energy of the scene [J].
    fn energies(&self) -> Option<[S; 2]> {
        None
    }
    /// A coordinate of a joint [m or rad].
    fn coordinate(&self, _joint: usize, _index: usize) -> Option<S> {
        None
    }
    /// The rate of a coordinate of a joint [m/s or rad/s].
    fn coordinate_rate(&self, _joint: usize, _index: usize) -> Option<S> {
        None
    }
    /// The force or torque of a motor along a coordinate of a joint [N or N m].
    fn motor_effort(&self, _joint: usize, _index: usize) -> Option<S> {
        None
    }
    /// Rate of the velocity of a place [m/s²].
    fn acceleration(&self, _place: Place) -> Option<Vector3<S>> {
        None
    }
    /// Rate of the angular velocity of a body in world axes [rad/s²].
    fn angular_acceleration(&self, _body: usize) -> Option<Vector3<S>> {
        None
    }
    /// The second rate of a coordinate of a joint [m/s² or rad/s²].
    fn coordinate_acceleration(&self, _joint: usize, _index: usize) -> Option<S> {
        None
    }
    /// Force [N] and torque [N m] of a joint on its child, world axes.
    fn reaction(&self, _joint: usize) -> Option<[Vector3<S>; 2]> {
        None
    }
    /// Length and stretch of a line [m]. They ask for no rate, so that the rate of the state that winds a damped line may follow them.
    fn line_length(&self, _line: usize) -> Option<[S; 2]> {
        None
    }
    /// Tension [N], length [m], stretch [m] and rate of the length [m/s] of a line.
    fn line(&self, _line: usize) -> Option<[S; 4]> {
        None
    }
    /// Rate of the free length of a line that is wound [m/s].
    fn winding(&self, _line: usize) -> Option<S> {
        None
    }
    /// Rate of the stretch of a line, ḋ − L̇0 [m/s].
    fn stretch_rate(&self, line: usize) -> Option<S> {
        let [_, _, _, rate] = self.line(line)?;
        Some(match self.winding(line) {
            Some(winding) => rate - winding,
            None => rate,
        })
    }
}

/// A scalar or a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<S> {
    /// A scalar.
    Scalar(S),
    /// A vector, world components.
    Vector(Vector3<S>),
}

use Value::{Scalar, Vector};

impl<S: Real> Value<S> {
    fn unknown() -> Self {
        Scalar(S::from_f64(f64::NAN))
    }

    fn map(self, f: impl Fn(S) -> S) -> Self {
        match self {
            Scalar(a) => Scalar(f(a)),
            Vector(a) => Vector(a.map(f)),
        }
    }
}

/// The value of a formula that was checked to be a scalar.
pub fn scalar<S: Real>(formula: &Formula, context: &dyn Context<S>) -> S {
    match value(formula, context) {
        Scalar(a) => a,
        Vector(_) => S::from_f64(f64::NAN),
    }
}

/// The value of a formula that was checked to be a vector.
pub fn vector<S: Real>(formula: &Formula, context: &dyn Context<S>) -> Vector3<S> {
    match value(formula, context) {
        Vector(a) => a,
        Scalar(_) => Vector3::repeat(S::from_f64(f64::NAN)),
    }
}

/// Three scalar formulas as a vector.
pub fn triple<S: Real>(formulas: &Triple, context: &dyn Context<S>) -> Vector3<S> {
    let [x, y, z] = formulas.each_ref().map(|formula| scalar(formula, context));
    Vector3::new(x, y, z)
}

/// The value of a formula.
pub fn value<S: Real>(formula: &Formula, context: &dyn Context<S>) -> Value<S> {
    let known = match formula {
        Formula::Number(x) => Some(Scalar(S::from_f64(*x))),
        Formula::Const(i) => context.scene().consts.get(*i).map(|c| constant(c.value)),
        Formula::Let(i) => context.named(*i),
        Formula::Param(i) => context.param(*i).map(Scalar),
        Formula::Input(i) => context.input(*i),
        Formula::State(i) => context.state(*i).map(Scalar),
        Formula::Time => context.time().map(Scalar),
        Formula::Position(place) => context.position(*place).map(Vector),
        Formula::Velocity(place) => context.velocity(*place).map(Vector),
        Formula::Axis(place, axis) => context.axis(*place, *axis).map(Vector),
        Formula::AngularVelocityWorld(body) => context.omega_world(*body).map(Vector),
        Formula::AngularVelocityBody(body) => context.omega_body(*body).map(Vector),
        Formula::Orientation(body) => context.orientation(*body).map(Vector),
        Formula::Energy(energy) => context.energies().map(|[kinetic, potential]| {
            Scalar(match energy {
                EnergyKind::Kinetic => kinetic,
                EnergyKind::Potential => potential,
                EnergyKind::Total => kinetic + potential,
            })
        }),
        Formula::MotorEffort(joint, index) => context.motor_effort(*joint, *index).map(Scalar),
        Formula::Acceleration(place) => context.acceleration(*place).map(Vector),
        Formula::AngularAcceleration(body) => context.angular_acceleration(*body).map(Vector),
        Formula::CoordinateAcceleration(joint, index) => {
            let rate = context.coordinate_acceleration(*joint, *index);
            rate.map(Scalar)
        }
        Formula::ReactionForce(joint) => context.reaction(*joint).map(|[force, _]| Vector(force)),
        Formula::ReactionTorque(joint) => {
            let reaction = context.reaction(*joint);
            reaction.map(|[_, torque]| Vector(torque))
        }
        Formula::Tension(i) => context.line(*i).map(|[tension, ..]| Scalar(tension)),
        Formula::Length(i) => context.line_length(*i).map(|[length, _]| Scalar(length)),
        Formula::Stretch(i) => context.line_length(*i).map(|[_, stretch]| Scalar(stretch)),
        Formula::StretchRate(i) => context.stretch_rate(*i).map(Scalar),
        Formula::Coordinate(joint, index) => context.coordinate(*joint, *index).map(Scalar),
        Formula::CoordinateRate(joint, index) => {
            context.coordinate_rate(*joint, *index).map(Scalar)
        }
        Formula::Vector(parts) => match parts.as_slice() {
            [x, y, z] => Some(Vector(Vector3::new(
                scalar(x, context),
                scalar(y, context),
                scalar(z, context),
            ))),
            _ => None,
        },
        Formula::Component(of, axis) => match (of.first().map(|of| value(of, context)), axis) {
            (Some(Vector(a)), 0..3) => Some(Scalar(a[*axis])),
            _ => None,
        },
        Formula::Apply(function, arguments) => match arguments.as_slice() {
            [a] => unary(*function, value(a, context)),
            [a, Formula::Number(n)] if *function == Function::Power => power(value(a, context), *n),
            [a, b] => match (function, context.apart([a, b])) {
                (Function::Sub, Some(apart)) => Some(apart),
                _ => binary(*function, value(a, context), value(b, context)),
            },
            [a, b, c, d] => {
                let compared = [a, b].map(|side| scalar(side, context));
                choice(*function, compared, value(c, context), value(d, context))
            }
            _ => None,
        },
        Formula::Lookup(table, arguments) => {
            match (context.scene().tables.get(*table), arguments.as_slice()) {
                (Some(table), [x]) => Some(Scalar(table.at(&[scalar(x, context)]))),
                (Some(table), [x, z]) => {
                    let at = [scalar(x, context), scalar(z, context)];
                    Some(Scalar(table.at(&at)))
                }
                _ => None,
            }
        }
    };
    known.unwrap_or_else(Value::unknown)
}

/// The value of a `let`, worked out.
pub fn of_let<S: Real>(index: usize, context: &dyn Context<S>) -> Option<Value<S>> {
    let declared = context.scene().lets.get(index)?;
    Some(value(&declared.value, context))
}

fn constant<S: Real>(value: Fixed) -> Value<S> {
    match value {
        Fixed::Scalar(a) => Scalar(S::from_f64(a)),
        Fixed::Vector(parts) => Vector(Vector3::from(parts.map(S::from_f64))),
    }
}

fn unary<S: Real>(function: Function, a: Value<S>) -> Option<Value<S>> {
    Some(match (function, a) {
        (Function::Neg, a) => a.map(|x| -x),
        (Function::Norm, Vector(a)) => Scalar(norm(&a)),
        (Function::Abs, Scalar(a)) => Scalar(a.abs()),
        (Function::Exp, Scalar(a)) => Scalar(a.exp()),
        (Function::Sqrt, Scalar(a)) => Scalar(a.sqrt()),
        (Function::Sin, Scalar(a)) => Scalar(a.sin_cos().0),
        (Function::Cos, Scalar(a)) => Scalar(a.sin_cos().1),
        (Function::Tanh, Scalar(a)) => Scalar(a.tanh()),
        (Function::Ln, Scalar(a)) => Scalar(a.ln()),
        (Function::Floor, Scalar(a)) => Scalar(a.floor()),
        _ => return None,
    })
}

fn binary<S: Real>(function: Function, a: Value<S>, b: Value<S>) -> Option<Value<S>> {
    Some(match (function, a, b) {
        (Function::Add, Scalar(a), Scalar(b)) => Scalar(a + b),
        (Function::Add, Vector(a), Vector(b)) => Vector(a + b),
        (Function::Sub, Scalar(a), Scalar(b)) => Scalar(a - b),
        (Function::Sub, Vector(a), Vector(b)) => Vector(a - b),
        (Function::Mul, Scalar(a), Scalar(b)) => Scalar(a * b),
        (Function::Mul, Scalar(a), Vector(b)) | (Function::Mul, Vector(b), Scalar(a)) => {
            Vector(b.map(|x| a * x))
        }
        (Function::Div, a, Scalar(b)) => a.map(|x| x / b),
        (Function::Dot, Vector(a), Vector(b)) => Scalar(a.dot(&b)),
        (Function::Cross, Vector(a), Vector(b)) => Vector(a.cross(&b)),
        (Function::Min, Scalar(a), Scalar(b)) => Scalar(smaller(a, b)),
        (Function::Max, Scalar(a), Scalar(b)) => Scalar(larger(a, b)),
        (Function::Atan2, Scalar(a), Scalar(b)) => Scalar(a.atan2(b)),
        (Function::Angle, Vector(a), Vector(b)) => Scalar(norm(&a.cross(&b)).atan2(a.dot(&b))),
        _ => return None,
    })
}

/// The smaller of two; no number where one of them is none. At equality it is `a`.
fn smaller<S: Real>(a: S, b: S) -> S {
    if b.is_always_a_number() {
        return a.min(b);
    }
    if a.is_always_a_number() {
        return S::select(a.le(b), a, b);
    }
    S::select(b.lt(a), b, unless_unordered([a, b], a))
}

/// The larger of two; no number where one of them is none. At equality it is `a`.
fn larger<S: Real>(a: S, b: S) -> S {
    if b.is_always_a_number() {
        return a.max(b);
    }
    if a.is_always_a_number() {
        return S::select(b.le(a), a, b);
    }
    S::select(a.lt(b), b, unless_unordered([b, a], a))
}

/// `value` where the first is at most the second, no number where they cannot be compared.
fn unless_unordered<S: Real>([a, b]: [S; 2], value: S) -> S {
    S::select(a.le(b), value, a + b)
}

/// One of two values of the same shape by what is compared; no number where that is none.
fn choice<S: Real>(
    function: Function,
    [a, b]: [S; 2],
    then: Value<S>,
    otherwise: Value<S>,
) -> Option<Value<S>> {
    let always = [a, b].iter().all(|side| side.is_always_a_number());
    let (holds, fails) = match function {
        Function::IfLess => (a.lt(b), b.le(a)),
        _ => (a.le(b), b.lt(a)),
    };
    let pick = |then: S, otherwise: S| {
        let otherwise = match always {
            true => otherwise,
            false => S::select(fails, otherwise, a + b),
        };
        S::select(holds, then, otherwise)
    };
    match (then, otherwise) {
        (Scalar(a), Scalar(b)) => Some(Scalar(pick(a, b))),
        (Vector(a), Vector(b)) => Some(Vector(a.zip_map(&b, pick))),
        _ => None,
    }
}

/// √(a·a); its derivative at zero is zero by the rule of [`Real::sqrt`].
pub fn norm<S: Real>(a: &Vector3<S>) -> S {
    a.dot(a).sqrt()
}

/// a to a whole power, by squaring.
fn power<S: Real>(a: Value<S>, exponent: f64) -> Option<Value<S>> {
    let Scalar(a) = a else { return None };
    if exponent.fract() != 0.0 || exponent.abs() > 64.0 {
        return None;
    }
    let mut left = exponent.abs() as u32;
    let (mut result, mut square) = (S::one(), a);
    while left > 0 {
        if left % 2 == 1 {
            result *= square;
        }
        left /= 2;
        if left > 0 {
            square = square * square;
        }
    }
    Some(Scalar(if exponent < 0.0 {
        S::one() / result
    } else {
        result
    }))
}
