//! `coordinates: auto`: the family that takes fewer operations, and nothing else changes.

use mbd_compiler::{Families, SceneEquations, emit, read_text, read_toml, write_toml};
use mbd_scene::{Coordinates, Quantity};

/// Rods hinged one below the other about y, x, y, …, in a family of coordinates.
fn chain(rods: usize, family: &str) -> String {
    let mut text = format!(
        "model Chain {{
            coordinates: {family};
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body rod[i in 0..{rods}] {{
                mass: 1 kg, inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
                frame top at [0.0, 0.0, 0.15] m, frame end at [0.0, 0.0, -0.15] m
            }}
            joint pin0: hinge from world to rod[0].top {{ axis: y }}"
    );
    for rod in 1..rods {
        let (before, axis) = (rod - 1, ["y", "x"][rod % 2]);
        text += &format!(
            "joint pin{rod}: hinge from rod[{before}].end to rod[{rod}].top {{ axis: {axis} }}"
        );
    }
    text + "}"
}

/// Bodies that float, each on two lines.
fn cloud(family: &str) -> String {
    format!(
        "model Cloud {{
            coordinates: {family};
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body stone[i in 0..3] {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.15) kg*m^2, frame hook at [0.1, 0.0, 0.2] m }}
            joint afloat[i in 0..3]: free from world to stone[i].com;
            spring cord[i in 0..3] from world to stone[i].hook {{ free_length: 1 m, stiffness: 20 N/m }}
        }}"
    )
}

/// The Rust of a declaration, but for the note that tells of the choice.
fn rust(text: &str) -> (Coordinates, Vec<String>, String) {
    let mut reading = read_text(text);
    assert!(reading.errors.is_empty(), "{:?}", reading.errors);
    let notes = std::mem::take(&mut reading.notes);
    let scene = reading.scene.as_ref().expect("a scene");
    (scene.coordinates, notes, emit(&reading).to_string())
}

#[test]
fn the_family_of_fewer_operations_is_taken_as_if_its_word_were_written() {
    for (text, want) in [
        (
            (|family| chain(3, family)) as fn(&str) -> String,
            Coordinates::Relative,
        ),
        (cloud, Coordinates::Absolute),
    ] {
        let (chosen, notes, found) = rust(&text("auto"));
        assert_eq!(chosen, want, "{notes:?}");
        assert!(notes[0].starts_with(&format!("coordinates: {}: ", want.word())));
        let (_, none, written) = rust(&text(want.word()));
        assert!(none.is_empty(), "{none:?}");
        assert!(found == written, "the code of both is the same");
    }
}

#[test]
fn what_is_counted_is_what_the_equations_of_both_families_take() {
    let scene = read_text(&chain(4, "auto")).scene.expect("a scene");
    let families = Families::count(&scene);
    let cost = |family, what| {
        let equations = SceneEquations::trace(&scene.in_coordinates(family));
        equations
            .program(what)
            .map_or(0, |program| program.cost().total())
    };
    let step = |family| {
        4 * cost(family, Quantity::Derivative) + 2 * cost(family, Quantity::ProjectionStep)
    };
    assert_eq!(families.absolute, step(Coordinates::Absolute));
    assert_eq!(families.relative, step(Coordinates::Relative));
    assert!(families.relative < families.absolute);
}

#[test]
fn text_and_toml_choose_alike_and_toml_is_written_with_the_choice() {
    let text = read_text(&chain(2, "auto"));
    let scene = text.scene.expect("a scene");
    let written = write_toml(&scene);
    assert!(written.contains("coordinates = \"relative\""), "{written}");
    let auto = written.replace("\"relative\"", "\"auto\"");
    let toml = read_toml(&auto);
    assert_eq!(toml.scene, Some(scene));
    assert_eq!(toml.notes, text.notes);
}
