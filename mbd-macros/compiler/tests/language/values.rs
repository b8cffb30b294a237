//! Formulas and choices that a declaration leaves to the compiler.

use mbd_compiler::read_text;
use mbd_scene::{Formula, NodeModel, PointKind};

use super::{parachute, told};

#[test]
fn conditions_hold_together_or_one_of_them() {
    // What is an operand's truth is written as a comparison of numbers.
    let truth = |holds: bool| if holds { "1 < 2" } else { "2 <= 1" };
    let value = |condition: &str| {
        let text = format!(
            "model M {{ gravity: none; state s = 0 {{ rate: 0 /s }}
                const short = if({condition}, 1, 0); const long = if {condition} {{ 1 }} else {{ 0 }}; }}"
        );
        let scene = read_text(&text)
            .scene
            .unwrap_or_else(|| panic!("{condition}"));
        let [short, long] = [0, 1].map(|k| scene.consts[k].value.scalar().expect("a number"));
        assert_eq!(short, long, "{condition}");
        short == 1.0
    };
    for bits in 0..8 {
        let [p, q, r] = [1, 2, 4].map(|bit| bits & bit != 0);
        let [a, b, c] = [p, q, r].map(truth);
        assert_eq!(value(&format!("{a} && {b}")), p && q);
        assert_eq!(value(&format!("{a} || {b}")), p || q);
        assert_eq!(value(&format!("{a} || {b} && {c}")), p || q && r);
        assert_eq!(value(&format!("({a} || {b}) && {c}")), (p || q) && r);
        assert_eq!(value(&format!("(0 + 1) * 2 > 1 && ({a} || {b})")), p || q);
        let half = format!("(if {a} && {b} {{ 2 }} else {{ 0 }} + 0) / 2 >= 1");
        assert_eq!(value(&half), p && q);
    }
}

#[test]
fn the_remainder_lies_between_zero_and_the_divisor() {
    let path = format!("{}/tests/pass/remainder.mbd", env!("CARGO_MANIFEST_DIR"));
    let scene = read_text(&std::fs::read_to_string(path).unwrap())
        .scene
        .unwrap();
    let ends: Vec<_> = scene.lines.iter().map(|line| line.to).collect();
    let point = mbd_scene::Place::Point;
    assert_eq!(ends, [1, 2, 0, 2, 0, 1].map(point));
    let left = scene.consts.iter().find(|it| it.name == "left").unwrap();
    assert_eq!(left.value.scalar(), Some(2.0));
    assert_eq!(scene.outputs[1].value, mbd_scene::Formula::Number(4.0));
}

#[test]
fn numbers_and_consts_fold_and_params_stay_live() {
    let scene = read_text(&parachute()).scene.unwrap();
    let leg = &scene.lines[1];
    assert_eq!(leg.free_length, Formula::Const(0));
    assert_eq!(leg.stiffness, Formula::Number(47e3));
    assert_eq!(scene.lines[0].stiffness, Formula::Param(0));
    // Three frames on a circle, 120° apart: the second at (r cos 120°, r sin 120°, h).
    let [x, y, z] = &scene.bodies[1].frames[2].position;
    let angle: f64 = 120.0 * std::f64::consts::PI / 180.0;
    assert_eq!(*x, Formula::Number(0.55 * angle.cos()));
    assert_eq!(*y, Formula::Number(0.55 * angle.sin()));
    assert_eq!(*z, Formula::Number(1.23));
    // A quarter turn about z has true zeros: x to y, y to −x.
    let rows = scene.bodies[1].frames[4].rotation.clone().unwrap();
    let expected = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(rows, expected.map(|row| row.map(Formula::Number)));
}

#[test]
fn gravity_across_the_plane_of_a_scene_is_noted() {
    let noted = |gravity: &str| {
        let text = format!(
            "model Disc {{ planar: xy; gravity: {gravity}; body disc {{ mass: 1 kg, inertia: 1 kg*m^2 }} joint loose: free from world to disc.com; }}"
        );
        let read = read_text(&text);
        assert!(read.scene.is_some(), "{}", told(&read));
        read.notes.join("; ")
    };
    assert_eq!(
        noted("[0, 0, -9.81] m/s^2"),
        "gravity is along z, across the plane `xy`, which carries it: nothing falls in the plane"
    );
    for gravity in ["none", "[0, -9.81, 0] m/s^2", "[0, -5, -5] m/s^2"] {
        assert_eq!(noted(gravity), "", "{gravity}");
    }
}

/// The model of the point `p` where three legs and one riser meet, by the damping of the lines.
fn chosen(riser: &str, leg: &str, legs: usize) -> (NodeModel, String) {
    let text = format!(
        "model S {{ gravity: none; point p; point end {{ mass: 1.0 kg }}
         line riser from world to p {{ free_length: 1.0 m, stiffness: 1.0 kN/m{riser} }}
         line leg[i in 0..{legs}] from end to p {{ free_length: 1.0 m, stiffness: 1.0 kN/m{leg} }} }}"
    );
    let reading = read_text(&text);
    let scene = reading.scene.unwrap();
    match scene.points[0].kind {
        PointKind::Node(model) => (model, reading.notes.join("; ")),
        PointKind::Mass(_) => unreachable!(),
    }
}

#[test]
fn a_node_without_a_declared_model_gets_the_default_of_its_lines() {
    let damping = ", damping: 1.0 N*s/m";
    let (model, note) = chosen("", "", 3);
    assert_eq!(model, NodeModel::Static);
    assert_eq!(note, "point `p`: static (no damped line)");
    let (model, note) = chosen(damping, damping, 3);
    assert_eq!(model, NodeModel::Rate);
    assert_eq!(
        note,
        "point `p`: rate (4 lines, all damped, none to another massless point)"
    );
    let (model, note) = chosen(damping, damping, 2);
    assert!(matches!(model, NodeModel::Stepwise { .. }));
    assert_eq!(note, "point `p`: stepwise (3 of 3 lines damped)");
    let (model, _) = chosen(damping, "", 3);
    assert!(matches!(model, NodeModel::Stepwise { .. }));
}

#[test]
fn the_axis_of_a_planet_is_a_letter_or_a_vector() {
    let read = |axis: &str| {
        let text = format!(
            "model S {{ gravity: oblate {{ mu: 4e13 m^3/s^2, center: [0, 0, 0] m, radius: 3000 km, j2: 0.002, axis: {axis} }};
               point p {{ mass: 1 kg }} }}"
        );
        let reading = read_text(&text);
        assert!(reading.errors.is_empty(), "{:?}", reading.errors);
        reading.scene
    };
    assert_eq!(read("z"), read("[0, 0, 1]"));
    assert_eq!(read("-y"), read("[0, -1, 0]"));
}
