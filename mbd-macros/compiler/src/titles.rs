//! Names of kernels and headings of their terms: the body, joint, line or variable they work for, and what they do for it, such as
//! `elbow_backward`.

use mbd_scene::Quantity;

use crate::emit::naming::Unique;
use crate::emit::quantity;
use crate::equations::SceneEquations;
use crate::kernels::{Kernel, KernelDriver};
use crate::names::identifier;
use crate::program::Program;

/// The name of every kernel, each different, and different from those of the model's functions.
pub fn titles(
    equations: &SceneEquations,
    kernels: &[Kernel],
    drivers: &[Option<KernelDriver>],
) -> Vec<String> {
    let programs: Vec<&Program> = equations.every_program().collect();
    let mut unique = Unique::default();
    let functions = functions(equations);
    for name in functions
        .iter()
        .map(String::as_str)
        .chain(["declared", "solution"])
    {
        unique.name(name);
    }
    let phases: Vec<Vec<String>> = programs
        .iter()
        .zip(drivers)
        .zip(&functions)
        .map(|((program, driver), function)| match driver {
            Some(driver) => phases(equations, driver.program(program), driver, function),
            None => Vec::new(),
        })
        .collect();
    let title = |kernel: &Kernel| {
        let (program, block) = kernel.first;
        let phase = phases.get(program).and_then(|phases| phases.get(block));
        unique.name(phase.map_or("kernel", String::as_str))
    };
    kernels.iter().map(title).collect()
}

/// The name of the function of every program, in the order of [`SceneEquations::every_program`].
fn functions(equations: &SceneEquations) -> Vec<String> {
    let name = |what: Quantity| quantity::name(&equations.scene, &equations.layout, what);
    let quantities = equations.programs.iter().map(|&(what, _)| name(what));
    let kinematics = equations.kinematics.iter();
    let others = [DERIVED].into_iter().chain(kinematics.map(|_| KINEMATICS));
    let values = equations.values.iter();
    let values = values.map(|&(what, _)| values_of(&name(what)));
    quantities
        .chain(others.map(str::to_owned))
        .chain(values)
        .collect()
}

/// The function of the terms of the parameters.
pub const DERIVED: &str = "derived";
/// The function of the rates of the coordinates.
pub const KINEMATICS: &str = "kinematics";

/// The function of what does not depend on the direction, of the function of a column.
pub fn values_of(function: &str) -> String {
    format!("{function}_values")
}

/// What a run of operations does for the thing it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperationPhase {
    /// Where a body or point is and how it moves.
    Motion,
    /// The rows of a joint.
    Rows,
    /// Length, stretch and tension of a line.
    Tension,
    /// The force of a load.
    Load,
    /// From the tips to the root: it is taken out of the system.
    Backward,
    /// From the root to the tips: its accelerations and forces are found.
    Forward,
    /// Something else.
    Other,
}

impl OperationPhase {
    /// Its part of a name.
    fn word(self) -> Option<&'static str> {
        match self {
            OperationPhase::Motion => Some("motion"),
            OperationPhase::Rows => Some("rows"),
            OperationPhase::Tension => Some("tension"),
            OperationPhase::Load => Some("load"),
            OperationPhase::Backward => Some("backward"),
            OperationPhase::Forward => Some("forward"),
            OperationPhase::Other => None,
        }
    }

    /// What it is called in a heading.
    fn heading(self) -> &'static str {
        match self {
            OperationPhase::Motion => ": where it is, how it moves",
            OperationPhase::Rows => ": rows",
            OperationPhase::Tension => ": length and tension",
            OperationPhase::Load => ": load",
            OperationPhase::Backward => ": backward, taken out of the system",
            OperationPhase::Forward => ": forward, what it does",
            OperationPhase::Other => "",
        }
    }
}

/// The phase of visit number `visit` of `all` that a program pays to a section. A solution comes to a thing up to three times: to see where it
/// is and what acts on it, backward from the tips to the root to take it out, and forward again. `before`: no joint has been come to yet, and one will
/// be, so that this is no solution even where there is no other visit: few terms may be done with others.
fn phase(
    equations: &SceneEquations,
    program: &Program,
    section: &str,
    (visit, before): ([usize; 2], bool),
) -> OperationPhase {
    let scene = &equations.scene;
    let solves = matches!(
        program.what,
        Some(
            Quantity::Derivative
                | Quantity::Multipliers
                | Quantity::Reactions
                | Quantity::ProjectionStep
        )
    );
    let moves = scene.bodies.iter().any(|body| body.name == section)
        || scene.points.iter().any(|point| point.name == section);
    let joint = scene.joints.iter().any(|joint| joint.name == section);
    match visit {
        _ if scene.loads.iter().any(|load| load.name == section) => OperationPhase::Load,
        [0, _] if joint => OperationPhase::Rows,
        [0, _] if scene.lines.iter().any(|line| line.name == section) => OperationPhase::Tension,
        [0, all] if moves && (all > 1 || before || !solves) => OperationPhase::Motion,
        _ if !solves || !(moves || joint) => OperationPhase::Other,
        [visit, all] if visit + 1 == all => OperationPhase::Forward,
        _ => OperationPhase::Backward,
    }
}

/// What each block of a program does.
fn phases(
    equations: &SceneEquations,
    program: &Program,
    driver: &KernelDriver,
    function: &str,
) -> Vec<String> {
    let blocks = driver.blocks.iter();
    let things: Vec<usize> = blocks
        .map(|block| busiest(program, &block.instructions))
        .collect();
    let name = |(&thing, visit): (&usize, ([usize; 2], bool))| {
        let section = program.sections.get(thing).map_or("", String::as_str);
        // A kernel of the state derivative is named after the phase, one of another quantity after the quantity.
        let phase = match program.what {
            Some(Quantity::Derivative) => phase(equations, program, section, visit).word(),
            _ => None,
        };
        let phase = phase.unwrap_or(function);
        // Kernels of a repetition are shared by its members.
        match section.split('[').next().unwrap_or_default() {
            "" => phase.to_owned(),
            family => format!("{}_{phase}", identifier(family)),
        }
    };
    let visits = visits(&things)
        .into_iter()
        .zip(before_joints(equations, program, &things));
    things.iter().zip(visits).map(name).collect()
}

/// A heading where the terms of another thing begin, for each of the instructions `indices` of a program: one that has a `let`.
pub fn headings(
    equations: &SceneEquations,
    program: &Program,
    indices: &[usize],
    lets: &[bool],
) -> Vec<Option<String>> {
    let mut headings = vec![None; indices.len()];
    let written = indices.iter().zip(lets).enumerate();
    let written: Vec<(usize, usize)> = written
        .filter(|&(_, (_, &has))| has)
        .map(|(at, (&index, _))| (at, program.instructions[index].section))
        .collect();
    let runs: Vec<&[(usize, usize)]> = written.chunk_by(|(_, a), (_, b)| a == b).collect();
    let runs: Vec<&[(usize, usize)]> = runs.into_iter().filter(|run| run.len() >= HEADED).collect();
    let things: Vec<usize> = runs.iter().map(|run| run[0].1).collect();
    let mut last = String::new();
    let before = before_joints(equations, program, &things);
    for (run, visit) in runs.iter().zip(visits(&things).into_iter().zip(before)) {
        let (at, thing) = run[0];
        let section = program.sections.get(thing).map_or("", String::as_str);
        if !section.is_empty() {
            let what = phase(equations, program, section, visit).heading();
            let heading = format!(" `{section}`{what}.");
            if last != heading {
                headings[at] = Some(heading.clone());
            }
            last = heading;
        }
    }
    headings
}

/// Fewer terms of a thing have no heading.
const HEADED: usize = 4;

/// The section that most of the instructions belong to, the first of those.
fn busiest(program: &Program, instructions: &[usize]) -> usize {
    let mut counts: Vec<(usize, usize)> = Vec::new();
    for &index in instructions {
        let section = program.instructions[index].section;
        match counts.iter_mut().find(|(known, _)| *known == section) {
            Some((_, count)) => *count += 1,
            None => counts.push((section, 1)),
        }
    }
    let most = counts.iter().map(|&(_, count)| count).max();
    let found = counts.iter().find(|&&(_, count)| Some(count) == most);
    found.map_or(0, |&(section, _)| section)
}

/// For each block, given the thing it works for, how many earlier visits to that thing there are, and how many in all. Blocks on one thing that
/// follow one another are one visit.
fn visits(things: &[usize]) -> Vec<[usize; 2]> {
    let mut counts = vec![0; things.iter().max().map_or(0, |most| most + 1)];
    let mut visits = Vec::with_capacity(things.len());
    let mut last = None;
    for &thing in things {
        if last != Some(thing) {
            counts[thing] += 1;
        }
        last = Some(thing);
        visits.push((thing, counts[thing] - 1));
    }
    let all = |(thing, visit): (usize, usize)| [visit, counts[thing]];
    visits.into_iter().map(all).collect()
}

/// For each block, given the thing it works for, whether none of the blocks so far works for a joint, and a later one does.
fn before_joints(
    equations: &SceneEquations,
    program: &Program,
    things: &[usize],
) -> impl Iterator<Item = bool> + use<> {
    let joint = |&thing: &usize| {
        let section = program.sections.get(thing);
        let mut joints = equations.scene.joints.iter();
        section.is_some_and(|name| joints.any(|joint| joint.name == *name))
    };
    let first = things.iter().position(joint).unwrap_or_default();
    (0..things.len()).map(move |block| block < first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_is_visited_again_after_another() {
        assert_eq!(
            visits(&[0, 0, 1, 0, 1, 2]),
            [[0, 2], [0, 2], [0, 2], [1, 2], [1, 2], [0, 1]]
        );
        assert!(visits(&[]).is_empty());
    }
}
