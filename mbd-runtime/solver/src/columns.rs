//! Names and units of the numbers in a state, a list of inputs and a trajectory.

use mbd_scene::{AngularVelocity, InputSource, Layout, Part, Plane, PointSlots, Scene};

/// The remark of a reaction of which there are many, and of what is made of it.
const NOT_UNIQUE: &str = "not unique";

/// What to know of a number that is a component of a reaction, or made of some.
pub(crate) fn remark(ambiguous: bool) -> String {
    if ambiguous { NOT_UNIQUE } else { "" }.to_owned()
}

/// A named quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// Owner and component: `capsule.qw`, `riser.tension`.
    pub name: String,
    /// SI unit; empty for a pure number.
    pub unit: String,
    /// What to know of its numbers, `not unique`; mostly empty.
    pub remark: String,
}

impl Name {
    /// It as a column is headed in files: `riser.tension [N]`, `close.force.x [N; not unique]`.
    #[must_use]
    pub fn heading(&self) -> String {
        match (self.unit.as_str(), self.remark.as_str()) {
            ("", "") => self.name.clone(),
            (unit, "") => format!("{} [{unit}]", self.name),
            (unit, remark) => format!("{} [{unit}; {remark}]", self.name),
        }
    }

    pub(crate) fn new(owner: &str, component: &str, unit: &str) -> Self {
        let name = if component.is_empty() {
            owner.to_owned()
        } else {
            format!("{owner}.{component}")
        };
        Name {
            name,
            unit: unit.to_owned(),
            remark: String::new(),
        }
    }
}

/// What a body's position, attitude, velocity and angular velocity are called, as they are in the state of absolute coordinates.
fn body_words(scene: &Scene, layout: &Layout) -> [Vec<&'static str>; 4] {
    let along = |names: [&'static str; 3]| -> Vec<&str> {
        let moves = layout.directions.translations();
        moves.iter().map(|&k| names[k]).collect()
    };
    let attitude = match layout.directions.plane {
        Some(_) => vec!["angle"],
        None => vec!["qw", "qx", "qy", "qz"],
    };
    let turn = match (
        layout.directions.plane.map(Plane::normal),
        scene.angular_velocity,
    ) {
        (Some(normal), _) => vec![["omega_x", "omega_y", "omega_z"][normal]],
        (None, AngularVelocity::Body) => vec!["omega_body_x", "omega_body_y", "omega_body_z"],
        (None, AngularVelocity::World) => vec!["omega_world_x", "omega_world_y", "omega_world_z"],
    };
    [
        along(["x", "y", "z"]),
        attitude,
        along(["vx", "vy", "vz"]),
        turn,
    ]
}

/// The unit of the rate of what has this one: `m/s` of `m`, `rad` of `rad*s`.
pub(crate) fn a_second(unit: &str) -> String {
    match unit {
        "" => "1/s".to_owned(),
        unit => match (unit.strip_suffix("*s"), unit.strip_suffix("/s")) {
            (Some(of), _) => of.to_owned(),
            (None, Some(of)) => format!("{of}/s^2"),
            (None, None) => format!("{unit}/s"),
        },
    }
}

/// The coordinates of the state x = [q | v | z | s], in order: `capsule.x` … `capsule.qz`, `capsule.vx`, `capsule.omega_body_x`, `swivel.x`, ….
/// In the plane xz: `crank.x`, `crank.z`, `crank.angle` (about y, not periodic), `crank.vx`, `crank.vz`, `crank.omega_y`.
#[must_use]
pub fn state_names(scene: &Scene, layout: &Layout) -> Vec<Name> {
    let [places, attitude, speeds, turn] = body_words(scene, layout);
    let masses = || {
        let points = scene.points.iter().zip(&layout.points);
        points
            .filter(|(_, slots)| matches!(slots, PointSlots::Mass(_)))
            .map(|(point, _)| point.name.as_str())
    };
    let mut names = Vec::with_capacity(layout.nx());
    let mut list = |owner: &str, components: &[&str], unit: &str| {
        names.extend(
            components
                .iter()
                .map(|component| Name::new(owner, component, unit)),
        );
    };
    let joints = |speeds: bool| {
        let own = layout
            .joint_links()
            .flat_map(move |(_, link)| match speeds {
                false => link.slots.q..link.slots.q + link.coordinates,
                true => layout.nq + link.slots.v..layout.nq + link.slots.v + link.speeds,
            });
        own.filter_map(|index| layout.joint_number(scene, index))
    };
    let bodies = || {
        layout
            .own_bodies()
            .filter_map(|(body, _)| scene.bodies.get(body))
    };
    for body in bodies() {
        list(&body.name, &places, "m");
        list(
            &body.name,
            &attitude,
            layout.directions.plane.map_or("", |_| "rad"),
        );
    }
    joints(false).for_each(|(joint, name, unit)| list(joint_name(scene, joint), &[name], unit));
    masses().for_each(|point| list(point, &places, "m"));
    for body in bodies() {
        list(&body.name, &speeds, "m/s");
        list(&body.name, &turn, "rad/s");
    }
    joints(true).for_each(|(joint, name, unit)| list(joint_name(scene, joint), &[name], unit));
    masses().for_each(|point| list(point, &speeds, "m/s"));
    for node in layout.nodes.iter().filter(|node| node.z.is_some()) {
        list(node_name(scene, node.point), &["x", "y", "z"], "m");
    }
    for state in &scene.states {
        list(&state.name, &[""], &state.unit.text);
    }
    names
}

/// Of the bodies that joints of a tree carry, position, attitude and velocities, named as in absolute coordinates.
pub(crate) fn carried_names(scene: &Scene, layout: &Layout) -> Vec<Name> {
    let units = [
        "m",
        layout.directions.plane.map_or("", |_| "rad"),
        "m/s",
        "rad/s",
    ];
    let words = body_words(scene, layout);
    let bodies = scene.bodies.iter().zip(&layout.bodies);
    let carried = bodies.filter(|(_, own)| own.is_none());
    let names = carried.flat_map(|(body, _)| {
        let kinds = words.iter().zip(units);
        kinds.flat_map(move |(words, unit)| {
            let names = words.iter();
            names.map(move |word| Name::new(&body.name, word, unit))
        })
    });
    names.collect()
}

macro_rules! names {
    ($($(#[$doc:meta])* $name:ident: $list:ident or $none:literal;)*) => {$(
        $(#[$doc])*
        pub(crate) fn $name(scene: &Scene, index: usize) -> &str {
            scene.$list.get(index).map_or($none, |found| found.name.as_str())
        }
    )*};
}

names! {
    /// The name of a point.
    node_name: points or "point";
    /// The name of a line.
    line_name: lines or "line";
    /// The name of a joint.
    joint_name: joints or "joint";
    /// The name of a body.
    body_name: bodies or "body";
}

/// The name of a body, a point or a joint.
pub(crate) fn part_name(scene: &Scene, part: Part) -> &str {
    match part {
        Part::Body(body) => body_name(scene, body),
        Part::Point(point) => node_name(scene, point),
        Part::Joint(joint) | Part::Coordinates(joint) => joint_name(scene, joint),
    }
}

/// The name of a stop: `elbow.angle high stop`.
pub(crate) fn stop_name(scene: &Scene, layout: &Layout, stop: usize) -> String {
    let slots = layout.stops.get(stop);
    let named = slots.and_then(|slots| {
        let (joint, coordinate) = scene.coordinate(slots.joint, slots.coordinate)?;
        let side = slots.side.word();
        Some(format!("{}.{} {side} stop", joint.name, coordinate.name))
    });
    named.unwrap_or_else(|| format!("stop {stop}"))
}

/// The output that a column of all outputs belongs to.
pub(crate) fn output_name(scene: &Scene, column: usize) -> &str {
    let mut columns = 0;
    let own = scene.outputs.iter().find(|output| {
        columns += output.components;
        column < columns
    });
    own.map_or("", |output| &output.name)
}

/// The name of the input slot at an index of the list of inputs.
pub(crate) fn input_name(scene: &Scene, layout: &Layout, index: usize) -> String {
    let slots = layout
        .inputs
        .iter()
        .find(|slots| (slots.at..slots.at + slots.len).contains(&index));
    let name = slots.and_then(|slots| match slots.source {
        InputSource::Input(i) => Some(scene.inputs.get(i)?.name.clone()),
        InputSource::Load(i) => Some(scene.loads.get(i)?.name.clone()),
        InputSource::BodyGravity(i) => Some(format!("gravity at {}", body_name(scene, i))),
        InputSource::PointGravity(i) => Some(format!("gravity at {}", node_name(scene, i))),
    });
    name.unwrap_or_else(|| format!("input {index}"))
}
