//! Names and units of the numbers in a state, a list of inputs and a trajectory.

use mbd_scene::{AngularVelocity, InputSource, Layout, Plane, PointSlots, Scene};

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

/// The coordinates of the state x = [q | v | z], in order: `capsule.x` … `capsule.qz`, `capsule.vx`, `capsule.omega_body_x`, `swivel.x`, ….
/// In the plane xz: `crank.x`, `crank.z`, `crank.angle` (about y, not periodic), `crank.vx`, `crank.vz`, `crank.omega_y`.
#[must_use]
pub fn state_names(scene: &Scene, layout: &Layout) -> Vec<Name> {
    let moves = layout.directions.translations();
    let along =
        |names: [&'static str; 3]| -> Vec<&str> { moves.iter().map(|&k| names[k]).collect() };
    let (places, speeds) = (along(["x", "y", "z"]), along(["vx", "vy", "vz"]));
    let plane = layout.directions.plane.map(Plane::normal);
    let turn: &[&str] = match (plane, scene.angular_velocity) {
        (Some(0), _) => &["omega_x"],
        (Some(1), _) => &["omega_y"],
        (Some(_), _) => &["omega_z"],
        (None, AngularVelocity::Body) => &["omega_body_x", "omega_body_y", "omega_body_z"],
        (None, AngularVelocity::World) => &["omega_world_x", "omega_world_y", "omega_world_z"],
    };
    let attitude: (&[&str], &str) = match plane {
        Some(_) => (&["angle"], "rad"),
        None => (&["qw", "qx", "qy", "qz"], ""),
    };
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
    for body in &scene.bodies {
        list(&body.name, &places, "m");
        list(&body.name, attitude.0, attitude.1);
    }
    masses().for_each(|point| list(point, &places, "m"));
    for body in &scene.bodies {
        list(&body.name, &speeds, "m/s");
        list(&body.name, turn, "rad/s");
    }
    masses().for_each(|point| list(point, &speeds, "m/s"));
    for node in layout.nodes.iter().filter(|node| node.z.is_some()) {
        list(node_name(scene, node.point), &["x", "y", "z"], "m");
    }
    names
}

/// The name of a point.
pub(crate) fn node_name(scene: &Scene, point: usize) -> &str {
    scene
        .points
        .get(point)
        .map_or("point", |point| point.name.as_str())
}

/// The name of a line.
pub(crate) fn line_name(scene: &Scene, line: usize) -> &str {
    scene
        .lines
        .get(line)
        .map_or("line", |line| line.name.as_str())
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

/// The name of a joint.
pub(crate) fn joint_name(scene: &Scene, joint: usize) -> &str {
    scene
        .joints
        .get(joint)
        .map_or("joint", |joint| joint.name.as_str())
}

/// The name of the input slot at an index of the list of inputs.
pub(crate) fn input_name(scene: &Scene, layout: &Layout, index: usize) -> String {
    let slots = layout
        .inputs
        .iter()
        .find(|slots| (slots.at..slots.at + slots.len).contains(&index));
    let name = slots.and_then(|slots| match slots.source {
        InputSource::Input(i) => scene.inputs.get(i).map(|input| input.name.clone()),
        InputSource::Load(i) => scene.loads.get(i).map(|load| load.name.clone()),
        InputSource::BodyGravity(i) => scene
            .bodies
            .get(i)
            .map(|body| format!("gravity at {}", body.name)),
        InputSource::PointGravity(i) => scene
            .points
            .get(i)
            .map(|point| format!("gravity at {}", point.name)),
    });
    name.unwrap_or_else(|| format!("input {index}"))
}
