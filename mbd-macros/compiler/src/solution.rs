//! The constrained system is solved once: state derivative, multipliers and reactions share its elimination.

use mbd_scene::Quantity;

use crate::equations::SceneEquations;
use crate::partition::{FLAT, ProgramBlock, partition, partition_after};
use crate::program::Program;

/// Several quantities of a model as one program.
pub struct Solution {
    /// The lists of all members, one after another.
    pub program: Program,
    /// Its members.
    pub members: Vec<SolutionMember>,
}

/// A quantity that is found with others.
#[derive(Clone, Copy, Debug)]
pub struct SolutionMember {
    /// Its number in [`SceneEquations::every_program`].
    pub index: usize,
    /// What it is.
    pub what: Quantity,
    /// Where its list begins in the result.
    pub begin: usize,
    /// The length of its list.
    pub len: usize,
    /// How many of the first operations it needs at most.
    pub end: usize,
}

impl Solution {
    /// The quantities of a model that solve its constrained system; `None` if there are not two. A derivative that is short enough for one
    /// function stays alone where the others would make that too long.
    pub fn of(equations: &SceneEquations) -> Option<Self> {
        let [derivative, multipliers, reactions] = [
            Quantity::Derivative,
            Quantity::Multipliers,
            Quantity::Reactions,
        ];
        let all = Self::of_quantities(equations, &[derivative, multipliers, reactions])?;
        if all.is_flat() || equations.program(derivative).and_then(partition).is_some() {
            return Some(all);
        }
        Self::of_quantities(equations, &[multipliers, reactions])
    }

    fn of_quantities(equations: &SceneEquations, wanted: &[Quantity]) -> Option<Self> {
        let found = |&what: &Quantity| {
            let mut programs = equations.programs.iter().enumerate();
            programs.find(|(_, (known, program))| *known == what && !program.outputs.is_empty())
        };
        let found: Vec<_> = wanted.iter().filter_map(found).collect();
        if found.len() < 2 {
            return None;
        }
        let programs: Vec<&Program> = found.iter().map(|(_, (_, program))| program).collect();
        let (program, ends) = Program::merged(&programs);
        let mut begin = 0;
        let member =
            |(&(index, &(what, ref program)), end): (&(usize, &(Quantity, Program)), usize)| {
                begin += program.len;
                SolutionMember {
                    index,
                    what,
                    begin: begin - program.len,
                    len: program.len,
                    end,
                }
            };
        let members = found.iter().zip(ends).map(member).collect();
        Some(Solution { program, members })
    }

    /// Whether it is one function.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.program.operations() <= FLAT
    }

    /// Its blocks: those of its first member, the derivative if it is one, as that is cut alone, then those of the others.
    #[must_use]
    pub fn partition(&self, equations: &SceneEquations) -> Vec<ProgramBlock> {
        let first = self.members.first().map(|member| member.what);
        let first = first.and_then(|what| partition(equations.program(what)?));
        let cut = usize::from(first.is_some());
        let ends: Vec<usize> = self.members.iter().map(|member| member.end).collect();
        partition_after(&self.program, &first.unwrap_or_default(), &ends[cut..])
    }

    /// The member with this number in [`SceneEquations::every_program`], and its place among the members.
    pub fn member(&self, index: usize) -> Option<(usize, SolutionMember)> {
        let members = self.members.iter().copied().enumerate();
        members
            .into_iter()
            .find(|(_, member)| member.index == index)
    }

    /// The whole with the result of one member.
    #[must_use]
    pub fn view(&self, member: SolutionMember) -> Program {
        let own = member.begin..member.begin + member.len;
        let outputs = self.program.outputs.iter();
        Program {
            what: Some(member.what),
            outputs: outputs
                .filter(|(place, _)| own.contains(place))
                .map(|&(place, register)| (place - member.begin, register))
                .collect(),
            len: member.len,
            ..self.program.clone()
        }
    }
}
