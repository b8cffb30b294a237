//! A program: the terms of one quantity in the order they are computed, one operation each, nothing that is not needed.

use mbd_scene::{Cost, Quantity};

use crate::directional::MatrixColumns;
use crate::expression::{Expr, Graph, Label, Slot, Term, TermKind};
use crate::hash::FastMap;
use crate::operation::{Binary, Comparison, Fused, Op, Unary};
use crate::selection::Operations;

/// A place in the register file of a program: constants first, then slots, then one register an instruction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Register(pub u32);

impl Register {
    /// Its place in the file.
    #[must_use]
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// What it does to which registers.
    pub op: Op<Register>,
    /// The name the law gave to its value.
    pub name: Option<Label>,
    /// The body, line, node or variable it belongs to: index into [`Program::sections`].
    pub section: usize,
}

impl Instruction {
    /// Whether the law named this very value, and not its negative.
    #[must_use]
    pub fn is_named(&self) -> bool {
        self.name.is_some_and(|name| !name.opposite)
    }
}

/// The straight-line computation of one list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The quantity; `None` for the terms of the parameters alone.
    pub what: Option<Quantity>,
    /// Registers 0…: numbers known at build time.
    pub constants: Vec<f64>,
    /// The registers after them: numbers from outside, sorted.
    pub slots: Vec<Slot>,
    /// The registers after them: one operation each.
    pub instructions: Vec<Instruction>,
    /// Which register goes to which place of the result, by place.
    pub outputs: Vec<(usize, Register)>,
    /// Length of the result.
    pub len: usize,
    /// Of one that has a matrix column by column, what it is the columns of.
    pub by_column: Option<MatrixColumns>,
    /// Names of bodies, lines, nodes and variables.
    pub sections: Vec<String>,
    /// The instructions once more, for the interpreter.
    pub(crate) steps: Vec<FlatInstruction>,
}

/// An instruction as the interpreter reads it: one flat code, at most three registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FlatInstruction {
    pub code: Code,
    pub a: u32,
    pub b: u32,
    pub c: u32,
}

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    Add,
    Sub,
    Mul,
    Div,
    Neg,
    Sqrt,
    Min,
    Max,
    Abs,
    Sin,
    Cos,
    Exp,
    Ln,
    Tanh,
    Floor,
    Atan2,
    Fmadd,
    Fmsub,
    Fnmadd,
    /// `c` is the mask.
    Select,
    Lt,
    Le,
    Both,
}

impl FlatInstruction {
    fn new(op: Op<Register>) -> Self {
        let (code, a, b, c) = match op {
            Op::Unary(kind, a) => (
                match kind {
                    Unary::Neg => Code::Neg,
                    Unary::Sqrt => Code::Sqrt,
                    Unary::Sin => Code::Sin,
                    Unary::Cos => Code::Cos,
                    Unary::Exp => Code::Exp,
                    Unary::Ln => Code::Ln,
                    Unary::Tanh => Code::Tanh,
                    Unary::Floor => Code::Floor,
                    Unary::Abs => Code::Abs,
                },
                a,
                a,
                a,
            ),
            Op::Binary(kind, a, b) => (
                match kind {
                    Binary::Add => Code::Add,
                    Binary::Sub => Code::Sub,
                    Binary::Mul => Code::Mul,
                    Binary::Div => Code::Div,
                    Binary::Atan2 => Code::Atan2,
                    Binary::Min => Code::Min,
                    Binary::Max => Code::Max,
                },
                a,
                b,
                a,
            ),
            Op::Fused(kind, a, b, c) => (
                match kind {
                    Fused::Fmadd => Code::Fmadd,
                    Fused::Fmsub => Code::Fmsub,
                    Fused::Fnmadd => Code::Fnmadd,
                },
                a,
                b,
                c,
            ),
            Op::Compare(kind, a, b) => (
                match kind {
                    Comparison::Lt => Code::Lt,
                    Comparison::Le => Code::Le,
                    Comparison::Both => Code::Both,
                },
                a,
                b,
                a,
            ),
            Op::Select(mask, a, b) => (Code::Select, a, b, mask),
        };
        FlatInstruction {
            code,
            a: a.0,
            b: b.0,
            c: c.0,
        }
    }
}

/// What a register holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand {
    /// A number known at build time.
    Constant(f64),
    /// A number from outside.
    Slot(Slot),
    /// The value of an instruction, by index.
    Value(usize),
}

impl Program {
    /// Puts the terms that `outputs` need in order. `derived` says which terms of the parameters alone are already computed.
    #[must_use]
    pub fn build(
        graph: &Graph,
        what: Option<Quantity>,
        outputs: &[(usize, Expr)],
        len: usize,
        order: &[Term],
        derived: &TermPlaces,
    ) -> Self {
        let operations = Operations::new(graph, outputs, derived);
        let scheduled = schedule(graph, &operations, outputs, order);
        let mut constants: Vec<Expr> = Vec::new();
        let mut slots: Vec<(Slot, Expr)> = Vec::new();
        let mut entered = vec![false; graph.len()];
        let mut enter = |expr: Expr| {
            if std::mem::replace(&mut entered[expr.index()], true) {
                return;
            }
            match leaf(graph, expr, derived) {
                Some(Leaf::Constant) => constants.push(expr),
                Some(Leaf::Slot(slot)) => slots.push((slot, expr)),
                None => {}
            }
        };
        for term in &scheduled {
            if let Some(op) = operations.of(term.expr) {
                for argument in op.arguments() {
                    enter(argument);
                }
            }
        }
        outputs.iter().for_each(|&(_, expr)| enter(expr));
        slots.sort_unstable_by_key(|(slot, _)| *slot);

        let mut file = vec![0_u32; graph.len()];
        let mut count = 0;
        for &expr in &constants {
            file[expr.index()] = count;
            count += 1;
        }
        for &(_, expr) in &slots {
            file[expr.index()] = count;
            count += 1;
        }
        for term in &scheduled {
            file[term.expr.index()] = count;
            count += 1;
        }
        let registers = file.as_slice();
        let mut instructions = Vec::with_capacity(scheduled.len());
        for term in &scheduled {
            if let Some(op) = operations.of(term.expr) {
                instructions.push(Instruction {
                    op: op.map(|a| Register(registers[a.index()])),
                    name: operations.name(term.expr),
                    section: term.section,
                });
            }
        }
        let mut outputs: Vec<(usize, Register)> = outputs
            .iter()
            .map(|&(place, expr)| (place, Register(registers[expr.index()])))
            .collect();
        outputs.sort_unstable();
        Program {
            what,
            constants: constants
                .iter()
                .filter_map(|&expr| graph.constant(expr))
                .collect(),
            slots: slots.into_iter().map(|(slot, _)| slot).collect(),
            steps: instructions
                .iter()
                .map(|i| FlatInstruction::new(i.op))
                .collect(),
            instructions,
            outputs,
            len,
            by_column: None,
            sections: graph.sections().to_vec(),
        }
    }

    /// One program for the results of several, one list after another: what they share is computed once. The operations of the first come
    /// first, in their order. Also how many operations the first program, the first two, … have.
    #[must_use]
    pub fn merged(programs: &[&Program]) -> (Self, Vec<usize>) {
        let mut constants: Vec<f64> = Vec::new();
        let mut slots: Vec<Slot> = Vec::new();
        for program in programs {
            for &value in &program.constants {
                if !constants
                    .iter()
                    .any(|known| known.to_bits() == value.to_bits())
                {
                    constants.push(value);
                }
            }
            slots.extend(&program.slots);
        }
        slots.sort_unstable();
        slots.dedup();
        let first = constants.len() + slots.len();
        let mut instructions: Vec<Instruction> = Vec::new();
        let mut known: FastMap<Op<Register>, usize> = FastMap::default();
        let (mut outputs, mut len, mut ends) = (Vec::new(), 0, Vec::new());
        for program in programs {
            let mut registers: Vec<Register> = Vec::with_capacity(program.registers());
            let mut enter = |place: usize| registers.push(Register(place as u32));
            for value in &program.constants {
                let same = |known: &f64| known.to_bits() == value.to_bits();
                enter(constants.iter().position(same).unwrap_or_default());
            }
            for slot in &program.slots {
                enter(constants.len() + slots.binary_search(slot).unwrap_or_default());
            }
            for instruction in &program.instructions {
                let op = instruction.op.map(|r| registers[r.index()]);
                let place = *known.entry(op).or_insert_with(|| {
                    instructions.push(Instruction { op, ..*instruction });
                    instructions.len() - 1
                });
                registers.push(Register((first + place) as u32));
            }
            let own = program.outputs.iter();
            outputs.extend(own.map(|&(place, r)| (len + place, registers[r.index()])));
            len += program.len;
            ends.push(instructions.len());
        }
        let first = programs.first();
        let merged = Program {
            what: first.and_then(|program| program.what),
            constants,
            slots,
            steps: instructions
                .iter()
                .map(|i| FlatInstruction::new(i.op))
                .collect(),
            instructions,
            outputs,
            len,
            by_column: None,
            // Sections are those of the graph, the same for all.
            sections: first.map_or_else(Vec::new, |program| program.sections.clone()),
        };
        (merged, ends)
    }

    /// Length of the register file.
    #[must_use]
    pub fn registers(&self) -> usize {
        self.constants.len() + self.slots.len() + self.instructions.len()
    }

    /// What a register holds.
    #[must_use]
    pub fn operand(&self, register: Register) -> Operand {
        let mut index = register.index();
        if let Some(&value) = self.constants.get(index) {
            return Operand::Constant(value);
        }
        index -= self.constants.len();
        match self.slots.get(index) {
            Some(&slot) => Operand::Slot(slot),
            None => Operand::Value(index - self.slots.len()),
        }
    }

    /// How many operations it does, a product in a sum counted as two: what its length as code goes by.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.instructions.iter().map(|it| it.op.operations()).sum()
    }

    /// How many operations of each kind it takes. A product in a sum is one, and one in all where several read it.
    #[must_use]
    pub fn cost(&self) -> Cost {
        let mut cost = Cost::default();
        let mut products: FastMap<(Register, Register), ()> = FastMap::default();
        for instruction in &self.instructions {
            if let Op::Binary(Binary::Mul, a, b) | Op::Fused(_, a, b, _) = instruction.op
                && products.insert((a, b), ()).is_none()
            {
                cost.muls += 1;
            }
            match instruction.op {
                Op::Unary(Unary::Neg, _)
                | Op::Binary(Binary::Add | Binary::Sub, ..)
                | Op::Fused(..) => cost.adds += 1,
                Op::Binary(Binary::Mul, ..) => {}
                Op::Binary(Binary::Div, ..) => cost.divs += 1,
                Op::Unary(Unary::Sqrt, _) => cost.sqrts += 1,
                Op::Unary(Unary::Sin | Unary::Cos | Unary::Exp | Unary::Ln | Unary::Tanh, _)
                | Op::Binary(Binary::Atan2, ..) => cost.trigs += 1,
                Op::Unary(Unary::Abs | Unary::Floor, _)
                | Op::Binary(Binary::Min | Binary::Max, ..)
                | Op::Compare(..)
                | Op::Select(..) => cost.selects += 1,
            }
        }
        cost
    }
}

/// Terms that are already computed, and where.
pub struct TermPlaces {
    /// One more than the place of each term, zero for a term that is not among them.
    places: Vec<u32>,
    /// The number from outside at a place.
    slot: fn(usize) -> Slot,
}

impl Default for TermPlaces {
    fn default() -> Self {
        TermPlaces {
            places: Vec::new(),
            slot: Slot::Derived,
        }
    }
}

impl TermPlaces {
    /// Those of terms in their order, as numbers from outside.
    #[must_use]
    pub fn new(graph: &Graph, terms: &[Expr], slot: fn(usize) -> Slot) -> Self {
        let mut places = vec![0; graph.len()];
        for (index, expr) in terms.iter().enumerate() {
            places[expr.index()] = index as u32 + 1;
        }
        TermPlaces { places, slot }
    }

    /// The number from outside that a term is.
    pub(crate) fn of(&self, expr: Expr) -> Option<Slot> {
        match self.places.get(expr.index()) {
            None | Some(0) => None,
            Some(&place) => Some((self.slot)(place as usize - 1)),
        }
    }
}

enum Leaf {
    Constant,
    Slot(Slot),
}

/// What a term is when it need not be computed here.
fn leaf(graph: &Graph, expr: Expr, derived: &TermPlaces) -> Option<Leaf> {
    if let Some(slot) = derived.of(expr) {
        return Some(Leaf::Slot(slot));
    }
    match graph.node(expr) {
        TermKind::Constant(_) => Some(Leaf::Constant),
        TermKind::Slot(slot) => Some(Leaf::Slot(slot)),
        TermKind::Truth(_) | TermKind::Apply(_) => None,
    }
}

/// The operations that `outputs` need, in the order the law asked for them, arguments always before their use.
fn schedule(
    graph: &Graph,
    operations: &Operations<'_>,
    outputs: &[(usize, Expr)],
    order: &[Term],
) -> Vec<Term> {
    let needed = operations.needed(outputs);
    let mut sections = vec![0; graph.len()];
    for term in order {
        sections[term.expr.index()] = term.section;
    }
    // What must be computed and is not placed yet.
    let mut missing = needed;
    let (missing, sections) = (missing.as_mut_slice(), sections.as_slice());
    let mut scheduled = Vec::with_capacity(order.len());
    let mut open = Vec::new();
    let asked = order.iter().map(|term| term.expr);
    for root in asked.chain(outputs.iter().map(|&(_, expr)| expr)) {
        if !missing[root.index()] {
            continue;
        }
        open.push(root);
        while let Some(&expr) = open.last() {
            if !missing[expr.index()] {
                open.pop();
                continue;
            }
            let before = open.len();
            if let Some(op) = operations.of(expr) {
                for argument in op.arguments() {
                    if missing[argument.index()] {
                        open.push(argument);
                    }
                }
            }
            if open.len() == before {
                missing[expr.index()] = false;
                let section = sections[expr.index()];
                scheduled.push(Term { expr, section });
                open.pop();
            }
        }
    }
    scheduled
}
