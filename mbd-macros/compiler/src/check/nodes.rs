//! Models of massless points: the default where none is declared, and what each model forbids.

use mbd_scene::{
    Clamp, Difference, Formula, Layout, LineEnd, LoadKind, Network, NodeModel, Place, PointKind,
    Redundancy,
};

use crate::messages::check as say;
use crate::resolve::{Named, Resolver, fold};

/// Gives every massless point without a declared model its default, network by network, and notes the choice:
/// all lines undamped: `static`; one node with at least four lines, all damped: `rate`; otherwise `stepwise`.
/// Where a point of the network has a declared model, the others take it.
pub fn choose_models(resolver: &mut Resolver<'_>) {
    if resolver.any_bad("line") {
        return;
    }
    let layout = Layout::keeping(&resolver.scene, Redundancy::default());
    for network in &layout.networks {
        let points = points(network, &layout);
        let declared = points
            .iter()
            .find(|point| resolver.chosen.contains(point))
            .and_then(|&point| model(resolver, point));
        let (chosen, reason) = match declared {
            Some(model) => (model, "as the points it is joined to".to_string()),
            None => default_model(resolver, network),
        };
        for point in points {
            if resolver.chosen.contains(&point) {
                continue;
            }
            if let Some(entry) = resolver.scene.points.get_mut(point) {
                entry.kind = PointKind::Node(chosen);
                let word = word(chosen);
                let note = format!("point `{}`: {word} ({reason})", entry.name);
                resolver.notes.push(note);
            }
        }
    }
}

/// The points of a network.
fn points(network: &Network, layout: &Layout) -> Vec<usize> {
    network
        .nodes
        .iter()
        .filter_map(|&node| layout.nodes.get(node).map(|node| node.point))
        .collect()
}

fn model(resolver: &Resolver<'_>, point: usize) -> Option<NodeModel> {
    match resolver.scene.points.get(point)?.kind {
        PointKind::Node(model) => Some(model),
        PointKind::Mass(_) => None,
    }
}

fn default_model(resolver: &Resolver<'_>, network: &Network) -> (NodeModel, String) {
    let damped = network
        .lines
        .iter()
        .filter(|&&line| is_damped(resolver, line))
        .count();
    let count = network.lines.len();
    if damped == 0 {
        return (NodeModel::Static, "no damped line".to_string());
    }
    if damped == count && count >= 4 && network.nodes.len() == 1 {
        let reason = format!("{count} lines, all damped, none to another massless point");
        return (NodeModel::Rate, reason);
    }
    let reason = if network.nodes.len() > 1 {
        "damped, joined to other massless points".to_string()
    } else {
        format!("{damped} of {count} lines damped")
    };
    let model = NodeModel::Stepwise {
        formula: Difference::default(),
        clamp: Clamp::default(),
    };
    (model, reason)
}

/// Whether a line has damping, with params at their defaults.
fn is_damped(resolver: &Resolver<'_>, line: usize) -> bool {
    resolver.scene.lines.get(line).is_some_and(|line| {
        fold::at_defaults(&line.damping, &resolver.scene).is_none_or(|c| c > 0.0)
    })
}

fn word(model: NodeModel) -> &'static str {
    match model {
        NodeModel::Static => "static",
        NodeModel::Stepwise { .. } => "stepwise",
        NodeModel::Rate => "rate",
    }
}

/// What the models forbid.
pub fn check_models(resolver: &mut Resolver<'_>) {
    if resolver.any_bad("line") || resolver.any_bad("point") {
        return;
    }
    let layout = Layout::keeping(&resolver.scene, Redundancy::default());
    for network in &layout.networks {
        check_one_model(resolver, network, &layout);
        for &node in &network.nodes {
            check_node(resolver, node, &layout);
        }
    }
    check_rates(resolver, &layout);
}

/// The velocity of a node without damping is asked for only where the rates of the loads of its network are told.
fn check_rates(resolver: &mut Resolver<'_>, layout: &Layout) {
    let scene = &resolver.scene;
    let mut found = Vec::new();
    for (asked, at) in &resolver.rates_asked {
        let ends = match *asked {
            Formula::StretchRate(line) => scene.lines.get(line).map(|line| [line.from, line.to]),
            Formula::Velocity(place) => Some([place; 2]),
            _ => None,
        };
        let node = ends.into_iter().flatten().find_map(|place| match place {
            Place::Point(point) => layout.nodes.iter().find(|node| node.point == point),
            _ => None,
        });
        // Others have a velocity of their own.
        let Some(node) = node.filter(|node| node.z.is_none() && node.velocity.is_none()) else {
            continue;
        };
        let network = layout.networks.get(node.network);
        let network = network.map_or_else(Vec::new, |network| points(network, layout));
        let load = scene.loads.iter().find(|load| {
            let acts = matches!(load.at, Place::Point(point) if network.contains(&point));
            matches!(&load.kind, LoadKind::Force(force) if acts && !scene.tells_load_rate(force))
        });
        let point = scene.points.get(node.point);
        if let (Some(load), Some(point)) = (load, point) {
            found.push(say::untold_load_rate(*at, &point.name, &load.name));
        }
    }
    for report in found {
        resolver.messages.push(report);
    }
}

/// Nodes that are solved together have one model.
fn check_one_model(resolver: &mut Resolver<'_>, network: &Network, layout: &Layout) {
    let points = points(network, layout);
    let Some((&first, rest)) = points.split_first() else {
        return;
    };
    for &point in rest {
        if model(resolver, point) == model(resolver, first) {
            continue;
        }
        let (declared, scene) = (&resolver.declared, &resolver.scene);
        if let (Some(&at), Some(&before), Some(this), Some(other)) = (
            declared.get(&Named::Point(point)),
            declared.get(&Named::Point(first)),
            scene.points.get(point),
            scene.points.get(first),
        ) {
            let report = say::mixed_models(at, &this.name, &other.name, before);
            resolver.messages.push(report);
        }
    }
}

fn check_node(resolver: &mut Resolver<'_>, node: usize, layout: &Layout) {
    let Some(node_slots) = layout.nodes.get(node) else {
        return;
    };
    let point = node_slots.point;
    let (Some(model), Some(&at)) = (
        model(resolver, point),
        resolver.declared.get(&Named::Point(point)),
    ) else {
        return;
    };
    let Some(name) = resolver.scene.points.get(point).map(|p| p.name.clone()) else {
        return;
    };
    for &line in &node_slots.lines {
        let Some(line_name) = resolver.scene.lines.get(line).map(|l| l.name.clone()) else {
            continue;
        };
        let damped = is_damped(resolver, line);
        match model {
            NodeModel::Static if damped => {
                let report = say::dropped_damping(at, &name, &line_name);
                resolver.warnings.push(report);
            }
            NodeModel::Rate if !damped => {
                let report = say::rate_undamped(at, &name, &line_name);
                resolver.messages.push(report);
            }
            NodeModel::Rate => {
                if let Some(other) = other_node(layout, line, node) {
                    let point = layout.nodes.get(other).map(|node| node.point);
                    let other = point.and_then(|point| resolver.scene.points.get(point));
                    let other = other.map(|p| p.name.clone()).unwrap_or_default();
                    let report = say::rate_tied(at, &name, &other);
                    resolver.messages.push(report);
                }
            }
            _ => {}
        }
    }
}

/// The node at the other end of a line.
fn other_node(layout: &Layout, line: usize, node: usize) -> Option<usize> {
    let ends = layout.lines.get(line)?.ends;
    ends.into_iter().find_map(|end| match end {
        LineEnd::Node(other) if other != node => Some(other),
        _ => None,
    })
}
