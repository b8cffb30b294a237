//! `coordinates: auto`: the family of coordinates in which a step takes fewer operations.
//!
//! Both families are traced, as for code that is emitted, as far as a step runs them: an RK4 step evaluates the derivative four times, and where joints
//! have rows it projects places and speeds on them.

use std::fmt;

use mbd_scene::{Coordinates, Quantity, Scene};

use crate::equations::{SceneEquations, lay_out};

/// Derivatives and projections of a step.
const STEP: [(Quantity, usize); 2] = [(Quantity::Derivative, 4), (Quantity::ProjectionStep, 2)];

/// What a step takes in each family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Families {
    /// Operations of an RK4 step in absolute coordinates.
    pub absolute: usize,
    /// Operations of an RK4 step in relative coordinates.
    pub relative: usize,
}

impl Families {
    /// Counts both families of a scene.
    #[must_use]
    pub fn count(scene: &Scene) -> Self {
        let operations = |family| {
            let scene = scene.in_coordinates(family);
            let layout = lay_out(&scene);
            let quantities = layout.quantities();
            let step: Vec<(Quantity, usize)> = STEP
                .into_iter()
                .filter(|(what, _)| quantities.contains(what))
                .collect();
            let wanted: Vec<Quantity> = step.iter().map(|&(what, _)| what).collect();
            let equations = SceneEquations::trace_in(&scene, layout, &wanted);
            let programs = equations.programs.iter();
            let each = programs.map(|(what, program)| {
                let times = step.iter().find(|(known, _)| known == what);
                times.map_or(0, |(_, times)| times * program.cost().total())
            });
            each.sum()
        };
        Families {
            absolute: operations(Coordinates::Absolute),
            relative: operations(Coordinates::Relative),
        }
    }

    /// The family that takes fewer operations; absolute coordinates where both take as many.
    #[must_use]
    pub fn cheaper(self) -> Coordinates {
        match self.relative < self.absolute {
            true => Coordinates::Relative,
            false => Coordinates::Absolute,
        }
    }
}

impl fmt::Display for Families {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Families { absolute, relative } = self;
        let projections = "(four derivatives, and two projections where joints have rows)";
        write!(
            f,
            "a step of RK4 takes {absolute} operations in absolute and {relative} in relative coordinates {projections}"
        )
    }
}
