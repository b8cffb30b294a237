//! What the solver needs to know of an equilibrium problem: the gradient and the stiffness of a convex line energy.

use mbd_scene::Float;

use super::factor::Block;

/// Forces on m coupled nodes held by tension-only lines.
///
/// ```text
/// E(p) = Σ ½ K ((d − L)₊)² − W·p        g = ∂E/∂p = −Σ T u − W        H = ∂g/∂p = Σ J        J = K u uᵀ + (T/d)(I − u uᵀ)
/// ```
///
/// E is convex, so every balance is a global minimum. p stacks the node positions, 3 a node, world axes [m].
pub trait Balance<T: Float> {
    /// Number of nodes m.
    fn nodes(&self) -> usize;
    /// Number of lines.
    fn lines(&self) -> usize;
    /// The load W on the nodes, 3 a node [N].
    fn load(&self) -> &[T];
    /// Evaluates at `p` with stiffness `k` [N/m] and free length `l` [m] per line.
    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut Evaluation<T>);
    /// The smallest L − d over the slack lines at `p` [m]; zero if no line is slack.
    fn smallest_slack(&self, p: &[T], l: &[T]) -> T;
}

/// A balance evaluated: one flat list in the order of `Quantity::Equilibrium`, so that a model writes it in one call.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation<T> {
    nodes: usize,
    values: Vec<T>,
}

impl<T: Float> Evaluation<T> {
    /// Room for `nodes` nodes and `blocks` blocks of H.
    #[must_use]
    pub fn new(nodes: usize, blocks: usize) -> Self {
        Evaluation {
            nodes,
            values: vec![T::zero(); 3 * nodes + 6 * blocks + 3],
        }
    }

    /// Everything as one list: g, blocks of H, the three sums.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The gradient g, 3 a node [N].
    #[must_use]
    pub fn gradient(&self) -> &[T] {
        &self.values[..3 * self.nodes]
    }

    /// Number of blocks of H.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.values.len().saturating_sub(3 * self.nodes + 3) / 6
    }

    /// Block `k` of H in full [N/m]; zero where there is none.
    #[must_use]
    pub fn block(&self, k: usize) -> Block<T, 3> {
        let at = 3 * self.nodes + 6 * k;
        match self.values.get(at..at + 6) {
            Some(&[xx, xy, xz, yy, yz, zz]) => [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]],
            _ => [[T::zero(); 3]; 3],
        }
    }

    /// Σ T over the taut lines [N].
    #[must_use]
    pub fn tension(&self) -> T {
        self.sum(3)
    }

    /// Σ K (d + |p|₁) over the taut lines [N]: what one unit of relative rounding in the lengths amounts to.
    #[must_use]
    pub fn floor(&self) -> T {
        self.sum(2)
    }

    /// Number of lines with positive stretch.
    #[must_use]
    pub fn stretched(&self) -> T {
        self.sum(1)
    }

    fn sum(&self, from_end: usize) -> T {
        self.values
            .len()
            .checked_sub(from_end)
            .and_then(|at| self.values.get(at))
            .copied()
            .unwrap_or_default()
    }
}

/// The Euclidean length of a list, safe against overflow of the squares.
pub(crate) fn norm<T: Float>(list: &[T]) -> T {
    let mut largest = T::zero();
    for &x in list {
        if !x.is_finite() {
            return x.abs();
        }
        largest = largest.max(x.abs());
    }
    if largest == T::zero() {
        return largest;
    }
    let mut sum = T::zero();
    for &x in list {
        let scaled = x / largest;
        sum += scaled * scaled;
    }
    largest * sum.sqrt()
}

/// The inner product of two lists.
pub(crate) fn inner<T: Float>(a: &[T], b: &[T]) -> T {
    let mut sum = T::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}
