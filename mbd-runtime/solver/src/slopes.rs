//! Derivatives of quantities by running the laws on dual numbers, some columns at a time. In `f64` whatever the scalar of the model: exact
//! enough for both, and compiled once.

use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::{Arguments, At, Dual, Float, Layout, Quantity, Scene, Variable};

/// How many variables one pass of dual numbers carries.
const PASS: usize = 8;
type Slope = Dual<f64, PASS>;

/// What is differentiated by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DerivativeBy {
    /// A variable of the model.
    Variable(Variable),
    /// Time, at fixed state, node unknowns, inputs and parameters.
    Time,
}

impl DerivativeBy {
    /// How many numbers it has.
    pub(crate) fn count(self, layout: &Layout) -> usize {
        match self {
            DerivativeBy::Variable(variable) => layout.variables(variable),
            DerivativeBy::Time => 1,
        }
    }
}

impl From<Variable> for DerivativeBy {
    fn from(variable: Variable) -> Self {
        DerivativeBy::Variable(variable)
    }
}

/// What K_e and L_e of the lines of nodes do while a parameter varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effective {
    /// They stay: a partial derivative.
    Fixed,
    /// They vary as K, C and L0 of their lines do, with what a step remembers as it is; lines of slack networks (K_e = 0) carry nothing.
    Follows,
}

/// The room of one scene and its parameters.
#[derive(Debug)]
pub(crate) struct Slopes {
    numbers: Numbers<Slope>,
    scratch: Scratch<Slope>,
    arguments: Arguments<Slope>,
    out: Vec<Slope>,
}

impl Slopes {
    /// Room for the longest of some quantities.
    pub(crate) fn reserve(&mut self, layout: &Layout, quantities: &[Quantity]) {
        let lengths = quantities.iter().map(|&what| layout.len(what));
        self.out.reserve(lengths.max().unwrap_or(0));
    }

    pub(crate) fn new<T: Float>(scene: &Scene, layout: &Layout, params: &[T]) -> Self {
        let params: Vec<Slope> = params.iter().map(|&x| constant(x)).collect();
        Slopes {
            numbers: Numbers::new(scene, &params),
            scratch: Scratch::new(layout),
            arguments: Arguments::default(),
            out: Vec::new(),
        }
    }

    /// Whether these are the parameters.
    pub(crate) fn are_at<T: Float>(&self, params: &[T]) -> bool {
        let own = self.numbers.params.iter().map(|own| own.value);
        own.eq(params.iter().map(|x| x.to_f64()))
    }

    /// Writes ∂(quantity)/∂(variable), dense, row by row; a slice of a wrong length is left as it is.
    pub(crate) fn differentiate<T: Float>(
        &mut self,
        (scene, layout): (&Scene, &Layout),
        (of, by): (Quantity, impl Into<DerivativeBy>),
        effective: Effective,
        at: &At<'_, T>,
        out: &mut [T],
    ) {
        let by = by.into();
        let (rows, columns) = (layout.len(of), by.count(layout));
        if out.len() != rows * columns {
            return;
        }
        self.arguments.read(at, constant);
        for first in (0..columns).step_by(PASS) {
            let last = columns.min(first + PASS);
            let mut seeded = None;
            match by {
                DerivativeBy::Time => {
                    let time = std::slice::from_mut(&mut self.arguments.time);
                    seed(time, first..last);
                }
                DerivativeBy::Variable(Variable::State) => {
                    seed(&mut self.arguments.state, first..last)
                }
                DerivativeBy::Variable(Variable::Node) => {
                    seed(&mut self.arguments.nodes, first..last)
                }
                DerivativeBy::Variable(Variable::Input) => {
                    seed(&mut self.arguments.inputs, first..last)
                }
                DerivativeBy::Variable(Variable::Parameter) => {
                    let mut params = self.numbers.params.clone();
                    seed(&mut params, first..last);
                    let numbers = Numbers::new(scene, &params);
                    if effective == Effective::Follows {
                        follow(layout, &numbers, &mut self.arguments.effective);
                    }
                    seeded = Some(numbers);
                }
            }
            self.out.clear();
            self.out.resize(rows, Dual::constant(0.0));
            mbd_scene::evaluate(
                of,
                scene,
                layout,
                seeded.as_ref().unwrap_or(&self.numbers),
                &self.arguments.at(),
                &mut self.scratch,
                &mut self.out,
            );
            for (row, value) in out.chunks_exact_mut(columns).zip(&self.out) {
                for (to, slope) in row[first..last].iter_mut().zip(value.slopes) {
                    *to = T::from_f64(slope);
                }
            }
        }
    }
}

/// Gives K_e and L_e the slopes that those of K, C and L0 make. Their parts by damping are in proportion to C, whatever the step and what it remembers:
///
/// ```text
/// K_e = K + β,   L_e = L0 + B/K_e,   β ∝ C,   B = (L_e − L0) K_e ∝ C                  (`stepwise`; β = B = 0 of a `static` node)
/// ∂K_e = ∂K + β ∂C/C,   ∂L_e = ∂L0 + (L_e − L0) (∂C/C − ∂K_e/K_e)
/// ```
///
/// L_e = 0 of a line that has a free length is held there by the literal clamp, and varies with nothing.
fn follow(layout: &Layout, numbers: &Numbers<Slope>, list: &mut [Slope]) {
    for (slots, line) in layout.lines.iter().zip(&numbers.lines) {
        if let Some(effective) = slots.effective
            && let Some([k, l]) = list.get_mut(2 * effective..2 * effective + 2)
            && k.value != 0.0
        {
            let [damped, longer] = [
                k.value - line.stiffness.value,
                l.value - line.free_length.value,
            ];
            let held = l.value == 0.0 && longer != 0.0;
            for by in 0..PASS {
                let [stiffness, damping, free_length] =
                    [line.stiffness, line.damping, line.free_length].map(|own| own.slopes[by]);
                let part = match damping == 0.0 {
                    true => 0.0,
                    false => damping / line.damping.value,
                };
                k.slopes[by] = match damped == 0.0 {
                    true => stiffness,
                    false => stiffness + damped * part,
                };
                l.slopes[by] = match (held, longer == 0.0) {
                    (true, _) => 0.0,
                    (false, true) => free_length,
                    (false, false) => free_length + longer * (part - k.slopes[by] / k.value),
                };
            }
        }
    }
}

/// A number that does not vary.
fn constant<T: Float>(x: T) -> Slope {
    Dual::constant(x.to_f64())
}

/// Makes the numbers in `range` variables 0, 1, …, all others constants.
fn seed(list: &mut [Slope], range: std::ops::Range<usize>) {
    for (index, number) in list.iter_mut().enumerate() {
        *number = if range.contains(&index) {
            Dual::variable(number.value, index - range.start)
        } else {
            Dual::constant(number.value)
        };
    }
}
