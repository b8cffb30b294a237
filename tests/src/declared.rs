//! Declarations read at run time, and what their equations cost.

use mbd_compiler::{SceneEquations, read_text};
use mbd_scene::{Cost, Quantity, Scene};

/// The scene of a declaration.
///
/// # Panics
/// With all messages, if the declaration has a mistake.
#[must_use]
pub fn read(text: &str) -> Scene {
    let reading = read_text(text);
    let errors: Vec<String> = reading.errors.iter().map(ToString::to_string).collect();
    reading
        .scene
        .unwrap_or_else(|| panic!("{}\n{text}", errors.join("\n")))
}

/// Operations of one quantity of a scene; none if the scene has no use for it.
#[must_use]
pub fn cost(scene: &Scene, what: Quantity) -> Cost {
    let equations = SceneEquations::trace(scene);
    equations
        .program(what)
        .map_or_else(Cost::default, mbd_compiler::Program::cost)
}

/// The terms of the parameters alone, computed once per set of parameters.
#[must_use]
pub fn derived_cost(scene: &Scene) -> Cost {
    SceneEquations::trace(scene).derived.cost()
}

/// A number of operations by kind, written as it is derived: additions, multiplications, divisions, roots, trigonometric, selections.
#[must_use]
pub fn operations([adds, muls, divs, sqrts, trigs, selects]: [usize; 6]) -> Cost {
    Cost {
        adds,
        muls,
        divs,
        sqrts,
        trigs,
        selects,
    }
}
