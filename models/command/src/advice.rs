//! What a scene could do without: coordinates that cost less, and the plane in which it moves.
//!
//! A scene moves in a plane if the joints of its tree leave nothing else, and if bodies and points that nothing carries start in it and are
//! not accelerated out of it at random states there, whatever the inputs and the time.

use mbd_compiler::{Families, without_inertia};
use mbd_runtime::scene::random::SplitMix64;
use mbd_runtime::scene::{
    Arguments, Coordinates, Layout, Model, Plane, PointSlots, Quantity, Scene, Slots,
};
use mbd_runtime::{Generic, Options, Simulation};

use crate::run::{RunPlan, Settings};

/// Random states at which a scene is looked at.
const STATES: usize = 5;
/// Rounding of places and of accelerations, as a part of the largest of them.
const ROUNDING: f64 = 1e-9;

/// Sentences about what would cost less, for runs with these settings.
#[must_use]
pub fn advice(scene: &Scene, settings: &Settings) -> Vec<String> {
    if scene.joints.is_empty() {
        return Vec::new();
    }
    let mut told = Vec::new();
    let families = Families::count(scene);
    let cost = |families: Families, family| match family {
        Coordinates::Absolute => families.absolute,
        Coordinates::Relative => families.relative,
    };
    let own = cost(families, scene.coordinates);
    let instead = |setting: String, operations: usize| {
        format!("`{setting};` takes {operations} operations a step of RK4 instead of {own}")
    };
    let cheaper = families.cheaper();
    if cheaper != scene.coordinates && without_inertia(scene).is_empty() {
        let setting = format!("coordinates: {}", cheaper.word());
        told.push(instead(setting, cost(families, cheaper)));
    }
    if let Some(plane) = plane(scene, settings) {
        let flat = Families::count(&in_plane(scene, plane));
        let operations = cost(flat, scene.coordinates);
        if operations < own {
            let word = plane.word();
            let less = instead(format!("planar: {word}"), operations);
            told.push(format!(
                "this scene moves in the plane {word}: {less}; reactions across the plane are not told then"
            ));
        }
    }
    told
}

fn in_plane(scene: &Scene, plane: Plane) -> Scene {
    Scene {
        planar: Some(plane),
        ..scene.clone()
    }
}

/// The plane in which a scene in space moves; `None` where there is none, and of scenes with equilibrium points, which keep three coordinates.
fn plane(scene: &Scene, settings: &Settings) -> Option<Plane> {
    if scene.planar.is_some() {
        return None;
    }
    let relative = scene.in_coordinates(Coordinates::Relative);
    let model = Generic::<f64>::with_defaults(relative).ok()?;
    if !model.layout().nodes.is_empty() {
        return None;
    }
    let start = match RunPlan::new(model.scene(), settings) {
        Ok(plan) => plan.state,
        Err(_) => {
            let run = Simulation::new(&model, Options::rk4(1e-3)).ok()?;
            run.state().to_vec()
        }
    };
    let planes = [Plane::Xy, Plane::Yz, Plane::Xz].into_iter();
    let mut planes = planes.filter(|&plane| carries_in(&model, plane));
    planes.find(|&plane| starts_in(&model, &start, plane) && stays_in(&model, &start, plane))
}

/// Whether the joints close in a plane, and what the tree carries has no other freedom.
fn carries_in(model: &Generic<f64>, plane: Plane) -> bool {
    let flat = in_plane(model.scene(), plane);
    if !Layout::apart(&flat).is_empty() || !Layout::still(&flat).is_empty() {
        return false;
    }
    let carried = |layout: &Layout| -> Vec<(usize, usize)> {
        let links = layout.joint_links();
        links.map(|(joint, link)| (joint, link.speeds)).collect()
    };
    carried(&Layout::new(&flat)) == carried(model.layout())
}

/// Where bodies that float and points with mass are: whether they turn, and their place in q and v.
fn afloat(layout: &Layout) -> impl Iterator<Item = (bool, Slots)> + '_ {
    let bodies = layout.own_bodies().map(|(_, slots)| (true, slots));
    let points = layout.points.iter().filter_map(|point| match point {
        PointSlots::Mass(slots) => Some((false, *slots)),
        PointSlots::Node(_) => None,
    });
    bodies.chain(points)
}

/// The numbers of a state, or of its speeds, that are zero in a plane, of one that floats.
fn across(plane: Plane, turns: bool, place: Option<usize>, motion: usize) -> Vec<usize> {
    let normal = plane.normal();
    let within = move |first: usize| {
        (0..3)
            .filter(move |&axis| axis != normal)
            .map(move |axis| first + axis)
    };
    let mut all = vec![motion + normal];
    all.extend(place.map(|place| place + normal));
    if turns {
        all.extend(within(motion + 3));
        all.extend(place.into_iter().flat_map(|place| within(place + 4)));
    }
    all
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(1.0, |most: f64, x| most.max(x.abs()))
}

fn starts_in(model: &Generic<f64>, start: &[f64], plane: Plane) -> bool {
    let layout = model.layout();
    let none = ROUNDING * largest(start);
    afloat(layout).all(|(turns, slots)| {
        let numbers = across(plane, turns, Some(slots.q), layout.nq + slots.v);
        numbers.into_iter().all(|at| start[at].abs() <= none)
    })
}

/// Whether nothing that floats is accelerated out of the plane at random states in it.
fn stays_in(model: &Generic<f64>, start: &[f64], plane: Plane) -> bool {
    let layout = model.layout();
    let mut random = SplitMix64(1);
    let (mut work, mut rates) = (model.work(), vec![0.0; layout.nx()]);
    (0..STATES).all(|_| {
        let mut arguments = Arguments {
            time: 1.0 + random.number(),
            state: start[..layout.nx()]
                .iter()
                .map(|x| x + random.number())
                .collect(),
            hold: vec![0.0; layout.holds()],
            inputs: (0..layout.ni).map(|_| random.number()).collect(),
            ..Arguments::default()
        };
        let state = &mut arguments.state;
        for (turns, slots) in afloat(layout) {
            for at in across(plane, turns, Some(slots.q), layout.nq + slots.v) {
                state[at] = 0.0;
            }
        }
        for first in layout.quaternions() {
            let square: f64 = state[first..first + 4].iter().map(|x| x * x).sum();
            state[first..first + 4]
                .iter_mut()
                .for_each(|x| *x /= square.sqrt());
        }
        model.evaluate(Quantity::Derivative, &arguments.at(), &mut work, &mut rates);
        let none = ROUNDING * largest(&rates);
        rates.iter().all(|x| x.is_finite())
            && afloat(layout).all(|(turns, slots)| {
                let numbers = across(plane, turns, None, layout.nq + slots.v);
                numbers.into_iter().all(|at| rates[at].abs() <= none)
            })
    })
}

#[cfg(test)]
mod tests {
    use mbd_compiler::read_text;

    use super::*;

    fn told(items: &str) -> String {
        let text = format!("model Scene {{ {items} }}");
        let reading = read_text(&text);
        let scene = reading
            .scene
            .unwrap_or_else(|| panic!("{:?}", reading.errors));
        advice(&scene, &Settings::default()).join("; ")
    }

    /// Bars between hinges about y.
    const BARS: &str = "gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame left at [0.0, 0.1, 0.0] m, frame right at [1.0, 0.0, 0.0] m, frame hook at [0.5, 0.0, 1.0] m }
        body crank { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame a at [-0.15, 0.1, 0.0] m, frame b at [0.15, 0.0, 0.0] m }
        body rod { mass: 2 kg, inertia: diag(0.13, 0.12, 0.11) kg*m^2, frame a at [-0.45, 0.0, 0.05] m, frame b at [0.45, 0.0, 0.05] m }
        body rocker { mass: 1.5 kg, inertia: diag(0.08, 0.09, 0.1) kg*m^2, frame a at [-0.4, 0.0, 0.0] m, frame b at [0.4, 0.0, 0.0] m }
        point weight { mass: 0.3 kg, start at [1.1, 0.0, 0.2] m }
        joint one: hinge from world.left to crank.a { axis: y, start: -60 deg }
        joint two: hinge from crank.b to rod.a { axis: y }
        joint three: hinge from rod.b to rocker.b { axis: y }
        joint four: hinge from world.right to rocker.a { axis: y }
        line cord from rocker.b to weight { free_length: 0.4 m, stiffness: 30 N/m }";

    #[test]
    fn bars_on_parallel_hinges_move_in_a_plane() {
        for family in ["absolute", "relative"] {
            let told = told(&format!("coordinates: {family}; {BARS}"));
            assert!(
                told.contains("moves in the plane xz: `planar: xz;` takes "),
                "{told}"
            );
        }
    }

    #[test]
    fn what_leaves_the_plane_is_not_said_to_move_in_it() {
        for (from, to) in [
            ("start at [1.1, 0.0, 0.2]", "start at [1.1, 0.01, 0.2]"),
            (
                "two: hinge from crank.b to rod.a { axis: y }",
                "two: hinge from crank.b to rod.a { axis: [0.0, 1.0, 0.1] }",
            ),
            (
                "line cord",
                "load wind on weight = [0.0, 0.1, 0.0] * 1 N; line cord",
            ),
            (
                "line cord",
                "input push: force; load wind on weight = [0.0, push, 0.0]; line cord",
            ),
            ("-9.81] m/s^2", "-9.81] m/s^2; planar: xz"),
        ] {
            assert!(BARS.contains(from), "{from}");
            let text = BARS.replacen(from, to, 1);
            assert!(!told(&text).contains("moves in the plane"), "{to}");
        }
        // On bodies that hinges carry a load across the plane moves nothing.
        let load = BARS.replacen(
            "line cord",
            "load wind on rod = [0.0, 0.1, 0.0] * 1 N; line cord",
            1,
        );
        assert!(told(&load).contains("moves in the plane xz"));
    }

    #[test]
    fn the_cheaper_family_is_told() {
        let arm = "gravity: [0, 0, -9.81] m/s^2;
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
            body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
            joint p: hinge from world to a.top { axis: y }
            joint q: hinge from a.end to b.top { axis: x }";
        let told_of = |family: &str| told(&format!("coordinates: {family}; {arm}"));
        assert!(told_of("absolute").starts_with("`coordinates: relative;` takes "));
        assert_eq!(told_of("relative"), "");
    }
}
