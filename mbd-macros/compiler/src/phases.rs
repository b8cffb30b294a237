//! Whether a scene can go on where an event of another one ends its run.

use mbd_scene::{Dimension, Layout, MapSource, Mapped, Part, Place, PointKind, Scene};

use crate::messages::resolve::fit as say;
use crate::messages::{Location, Message};
use crate::reading::Reading;

/// Something of a scene that begins with what the last one leaves.
enum Begins {
    Body,
    Point,
    Number(&'static str, Dimension),
}

/// What is wrong with the scene `next` as the one that goes on at a place of [`Reading::going`], by its number there. `placed` are the bodies and points
/// that the settings of its run place.
#[must_use]
pub fn misfits(reading: &Reading, going: usize, next: &Scene, placed: &[String]) -> Vec<Message> {
    let at = reading.going.get(going);
    let Some((scene, at)) = reading.scene.as_ref().zip(at) else {
        return Vec::new();
    };
    let event = scene.events.get(at.event);
    let Some(declared) = event.and_then(|event| event.actions.next.as_ref()) else {
        return Vec::new();
    };
    let mut found: Vec<Message> = Vec::new();
    let entries = declared.map.iter().zip(&at.map);
    found.extend(entries.filter_map(|(mapped, [name, value])| {
        let (text, is_value) = misfit(next, mapped)?;
        Some(Message::new(text, if is_value { *value } else { *name }))
    }));
    let whole = |text: String| Message::new(text, at.file);
    let axes = [
        (scene.planar != next.planar, "planar"),
        (
            scene.angular_velocity != next.angular_velocity,
            "angular_velocity",
        ),
    ];
    let other = axes.into_iter().filter(|(differs, _)| *differs);
    found.extend(other.map(|(_, what)| whole(say::axes(&next.name, what))));
    let mapped = |name: &str| declared.map.iter().any(|mapped| mapped.name == name);
    found.extend(unlike(scene, next, &mapped, at.file));
    let starts = |name: &str| mapped(name) || placed.iter().any(|known| known == name);
    let nowhere = unplaced(scene, next, &starts).into_iter();
    found.extend(nowhere.map(|(kind, name)| whole(say::nowhere(&next.name, kind, &name))));
    found
}

/// What an entry of a map begins in a scene.
fn begins(scene: &Scene, name: &str) -> Option<Begins> {
    let mut points = scene.points.iter();
    let mass = |kind: &PointKind| !matches!(kind, PointKind::Node(_));
    let state = scene.states.iter().find(|state| state.name == name);
    let param = scene.params.iter().find(|param| param.name == name);
    if scene.bodies.iter().any(|body| body.name == name) {
        Some(Begins::Body)
    } else if points.any(|point| point.name == name && mass(&point.kind)) {
        Some(Begins::Point)
    } else if let Some(state) = state {
        Some(Begins::Number("state", state.unit.dimension))
    } else {
        param.map(|param| Begins::Number("param", param.unit.dimension))
    }
}

/// What is wrong with an entry of a map, and whether with its value.
fn misfit(next: &Scene, mapped: &Mapped) -> Option<(String, bool)> {
    let (scene, name) = (next.name.as_str(), mapped.name.as_str());
    let Some(begins) = begins(next, name) else {
        let bodies = next.bodies.iter().map(|body| body.name.clone());
        let points = next.points.iter();
        let points = points.filter(|point| !matches!(point.kind, PointKind::Node(_)));
        let points = points.map(|point| point.name.clone());
        let states = next.states.iter().map(|state| state.name.clone());
        let params = next.params.iter().map(|param| param.name.clone());
        let known: Vec<String> = bodies.chain(points).chain(states).chain(params).collect();
        return Some((say::unknown(scene, name, &known), false));
    };
    let text = match (begins, &mapped.from) {
        (Begins::Body, MapSource::Value { .. }) => say::not_a_place(scene, name, "body"),
        (Begins::Point, MapSource::Value { .. }) => say::not_a_place(scene, name, "point"),
        (Begins::Body, MapSource::Place(Place::Point(_))) => say::without_axes(scene, name),
        (Begins::Number(kind, _), MapSource::Place(_)) => say::not_a_number(scene, name, kind),
        (
            Begins::Number(_, wanted),
            MapSource::Value {
                dimension: Some(found),
                ..
            },
        ) if wanted != *found => say::dimension(scene, name, wanted, *found),
        _ => return None,
    };
    Some((text, true))
}

/// States and inputs of the same name that measure something else.
fn unlike(
    scene: &Scene,
    next: &Scene,
    mapped: &dyn Fn(&str) -> bool,
    at: Location,
) -> Vec<Message> {
    let states = next.states.iter().filter_map(|new| {
        let old = scene.states.iter().find(|old| old.name == new.name)?;
        Some(("state", &new.name, [old.unit.dimension, new.unit.dimension]))
    });
    let inputs = next.inputs.iter().filter_map(|new| {
        let old = scene.inputs.iter().find(|old| old.name == new.name)?;
        Some(("input", &new.name, [old.unit.dimension, new.unit.dimension]))
    });
    let unlike = states
        .chain(inputs)
        .filter(|(kind, name, [old, new])| old != new && !(*kind == "state" && mapped(name)));
    unlike
        .map(|(kind, name, both)| {
            Message::new(say::same_name(&next.name, (kind, name.as_str()), both), at)
        })
        .collect()
}

/// Bodies and points of the next scene that have coordinates of their own and start nowhere.
fn unplaced(
    scene: &Scene,
    next: &Scene,
    starts: &dyn Fn(&str) -> bool,
) -> Vec<(&'static str, String)> {
    let layout = Layout::new(next);
    let declared = |part: Part| next.starts.parts.iter().any(|start| start.part == part);
    let bodies = layout.own_bodies().filter_map(|(body, _)| {
        let name = &next.bodies.get(body)?.name;
        let known = scene.bodies.iter().any(|old| old.name == *name);
        (!known && !declared(Part::Body(body))).then(|| ("body", name.clone()))
    });
    let points = next.points.iter().enumerate().filter_map(|(point, new)| {
        let has_mass = !matches!(new.kind, PointKind::Node(_));
        let same = |old: &mbd_scene::Point| {
            old.name == new.name && !matches!(old.kind, PointKind::Node(_))
        };
        let known = scene.points.iter().any(same);
        let nowhere = has_mass && !known && !declared(Part::Point(point));
        nowhere.then(|| ("point", new.name.clone()))
    });
    let all = bodies.chain(points);
    all.filter(|(_, name)| !starts(name)).collect()
}
