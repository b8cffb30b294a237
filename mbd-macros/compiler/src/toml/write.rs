//! A scene as a TOML document that reads back as the same scene.

use std::fmt::Write;

use mbd_scene::{AngularVelocity, Fixed, Gravity, Part, Scene, Unit};

use super::formula::{number, text, vector};
use crate::units;

mod bodies;
mod entries;
mod joints;
mod results;

use bodies::bodies;
use entries::{doc, entry, inverse, table, unit, unit_word, with_unit};
pub(super) use entries::{key, quoted};
use joints::connections;
use results::{metrics, results, states};

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

/// Named expressions. Those of a document may stand anywhere; here they follow what they are made of.
fn lets(out: &mut String, scene: &Scene) {
    for named in &scene.lets {
        table(out, "let", &named.name);
        doc(out, &named.doc);
        entry(out, "value", &text(&named.value, scene));
        unit(out, &named.unit);
    }
}
