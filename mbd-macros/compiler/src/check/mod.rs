//! Checking: what is wrong with the scene as a whole, and the choices the declaration leaves open.
//!
//! A check runs when everything it looks at was resolved, so that one mistake is told once.

mod attached;
mod carried;
mod complete;
mod inertia;
mod lone;
mod nodes;
mod planar;
mod unused;
mod winding;

pub use carried::without_inertia;
pub use inertia::{WrongInertia, inertia, moments_of_a_body, moments_of_a_part};
pub use winding::wound_by_themselves;

use mbd_scene::{Place, PointKind};

use crate::describe;
use crate::messages::check as say;
use crate::resolve::{Named, Resolver};
use crate::syntax::ModelSyntax;

/// Runs all checks; `whole`: no item was lost in reading, so that each must have come somewhere.
pub fn check(resolver: &mut Resolver<'_>, model: &ModelSyntax<'_>, whole: bool) {
    if whole {
        complete::check_complete(resolver, model);
    }
    check_not_empty(resolver);
    attached::check_attached(resolver);
    attached::check_marks(resolver);
    check_line_ends(resolver);
    check_lonely_points(resolver);
    lone::check_lone_indices(resolver);
    nodes::choose_models(resolver);
    nodes::check_models(resolver);
    planar::check_planar(resolver);
    carried::check_carried(resolver);
    unused::check_used(resolver, model);
}

fn check_not_empty(resolver: &mut Resolver<'_>) {
    let scene = &resolver.scene;
    let nothing = scene.bodies.is_empty() && scene.points.is_empty() && scene.states.is_empty();
    if nothing && resolver.whole && resolver.messages.is_empty() {
        let report = say::empty(resolver.head, &resolver.scene.name);
        resolver.messages.push(report);
    }
}

/// A line joins two different things, and ends at no node that its law cannot hold.
fn check_line_ends(resolver: &mut Resolver<'_>) {
    let scene = &resolver.scene;
    for (index, line) in scene.lines.iter().enumerate() {
        let named = Named::Line(index);
        let Some(&at) = resolver.declared.get(&named) else {
            continue;
        };
        if resolver.bad.contains(&named) {
            continue;
        }
        let kind = line.kind.word();
        let report = match (line.from, line.to) {
            (from, to) if from == to => Some(say::same_ends(
                at,
                kind,
                &line.name,
                &describe::place(scene, from),
            )),
            (Place::World(_), Place::World(_)) => {
                Some(say::one_body(at, kind, &line.name, "the world"))
            }
            (Place::Body(a, _), Place::Body(b, _)) if a == b => {
                let owner = scene
                    .bodies
                    .get(a)
                    .map(|body| format!("body `{}`", body.name));
                Some(say::one_body(
                    at,
                    kind,
                    &line.name,
                    &owner.unwrap_or_default(),
                ))
            }
            _ => None,
        };
        if let Some(report) = report {
            resolver.messages.push(report);
        }
        if let Some(why) = line.kind.not_at_node() {
            for place in [line.from, line.to] {
                if resolver.scene.is_node(place) {
                    let point = describe::place(scene, place);
                    let report = say::line_at_node(at, kind, &line.name, &point, why);
                    resolver.messages.push(report);
                }
            }
        }
    }
}

fn check_lonely_points(resolver: &mut Resolver<'_>) {
    if resolver.any_bad("line") {
        return;
    }
    let mut others = vec![Vec::new(); resolver.scene.points.len()];
    for line in &resolver.scene.lines {
        for (place, other) in [(line.from, line.to), (line.to, line.from)] {
            if let Place::Point(point) = place
                && let Some(others) = others.get_mut(point)
            {
                others.push(other);
            }
        }
    }
    let loads = &resolver.scene.loads;
    for (index, point) in resolver.scene.points.iter().enumerate() {
        let named = Named::Point(index);
        let others: &[Place] = others.get(index).map_or(&[], Vec::as_slice);
        let lines = others.len();
        let node = matches!(point.kind, PointKind::Node(_));
        let at = resolver.declared.get(&named).copied();
        let (Some(at), true) = (at, node && !resolver.bad.contains(&named)) else {
            continue;
        };
        let pulled =
            resolver.any_bad("load") || loads.iter().any(|load| load.at == Place::Point(index));
        match others {
            [first, rest @ ..] if !rest.is_empty() => {
                if !pulled && rest.iter().all(|other| other == first) {
                    let place = describe::place(&resolver.scene, *first);
                    let report = say::undecided_point(at, &point.name, &place);
                    resolver.warnings.push(report);
                }
            }
            _ => resolver.messages.push(say::lonely(at, &point.name, lines)),
        }
    }
}
