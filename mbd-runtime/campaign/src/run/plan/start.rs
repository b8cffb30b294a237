//! The state at the start, from names of coordinates.

use mbd_compiler::ABOUT;
use mbd_runtime::scene::laws::starts;
use mbd_runtime::scene::{
    JointStart, Part, PartStart, PlacementError, PlacementReport, Scene, StartFrom, StartNumber,
    declared_parts, place_declared,
};
use mbd_runtime::{Layout, state_names};
use toml::{Table, Value};

use crate::run::mistakes::CampaignMistakes;
use crate::run::names::{PlanError, VECTORS, flat, state_name, unknown, wrong};
use crate::run::number::{number, numbers as numbers_of};

/// A state, the places of the equilibrium points where any is given, and the joint coordinates that are given.
pub(super) struct PlannedStart {
    pub(super) state: Vec<f64>,
    pub(super) nodes: Option<Vec<f64>>,
    pub(super) joints: Vec<(String, f64)>,
    pub(super) assembly: PlacementReport,
    pub(super) placed: Vec<String>,
    pub(super) moving: Vec<String>,
    pub(super) turning: Vec<String>,
}

/// What the settings say of the start, whatever the params are: numbers by their places in the state and behind it in those of equilibrium points, and joint
/// coordinates.
pub(super) struct SaidStart {
    /// All of it, in the numbers of the state.
    pub(super) given: Table,
    numbers: Vec<(usize, f64)>,
    joints: Vec<(String, StartNumber)>,
}

/// Reads what is said of the start, by names of coordinates.
pub(super) fn said(
    (scene, layout): (&Scene, &Layout),
    given: &Table,
) -> Result<SaidStart, CampaignMistakes> {
    let mut mistakes = CampaignMistakes::default();
    let given = in_numbers((scene, layout), given, &mut mistakes);
    let names = state_names(scene, layout).into_iter();
    let mut slots: Vec<(String, String)> = names.map(|name| (name.name, name.unit)).collect();
    for node in &layout.nodes {
        let owner = scene.points.get(node.point).map_or("", |point| &point.name);
        // The position of a `rate` node is part of the state already.
        let owner = if node.z.is_some() { "" } else { owner };
        slots.extend(["x", "y", "z"].map(|c| (format!("{owner}.{c}"), "m".to_owned())));
    }
    let (mut numbers, mut joints) = (Vec::new(), Vec::new());
    for (name, value) in flat(&given) {
        let setting = format!("start.{name}");
        if let Some(unit) = coordinate_unit(scene, &name) {
            let said = mistakes.note(start_number(scene, &setting, value, unit));
            joints.extend(said.map(|said| (name.clone(), said)));
            continue;
        }
        let Some(index) = slots.iter().position(|(slot, _)| *slot == name) else {
            if let Some(text) = carried((scene, layout), &name) {
                mistakes.note::<()>(Err(wrong(setting, text)));
                continue;
            }
            let known = slots.iter().map(|(slot, _)| slot.as_str());
            let known = known.filter(|slot| !slot.starts_with('.'));
            let coordinates = scene.joint_coordinates();
            let known = known.chain(coordinates.iter().map(String::as_str));
            mistakes.note::<()>(Err(unknown(&setting, &name, known)));
            continue;
        };
        let number = mistakes.note(number(&setting, value, &slots[index].1));
        numbers.extend(number.map(|number| (index, number)));
    }
    mistakes.unless(Some(SaidStart {
        given,
        numbers,
        joints,
    }))
}

/// The state and the places of the equilibrium points, from what is said of them.
pub(super) fn start(
    (scene, layout): (&Scene, &Layout),
    from: StartFrom<'_>,
    said: SaidStart,
) -> Result<PlannedStart, PlanError> {
    let placed = placed(scene, &said.given);
    let mut numbers = vec![0.0; layout.nx()];
    for upright in layout.quaternions() {
        numbers[upright] = 1.0;
    }
    declared_parts(scene, layout, from, &mut numbers);
    let fixed: Vec<Part> = placed
        .iter()
        .filter_map(|name| scene.part_named(name))
        .collect();
    if !fixed.is_empty() {
        // Of a body of which one number is given, the others are as declared. Loops that nothing closes yet are closed below, or told there.
        let mut alone = numbers.clone();
        if place_declared(scene, layout, from, &[], &[], &mut alone).is_ok() {
            numbers = alone;
        }
    }
    let own = numbers.iter_mut().skip(layout.states());
    own.zip(starts(scene, from.params))
        .for_each(|(number, start)| *number = start);
    let of_state = numbers.len();
    numbers.resize(of_state + 3 * layout.nodes.len(), 0.0);
    for (index, number) in &said.numbers {
        numbers[*index] = *number;
    }
    let places_given = said.numbers.iter().any(|(index, _)| *index >= of_state);
    let nodes = numbers.split_off(of_state);
    for quaternion in layout.quaternions() {
        normalise(scene, &mut numbers, quaternion)?;
    }
    let joints = said.joints;
    let named = joints.iter().map(|(name, number)| (name.as_str(), *number));
    let starts = JointStart::by_name(scene, named)
        .map_err(|name| wrong(format!("start.{name}"), "is no joint coordinate"))?;
    let assembly = place_declared(scene, layout, from, &starts, &fixed, &mut numbers)
        .map_err(|error| misplaced(scene, error))?;
    let joints = joints.into_iter().map(|(name, said)| (name, said.number()));
    let placed = with_declared(scene, &said.given, placed);
    let [moving, turning] = in_motion(scene, &said.given, &placed);
    Ok(PlannedStart {
        state: numbers,
        nodes: places_given.then_some(nodes),
        joints: joints.collect(),
        assembly,
        placed,
        moving,
        turning,
    })
}

/// What is said of where a body starts that the joints of a tree carry: it has no numbers of its own in the state.
fn carried((scene, layout): (&Scene, &Layout), name: &str) -> Option<String> {
    let (owner, number) = name.rsplit_once('.')?;
    let part = scene.part_named(owner)?;
    let of_body = ["x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz"];
    let asked = of_body.contains(&number) || number.starts_with("omega");
    if !asked || !matches!(part, Part::Body(_)) || layout.own_slots(part).is_some() {
        return None;
    }
    let joints = scene.joints.iter().zip(&layout.joints).enumerate();
    let own = joints.filter(|(_, (_, slots))| slots.ends.contains(&Some(part)));
    let coordinates = own.flat_map(|(joint, (declared, _))| {
        let own = 0..declared.law.measured().count();
        own.map(move |coordinate| format!("`{}`", scene.coordinate_name(joint, coordinate)))
    });
    let coordinates: Vec<String> = coordinates.collect();
    let joints = match coordinates.is_empty() {
        true => String::new(),
        false => format!(", {}", coordinates.join(", ")),
    };
    Some(format!(
        "in relative coordinates `{owner}` is where its joints carry it: say where these start{joints}, give `{owner}` a `start at` among its fields, or take `coordinates: absolute;`"
    ))
}

/// A start in the numbers of the state: `bob.velocity = "[1, 0, 0] m/s"` is `bob.vx`, `bob.vy` and `bob.vz`, and `bob.velocity.x` is `bob.vx`. A zero across
/// the plane of a scene is no number of its state.
fn in_numbers(
    (scene, layout): (&Scene, &Layout),
    given: &Table,
    mistakes: &mut CampaignMistakes,
) -> Table {
    let known = state_names(scene, layout);
    let across = |name: &str, number: f64| {
        let has = known.iter().any(|known| known.name == name);
        layout.directions.plane.is_some() && number == 0.0 && !has
    };
    // A component goes before the vector that it is one of.
    let (mut vectors, mut all) = (Table::new(), Table::new());
    let mut add = |name: String, value: Value| match all.insert(name.clone(), value) {
        None => Ok(()),
        Some(_) => Err(wrong(format!("start.{name}"), "is given twice")),
    };
    for (name, value) in flat(given) {
        let (owner, last) = name.rsplit_once('.').unwrap_or(("", &name));
        let found = |word: &str| VECTORS.into_iter().find(|(quantity, ..)| *quantity == word);
        if let (Some((_, prefix, unit)), false) = (found(last), owner.is_empty()) {
            let given = numbers_of(&format!("start.{name}"), value, &[unit; 3]);
            let given = mistakes.note(given).unwrap_or_default();
            for (axis, number) in ["x", "y", "z"].into_iter().zip(given) {
                let name = format!("{owner}.{prefix}{axis}");
                if !across(&name, number) {
                    vectors.insert(name, Value::String(format!("{number:?} {unit}")));
                }
            }
            continue;
        }
        let name = match state_name(&name) {
            Some(name) => name,
            None => whole_name(scene, name),
        };
        mistakes.note(add(name, value.clone()));
    }
    for (name, value) in vectors {
        all.entry(name).or_insert(value);
    }
    all
}

/// A start that can be used, by the names that the state and the joints have for its numbers.
pub(crate) fn in_state_numbers(scene: (&Scene, &Layout), given: &Table) -> Table {
    in_numbers(scene, given, &mut CampaignMistakes::default())
}

/// A joint coordinate by its whole name, `pin.angle` for `pin`; any other name as it is.
pub(crate) fn whole_name(scene: &Scene, name: String) -> String {
    match scene.joint_coordinate(&name) {
        Some((joint, number, false)) => scene.coordinate_name(joint, number),
        _ => name,
    }
}

/// What is said of a joint coordinate or its rate: a number, or `"about 30 deg"` of a coordinate.
fn start_number(
    scene: &Scene,
    setting: &str,
    value: &Value,
    unit: &str,
) -> Result<StartNumber, PlanError> {
    let Some(text) = value.as_str().and_then(about) else {
        return number(setting, value, unit).map(StartNumber::Exact);
    };
    let name = setting.strip_prefix("start.").unwrap_or(setting);
    if matches!(scene.joint_coordinate(name), Some((.., true))) {
        let text =
            "is a rate, and `about` is said of coordinates: give its number alone, or leave it out";
        return Err(wrong(setting, text));
    }
    number(setting, &Value::String(text.to_owned()), unit).map(StartNumber::About)
}

/// What stands behind `about`; `None` of a text that does not begin so.
pub(crate) fn about(text: &str) -> Option<&str> {
    let rest = text.trim_start().strip_prefix(ABOUT)?;
    rest.starts_with(char::is_whitespace).then(|| rest.trim())
}

/// The unit of a joint coordinate, `pin.angle`, or of its rate, `pin.angle_rate`; `None` of another name.
pub(crate) fn coordinate_unit(scene: &Scene, name: &str) -> Option<&'static str> {
    let (joint, number, is_rate) = scene.joint_coordinate(name)?;
    let (_, coordinate) = scene.coordinate(joint, number)?;
    Some(match (is_rate, coordinate.is_angle()) {
        (false, true) => "rad",
        (false, false) => "m",
        (true, true) => "rad/s",
        (true, false) => "m/s",
    })
}

fn misplaced(scene: &Scene, error: PlacementError) -> PlanError {
    let (name, why) = error.describe(scene);
    wrong("start", format!("joint `{name}` {why}"))
}

/// The bodies and points whose coordinates are given.
fn placed(scene: &Scene, given: &Table) -> Vec<String> {
    let names = flat(given).into_iter();
    let names = names.filter(|(name, _)| scene.joint_coordinate(name).is_none());
    let owners = names.filter_map(|(name, _)| Some(name.rsplit_once('.')?.0.to_owned()));
    let mut owners: Vec<String> = owners.collect();
    owners.dedup();
    owners
}

/// Those and the bodies and points that the declaration puts somewhere, unless joint coordinates are given, which go before.
fn with_declared(scene: &Scene, given: &Table, mut placed: Vec<String>) -> Vec<String> {
    let mut names = flat(given).into_iter();
    if names.any(|(name, _)| scene.joint_coordinate(&name).is_some()) {
        return placed;
    }
    for start in &scene.starts.parts {
        let name = match start.part {
            Part::Body(body) => scene.bodies.get(body).map(|body| &body.name),
            Part::Point(point) => scene.points.get(point).map(|point| &point.name),
            _ => None,
        };
        placed.extend(name.filter(|name| !placed.contains(name)).cloned());
    }
    placed
}

/// Of the bodies and points that are placed those whose velocity is said, and those whose angular velocity is, by the settings or by the declaration.
fn in_motion(scene: &Scene, given: &Table, placed: &[String]) -> [Vec<String>; 2] {
    let given = flat(given);
    let said = |name: &str, prefix: &str, declared: fn(&PartStart) -> bool| {
        let set = given.iter().any(|(key, _)| {
            let own = key.strip_prefix(name).and_then(|key| key.strip_prefix('.'));
            own.is_some_and(|slot| slot.starts_with(prefix))
        });
        let of = |start: &&PartStart| Some(start.part) == scene.part_named(name) && declared(start);
        set || scene.starts.parts.iter().any(|start| of(&start))
    };
    let all = |prefix: &str, declared: fn(&PartStart) -> bool| {
        let said = placed.iter().filter(|name| said(name, prefix, declared));
        said.cloned().collect()
    };
    [
        all("v", |start| start.velocity.is_some()),
        all("omega", |start| start.angular_velocity.is_some()),
    ]
}

/// Makes a quaternion a unit one; it needs a direction for that.
fn normalise(scene: &Scene, numbers: &mut [f64], at: usize) -> Result<(), PlanError> {
    let Some(quaternion) = numbers.get_mut(at..at + 4) else {
        return Ok(());
    };
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length.is_finite() && length > 1e-6) {
        let layout = Layout::new(scene);
        let name = state_names(scene, &layout)
            .into_iter()
            .nth(at)
            .map_or_else(String::new, |name| name.name);
        return Err(wrong(
            format!("start.{name}"),
            "qw, qx, qy, qz of this body must not all vanish",
        ));
    }
    quaternion.iter_mut().for_each(|x| *x /= length);
    Ok(())
}
