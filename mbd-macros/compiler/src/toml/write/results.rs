//! States, outputs, metrics and events.

use mbd_scene::metrics::Take;
use mbd_scene::{
    Actions, Detachable, Direction, Formula, Function, MapSource, Next, Output, Scene, Setting,
};

use super::entries::{doc, entry, inverse, table, unit, unit_word};
use crate::toml::formula::{number, place, text, vector};

pub(super) fn states(out: &mut String, scene: &Scene) {
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

pub(super) fn results(out: &mut String, scene: &Scene) {
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
        unit(out, &output.unit);
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

pub(super) fn metrics(out: &mut String, scene: &Scene) {
    for metric in &scene.runs.metrics {
        table(out, "metric", &metric.name);
        doc(out, &metric.doc);
        let output = metric.output.and_then(|output| scene.outputs.get(output));
        let event = metric.event.and_then(|event| scene.events.get(event));
        let event = event.map_or("", |event| event.name.as_str());
        let of = output.map_or(event.to_owned(), |output| output_value(output, scene));
        entry(out, "value", &format!("{} {of}", metric.take.keyword()));
        if let Some(output) = output {
            unit(out, &output.unit);
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
