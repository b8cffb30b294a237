//! Symbols: a scalar that records what a law does with it.
//!
//! An [`Expr`] is an index into a graph that belongs to the current thread. Equal operations on equal arguments are the same node, so
//! running a law on symbols shares every common term by itself. Each node is simplified when it is made; sums and products are never
//! re-associated, so the value keeps the rounding of the law as written (signs apart, which are exact).

mod always;
mod scalar;

use std::cell::RefCell;
use std::collections::HashMap;

use self::always::Always;
use crate::hash::WordPairs;
use crate::operation::{Binary, Op, Unary};

/// A number that enters an evaluation from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Slot {
    /// Time.
    Time,
    /// A number of the state x = [q | v | z].
    State(usize),
    /// A node unknown.
    Node(usize),
    /// An effective stiffness or free length.
    Effective(usize),
    /// The hold flag of a line.
    Hold(usize),
    /// A number of the anchors' list.
    Ends(usize),
    /// An input.
    Input(usize),
    /// The last value of an angle whose turns are counted.
    Turn {
        /// Which of them.
        number: usize,
        /// Where it stands behind the modes.
        at: usize,
    },
    /// A number of how the origin moves.
    Origin {
        /// Which of them.
        number: usize,
        /// Where it stands behind the modes.
        at: usize,
    },
    /// A right-hand side of a row.
    Row(usize),
    /// An acceleration or a multiplier at which a residual is asked for.
    Motion(usize),
    /// A number of the factor of the system.
    Factored(usize),
    /// A number of a right-hand side to be solved by the factor.
    Right {
        /// Which of them.
        number: usize,
        /// Where it stands behind the factor.
        at: usize,
    },
    /// A number of the direction in which is differentiated.
    Direction(usize),
    /// A number that does not depend on that direction.
    Value(usize),
    /// A live parameter.
    Param(usize),
    /// A term of the parameters alone, computed once per set of parameters.
    Derived(usize),
}

/// A symbol: a term of the current graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Expr(u32);

/// A symbol that holds or does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mask(Expr);

/// What a term is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TermKind {
    /// A number, by its bits.
    Constant(u64),
    /// A mask known beforehand.
    Truth(bool),
    /// A number from outside.
    Slot(Slot),
    /// An operation on earlier terms.
    Apply(Op<Expr>),
}

/// The name a law gave to a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// The name.
    pub text: &'static str,
    /// Whether it is the name of the negative: signs move out of products and sums.
    pub opposite: bool,
}

/// All terms of a trace, in the order of their creation; the first is the number zero.
#[derive(Debug)]
pub struct Graph {
    nodes: Vec<TermKind>,
    found: WordPairs,
    /// The name a law gave to each term.
    names: Vec<Option<Label>>,
    /// Whether a term depends on anything but constants and parameters.
    live: Vec<bool>,
    /// What holds of the value of each term whatever the numbers from outside are.
    always: Vec<Always>,
    /// The last epoch in which a term was asked for.
    epochs: Vec<u32>,
    epoch: u32,
    order: Vec<Term>,
    sections: Vec<String>,
    section_of: HashMap<String, usize>,
    section: usize,
}

/// A term at its place in the trace of one quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The term.
    pub expr: Expr,
    /// What it belongs to: index into [`Graph::sections`].
    pub section: usize,
}

thread_local! {
    static GRAPH: RefCell<Graph> = RefCell::new(Graph::default());
}

fn with<R>(body: impl FnOnce(&mut Graph) -> R) -> R {
    GRAPH.with(|graph| body(&mut graph.borrow_mut()))
}

/// Runs `body` on a fresh graph and hands back what it returns together with the graph.
pub fn session<R>(body: impl FnOnce() -> R) -> (R, Graph) {
    let outer = with(std::mem::take);
    let result = body();
    let graph = with(|graph| std::mem::replace(graph, outer));
    (result, graph)
}

/// Runs `body` and hands back what it returns together with the terms it asked for, in the order of asking.
pub fn recorded<R>(body: impl FnOnce() -> R) -> (R, Vec<Term>) {
    with(Graph::begin);
    let result = body();
    (result, with(|graph| std::mem::take(&mut graph.order)))
}

impl Default for Graph {
    fn default() -> Self {
        let mut graph = Graph {
            nodes: Vec::new(),
            found: WordPairs::default(),
            names: Vec::new(),
            live: Vec::new(),
            always: Vec::new(),
            epochs: Vec::new(),
            epoch: 0,
            order: Vec::new(),
            sections: Vec::new(),
            section_of: HashMap::new(),
            section: 0,
        };
        graph.number(0.0);
        graph
    }
}

impl Graph {
    fn begin(&mut self) {
        self.epoch += 1;
        self.order.clear();
        self.section = self.named("");
    }

    fn named(&mut self, name: &str) -> usize {
        if let Some(&index) = self.section_of.get(name) {
            return index;
        }
        self.sections.push(name.to_owned());
        self.section_of
            .insert(name.to_owned(), self.sections.len() - 1);
        self.sections.len() - 1
    }

    /// What a term is.
    #[must_use]
    pub fn node(&self, expr: Expr) -> TermKind {
        self.nodes[expr.0 as usize]
    }

    /// The name a law gave to a term.
    #[must_use]
    pub fn name(&self, expr: Expr) -> Option<Label> {
        self.names[expr.0 as usize]
    }

    /// Whether a term depends on anything but constants and parameters.
    #[must_use]
    pub fn is_live(&self, expr: Expr) -> bool {
        self.live[expr.0 as usize]
    }

    /// The names of bodies, lines and nodes that terms belong to.
    #[must_use]
    pub fn sections(&self) -> &[String] {
        &self.sections
    }

    /// How many terms there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no term at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The value of a term that is a constant.
    #[must_use]
    pub fn constant(&self, expr: Expr) -> Option<f64> {
        match self.node(expr) {
            TermKind::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// x of −x.
    pub(crate) fn negated(&self, expr: Expr) -> Option<Expr> {
        match self.node(expr) {
            TermKind::Apply(Op::Unary(Unary::Neg, a)) => Some(a),
            _ => None,
        }
    }

    /// Names a term, if it is an operation without a name; of −x it names x, too.
    pub(crate) fn label(&mut self, expr: Expr, text: &'static str) {
        if let TermKind::Apply(_) = self.node(expr) {
            let name = &mut self.names[expr.index()];
            let opposite = false;
            *name = name
                .filter(|known| !known.opposite)
                .or(Some(Label { text, opposite }));
        }
        if let Some(positive) = self.negated(expr)
            && let TermKind::Apply(_) = self.node(positive)
        {
            let opposite = true;
            self.names[positive.index()].get_or_insert(Label { text, opposite });
        }
    }

    /// The number −c of a number c, if it is there: it is where a term is multiplied by c.
    pub(crate) fn opposite_number(&self, expr: Expr) -> Option<Expr> {
        let number = TermKind::Constant((-self.constant(expr)?).to_bits());
        Some(Expr(self.found.find(code(number))? as u32))
    }

    /// The term of a node, if it has been asked for since the trace began: what is not of this trace may not be needed.
    pub(crate) fn asked(&self, node: TermKind) -> Option<Expr> {
        let index = self.found.find(code(node))?;
        (self.epochs[index] == self.epoch).then_some(Expr(index as u32))
    }

    /// The term at a place in the order of creation.
    pub(crate) fn term(&self, index: usize) -> Expr {
        Expr(index as u32)
    }

    /// The value of a mask known beforehand.
    pub(crate) fn truth(&self, expr: Expr) -> Option<bool> {
        match self.node(expr) {
            TermKind::Truth(value) => Some(value),
            _ => None,
        }
    }

    /// The term of this node: an earlier one if there is one.
    pub(crate) fn add_node(&mut self, node: TermKind) -> Expr {
        let index = self.found.place(code(node));
        let expr = Expr(index as u32);
        if index == self.nodes.len() {
            let live = match node {
                TermKind::Constant(_) | TermKind::Truth(_) | TermKind::Slot(Slot::Param(_)) => {
                    false
                }
                TermKind::Slot(_) => true,
                TermKind::Apply(op) => op.arguments().any(|a| self.is_live(a)),
            };
            self.always.push(self.always_of(node));
            self.nodes.push(node);
            self.names.push(None);
            self.live.push(live);
            self.epochs.push(0);
        }
        let seen = &mut self.epochs[index];
        if *seen != self.epoch {
            *seen = self.epoch;
            self.order.push(Term {
                expr,
                section: self.section,
            });
        }
        expr
    }
}

/// A node as two words, different for different nodes.
fn code(node: TermKind) -> [u64; 2] {
    let kinds = |node: u64, kind: u64| node | kind << 8;
    let pair =
        |kind: u64, a: Expr, b: Expr| [kinds(3, kind) | u64::from(a.0) << 32, u64::from(b.0)];
    match node {
        TermKind::Constant(bits) => [0, bits],
        TermKind::Truth(value) => [1, u64::from(value)],
        TermKind::Slot(slot) => {
            let (kind, index) = match slot {
                Slot::Time => (0, 0),
                Slot::State(index) => (1, index),
                Slot::Node(index) => (2, index),
                Slot::Effective(index) => (3, index),
                Slot::Hold(index) => (4, index),
                Slot::Ends(index) => (5, index),
                Slot::Input(index) => (6, index),
                Slot::Row(index) => (7, index),
                Slot::Param(index) => (8, index),
                Slot::Derived(index) => (9, index),
                Slot::Motion(index) => (10, index),
                Slot::Factored(index) => (11, index),
                Slot::Origin { number, .. } => (12, number),
                Slot::Turn { number, .. } => (13, number),
                Slot::Right { number, .. } => (14, number),
                Slot::Direction(index) => (15, index),
                Slot::Value(index) => (16, index),
            };
            [kinds(2, kind), index as u64]
        }
        TermKind::Apply(Op::Unary(kind, a)) => pair(kind as u64, a, Expr(0)),
        TermKind::Apply(Op::Binary(kind, a, b)) => pair(16 + kind as u64, a, b),
        TermKind::Apply(Op::Compare(kind, a, b)) => pair(32 + kind as u64, a, b),
        TermKind::Apply(Op::Select(mask, a, b)) => {
            let [first, second] = pair(48, mask, a);
            [first, second | u64::from(b.0) << 32]
        }
        TermKind::Apply(Op::Fused(kind, a, b, c)) => {
            let [first, second] = pair(64 + kind as u64, a, b);
            [first, second | u64::from(c.0) << 32]
        }
    }
}

impl Expr {
    /// What is asked for from here on belongs to this section, by its index.
    pub(crate) fn in_section(section: usize) {
        with(|graph| graph.section = section);
    }

    /// Whether it depends on anything but constants and parameters.
    #[must_use]
    pub fn is_live(self) -> bool {
        with(|graph| graph.is_live(self))
    }

    /// The symbol of a number from outside.
    #[must_use]
    pub fn slot(slot: Slot) -> Self {
        with(|graph| graph.add_node(TermKind::Slot(slot)))
    }

    /// What this term is.
    #[must_use]
    pub fn node(self) -> TermKind {
        with(|graph| graph.node(self))
    }

    /// Its place in the order of creation.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Whether this is the number zero: the first term of every graph, asked for more often than anything.
    #[must_use]
    pub fn is_structural_zero(self) -> bool {
        self.0 == 0
    }

    /// The symbol of a mask of this graph, for the differentiation of a select.
    #[must_use]
    pub fn as_mask(self) -> Mask {
        Mask(self)
    }

    fn unary(self, kind: Unary) -> Self {
        with(|graph| graph.unary(kind, self))
    }

    fn binary(self, kind: Binary, other: Self) -> Self {
        with(|graph| graph.binary(kind, self, other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbd_scene::Real;
    use num_traits::{One, Zero};

    fn symbols<R>(body: impl FnOnce(Expr, Expr) -> R) -> R {
        session(|| body(Expr::slot(Slot::State(0)), Expr::slot(Slot::State(1)))).0
    }

    #[test]
    fn nothing_is_added_and_nothing_multiplied_by_one() {
        symbols(|x, y| {
            let (zero, one) = (Expr::zero(), Expr::one());
            assert_eq!(x + zero, x);
            assert_eq!(zero + x, x);
            assert_eq!(x - zero, x);
            assert_eq!(zero - x, -x);
            assert_eq!(x - x, zero);
            assert_eq!(x * one, x);
            assert_eq!(one * x, x);
            assert_eq!(x * zero, zero);
            assert_eq!(x / one, x);
            assert_eq!(zero / x, zero);
            assert_eq!(x * -one, -x);
            assert_eq!(-(-x), x);
            assert_eq!(x + -y, x - y);
            assert_eq!(x - -y, x + y);
            assert_eq!(-x * y, -(x * y));
            assert_eq!(-x * -y, x * y);
            assert_eq!(-x / -y, x / y);
            assert_eq!((-(x - y)) * y, -((x - y) * y));
            assert_eq!(x + -(x - y), x - (x - y));
            assert_eq!(-x - y, -(x + y));
            assert_eq!(y - x, -(x - y));
        });
    }

    #[test]
    fn constants_fold_and_a_fold_that_is_not_finite_waits() {
        symbols(|x, _| {
            let number = Expr::from_f64;
            assert_eq!(number(2.0) * number(3.0), number(6.0));
            assert_eq!(number(9.0).sqrt(), number(3.0));
            assert_eq!(number(-0.0), number(0.0));
            assert_eq!(-x * number(2.0), x * number(-2.0));
            assert_eq!(x * number(-2.0), -(x * number(2.0)));
            assert_eq!(x * number(3.0), -(x * number(-3.0)));
            let quotient = number(1.0) / number(0.0);
            assert!(matches!(quotient.node(), TermKind::Apply(_)));
            assert_eq!(number(1.0).max(number(2.0)), number(2.0));
            assert_eq!(Expr::select(number(1.0).lt(number(2.0)), x, quotient), x);
        });
    }

    #[test]
    fn equal_terms_are_one_term_in_either_order_of_a_sum_or_product() {
        symbols(|x, y| {
            assert_eq!(x + y, y + x);
            assert_eq!(x * y, y * x);
            assert_ne!(x - y, y - x);
            assert_ne!(
                x.max(y),
                y.max(x),
                "at equality each takes its own derivative"
            );
            assert_eq!(Expr::select(x.lt(y), x * y, y * x), x * y);
            assert_eq!(Expr::select(x.lt(x), x, y), y);
            assert_eq!(Expr::select(x.le(x), x, y), x);
        });
    }

    #[test]
    fn the_first_name_of_a_term_wins_and_numbers_have_none() {
        let ((product, cube, zero), graph) = session(|| {
            let x = Expr::slot(Slot::Time);
            let product = (x * x).label("square").label("again");
            let cube = x * x * x;
            let _ = (-cube).label("pull");
            (product, cube, Expr::zero().label("nothing"))
        });
        let name = |expr: Expr| graph.name(expr).map(|label| (label.text, label.opposite));
        assert_eq!(name(product), Some(("square", false)));
        assert_eq!(name(cube), Some(("pull", true)));
        assert_eq!(name(zero), None);
    }

    #[test]
    fn a_rotation_by_nalgebra_gives_the_nodes_of_hand_written_rows() {
        use nalgebra::{Matrix3, Vector3};
        session(|| {
            let r = Matrix3::from_fn(|i, j| Expr::slot(Slot::State(3 * i + j)));
            let p = Vector3::from_fn(|i, _| Expr::slot(Slot::State(9 + i)));
            let by_hand = r[(0, 0)] * p[0] + r[(0, 1)] * p[1] + r[(0, 2)] * p[2];
            assert_eq!((r * p)[0], by_hand);
        });
    }
}
