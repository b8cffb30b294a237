//! What is chosen by counting: `coordinates: auto` takes the family of fewer operations, and nothing else changes; a tree is solved by the algorithm of fewer.

use mbd_compiler::{
    Families, SceneEquations, emit, lay_out, lay_out_factor, read_text, read_toml, write_toml,
};
use mbd_scene::{Coordinates, Layout, Quantity, Scene};

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

/// How rods are joined.
const KINDS: [&str; 7] = [
    "parallel",
    "crossed",
    "skew",
    "spherical",
    "universal",
    "cylindrical",
    "floating",
];

/// Rods on joints of a kind, each on the last one or (`branched`) on one before; `tip` is where a rod carries the next.
fn tree(rods: usize, kind: &str, tip: &str, branched: bool) -> Scene {
    let mut text =
        "model Tree { coordinates: relative; gravity: [0.0, 0.0, -9.81] m/s^2;".to_owned();
    for rod in 0..rods {
        let carries = match branched {
            true => rod / 2,
            false => rod.max(1) - 1,
        };
        let joint = match (kind, rod) {
            ("floating", 0) => "free from world to rod0.com;".to_owned(),
            (_, 0) => format!("{} from world to rod0.top", word(kind)),
            _ => format!("{} from rod{carries}.end to rod{rod}.top", word(kind)),
        };
        let along = ["x", "y"][rod % 2];
        let said = match (kind, rod) {
            ("floating", 0) => String::new(),
            ("spherical", _) => ";".to_owned(),
            ("universal", _) => "{ axes: [x, y] }".to_owned(),
            ("parallel", _) => "{ axis: y }".to_owned(),
            ("skew", _) => "{ axis: [0.3, 0.5, 0.8] }".to_owned(),
            _ => format!("{{ axis: {along} }}"),
        };
        text += &format!(
            "body rod{rod} {{ mass: 1 kg, inertia: diag(0.02, 0.03, 0.01) kg*m^2, frame top at [0.0, 0.0, 0.5] m, frame end at {tip} m }}
             joint pin{rod}: {joint}{said}"
        );
    }
    let reading = read_text(&(text + "}"));
    reading
        .scene
        .unwrap_or_else(|| panic!("{:?}", reading.errors))
}

fn word(kind: &str) -> &str {
    match kind {
        "spherical" | "universal" | "cylindrical" => kind,
        _ => "hinge",
    }
}

/// What a derivative of this layout takes.
fn operations(scene: &Scene, layout: Layout) -> usize {
    let equations = SceneEquations::trace_in(scene, layout, &[Quantity::Derivative]);
    let derivative = equations.program(Quantity::Derivative).expect("traced");
    derivative.cost().total()
}

#[test]
fn a_tree_is_accelerated_by_the_factor_of_its_mass_matrix_or_by_articulated_bodies_whichever_takes_fewer_operations()
 {
    let (mut trees, mut by_articulated_bodies, mut estimated) = (0, 0, 0.0);
    for kind in KINDS {
        for rods in [2, 3, 5, 7, 9, 12] {
            let tip = ["[0.0, 0.0, -0.5]", "[0.1, 0.2, -0.5]"][rods % 2];
            let scene = tree(rods, kind, tip, rods == 7);
            let [factor, articulated] = [false, true].map(|articulated| {
                let mut layout = Layout::new(&scene);
                layout.elimination.order.articulated = articulated;
                operations(&scene, layout)
            });
            let least = factor.min(articulated);
            let chosen = operations(&scene, lay_out(&scene));
            assert_eq!(
                chosen, least,
                "{rods} rods, {kind}: {factor} by the factor, {articulated} by articulated bodies"
            );
            trees += 1;
            by_articulated_bodies += usize::from(articulated < factor);
            estimated += operations(&scene, Layout::new(&scene)) as f64 / least as f64;
        }
    }
    assert!(
        2 * by_articulated_bodies > trees / 2 && by_articulated_bodies < trees - trees / 4,
        "{by_articulated_bodies} of {trees}"
    );
    // What is not compiled goes by an estimate.
    assert!(
        estimated / (trees as f64) < 1.03,
        "{}",
        estimated / trees as f64
    );
}

#[test]
fn derivatives_of_a_tree_are_solved_by_the_factor_of_fewer_operations() {
    let counted = |scene: &Scene, layout: Layout| {
        let solutions = 2 * layout.nv;
        let equations =
            SceneEquations::trace_in(scene, layout, &[Quantity::Factor, Quantity::Solve]);
        let cost = |what| equations.program(what).expect("traced").cost().total();
        cost(Quantity::Factor) + solutions * cost(Quantity::Solve)
    };
    let mut of_other = 0;
    for kind in KINDS {
        for rods in [4, 9, 14] {
            let scene = tree(rods, kind, "[0.0, 0.0, -0.5]", rods == 9);
            let layout = Layout::new(&scene);
            let Some(other) = layout.with_other_factor() else {
                continue;
            };
            let least = counted(&scene, layout.clone()).min(counted(&scene, other));
            let chosen = lay_out_factor(&scene, layout.clone());
            of_other += usize::from(chosen != layout);
            assert_eq!(counted(&scene, chosen), least, "{rods} rods, {kind}");
        }
    }
    assert!(of_other < 4, "the estimate was wrong {of_other} times");
}
