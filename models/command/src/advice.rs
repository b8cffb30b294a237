//! What a scene could do without: coordinates that cost less, and the plane in which it moves.

use mbd_compiler::{Families, plane_of_motion, without_inertia};
use mbd_runtime::scene::{Coordinates, Plane, Scene};

use crate::run::{RunPlan, Settings};

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

/// The plane in which a scene in space moves, with these settings, too.
fn plane(scene: &Scene, settings: &Settings) -> Option<Plane> {
    let space = scene.planar.is_none();
    let plane = space.then(|| plane_of_motion(scene).ok()).flatten()?;
    // Who gives a start of something that a plane does not have, wants it.
    let is_in_reach = |scene: &Scene| RunPlan::new(scene, settings).is_ok();
    (is_in_reach(&in_plane(scene, plane)) || !is_in_reach(scene)).then_some(plane)
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
