//! Kernels of a model: blocks of its programs that do the same operations on the same pattern of numbers share one function.
//!
//! A program in blocks works on one list of numbers, in this order: the lists it reads, known numbers among its results, then one range a
//! block with what that block hands on. A kernel hears where its own range begins and where its *windows* begin: each window covers the numbers
//! it takes from one earlier range, or from one body's part of a list. Calls whose places advance evenly are a loop.

use std::collections::BTreeMap;

use mbd_scene::{Layout, PointSlots, Quantity};

use crate::equations::SceneEquations;
use crate::expression::Slot;
use crate::lists::{NumberList, ProgramArguments};
use crate::partition::{ProgramBlock, Shapes, partition};
use crate::program::{Operand, Program, Register};
use crate::solution::Solution;
use crate::strided::{RoundItem, StridedRun, strided_runs};
use crate::titles::titles;

/// The kernels of all programs of a model.
#[derive(Default)]
pub struct Kernels {
    /// Every kernel once.
    pub kernels: Vec<Kernel>,
    /// How each program calls them, in the order of [`SceneEquations::every_program`]; `None` if it stays one function.
    pub drivers: Vec<Option<KernelDriver>>,
    /// The quantities that are found together in one function, if there are such.
    pub solution: Option<Solution>,
}

/// One function for all blocks of a shape.
pub struct Kernel {
    /// Its name: the thing it works for, and what it does for it.
    pub name: String,
    /// The first program and block that has it.
    pub first: (usize, usize),
    /// What it takes.
    pub windows: Vec<Window>,
    /// How many blocks have it.
    pub users: usize,
    /// Whether its blocks differ in their known numbers, which are then arguments.
    pub tabled: bool,
}

/// Numbers that a block takes from one place.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Window {
    /// From the first number that is taken to the last.
    pub len: usize,
    /// Place in the window and index into [`ProgramBlock::given`] of each.
    pub given: Vec<(usize, usize)>,
}

/// Where the results of a program stand in its working list.
pub enum ResultPlaces {
    /// The place of each.
    All(Vec<usize>),
    /// Of a matrix, those that are not zero in every state: the key is a length; place in the result, place in the working list.
    Some(Vec<StridedRun>),
}

/// How a program calls its kernels.
pub struct KernelDriver {
    /// The program that its blocks are of, where that is the one of several quantities.
    pub shared: Option<Program>,
    /// Its blocks, in order.
    pub blocks: Vec<ProgramBlock>,
    /// The lists it reads and where each begins, in order.
    pub lists: Vec<(NumberList, usize)>,
    /// Known numbers among its results.
    pub kept: Vec<Register>,
    /// Where these begin.
    pub kept_at: usize,
    /// How many numbers it works on.
    pub work: usize,
    /// Its calls: the key is the kernel; places of its own range, then of its windows.
    pub calls: Vec<StridedRun>,
    /// Its results.
    pub results: ResultPlaces,
}

impl Kernels {
    /// Cuts the programs of a model and recognises what is alike.
    #[must_use]
    pub fn of(equations: &SceneEquations) -> Self {
        let programs: Vec<&Program> = equations.every_program().collect();
        let layout = &equations.layout;
        let mut sharing = Sharing {
            equations,
            owners: (0..layout.nx()).map(|i| owner(layout, i)).collect(),
            of_values: Vec::new(),
            shapes: Shapes::default(),
            kernels: Vec::new(),
            numbers: Vec::new(),
        };
        let solution = Solution::of(equations);
        let blocks = solution
            .as_ref()
            .filter(|solution| !solution.is_flat())
            .map(|solution| solution.partition(equations));
        let mut shared: Vec<usize> = Vec::new();
        let mut drivers: Vec<Option<KernelDriver>> = Vec::with_capacity(programs.len());
        for (index, program) in programs.iter().enumerate() {
            let member = solution
                .as_ref()
                .and_then(|s| Some((s, s.member(index)?.1)));
            drivers.push(match (member, &blocks) {
                (Some((solution, member)), Some(blocks)) => {
                    let needed =
                        |block: &&ProgramBlock| block.instructions.last() < Some(&member.end);
                    let blocks = blocks.iter().take_while(needed).cloned().collect();
                    let whole = solution.view(member);
                    let lists = ProgramArguments::of(program, layout).0;
                    let mut driver = sharing.driver(index, &whole, blocks, &mut shared);
                    // What a member does not read no result of its own depends on.
                    driver.lists.retain(|(group, _)| lists.contains(group));
                    driver.shared = Some(whole);
                    Some(driver)
                }
                (Some(_), None) => None,
                (None, _) => partition(program)
                    .map(|blocks| sharing.driver(index, program, blocks, &mut Vec::new())),
            });
        }
        let mut kernels = sharing.kernels;
        let titles = titles(equations, &kernels, &drivers);
        for (kernel, title) in kernels.iter_mut().zip(titles) {
            kernel.name = title;
        }
        let solution = solution.filter(Solution::is_flat);
        Kernels {
            kernels,
            drivers,
            solution,
        }
    }

    /// Operations of every function of the model: programs that stay whole, then kernels.
    #[must_use]
    pub fn lengths(&self, equations: &SceneEquations) -> Vec<usize> {
        let solution = self.solution.as_ref();
        let programs = equations.every_program().zip(&self.drivers).enumerate();
        let whole = programs
            .filter(|(_, (_, driver))| driver.is_none())
            .filter(|&(index, _)| solution.and_then(|s| s.member(index)).is_none())
            .map(|(_, (program, _))| program.instructions.len())
            .chain(solution.map(|solution| solution.program.instructions.len()));
        let blocks = self.kernels.iter().filter_map(|kernel| {
            let (program, block) = kernel.first;
            let driver = self.drivers.get(program)?.as_ref()?;
            Some(driver.blocks.get(block)?.instructions.len())
        });
        whole.chain(blocks).collect()
    }

    /// The length of the longest working list. Of a matrix that is found column by column it begins with the direction and with what does not depend on it.
    #[must_use]
    pub fn work(&self, equations: &SceneEquations) -> usize {
        let drivers = self.drivers.iter().flatten();
        let alone = drivers.map(|driver| driver.work);
        let values = self.drivers.iter().skip(equations.first_of_values());
        let values = values.zip(&equations.values);
        let before = values.filter_map(|(driver, (what, _))| {
            let matrix = equations.program(*what)?.by_column.as_ref()?;
            let known = matrix.columns.len() + matrix.values;
            Some(known + driver.as_ref().map_or(0, |driver| driver.work))
        });
        alone.chain(before).max().unwrap_or_default()
    }

    /// The length of the longest working list of four columns beside each other, of a matrix or of solutions by a factor; zero where none needs one.
    #[must_use]
    pub fn work_beside(&self, equations: &SceneEquations) -> usize {
        let programs = equations.programs.iter().zip(&self.drivers);
        let work = programs.filter_map(|((what, program), driver)| {
            let matrix = program.by_column.as_ref();
            let known = matrix.map(|own| own.columns.len() + own.values);
            let solves = *what == Quantity::Solve;
            let own = driver.as_ref().filter(|_| solves || known.is_some());
            own.map(|driver| driver.work).or(known)
        });
        work.max().unwrap_or_default()
    }
}

struct Sharing<'a> {
    equations: &'a SceneEquations,
    /// What each number of the state belongs to.
    owners: Vec<usize>,
    /// What each number belongs to that does not depend on the direction of the program at hand.
    of_values: Vec<usize>,
    shapes: Shapes,
    kernels: Vec<Kernel>,
    /// Per kernel, the known numbers of its first block.
    numbers: Vec<Vec<Operand>>,
}

impl Sharing<'_> {
    /// The driver of a program in `blocks`; the first of these have the kernels `shared`, which those of the others join.
    fn driver(
        &mut self,
        index: usize,
        program: &Program,
        blocks: Vec<ProgramBlock>,
        shared: &mut Vec<usize>,
    ) -> KernelDriver {
        let values = program.what.filter(|_| program.by_column.is_some());
        let values = values.and_then(|what| self.equations.values(what));
        self.of_values = values.map_or_else(Vec::new, |values| self.owners_of(values));
        let layout = &self.equations.layout;
        let mut lists = Vec::new();
        let mut begins: BTreeMap<NumberList, usize> = BTreeMap::new();
        let mut work = 0;
        for group in ProgramArguments::of(program, layout).0 {
            lists.push((group, work));
            begins.insert(group, work);
            work += group.len(self.equations, Some(program));
        }
        let kept_at = work;
        let first = program.constants.len() + program.slots.len();
        // Where each register is kept, and whose range that is.
        let mut places: Vec<Option<(RangeOwner, usize)>> = vec![None; program.registers()];
        for (&slot, place) in program
            .slots
            .iter()
            .zip(&mut places[program.constants.len()..])
        {
            let (group, item) = NumberList::of(slot, layout);
            let owner = RangeOwner::Item(group, self.item(slot));
            *place = begins.get(&group).map(|begin| (owner, begin + item));
        }
        let mut kept: Vec<Register> = Vec::new();
        for &(_, register) in &program.outputs {
            let place = &mut places[register.index()];
            if place.is_none() && matches!(program.operand(register), Operand::Constant(_)) {
                *place = Some((RangeOwner::Known, work));
                kept.push(register);
                work += 1;
            }
        }
        let mut calls: Vec<(usize, Vec<usize>)> = Vec::new();
        for (number, block) in blocks.iter().enumerate() {
            let (begins, windows) = windows(block, &places);
            let at = std::iter::once(work).chain(begins).collect();
            for &result in &block.results {
                let register = first + block.instructions[result];
                places[register] = Some((RangeOwner::Block(number), work));
                work += 1;
            }
            if number == shared.len() {
                shared.push(self.kernel(program, (index, number), block, windows));
            }
            calls.push((shared[number], at));
        }
        KernelDriver {
            shared: None,
            blocks,
            lists,
            kept,
            kept_at,
            work,
            calls: strided_runs(&calls),
            results: results(program, &places),
        }
    }

    /// The kernel of a block: a known one if there is one.
    fn kernel(
        &mut self,
        program: &Program,
        place: (usize, usize),
        block: &ProgramBlock,
        windows: Vec<Window>,
    ) -> usize {
        let constants = block.constants.iter();
        let numbers: Vec<Operand> = constants.map(|&c| program.operand(c)).collect();
        // Windows by their number and lengths, then the block: each says where it ends.
        let mut shape = vec![windows.len() as u32];
        for window in &windows {
            shape.push(window.len as u32);
            shape.push(window.given.len() as u32);
            for &(place, given) in &window.given {
                shape.push(place as u32);
                shape.push(given as u32);
            }
        }
        shape.extend_from_slice(&block.shape);
        let (known, new) = self.shapes.of(&shape);
        if new {
            self.kernels.push(Kernel {
                name: String::new(),
                first: place,
                windows,
                users: 1,
                tabled: false,
            });
            self.numbers.push(numbers);
        } else if let (Some(kernel), Some(earlier)) =
            (self.kernels.get_mut(known), self.numbers.get(known))
        {
            kernel.users += 1;
            kernel.tabled |= *earlier != numbers;
        }
        known
    }

    /// What the results of a program belong to: numbers from outside one by one, terms to the run of operations on one thing that they are from.
    fn owners_of(&self, values: &Program) -> Vec<usize> {
        let outside = values.slots.len();
        let mut runs = Vec::with_capacity(values.instructions.len());
        let (mut run, mut section) = (outside, None);
        for instruction in &values.instructions {
            run += usize::from(section != Some(instruction.section));
            section = Some(instruction.section);
            runs.push(run);
        }
        let outputs = values.outputs.iter();
        let owner = outputs.map(|&(_, register)| match values.operand(register) {
            Operand::Value(value) => runs.get(value).copied().unwrap_or_default(),
            _ => register.index(),
        });
        owner.collect()
    }

    /// What a number of a list belongs to, counted within the list.
    fn item(&self, slot: Slot) -> usize {
        let layout = &self.equations.layout;
        match slot {
            Slot::Time => 0,
            Slot::State(i) => self.owners.get(i).copied().unwrap_or_default(),
            Slot::Node(i) => i / 3,
            Slot::Effective(i) => match i.checked_sub(2 * layout.effective_lines) {
                Some(behind) => layout.effective_lines + behind / 3,
                None => i / 2,
            },
            Slot::Ends(i) => i / 6,
            Slot::Hold(i) | Slot::Param(i) | Slot::Turn { number: i, .. } => i,
            Slot::Origin { number, .. } => number / 3,
            Slot::Input(i) => layout.inputs.iter().filter(|slots| slots.at <= i).count(),
            Slot::Row(i) => layout.joints.iter().filter(|slots| slots.row <= i).count(),
            Slot::Motion(i) | Slot::Right { number: i, .. } => match i < layout.nv {
                true => self.owners.get(layout.nq + i).copied().unwrap_or_default(),
                false => self.item(Slot::Row(i - layout.nv)),
            },
            Slot::Factored(i) => i / 64,
            Slot::Direction(i) => i,
            Slot::Value(i) => self.of_values.get(i).copied().unwrap_or_default(),
            Slot::Derived(i) => self.equations.derived_section(i),
        }
    }
}

/// What a number of the state belongs to: how many bodies and points begin before it.
fn owner(layout: &Layout, index: usize) -> usize {
    if let Some(own) = index.checked_sub(layout.states()) {
        return layout.bodies.len() + layout.points.len() + 1 + own;
    }
    let bodies = layout.own_bodies().map(|(_, slots)| slots);
    let joints = layout.joint_links().map(|(_, link)| link.slots);
    let points = layout.points.iter().filter_map(|slots| match slots {
        PointSlots::Mass(slots) => Some(*slots),
        PointSlots::Node(_) => None,
    });
    let begins = bodies
        .chain(joints)
        .chain(points)
        .map(|slots| match index < layout.nq {
            true => slots.q,
            false => layout.nq + slots.v,
        });
    begins.filter(|&begin| begin <= index).count()
}

/// Whose range a number is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RangeOwner {
    Item(NumberList, usize),
    Known,
    Block(usize),
}

/// Where the windows of a block begin, and what they are.
fn windows(
    block: &ProgramBlock,
    places: &[Option<(RangeOwner, usize)>],
) -> (Vec<usize>, Vec<Window>) {
    let mut taken: Vec<(RangeOwner, Vec<(usize, usize)>)> = Vec::new();
    for (given, register) in block.given.iter().enumerate() {
        let Some((owner, place)) = places[register.index()] else {
            continue;
        };
        match taken.iter_mut().find(|(known, _)| *known == owner) {
            Some((_, from)) => from.push((place, given)),
            None => taken.push((owner, vec![(place, given)])),
        }
    }
    taken
        .into_iter()
        .map(|(_, mut from)| {
            from.sort_unstable();
            let begin = from.first().map_or(0, |&(place, _)| place);
            let end = from.last().map_or(0, |&(place, _)| place + 1);
            let given = from.into_iter().map(|(place, g)| (place - begin, g));
            let given = given.collect();
            let len = end - begin;
            (begin, Window { len, given })
        })
        .unzip()
}

fn results(program: &Program, places: &[Option<(RangeOwner, usize)>]) -> ResultPlaces {
    let outputs = program.outputs.iter();
    let found: Vec<(usize, usize)> = outputs
        .filter_map(|&(to, register)| Some((to, places[register.index()]?.1)))
        .collect();
    if found.iter().map(|&(to, _)| to).eq(0..program.len) {
        return ResultPlaces::All(found.into_iter().map(|(_, from)| from).collect());
    }
    let mut stretches: Vec<(usize, Vec<usize>)> = Vec::new();
    for (to, from) in found {
        match stretches.last_mut() {
            Some((len, at)) if at[0] + *len == to && at[1] + *len == from => *len += 1,
            _ => stretches.push((1, vec![to, from])),
        }
    }
    ResultPlaces::Some(strided_runs(&stretches))
}

impl KernelDriver {
    /// The program that its blocks are of, given the one that it is for.
    #[must_use]
    pub fn program<'a>(&'a self, own: &'a Program) -> &'a Program {
        self.shared.as_ref().unwrap_or(own)
    }

    /// The block that a call of a round is for.
    #[must_use]
    pub fn block(&self, run: &StridedRun, round: usize, item: usize) -> Option<&ProgramBlock> {
        self.blocks.get(run.start + round * run.items.len() + item)
    }

    /// Every item of its calls.
    pub fn items(&self) -> impl Iterator<Item = &RoundItem> {
        self.calls.iter().flat_map(|run| &run.items)
    }
}
