//! Joints, lines, springs and loads.

use std::fmt::Write;

use mbd_scene::joints::{FILTER, FORCE, MOTOR, NUMBERS, START, START_RATE, STOPS};
use mbd_scene::{Axis, Detachable, Dimension, Formula, Joint, JointLaw, Line, LoadKind, Scene};
use toml::Value;

use super::entries::{doc, entry, key, table};
use crate::resolve::letter;
use crate::syntax::words::{ABOUT, AT_START, LOCKED};
use crate::toml::formula::{place, text};
use crate::units;

pub(super) fn connections(out: &mut String, scene: &Scene) {
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
        for (field, formula) in [
            (&FORCE, forces.force.as_ref()),
            (&MOTOR, forces.declared_motor()),
        ] {
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
