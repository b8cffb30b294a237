//! Formulas as the user would write them, and formulas changed all over a scene.

use mbd_scene::joints::{Coordinate, FILTER, FORCE, JointForces, MOTOR, NUMBERS, STOPS};
use mbd_scene::metrics::{Metric, Take};
use mbd_scene::{
    Formula, Function, Gravity, LoadKind, MapSource, Part, Place, PointKind, Scene, Triple,
};

/// The name of a body, a point or a joint.
#[must_use]
pub fn part(scene: &Scene, part: Part) -> &str {
    match part {
        Part::Body(body) => scene.bodies.get(body).map_or("", |body| &body.name),
        Part::Point(point) => scene.points.get(point).map_or("", |point| &point.name),
        Part::Joint(joint) | Part::Coordinates(joint) => {
            scene.joints.get(joint).map_or("", |joint| &joint.name)
        }
    }
}

/// A place by its name, `capsule.bridle[0]`.
#[must_use]
pub fn place(scene: &Scene, place: Place) -> String {
    let unknown = || "?".to_owned();
    match place {
        Place::World(0) => "world".to_owned(),
        Place::World(frame) => scene
            .world_frames
            .get(frame)
            .map_or_else(unknown, |f| format!("world.{}", f.name)),
        Place::Body(body, frame) => scene.bodies.get(body).map_or_else(unknown, |b| {
            b.frames
                .get(frame)
                .map_or_else(unknown, |f| format!("{}.{}", b.name, f.name))
        }),
        Place::Point(point) => scene
            .points
            .get(point)
            .map_or_else(unknown, |p| p.name.clone()),
    }
}

/// A vector of three formulas.
#[must_use]
pub fn triple(scene: &Scene, parts: &Triple) -> String {
    let parts = parts.each_ref().map(|part| text(scene, part));
    format!("[{}]", parts.join(", "))
}

/// A formula in the user's names.
#[must_use]
pub fn text(scene: &Scene, formula: &Formula) -> String {
    write(scene, formula, 0)
}

/// What a metric takes, in the user's words: `max bob.position.z in mm, from 1 s`. Scenes whose metrics of one name say this alike mean the same by it.
#[must_use]
pub fn metric_text(scene: &Scene, metric: &Metric) -> String {
    let output = metric.output.and_then(|output| scene.outputs.get(output));
    let event = metric.event.and_then(|event| scene.events.get(event));
    let event = event.map(|event| event.name.as_str());
    let mut told = match output {
        Some(output) => format!("{} {}", metric.take.keyword(), text(scene, &output.value)),
        None => format!("{} {}", metric.take.keyword(), event.unwrap_or_default()),
    };
    if let Some(output) = output.filter(|output| !output.unit.text.is_empty()) {
        told += &format!(" in {}", output.unit.text);
    }
    if let Some((level, output)) = metric.level.zip(output) {
        let level = level / output.unit.factor;
        told += format!(", level {level} {}", output.unit.text).trim_end();
    }
    if let Some(event) = event.filter(|_| metric.take == Take::Value) {
        told += &format!(", at {event}");
    }
    for (word, time) in [("from", metric.from), ("to", metric.to)] {
        if let Some(time) = time {
            told += &format!(", {word} {time} s");
        }
    }
    told
}

/// `level` is the binding strength around: 0 none, 1 sum, 2 product, 3 power.
fn write(scene: &Scene, formula: &Formula, level: u8) -> String {
    let named = |name: Option<&String>| name.cloned().unwrap_or_else(|| "?".to_owned());
    let body = |index: usize| named(scene.bodies.get(index).map(|b| &b.name));
    let line = |index: usize| named(scene.lines.get(index).map(|l| &l.name));
    let joint_name = |index: usize| named(scene.joints.get(index).map(|j| &j.name));
    match formula {
        Formula::Number(value) => format!("{value}"),
        Formula::Const(index) => named(scene.consts.get(*index).map(|c| &c.name)),
        Formula::Param(index) => named(scene.params.get(*index).map(|p| &p.name)),
        Formula::Input(index) => named(scene.inputs.get(*index).map(|i| &i.name)),
        Formula::Let(index) => named(scene.lets.get(*index).map(|l| &l.name)),
        Formula::State(index) => named(scene.states.get(*index).map(|s| &s.name)),
        Formula::Time => "time".to_owned(),
        Formula::Position(at) => format!("{}.position", place(scene, *at)),
        Formula::Velocity(at) => format!("{}.velocity", place(scene, *at)),
        Formula::Axis(at, axis) => {
            format!(
                "{}.{}",
                place(scene, *at),
                ["x", "y", "z"].get(*axis).unwrap_or(&"?")
            )
        }
        Formula::AngularVelocityWorld(index) => format!("{}.omega_world", body(*index)),
        Formula::AngularVelocityBody(index) => format!("{}.omega_body", body(*index)),
        Formula::Orientation(index) => format!("{}.orientation", body(*index)),
        Formula::Energy(energy) => format!("energy.{}", energy.word()),
        Formula::Tension(index) => format!("{}.tension", line(*index)),
        Formula::Length(index) => format!("{}.length", line(*index)),
        Formula::Stretch(index) => format!("{}.stretch", line(*index)),
        Formula::StretchRate(index) => format!("{}.stretch_rate", line(*index)),
        Formula::Coordinate(joint, index) => coordinate(scene, *joint, *index, |c| c.name),
        Formula::CoordinateRate(joint, index) => coordinate(scene, *joint, *index, |c| c.rate),
        Formula::MotorEffort(joint, index) => motor_effort(scene, *joint, *index),
        Formula::Acceleration(at) => format!("{}.acceleration", place(scene, *at)),
        Formula::AngularAcceleration(index) => format!("{}.angular_acceleration", body(*index)),
        Formula::CoordinateAcceleration(joint, index) => {
            let name = coordinate(scene, *joint, *index, |c| c.name);
            format!("{name}_acceleration")
        }
        Formula::ReactionForce(index) => format!("{}.force", joint_name(*index)),
        Formula::ReactionTorque(index) => format!("{}.torque", joint_name(*index)),
        Formula::Vector(parts) => format!("[{}]", list(scene, parts)),
        Formula::Component(parts, axis) => {
            let inner = parts
                .first()
                .map_or_else(String::new, |part| write(scene, part, 4));
            format!("{inner}.{}", ["x", "y", "z"].get(*axis).unwrap_or(&"?"))
        }
        Formula::Lookup(table, parts) => {
            let name = named(scene.tables.get(*table).map(|t| &t.name));
            format!("{name}({})", list(scene, parts))
        }
        Formula::Apply(function, parts) => apply(scene, *function, parts, level),
    }
}

/// The force or torque of a motor, `crank.motor_torque`.
pub fn motor_effort(scene: &Scene, joint: usize, index: usize) -> String {
    let found = scene.coordinate(joint, index);
    found.map_or_else(
        || "?".to_owned(),
        |(joint, coordinate)| format!("{}.{}", joint.name, joint.law.motor_word(&coordinate)),
    )
}

/// A joint coordinate or its rate, `elbow.angle`.
pub fn coordinate(
    scene: &Scene,
    joint: usize,
    index: usize,
    word: impl Fn(Coordinate) -> &'static str,
) -> String {
    let found = scene.coordinate(joint, index);
    found.map_or_else(
        || "?".to_owned(),
        |(joint, coordinate)| format!("{}.{}", joint.name, word(coordinate)),
    )
}

fn list(scene: &Scene, parts: &[Formula]) -> String {
    parts
        .iter()
        .map(|part| text(scene, part))
        .collect::<Vec<_>>()
        .join(", ")
}

fn apply(scene: &Scene, function: Function, parts: &[Formula], level: u8) -> String {
    let binary = |sign: &str, strength: u8| {
        let left = parts
            .first()
            .map_or_else(String::new, |a| write(scene, a, strength));
        let right = parts
            .get(1)
            .map_or_else(String::new, |b| write(scene, b, strength + 1));
        let text = format!("{left}{sign}{right}");
        if level > strength {
            format!("({text})")
        } else {
            text
        }
    };
    let name = match function {
        Function::Add => return binary(" + ", 1),
        Function::Sub => return binary(" - ", 1),
        Function::Mul => return binary(" * ", 2),
        Function::Div => return binary(" / ", 2),
        Function::Power => return binary("^", 3),
        Function::Neg => {
            let inner = parts
                .first()
                .map_or_else(String::new, |a| write(scene, a, 3));
            return if level > 1 {
                format!("(-{inner})")
            } else {
                format!("-{inner}")
            };
        }
        Function::IfLess | Function::IfAtMost => {
            let sign = if function == Function::IfLess {
                "<"
            } else {
                "≤"
            };
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| {
                parts
                    .get(k)
                    .map_or_else(String::new, |part| text(scene, part))
            });
            return format!("if({a} {sign} {b}, {c}, {d})");
        }
        function => function.word(),
    };
    format!("{name}({})", list(scene, parts))
}

/// What acts along one coordinate of a joint, in the user's names.
#[must_use]
pub fn forces(scene: &Scene, coordinate: &Coordinate, forces: &JointForces) -> String {
    let mut parts = Vec::new();
    let given = |index: usize| {
        let (field, formula) = (NUMBERS.get(index)?, forces.numbers()[index].as_ref()?);
        let unit = field.measured.unit(coordinate);
        Some(format!("{} = {} {unit}", field.name, text(scene, formula)))
    };
    parts.extend((0..NUMBERS.len()).filter_map(given));
    if forces.stops.iter().any(Option::is_some) {
        let place = |stop: &Option<Formula>| {
            let stop = stop.as_ref();
            stop.map_or_else(|| "none".to_owned(), |stop| text(scene, stop))
        };
        let [low, high] = forces.stops.each_ref().map(place);
        let unit = STOPS.measured.unit(coordinate);
        parts.push(format!("stops = [{low}, {high}] {unit}"));
    }
    for (field, formula) in [
        (&FORCE, forces.force.as_ref()),
        (&MOTOR, forces.declared_motor()),
    ] {
        if let Some(formula) = formula {
            let unit = field.measured.unit(coordinate);
            parts.push(format!("{} = {} {unit}", field.name, text(scene, formula)));
        }
    }
    if let Some(filter) = &forces.filter {
        parts.push(format!("{FILTER} = {} s", text(scene, &filter.time)));
    }
    parts.join(", ")
}

/// Applies `change` to every formula of a scene and to everything inside it.
pub fn rewrite(scene: &mut Scene, change: &mut impl FnMut(&mut Formula)) {
    match &mut scene.gravity {
        Gravity::None | Gravity::Field => {}
        Gravity::Uniform { acceleration } => each(acceleration, change),
        Gravity::PointMass { mu, center } => {
            one(mu, change);
            each(center, change);
        }
        Gravity::Oblate {
            mu,
            center,
            radius,
            j2,
            axis,
        } => {
            for formula in [mu, radius, j2] {
                one(formula, change);
            }
            each(center, change);
            each(axis, change);
        }
    }
    for start in &mut scene.starts.parts {
        start
            .formulas_mut()
            .for_each(|formula| one(formula, change));
    }
    for start in &mut scene.starts.coordinates {
        let formulas = [&mut start.value, &mut start.rate].into_iter().flatten();
        formulas.for_each(|formula| one(formula, change));
    }
    for named in &mut scene.lets {
        one(&mut named.value, change);
    }
    let frames = scene.bodies.iter_mut().flat_map(|body| &mut body.frames);
    for frame in frames.chain(&mut scene.world_frames) {
        each(&mut frame.position, change);
        frame
            .rotation
            .iter_mut()
            .flatten()
            .for_each(|row| each(row, change));
    }
    for body in &mut scene.bodies {
        let i = &mut body.inertia;
        for formula in [
            &mut body.mass,
            &mut i.xx,
            &mut i.yy,
            &mut i.zz,
            &mut i.xy,
            &mut i.xz,
            &mut i.yz,
        ] {
            one(formula, change);
        }
    }
    for shape in &mut scene.shapes {
        shape.formulas_mut().for_each(|part| one(part, change));
    }
    for point in &mut scene.points {
        if let PointKind::Mass(mass) = &mut point.kind {
            one(mass, change);
        }
    }
    for joint in &mut scene.joints {
        let numbers = joint.law.numbers_mut();
        numbers.into_iter().for_each(|number| one(number, change));
        let forces = joint.forces.iter_mut().flat_map(JointForces::formulas_mut);
        forces.for_each(|formula| one(formula, change));
    }
    for line in &mut scene.lines {
        for formula in [
            &mut line.free_length,
            &mut line.stiffness,
            &mut line.damping,
        ] {
            one(formula, change);
        }
    }
    for state in &mut scene.states {
        one(&mut state.start, change);
        one(&mut state.rate, change);
    }
    for load in &mut scene.loads {
        if let LoadKind::Force(formula) | LoadKind::Torque(formula) = &mut load.kind {
            one(formula, change);
        }
    }
    scene
        .outputs
        .iter_mut()
        .for_each(|output| one(&mut output.value, change));
    scene.events.iter_mut().for_each(|event| {
        one(&mut event.guard, change);
        let settings = event.actions.set.iter_mut();
        settings.for_each(|setting| one(&mut setting.value, change));
        let map = event.actions.next.iter_mut().flat_map(|next| &mut next.map);
        map.for_each(|mapped| {
            if let MapSource::Value { value, .. } = &mut mapped.from {
                one(value, change);
            }
        });
    });
}

fn each(parts: &mut [Formula], change: &mut impl FnMut(&mut Formula)) {
    parts.iter_mut().for_each(|part| one(part, change));
}

fn one(formula: &mut Formula, change: &mut impl FnMut(&mut Formula)) {
    change(formula);
    if let Formula::Vector(parts)
    | Formula::Apply(_, parts)
    | Formula::Component(parts, _)
    | Formula::Lookup(_, parts) = formula
    {
        parts.iter_mut().for_each(|part| one(part, change));
    }
}
