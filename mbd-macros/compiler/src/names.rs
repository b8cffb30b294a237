//! What the reader of generated code calls a number: names of the declaration, made into identifiers.

use mbd_scene::{InputSource, Layout, Place, PointSlots, Quantity, Scene};

use crate::expression::Slot;

const POSITION: [&str; 3] = ["x", "y", "z"];
const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];
const RATE: [&str; 3] = ["wx", "wy", "wz"];

/// The coordinates of a body.
fn pose(layout: &Layout) -> Vec<&'static str> {
    let attitude: &[&str] = match layout.directions.plane {
        None => &["qw", "qx", "qy", "qz"],
        Some(_) => &["angle"],
    };
    let moves = layout
        .directions
        .translations()
        .iter()
        .map(|&k| POSITION[k]);
    moves.chain(attitude.iter().copied()).collect()
}

/// The speeds of a body.
fn twist(layout: &Layout) -> Vec<&'static str> {
    let moves = layout
        .directions
        .translations()
        .iter()
        .map(|&k| VELOCITY[k]);
    let turns = layout.directions.rotations().iter().map(|&k| RATE[k]);
    moves.chain(turns).collect()
}

/// A name of the declaration as part of an identifier: `bridle[2]` becomes `bridle_2`.
#[must_use]
pub fn identifier(name: &str) -> String {
    let mut text = String::new();
    for character in name.chars() {
        if character.is_ascii_alphanumeric() || character == '_' {
            text.push(character.to_ascii_lowercase());
        } else if !character.is_ascii() {
            text.push_str(&format!("u{:x}", u32::from(character)));
        } else if !text.ends_with('_') {
            text.push('_');
        }
    }
    let text = text.trim_end_matches('_');
    match text.chars().next() {
        Some(first) if first.is_ascii_digit() => format!("n{text}"),
        Some(_) => text.to_owned(),
        None => "unnamed".to_owned(),
    }
}

/// The name of a number from outside.
#[must_use]
pub fn slot(scene: &Scene, layout: &Layout, slot: Slot) -> String {
    match slot {
        Slot::Time => "time".to_owned(),
        Slot::State(index) => state(scene, layout, index),
        Slot::Node(index) => {
            let node = layout.nodes.get(index / 3);
            let rate = node.is_some_and(|node| node.z.is_some());
            let name = node.map_or_else(String::new, |node| point(scene, node.point));
            format!("{name}_{}{}", if rate { "w" } else { "p" }, axis(index))
        }
        Slot::Effective(index) if index >= 2 * layout.effective_lines => {
            let mut all = layout.nodes.iter();
            let own = all.rfind(|node| node.velocity.is_some_and(|at| at <= index));
            let name = own.map_or_else(String::new, |node| point(scene, node.point));
            format!("{name}_v{}", axis(index - 2 * layout.effective_lines))
        }
        Slot::Effective(index) => {
            let line = layout
                .lines
                .iter()
                .position(|l| l.effective == Some(index / 2));
            let letter = if index % 2 == 0 { "k" } else { "l" };
            format!("{}_{letter}", line_name(scene, line.unwrap_or_default()))
        }
        Slot::Hold(index) => match index.checked_sub(layout.lines.len()) {
            Some(stop) => match stop.checked_sub(layout.stops.len()) {
                Some(joint) => {
                    let held = layout.joints.iter().position(|it| it.held == Some(index));
                    let joint = layout.detachable_joints.get(joint).map(|it| it.joint);
                    let name =
                        |joint: usize| scene.joints.get(joint).map(|it| identifier(&it.name));
                    match held.and_then(name) {
                        Some(lock) => format!("{lock}_at"),
                        None => format!(
                            "{}_hold",
                            joint.and_then(name).as_deref().unwrap_or("joint")
                        ),
                    }
                }
                None => format!("{}_hold", stop_name(scene, layout, stop)),
            },
            None => format!("{}_hold", line_name(scene, index)),
        },
        Slot::Ends(index) => end(scene, layout, index),
        Slot::Input(index) => input(scene, layout, index),
        Slot::Turn { number, .. } => {
            let angle = layout.turns.get(number);
            let named = angle.and_then(|&(joint, index)| scene.coordinate(joint, index));
            named.map_or_else(
                || "angle_before".to_owned(),
                |(joint, coordinate)| {
                    format!("{}_{}_before", identifier(&joint.name), coordinate.name)
                },
            )
        }
        Slot::Origin {
            number: index @ 0..3,
            ..
        } => format!("origin_{}", axis(index)),
        Slot::Origin {
            number: index @ 3..6,
            ..
        } => format!("origin_v{}", axis(index)),
        Slot::Origin { .. } => "origin_since".to_owned(),
        Slot::Row(index) => row(scene, layout, index),
        Slot::Motion(index) => match index.checked_sub(layout.nv) {
            Some(index) => format!("{}_lambda", row(scene, layout, index)),
            None => format!("{}_rate", state(scene, layout, layout.nq + index)),
        },
        Slot::Factored(index) => format!("factored_{index}"),
        Slot::Right { number, .. } => match number.checked_sub(layout.nv) {
            Some(index) => format!("{}_right", row(scene, layout, index)),
            None => format!("{}_right", state(scene, layout, layout.nq + number)),
        },
        Slot::Direction(index) => format!("along_{index}"),
        Slot::Value(index) => format!("value_{index}"),
        Slot::Param(index) => scene
            .params
            .get(index)
            .map_or_else(|| format!("param_{index}"), |p| identifier(&p.name)),
        Slot::Derived(index) => format!("derived_{index}"),
    }
}

/// The name of a number of a result, where what it belongs to has one: `upper_vx_rate`, `elbow_gamma_b`.
#[must_use]
pub fn result(scene: &Scene, layout: &Layout, what: Quantity, place: usize) -> Option<String> {
    let speed = |place: usize| state(scene, layout, layout.nq + place);
    let of_row = |suffix: &str| {
        let (joint, row) = joint_of(scene, layout, place)?;
        Some(format!("{joint}_{suffix}_{}", LETTERS.get(row)?))
    };
    let six = |names: [&str; 2]| {
        let name = names.get(place % 6 / 3)?;
        Some(format!("{name}_{}", axis(place)))
    };
    match what {
        Quantity::Derivative | Quantity::Rates if place < layout.nx() => {
            Some(format!("{}_rate", state(scene, layout, place)))
        }
        Quantity::BiasForce => Some(format!("{}_bias", speed(place))),
        Quantity::Forces => Some(format!("{}_force", speed(place))),
        Quantity::ProjectionStep if place < layout.nv => Some(format!("{}_move", speed(place))),
        Quantity::Constraint => of_row("row"),
        Quantity::ConstraintRate => of_row("rate"),
        Quantity::ConstraintBias => of_row("gamma"),
        Quantity::Multipliers => of_row("lambda"),
        Quantity::Reactions => {
            let joint = identifier(&scene.joints.get(place / 6)?.name);
            six(["force", "torque"]).map(|name| format!("{joint}_{name}"))
        }
        Quantity::Coordinates => scene
            .joint_coordinates()
            .get(place)
            .map(|name| identifier(name)),
        Quantity::Momentum => six(["momentum", "angular_momentum"]),
        Quantity::Energy => ENERGIES.get(place).map(|name| (*name).to_owned()),
        _ => None,
    }
}

/// The rows of a joint and its motors.
const LETTERS: [char; 12] = ['a', 'b', 'c', 'd', 'e', 'f', 'g', 'h', 'i', 'j', 'k', 'l'];

/// The parts of [`Quantity::Energy`].
const ENERGIES: [&str; 6] = [
    "kinetic",
    "gravitational",
    "elastic",
    "load_power",
    "damper_power",
    "drive_power",
];

/// Name and SI unit of a number of the state, as a table shows them: `capsule.qw`.
#[must_use]
pub fn coordinate<'s>(scene: &'s Scene, layout: &Layout, index: usize) -> (String, &'s str) {
    let own = index.checked_sub(layout.states());
    if let Some(state) = own.and_then(|own| scene.states.get(own)) {
        return (state.name.clone(), &state.unit.text);
    }
    let v = index.checked_sub(layout.nq);
    let (pose, twist) = (pose(layout), twist(layout));
    let moves = layout.directions.translations();
    if let Some((joint, name, unit)) = layout.joint_number(scene, index) {
        return (format!("{}.{name}", scene.joints[joint].name), unit);
    }
    for (number, slots) in layout.own_bodies() {
        let body = &scene.bodies[number];
        if let Some((i, item)) = v
            .is_none()
            .then(|| index.checked_sub(slots.q))
            .flatten()
            .and_then(|i| Some((i, pose.get(i)?)))
        {
            return (
                format!("{}.{item}", body.name),
                match () {
                    () if i < moves.len() => "m",
                    () if layout.directions.plane.is_some() => "rad",
                    () => "",
                },
            );
        }
        if let Some((i, item)) = v
            .and_then(|v| v.checked_sub(slots.v))
            .and_then(|i| Some((i, twist.get(i)?)))
        {
            return (
                format!("{}.{item}", body.name),
                if i < moves.len() { "m/s" } else { "rad/s" },
            );
        }
    }
    for (point, slots) in scene.points.iter().zip(&layout.points) {
        let PointSlots::Mass(slots) = slots else {
            continue;
        };
        let own = |from: usize| index.checked_sub(from).and_then(|i| moves.get(i));
        if let (Some(&k), None) = (own(slots.q), v) {
            return (format!("{}.{}", point.name, POSITION[k]), "m");
        }
        if let (Some(&k), Some(_)) = (own(layout.nq + slots.v), v) {
            return (format!("{}.{}", point.name, VELOCITY[k]), "m/s");
        }
    }
    (format!("x[{index}]"), "")
}

fn axis(index: usize) -> &'static str {
    ["x", "y", "z"][index % 3]
}

fn point(scene: &Scene, index: usize) -> String {
    let found = scene.points.get(index);
    found.map_or_else(|| format!("point_{index}"), |p| identifier(&p.name))
}

fn body(scene: &Scene, index: usize) -> String {
    let found = scene.bodies.get(index);
    found.map_or_else(|| format!("body_{index}"), |b| identifier(&b.name))
}

fn line_name(scene: &Scene, index: usize) -> String {
    let found = scene.lines.get(index);
    found.map_or_else(|| format!("line_{index}"), |l| identifier(&l.name))
}

/// The name of a stop: joint, coordinate, side.
fn stop_name(scene: &Scene, layout: &Layout, index: usize) -> String {
    let slots = layout.stops.get(index);
    let named = slots.and_then(|slots| {
        let (joint, coordinate) = scene.coordinate(slots.joint, slots.coordinate)?;
        let (joint, side) = (identifier(&joint.name), slots.side.word());
        Some(format!("{joint}_{}_{side}", coordinate.name))
    });
    named.unwrap_or_else(|| format!("stop_{index}"))
}

/// The name of a number of the state.
fn state(scene: &Scene, layout: &Layout, index: usize) -> String {
    let v = index.checked_sub(layout.nq);
    let (pose, twist) = (pose(layout), twist(layout));
    if let Some((joint, name, _)) = layout.joint_number(scene, index) {
        return format!("{}_{name}", identifier(&scene.joints[joint].name));
    }
    for (number, slots) in layout.own_bodies() {
        if let Some(item) = index.checked_sub(slots.q).and_then(|i| pose.get(i))
            && v.is_none()
        {
            return format!("{}_{item}", body(scene, number));
        }
        if let Some(item) = v
            .and_then(|v| v.checked_sub(slots.v))
            .and_then(|i| twist.get(i))
        {
            return format!("{}_{item}", body(scene, number));
        }
    }
    for (number, slots) in layout.points.iter().enumerate() {
        let PointSlots::Mass(slots) = slots else {
            continue;
        };
        let moves = layout.directions.translations();
        let own = |from: usize| index.checked_sub(from).and_then(|i| moves.get(i));
        if let (Some(&k), None) = (own(slots.q), v) {
            return format!("{}_{}", point(scene, number), POSITION[k]);
        }
        if let (Some(&k), Some(_)) = (own(layout.nq + slots.v), v) {
            return format!("{}_{}", point(scene, number), VELOCITY[k]);
        }
    }
    if let Some(own) = index.checked_sub(layout.states()) {
        let found = scene.states.get(own);
        return found.map_or_else(|| format!("x_{index}"), |own| identifier(&own.name));
    }
    let z = index.saturating_sub(layout.nq + layout.nv);
    let node = layout.nodes.iter().find(|n| n.z == Some(z / 3 * 3));
    node.map_or_else(
        || format!("x_{index}"),
        |node| format!("{}_{}", point(scene, node.point), axis(z)),
    )
}

/// The name of a number of [`mbd_scene::Quantity::AnchorStates`].
fn end(scene: &Scene, layout: &Layout, index: usize) -> String {
    match layout.anchors.get(index / 6) {
        Some(anchor) => {
            let line = line_name(scene, anchor.line);
            let place = match anchor.place {
                Place::World(_) => "world".to_owned(),
                Place::Body(number, _) => body(scene, number),
                Place::Point(number) => point(scene, number),
            };
            let letter = if index % 6 < 3 { "p" } else { "v" };
            format!("{line}_{place}_{letter}{}", axis(index % 6))
        }
        None => {
            let load = index.saturating_sub(6 * layout.anchors.len());
            let rate = layout.nodes.iter().find(|node| {
                node.load_rate
                    .is_some_and(|at| (at..at + 3).contains(&index))
            });
            let (node, what) = match rate {
                Some(node) => (Some(node), "load_rate"),
                None => (layout.nodes.get(load / 3), "load"),
            };
            let name = node.map_or_else(String::new, |node| point(scene, node.point));
            format!("{name}_{what}_{}", axis(load))
        }
    }
}

/// The name of a row's right-hand side.
fn row(scene: &Scene, layout: &Layout, index: usize) -> String {
    joint_of(scene, layout, index).map_or_else(
        || format!("row_{index}"),
        |(joint, row)| format!("{joint}_row_{row}"),
    )
}

/// The joint of a row, and which of its rows it is.
fn joint_of(scene: &Scene, layout: &Layout, index: usize) -> Option<(String, usize)> {
    let mut slots = layout.joints.iter().zip(&scene.joints);
    let (slots, joint) =
        slots.find(|(slots, _)| (slots.row..slots.row + slots.len).contains(&index))?;
    Some((identifier(&joint.name), index - slots.row))
}

/// The name of an input number.
fn input(scene: &Scene, layout: &Layout, index: usize) -> String {
    let Some(slots) = layout
        .inputs
        .iter()
        .find(|slots| (slots.at..slots.at + slots.len).contains(&index))
    else {
        return format!("input_{index}");
    };
    let item = index - slots.at;
    let name = match slots.source {
        InputSource::Input(number) => scene.inputs.get(number).map(|i| identifier(&i.name)),
        InputSource::Load(number) => scene.loads.get(number).map(|l| identifier(&l.name)),
        InputSource::BodyGravity(number) => Some(format!("{}_gravity", body(scene, number))),
        InputSource::PointGravity(number) => Some(format!("{}_gravity", point(scene, number))),
    }
    .unwrap_or_else(|| "input".to_owned());
    match (slots.len, item) {
        (1, _) => name,
        (6, 3..) => format!("{name}_couple_{}", axis(item)),
        _ => format!("{name}_{}", axis(item)),
    }
}
