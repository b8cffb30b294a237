//! What is told of scenes.

use mbd_compiler::SceneEquations;
use mbd_report::ReportTable;
use mbd_runtime::scene::{
    Formula, Line, LineKind, Parameter, Place, Point, PointKind, Scene, Unit,
};

use super::*;

/// A point of 2 kg between two lines.
fn swing() -> Scene {
    let line = |name: &str| Line {
        name: name.into(),
        doc: String::new(),
        kind: LineKind::Line,
        from: Place::World(0),
        to: Place::Point(0),
        free_length: Formula::Number(1.5),
        stiffness: Formula::Param(0),
        damping: Formula::Number(0.0),
    };
    Scene {
        name: "Swing".into(),
        params: vec![Parameter {
            name: "k".into(),
            doc: " Stiffness of both lines.".into(),
            default: 47e3,
            range: Some([1e3, 1e6]),
            unit: Unit {
                text: "kN/m".into(),
                factor: 1e3,
                ..Unit::default()
            },
        }],
        points: vec![Point {
            name: "bob".into(),
            doc: String::new(),
            kind: PointKind::Mass(Formula::Number(2.0)),
        }],
        lines: vec![line("left"), line("right")],
        world_frames: vec![mbd_runtime::scene::Frame {
            name: "world".into(),
            position: [0.0; 3].map(Formula::Number),
            rotation: None,
        }],
        ..Scene::default()
    }
}

#[test]
fn a_scene_without_bodies_lists_none_and_shows_params_in_their_own_unit() {
    let text: Vec<String> = things(&swing()).iter().map(ReportTable::text).collect();
    let text = text.join("\n");
    assert!(!text.contains("Bodies"));
    assert!(
        text.contains("bob") && text.contains("point with mass") && text.contains("left, right")
    );
    assert!(text.contains("47.00") && text.contains("kN/m"));
    assert!(text.contains("47000"));
}

#[test]
fn a_point_and_two_lines_have_six_states() {
    let text = counts(&swing()).text();
    assert!(
        text.contains("coordinates q                                    3"),
        "{text}"
    );
    assert!(text.contains("gravity: none"));
}

#[test]
fn joints_are_listed_with_their_rows_and_freedoms_are_counted() {
    let link = |name: &str| {
        format!(
            "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame tip at [1, 0, 0] m }}"
        )
    };
    let text = format!(
        "model S {{ gravity: none; {} {}
         joint hip: hinge from world to a.com {{ axis: y }}
         joint knee: universal from a.tip to b.com {{ angle2: {{ damping: 0.25 N*m*s }} }} }}",
        link("a"),
        link("b")
    );
    let scene = mbd_compiler::read_text(&text).scene.unwrap_or_default();
    assert!(
        counts(&scene)
            .text()
            .contains("freedoms (Grübler): 6·2 + 3·0 − 9 = 3")
    );
    let tables: Vec<String> = things(&scene).iter().map(ReportTable::text).collect();
    let text = tables.join("\n");
    assert!(text.contains("knee") && text.contains("universal") && text.contains("a.tip"));
    assert!(text.contains("knee.angle2") && text.contains("0.25"));
}

#[test]
fn a_loop_of_parallel_hinges_counts_by_its_rank_and_names_what_repeats() {
    let link = |name: &str, x: f64, z: f64| {
        format!(
            "body {name} {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame one at [{x}, 0, {z}] m, frame two at [{}, 0, {}] m }}",
            -x, -z
        )
    };
    let text = format!(
        "model S {{ gravity: none; world {{ frame far at [2, 0, 0] m }} {} {} {}
         joint a: hinge from world to left.one {{ axis: y }}
         joint b: hinge from left.two to bar.one {{ axis: y }}
         joint c: hinge from bar.two to right.two {{ axis: y }}
         joint close: hinge from world.far to right.one {{ axis: y }}
         output pull = close.force; }}",
        link("left", 0.0, -0.5),
        link("bar", -1.0, 0.0),
        link("right", 0.0, -0.7)
    );
    let scene = mbd_compiler::read_text(&text).scene.unwrap_or_default();
    let text = counts(&scene).text();
    for part in [
        "freedoms (Grübler): 6·3 + 3·0 − 20 = -2; by the rank 17 of the rows: 1; loops: 1",
        "`close` repeats rows of `a`, `b`, `c`: 3 of 5",
        "output `pull` asks for the reaction of `close`, which is not unique",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let tables: Vec<String> = things(&scene).iter().map(ReportTable::text).collect();
    assert_eq!(tables.join("\n").matches("not unique").count(), 4);
}

#[test]
fn rows_of_motors_are_counted_beside_those_of_their_joints() {
    let text = "model S { gravity: none; body a { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
         joint hip: hinge from world to a.com { axis: y, motor: 1 rad/s * time } }";
    let scene = mbd_compiler::read_text(text).scene.unwrap_or_default();
    let tables: Vec<String> = things(&scene).iter().map(ReportTable::text).collect();
    let text = tables.join("\n");
    let row = text
        .lines()
        .find(|line| line.trim_start().starts_with("hip"));
    let cells: Vec<&str> = row.unwrap_or_default().split_whitespace().collect();
    // Freedoms, rows, of motors, kept.
    assert_eq!(
        cells.get(4..),
        Some(["1", "6", "1", "6"].as_slice()),
        "{text}"
    );
}

#[test]
fn every_quantity_of_a_scene_has_its_operations() {
    let text = operations(&SceneEquations::trace(&swing())).text();
    assert!(
        text.contains("derivative of the state")
            && text.contains("∂(derivative of the state)/∂(params)")
    );
}

#[test]
fn a_lock_that_an_event_may_set_takes_no_freedom_and_closes_no_loop_at_the_start() {
    for (family, speeds) in [
        ("absolute", "6·1 + 3·0 − 5"),
        ("relative", "tree and of points − 0"),
    ] {
        let reading = mbd_compiler::read_text(&format!(
            "model Latched {{ coordinates: {family};
                gravity: [0, 0, -9.81] m/s^2;
                body rod {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, frame top at [0, 0, 1] m }}
                joint pin: hinge from world to rod.top {{ axis: y, start: 30 deg }}
                event caught = pin.angle falls 0 deg {{ lock: pin }}
            }}"
        ));
        let text = counts(&reading.scene.expect("a scene")).text();
        assert!(text.contains(&format!("{speeds} = 1")), "{text}");
        assert!(
            text.contains("1 row more where events lock or attach"),
            "{text}"
        );
        let loops = text.lines().find(|line| line.contains("loops of joints"));
        assert!(
            loops.is_some_and(|line| line.trim_end().ends_with('0')),
            "{text}"
        );
    }
}
