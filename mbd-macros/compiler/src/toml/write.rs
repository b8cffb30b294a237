//! A scene as a TOML document that reads back as the same scene.

use std::fmt::Write;

use mbd_scene::joints::{FILTER, FORCE, MOTOR, NUMBERS, START, START_RATE, STOPS};
use mbd_scene::metrics::Take;
use mbd_scene::solids::Solid;
use mbd_scene::{
    Actions, AngularVelocity, Axis, Body, Clamp, Detachable, Difference, Dimension, Direction,
    Fixed, Formula, Frame, Function, Gravity, Inertia, Joint, JointLaw, Line, LoadKind, MapSource,
    Next, NodeModel, Output, Part, PointKind, Scene, Setting, Triple, Unit,
};

use toml::Value;

use super::formula::{number, place, text, vector};
use crate::resolve::letter;
use crate::syntax::words::{ABOUT, AT_START, LOCKED};
use crate::units;

/// Writes a scene as TOML. Numbers without a unit are SI; repeated items are written one by one.
#[must_use]
pub fn write_toml(scene: &Scene) -> String {
    let mut out = String::new();
    head(&mut out, scene);
    numbers(&mut out, scene);
    bodies(&mut out, scene);
    connections(&mut out, scene);
    lets(&mut out, scene);
    states(&mut out, scene);
    results(&mut out, scene);
    metrics(&mut out, scene);
    out
}

/// A string in quotes; one without escapes keeps its places when it is read.
pub(super) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// A key, in quotes where it has an index.
pub(super) fn key(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if plain {
        name.to_string()
    } else {
        quoted(name)
    }
}

fn entry(out: &mut String, name: &str, value: &str) {
    let _ = writeln!(out, "{name} = {}", quoted(value));
}

fn doc(out: &mut String, doc: &str) {
    if !doc.is_empty() {
        entry(out, "doc", doc);
    }
}

fn table(out: &mut String, word: &str, name: &str) {
    let _ = writeln!(out, "\n[{word}.{}]", key(name));
}

fn head(out: &mut String, scene: &Scene) {
    out.push_str("# Numbers without a unit are SI.\n");
    entry(out, "model", &scene.name);
    doc(out, &scene.doc);
    entry(out, "units", "si");
    entry(out, "coordinates", scene.coordinates.word());
    let components = match scene.angular_velocity {
        AngularVelocity::Body => "body",
        AngularVelocity::World => "world",
    };
    entry(out, "angular_velocity", components);
    if let Some(plane) = scene.planar {
        entry(out, "planar", plane.word());
    }
    let followed = match scene.runs.origin {
        Some(Part::Body(body)) => scene.bodies.get(body).map(|body| &body.name),
        Some(Part::Point(point)) => scene.points.get(point).map(|point| &point.name),
        _ => None,
    };
    if let Some(name) = followed {
        entry(out, "origin", &format!("follows {name}"));
    }
    let gravity = match &scene.gravity {
        Gravity::None => "none".to_string(),
        Gravity::Field => "field".to_string(),
        Gravity::Uniform { acceleration } => vector(acceleration, scene),
        Gravity::PointMass { mu, center } => format!(
            "point_mass {{ mu: {}, center: {} }}",
            text(mu, scene),
            vector(center, scene)
        ),
        Gravity::Oblate {
            mu,
            center,
            radius,
            j2,
            axis,
        } => format!(
            "oblate {{ mu: {}, center: {}, radius: {}, j2: {}, axis: {} }}",
            text(mu, scene),
            vector(center, scene),
            text(radius, scene),
            text(j2, scene),
            vector(axis, scene)
        ),
    };
    entry(out, "gravity", &gravity);
}

/// A number in the unit it was declared in; in SI where no decimal number of that unit gives it exactly.
fn with_unit(value: f64, unit: &Unit) -> String {
    if unit.text.is_empty() {
        return number(value);
    }
    match inverse(value, |x| x * unit.factor, value / unit.factor) {
        Some(x) => format!("{} {}", number(x), unit.text),
        None => format!("{} {}", number(value), units::si_text(unit.dimension)),
    }
}

/// A const in the unit it was declared in.
fn constant_value(value: Fixed, unit: &Unit) -> String {
    let parts = match value {
        Fixed::Scalar(value) => return with_unit(value, unit),
        Fixed::Vector(parts) => parts,
    };
    let inside = |value: f64| {
        let found = inverse(value, |x| x * unit.factor, value / unit.factor);
        found.map(number)
    };
    let written: Option<Vec<String>> = parts.into_iter().map(inside).collect();
    let (written, unit) = match written {
        Some(written) => (written, unit.text.clone()),
        None => (parts.map(number).to_vec(), units::si_text(unit.dimension)),
    };
    let vector = format!("[{}] {unit}", written.join(", "));
    vector.trim_end().to_string()
}

/// The number near `guess` whose image is `value`.
fn inverse(value: f64, image: impl Fn(f64) -> f64, guess: f64) -> Option<f64> {
    let (mut up, mut down) = (guess, guess);
    for _ in 0..4 {
        for x in [up, down] {
            if image(x) == value {
                return Some(x);
            }
        }
        (up, down) = (up.next_up(), down.next_down());
    }
    None
}

fn numbers(out: &mut String, scene: &Scene) {
    for constant in &scene.consts {
        table(out, "const", &constant.name);
        doc(out, &constant.doc);
        entry(
            out,
            "value",
            &constant_value(constant.value, &constant.unit),
        );
    }
    for param in &scene.params {
        table(out, "param", &param.name);
        doc(out, &param.doc);
        entry(out, "value", &with_unit(param.default, &param.unit));
        if let Some([low, high]) = param.range {
            let (low, high) = (with_unit(low, &param.unit), with_unit(high, &param.unit));
            entry(out, "in", &format!("{low} ..= {high}"));
        }
    }
    for input in &scene.inputs {
        table(out, "input", &input.name);
        doc(out, &input.doc);
        let unit = unit_word(&input.unit);
        let kind = match input.components {
            3 => format!("[{unit}; 3]"),
            _ => unit.to_string(),
        };
        entry(out, "kind", &kind);
        if input.default != [0.0; 3] {
            let [x, y, z] = input.default.map(number);
            let value = match input.components {
                3 => format!("[{x}, {y}, {z}]"),
                _ => x,
            };
            entry(out, "value", format!("{value} {}", input.unit.text).trim());
        }
    }
    for declared in &scene.tables {
        table(out, "table", &declared.name);
        doc(out, &declared.doc);
        if declared.smooth {
            let _ = writeln!(out, "smooth = true");
        }
        entry(
            out,
            "value",
            &format!("{{ {} }}", rows(declared).join(", ")),
        );
    }
}

/// The rows of a table.
fn rows(table: &mbd_scene::Table) -> Vec<String> {
    let row = |argument: String, i, j| {
        let value = with_unit(table.entry(i, j), &table.y_unit);
        format!("{argument}: {value}")
    };
    let first = table.x.iter().map(|x| with_unit(*x, &table.x_unit));
    match &table.second {
        None => first.enumerate().map(|(i, x)| row(x, i, 0)).collect(),
        Some(second) => {
            let pairs = first.enumerate().flat_map(|(i, x)| {
                let numbers = second.z.iter().enumerate();
                numbers.map(move |(j, z)| (i, j, format!("({x}, {})", with_unit(*z, &second.unit))))
            });
            pairs.map(|(i, j, both)| row(both, i, j)).collect()
        }
    }
}

/// A unit as the kind of an input or a state.
fn unit_word(unit: &Unit) -> &str {
    match unit.text.as_str() {
        "" => "number",
        text => text,
    }
}

fn bodies(out: &mut String, scene: &Scene) {
    for frame in scene.world_frames.iter().skip(1) {
        let _ = writeln!(out, "\n[world.frame.{}]", key(&frame.name));
        place_and_axes(out, frame, scene);
    }
    for (index, body) in scene.bodies.iter().enumerate() {
        table(out, "body", &body.name);
        doc(out, &body.doc);
        entry(out, "mass", &text(&body.mass, scene));
        let unchecked = match scene.unchecked.contains(&index) {
            true => " (unchecked)",
            false => "",
        };
        let inertia = inertia(&body.inertia, scene);
        entry(out, "inertia", &format!("{inertia}{unchecked}"));
        shapes(out, index, scene);
        frames(out, body, scene);
        start(out, ("body", &body.name), Part::Body(index), scene);
    }
    for (index, point) in scene.points.iter().enumerate() {
        table(out, "point", &point.name);
        doc(out, &point.doc);
        match &point.kind {
            PointKind::Mass(mass) => entry(out, "mass", &text(mass, scene)),
            PointKind::Node(model) => entry(out, "equilibrium", &node_model(*model)),
        }
        start(out, ("point", &point.name), Part::Point(index), scene);
    }
}

/// The start of a body or a point.
fn start(out: &mut String, (word, name): (&str, &str), part: Part, scene: &Scene) {
    let mut starts = scene.starts.parts.iter();
    let Some(start) = starts.find(|start| start.part == part) else {
        return;
    };
    let _ = writeln!(out, "\n[{word}.{}.start]", key(name));
    if let Some(position) = &start.position {
        entry(out, "at", &vector(position, scene));
    }
    if let Some(rows) = &start.rotation {
        entry(out, "rotated", &matrix(rows, scene));
    }
    if let Some(velocity) = &start.velocity {
        entry(out, "velocity", &vector(velocity, scene));
    }
    if let Some(omega) = &start.angular_velocity {
        entry(out, "angular_velocity", &vector(omega, scene));
    }
}

fn inertia(inertia: &Inertia, scene: &Scene) -> String {
    let zero = Formula::Number(0.0);
    let [xx, yy, zz] = [&inertia.xx, &inertia.yy, &inertia.zz].map(|element| text(element, scene));
    let products = [&inertia.xy, &inertia.xz, &inertia.yz];
    if products.iter().all(|element| **element == zero) {
        return format!("diag({xx}, {yy}, {zz})");
    }
    let [xy, xz, yz] = products.map(|element| text(element, scene));
    format!(
        "full {{ xx: {xx}, yy: {yy}, zz: {zz}, xy: {xy}, xz: {xz}, yz: {yz} }} (matrix elements)"
    )
}

/// The shapes of a body: one as it is, several in brackets.
fn shapes(out: &mut String, body: usize, scene: &Scene) {
    let own = scene.shapes.iter().filter(|shape| shape.body == body);
    let written: Vec<String> = own
        .map(|shape| {
            let sizes = shape.sizes.iter().map(|size| text(size, scene));
            let word = shape.solid.keyword();
            let mut written = match shape.solid {
                Solid::Box => format!("{word} [{}]", sizes.collect::<Vec<_>>().join(", ")),
                solid => {
                    let named = solid.sizes().iter().zip(sizes);
                    let named = named.map(|(name, size)| format!("{name}: {size}"));
                    format!("{word} {{ {} }}", named.collect::<Vec<_>>().join(", "))
                }
            };
            let zero = Formula::Number(0.0);
            if shape.position.iter().any(|part| *part != zero) || shape.rotation.is_some() {
                written += &format!(" at {}", vector(&shape.position, scene));
            }
            if let Some(rows) = &shape.rotation {
                written += &format!(" rotated {}", matrix(rows, scene));
            }
            written
        })
        .collect();
    match written.as_slice() {
        [] => {}
        [one] => entry(out, "shape", one),
        several => entry(out, "shape", &format!("[{}]", several.join(", "))),
    }
}

fn frames(out: &mut String, body: &Body, scene: &Scene) {
    for frame in body.frames.iter().skip(1) {
        let _ = writeln!(
            out,
            "\n[body.{}.frame.{}]",
            key(&body.name),
            key(&frame.name)
        );
        place_and_axes(out, frame, scene);
    }
}

fn place_and_axes(out: &mut String, frame: &Frame, scene: &Scene) {
    entry(out, "at", &vector(&frame.position, scene));
    if let Some(rows) = &frame.rotation {
        entry(out, "rotated", &matrix(rows, scene));
    }
}

fn matrix(rows: &[Triple; 3], scene: &Scene) -> String {
    let rows = rows.each_ref().map(|row| vector(row, scene));
    format!("matrix({})", rows.join(", "))
}

fn node_model(model: NodeModel) -> String {
    match model {
        NodeModel::Static => "static".to_string(),
        NodeModel::Rate => "rate".to_string(),
        NodeModel::Stepwise { formula, clamp } => {
            let formula = match formula {
                Difference::Euler => "euler",
                Difference::Bdf2 => "bdf2",
            };
            let clamp = match clamp {
                Clamp::Positive => "positive",
                Clamp::Literal => "literal",
            };
            format!("stepwise {{ formula: {formula}, clamp: {clamp} }}")
        }
    }
}

fn connections(out: &mut String, scene: &Scene) {
    // Locks are made by events.
    let declared = |(_, joint): &(usize, &Joint)| !matches!(joint.law, JointLaw::Lock(_));
    for (index, joint) in scene.joints.iter().enumerate().filter(declared) {
        table(out, "joint", &joint.name);
        doc(out, &joint.doc);
        entry(out, "kind", joint.law.keyword());
        let ends = scene.coupled(joint);
        let ends = ends.unwrap_or_else(|| [joint.parent, joint.child].map(|end| place(end, scene)));
        for (word, end) in ["from", "to"].iter().zip(&ends) {
            entry(out, word, end);
        }
        if joint.cut {
            out.push_str("loop = true\n");
        }
        joint_fields(out, &joint.law, scene);
        if scene.starts.detached.contains(&Detachable::Joint(index)) {
            entry(out, AT_START, "detached");
        }
        forces(out, index, joint, scene);
    }
    for (index, line) in scene.lines.iter().enumerate() {
        write_line(out, (index, line), scene);
    }
    for load in &scene.loads {
        table(out, "load", &load.name);
        doc(out, &load.doc);
        let at = place(load.at, scene);
        match (load.at, at.split_once('.')) {
            (mbd_scene::Place::Body(..), Some((body, frame))) => {
                entry(out, "on", body);
                entry(out, "at", frame);
            }
            _ => entry(out, "on", &at),
        }
        let unit = |dimension: Dimension| units::si_text(dimension);
        match &load.kind {
            LoadKind::External => entry(out, "kind", "external"),
            LoadKind::Force(formula) => {
                entry(out, "value", &text(formula, scene));
                entry(out, "in", &unit(units::FORCE));
            }
            LoadKind::Torque(formula) => {
                entry(out, "value", &text(formula, scene));
                entry(out, "in", &unit(units::TORQUE));
            }
        }
    }
}

/// The fields of a joint, as its law holds them.
fn joint_fields(out: &mut String, law: &JointLaw, scene: &Scene) {
    let numbers = law.numbers();
    let held = match Value::try_from(law) {
        Ok(Value::Table(law)) => law.into_iter().next().map(|(_, fields)| fields),
        _ => None,
    };
    for (name, value) in held
        .as_ref()
        .and_then(Value::as_table)
        .into_iter()
        .flatten()
    {
        let number = numbers.iter().find(|(field, _)| field.name == name);
        match (number, axis(value), value) {
            (Some((_, formula)), ..) => entry(out, name, &text(formula, scene)),
            (None, Some(axis), _) => entry(out, name, &axis),
            (None, None, Value::Array(list)) if law.couples().is_empty() => {
                let list: Vec<String> = list.iter().filter_map(axis).collect();
                entry(out, name, &format!("[{}]", list.join(", ")));
            }
            _ => {}
        }
    }
}

/// What acts along the coordinates of a joint: directly for one coordinate, else in a table of its own for each.
fn forces(out: &mut String, index: usize, joint: &Joint, scene: &Scene) {
    let several = joint.law.measured().count() > 1;
    for (number, coordinate) in joint.law.measured().enumerate() {
        let mut starts = scene.starts.coordinates.iter();
        let start = starts.find(|start| (start.joint, start.coordinate) == (index, number));
        let forces = joint
            .forces
            .iter()
            .find(|forces| forces.coordinate == number);
        let lock = scene.lock_of(index, number).map(Detachable::Joint);
        let locked = lock.is_some_and(|lock| !scene.starts.detached.contains(&lock));
        if several && (start.is_some() || forces.is_some() || locked) {
            let _ = writeln!(out, "\n[joint.{}.{}]", key(&joint.name), coordinate.name);
        }
        if locked {
            entry(out, AT_START, LOCKED);
        }
        if let Some(start) = start {
            if let Some(value) = &start.value {
                let about = if start.about { ABOUT } else { "" };
                let said = format!("{about} {}", text(value, scene));
                entry(out, START.name, said.trim_start());
            }
            if let Some(rate) = &start.rate {
                entry(out, START_RATE.name, &text(rate, scene));
            }
        }
        let Some(forces) = forces else { continue };
        for (field, formula) in NUMBERS.iter().zip(forces.numbers()) {
            if let Some(formula) = formula {
                entry(out, field.name, &text(formula, scene));
            }
        }
        if forces.stops.iter().any(Option::is_some) {
            let place = |stop: &Option<Formula>| {
                let stop = stop.as_ref();
                stop.map_or_else(|| "none".to_string(), |stop| text(stop, scene))
            };
            let [low, high] = forces.stops.each_ref().map(place);
            entry(out, STOPS.name, &format!("[{low}, {high}]"));
        }
        let filter = forces.filter.as_ref();
        let motor = filter
            .map(|filter| &filter.command)
            .or(forces.motor.as_ref());
        for (field, formula) in [(&FORCE, forces.force.as_ref()), (&MOTOR, motor)] {
            if let Some(formula) = formula {
                entry(out, field.name, &text(formula, scene));
            }
        }
        if let Some(filter) = filter {
            entry(out, FILTER, &text(&filter.time, scene));
            let states = scene.states.iter().skip(filter.state);
            let usual = [&filter.command, &Formula::Number(0.0)];
            for ((field, state), usual) in [&START, &START_RATE].into_iter().zip(states).zip(usual)
            {
                if state.start != *usual {
                    entry(out, field.name, &text(&state.start, scene));
                }
            }
        }
    }
}

/// An axis in the language, if the value is one.
fn axis(value: &Value) -> Option<String> {
    value.clone().try_into::<Axis>().ok().map(letter)
}

fn write_line(out: &mut String, (index, line): (usize, &Line), scene: &Scene) {
    table(out, line.kind.word(), &line.name);
    doc(out, &line.doc);
    entry(out, "from", &place(line.from, scene));
    entry(out, "to", &place(line.to, scene));
    entry(out, "free_length", &text(&line.free_length, scene));
    match line.kind.table().and_then(|table| scene.tables.get(table)) {
        Some(table) => entry(out, "force", &table.name),
        None => entry(out, "stiffness", &text(&line.stiffness, scene)),
    }
    entry(out, "damping", &text(&line.damping, scene));
    if scene.starts.detached.contains(&Detachable::Line(index)) {
        entry(out, AT_START, "detached");
    }
}

fn states(out: &mut String, scene: &Scene) {
    let joints = scene.joints.iter().flat_map(|joint| &joint.forces);
    let filters: Vec<usize> = joints
        .filter_map(|forces| Some(forces.filter.as_ref()?.state))
        .collect();
    for (index, state) in scene.states.iter().enumerate() {
        // Those of filters are made by their joints.
        if filters
            .iter()
            .any(|&first| (first..first + 2).contains(&index))
        {
            continue;
        }
        table(out, "state", &state.name);
        doc(out, &state.doc);
        entry(out, "kind", unit_word(&state.unit));
        entry(out, "start", &text(&state.start, scene));
        entry(out, "rate", &text(&state.rate, scene));
    }
}

fn results(out: &mut String, scene: &Scene) {
    let of_metric = |at: usize| {
        scene
            .runs
            .metrics
            .iter()
            .any(|metric| metric.output == Some(at))
    };
    let outputs = scene.outputs.iter().enumerate();
    for (_, output) in outputs.filter(|(at, _)| !of_metric(*at)) {
        table(out, "output", &output.name);
        doc(out, &output.doc);
        entry(out, "value", &output_value(output, scene));
        unit(out, &output.unit, &output.value);
    }
    for event in &scene.events {
        table(out, "event", &event.name);
        doc(out, &event.doc);
        entry(out, "value", &text(&event.guard, scene));
        let direction = match event.direction {
            Direction::Crosses => "crosses",
            Direction::Rises => "rises",
            Direction::Falls => "falls",
        };
        entry(out, direction, "0.0");
        actions(out, &event.actions, scene);
    }
}

fn metrics(out: &mut String, scene: &Scene) {
    for metric in &scene.runs.metrics {
        table(out, "metric", &metric.name);
        doc(out, &metric.doc);
        let output = metric.output.and_then(|output| scene.outputs.get(output));
        let event = metric.event.and_then(|event| scene.events.get(event));
        let event = event.map_or("", |event| event.name.as_str());
        let of = output.map_or(event.to_owned(), |output| output_value(output, scene));
        entry(out, "value", &format!("{} {of}", metric.take.keyword()));
        if let Some(output) = output {
            unit(out, &output.unit, &output.value);
        }
        if let Some(level) = metric.level {
            entry(out, "level", &number(level));
        }
        if metric.take == Take::Value {
            entry(out, "at", event);
        }
        for (word, time) in [("from", metric.from), ("to", metric.to)] {
            if let Some(time) = time {
                entry(out, word, &number(time));
            }
        }
    }
}

/// What an event does.
fn actions(out: &mut String, actions: &Actions, scene: &Scene) {
    let setting = |setting: &Setting| {
        let name = scene.settable_name(setting.what);
        format!("{name} = {}", text(&setting.value, scene))
    };
    let names = |list: &[Detachable], locks: bool| -> Vec<String> {
        let own = list.iter().filter_map(|what| match scene.locked(*what) {
            Some(coordinate) => locks.then_some(coordinate),
            None => (!locks).then(|| scene.detachable_name(*what).to_owned()),
        });
        own.collect()
    };
    let lists: [(&str, Vec<String>); 5] = [
        ("set", actions.set.iter().map(setting).collect()),
        ("detach", names(&actions.detach, false)),
        ("attach", names(&actions.attach, false)),
        ("lock", names(&actions.attach, true)),
        ("free", names(&actions.detach, true)),
    ];
    for (word, list) in lists {
        match list.as_slice() {
            [] => {}
            [only] => entry(out, word, only),
            _ => entry(out, word, &format!("[{}]", list.join(", "))),
        }
    }
    match &actions.next {
        Some(next) => going_on(out, next, scene),
        None if actions.stop => entry(out, "then", "stop"),
        None => {}
    }
    if actions.once {
        entry(out, "acts", "once");
    }
}

/// The scene that goes on, and what begins there where.
fn going_on(out: &mut String, next: &Next, scene: &Scene) {
    entry(out, "then", &format!("scene \"{}\"", next.file));
    let entries = next.map.iter().map(|mapped| {
        let from = match &mapped.from {
            MapSource::Place(at) => place(*at, scene),
            MapSource::Value { value, .. } => text(value, scene),
        };
        format!("{} = {from}", mapped.name)
    });
    match entries.collect::<Vec<String>>().as_slice() {
        [] => {}
        [only] => entry(out, "map", only),
        all => entry(out, "map", &format!("[{}]", all.join(", "))),
    }
}

/// The unit of a value. What has none says so where its numbers stand among other things: in SI they could be angles, which makes radians of it.
fn unit(out: &mut String, unit: &Unit, value: &Formula) {
    let mut among_others = false;
    value.walk(&mut |part| {
        if let Formula::Apply(_, parts) = part {
            among_others |= parts.iter().any(|part| matches!(part, Formula::Number(_)));
        }
    });
    match (unit.text.as_str(), among_others) {
        ("", false) => {}
        ("", true) => entry(out, "in", "1"),
        (text, _) => entry(out, "in", text),
    }
}

/// Named expressions. Those of a document may stand anywhere; here they follow what they are made of.
fn lets(out: &mut String, scene: &Scene) {
    for named in &scene.lets {
        table(out, "let", &named.name);
        doc(out, &named.doc);
        entry(out, "value", &text(&named.value, scene));
        unit(out, &named.unit, &named.value);
    }
}

/// An output in SI: its formula holds it in the unit of its column.
fn output_value(output: &Output, scene: &Scene) -> String {
    let factor = output.unit.factor;
    if factor == 1.0 {
        return text(&output.value, scene);
    }
    let in_si = |value: f64| inverse(value, |x| x / factor, value * factor);
    match &output.value {
        Formula::Apply(Function::Div, parts) => match parts.as_slice() {
            [value, Formula::Number(by)] if *by == factor => text(value, scene),
            _ => text(&output.value, scene),
        },
        Formula::Number(value) => number(in_si(*value).unwrap_or(value * factor)),
        Formula::Vector(parts) => {
            let parts: Vec<Formula> = parts
                .iter()
                .map(|part| match part {
                    Formula::Number(value) => {
                        Formula::Number(in_si(*value).unwrap_or(value * factor))
                    }
                    other => other.clone(),
                })
                .collect();
            vector(&parts, scene)
        }
        other => text(other, scene),
    }
}
