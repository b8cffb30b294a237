//! Formulas as text, in bare SI numbers, with the names of the scene.

use mbd_scene::{Formula, Function, Place, Scene};

use crate::describe::{coordinate, motor_effort};

/// How tightly an expression binds: sums 1, products 2, signs 3, powers 4, names and calls 5.
type Rank = u8;

/// A formula in the language of `model!` under `units: si`.
pub fn text(formula: &Formula, scene: &Scene) -> String {
    ranked(formula, scene).0
}

/// Three formulas as a vector.
pub fn vector(parts: &[Formula], scene: &Scene) -> String {
    let parts: Vec<String> = parts.iter().map(|part| text(part, scene)).collect();
    format!("[{}]", parts.join(", "))
}

/// A place: `capsule.bridle[0]`, `world`, `knot`.
pub fn place(place: Place, scene: &Scene) -> String {
    match place {
        Place::World(0) => "world".to_string(),
        Place::World(frame) => {
            let frame = scene.world_frames.get(frame);
            format!("world.{}", frame.map_or("", |frame| &frame.name))
        }
        Place::Body(body, frame) => {
            let body = scene.bodies.get(body);
            let frame = body.and_then(|body| body.frames.get(frame));
            format!(
                "{}.{}",
                body.map_or("", |body| &body.name),
                frame.map_or("", |frame| &frame.name)
            )
        }
        Place::Point(point) => scene
            .points
            .get(point)
            .map(|point| point.name.clone())
            .unwrap_or_default(),
    }
}

/// A number that reads back as itself.
pub fn number(value: f64) -> String {
    format!("{value:?}")
}

fn ranked(formula: &Formula, scene: &Scene) -> (String, Rank) {
    let name = |name: Option<&String>| (name.cloned().unwrap_or_default(), 5);
    match formula {
        Formula::Number(value) if value.is_sign_negative() => (number(*value), 3),
        Formula::Number(value) => (number(*value), 5),
        Formula::Const(i) => name(scene.consts.get(*i).map(|c| &c.name)),
        Formula::Param(i) => name(scene.params.get(*i).map(|p| &p.name)),
        Formula::Input(i) => name(scene.inputs.get(*i).map(|i| &i.name)),
        Formula::Let(i) => name(scene.lets.get(*i).map(|l| &l.name)),
        Formula::State(i) => name(scene.states.get(*i).map(|s| &s.name)),
        Formula::Time => ("time".to_string(), 5),
        Formula::Position(at) => (format!("{}.position", owner(*at, scene)), 5),
        Formula::Velocity(at) => (format!("{}.velocity", owner(*at, scene)), 5),
        Formula::Axis(at, axis) => (format!("{}.{}", owner(*at, scene), letter(*axis)), 5),
        Formula::AngularVelocityWorld(body) => {
            let owner = owner(Place::Body(*body, 0), scene);
            (format!("{owner}.omega_world"), 5)
        }
        Formula::AngularVelocityBody(body) => {
            let owner = owner(Place::Body(*body, 0), scene);
            (format!("{owner}.omega_body"), 5)
        }
        Formula::Orientation(body) => {
            let owner = owner(Place::Body(*body, 0), scene);
            (format!("{owner}.orientation"), 5)
        }
        Formula::Energy(energy) => (format!("energy.{}", energy.word()), 5),
        Formula::Tension(line) => (of_line(*line, "tension", scene), 5),
        Formula::Length(line) => (of_line(*line, "length", scene), 5),
        Formula::Stretch(line) => (of_line(*line, "stretch", scene), 5),
        Formula::StretchRate(line) => (of_line(*line, "stretch_rate", scene), 5),
        Formula::Coordinate(joint, index) => (coordinate(scene, *joint, *index, |c| c.name), 5),
        Formula::CoordinateRate(joint, index) => (coordinate(scene, *joint, *index, |c| c.rate), 5),
        Formula::MotorEffort(joint, index) => (motor_effort(scene, *joint, *index), 5),
        Formula::Acceleration(at) => (format!("{}.acceleration", owner(*at, scene)), 5),
        Formula::AngularAcceleration(body) => {
            let owner = owner(Place::Body(*body, 0), scene);
            (format!("{owner}.angular_acceleration"), 5)
        }
        Formula::CoordinateAcceleration(joint, index) => {
            let name = coordinate(scene, *joint, *index, |c| c.name);
            (format!("{name}_acceleration"), 5)
        }
        Formula::ReactionForce(joint) => (of_joint(*joint, "force", scene), 5),
        Formula::ReactionTorque(joint) => (of_joint(*joint, "torque", scene), 5),
        Formula::Vector(parts) => (vector(parts, scene), 5),
        Formula::Component(of, axis) => {
            let inner = of.first().map(|of| at_least(of, 5, scene));
            (
                format!("{}.{}", inner.unwrap_or_default(), letter(*axis)),
                5,
            )
        }
        Formula::Lookup(table, of) => {
            let table = scene.tables.get(*table).map_or("", |table| &table.name);
            (call(table, of, scene), 5)
        }
        Formula::Apply(function, of) => applied(*function, of, scene),
    }
}

fn applied(function: Function, of: &[Formula], scene: &Scene) -> (String, Rank) {
    let two = |sign: &str, left: Rank, right: Rank| match of {
        [a, b] => format!(
            "{}{sign}{}",
            at_least(a, left, scene),
            at_least(b, right, scene)
        ),
        _ => String::new(),
    };
    match function {
        Function::Add => (two(" + ", 1, 2), 1),
        Function::Sub => (two(" - ", 1, 2), 1),
        Function::Mul => (two(" * ", 2, 3), 2),
        Function::Div => (two(" / ", 2, 3), 2),
        Function::Power => (two("^", 5, 3), 4),
        Function::Neg => {
            let inner = of.first().map(|of| at_least(of, 3, scene));
            (format!("-{}", inner.unwrap_or_default()), 3)
        }
        Function::IfLess => (choice("<", of, scene), 5),
        Function::IfAtMost => (choice("<=", of, scene), 5),
        function => (call(function.word(), of, scene), 5),
    }
}

fn choice(sign: &str, of: &[Formula], scene: &Scene) -> String {
    let parts: Vec<String> = of.iter().map(|part| text(part, scene)).collect();
    match parts.as_slice() {
        [a, b, c, d] => format!("if({a} {sign} {b}, {c}, {d})"),
        _ => String::new(),
    }
}

fn call(function: &str, of: &[Formula], scene: &Scene) -> String {
    let arguments: Vec<String> = of.iter().map(|argument| text(argument, scene)).collect();
    format!("{function}({})", arguments.join(", "))
}

/// In brackets if it binds less tightly.
fn at_least(formula: &Formula, rank: Rank, scene: &Scene) -> String {
    let (text, found) = ranked(formula, scene);
    if found < rank {
        format!("({text})")
    } else {
        text
    }
}

/// A place as the owner of a quantity: the centre of mass is the body itself.
fn owner(at: Place, scene: &Scene) -> String {
    match at {
        Place::Body(body, 0) => scene
            .bodies
            .get(body)
            .map(|body| body.name.clone())
            .unwrap_or_default(),
        at => place(at, scene),
    }
}

fn of_line(line: usize, quantity: &str, scene: &Scene) -> String {
    let name = scene.lines.get(line).map_or("", |line| &line.name);
    format!("{name}.{quantity}")
}

fn of_joint(joint: usize, quantity: &str, scene: &Scene) -> String {
    let name = scene.joints.get(joint).map_or("", |joint| &joint.name);
    format!("{name}.{quantity}")
}

fn letter(axis: usize) -> char {
    match axis {
        0 => 'x',
        1 => 'y',
        _ => 'z',
    }
}
