//! Bodies, points and frames, where they start, and their shapes.

use std::fmt::Write;

use mbd_scene::solids::Solid;
use mbd_scene::{
    Body, Clamp, Difference, Formula, Frame, Inertia, NodeModel, Part, PointKind, Scene, Triple,
};

use super::entries::{doc, entry, key, table};
use crate::toml::formula::{text, vector};

pub(super) fn bodies(out: &mut String, scene: &Scene) {
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
