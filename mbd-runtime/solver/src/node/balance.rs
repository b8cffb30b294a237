//! What the solver needs to know of an equilibrium problem: the gradient and the stiffness of a convex line energy.

use mbd_scene::laws::{self, line};
use mbd_scene::{Float, Real};
use nalgebra::Vector3;

use super::factor::Block;
use super::scene::ENDLESS;
use super::warm::is_safe;

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
    /// The load W on the nodes, 3 a node [N].
    fn load(&self) -> &[T];
    /// Evaluates at `p` with stiffness `k` [N/m] and free length `l` [m] per line.
    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut BalanceEvaluation<T>);
    /// The two places between which a line is stretched [m].
    fn places(&self, line: usize, p: &[T]) -> [Vector3<T>; 2];

    /// The smallest L − d over the slack lines at `p` [m]; zero if no line is slack.
    fn smallest_slack(&self, p: &[T], l: &[T]) -> T {
        let mut smallest = None;
        for (index, &l) in l.iter().enumerate() {
            let [from, to] = self.places(index, p);
            let slack = -line::geometry(&(to - from), l).stretch;
            let there = l < T::from_f64(ENDLESS);
            if there && slack > T::zero() && smallest.is_none_or(|least| slack < least) {
                smallest = Some(slack);
            }
        }
        smallest.unwrap_or_default()
    }
}

/// Where a line of [`Tied`] ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tie<T> {
    /// At a fixed place [m].
    Anchor([T; 3]),
    /// At a node.
    Node(usize),
}

/// Nodes and lines without a scene, by the law run on numbers.
#[derive(Clone, Copy, Debug)]
pub struct Tied<'a, T> {
    /// The load on the nodes, 3 a node [N].
    pub load: &'a [T],
    /// Structural non-zero blocks of H, row ≥ column.
    pub blocks: &'a [(usize, usize)],
    /// The ends of every line.
    pub lines: &'a [[Tie<T>; 2]],
}

impl<T: Float> Balance<T> for Tied<'_, T> {
    fn nodes(&self) -> usize {
        self.load.len() / 3
    }

    fn load(&self) -> &[T] {
        self.load
    }

    fn evaluate(&mut self, p: &[T], k: &[T], l: &[T], out: &mut BalanceEvaluation<T>) {
        let loads = self.load.chunks_exact(3).map(|load| triple(load, 0));
        let lines = self.lines.iter().zip(k.iter().zip(l)).enumerate();
        let lines = lines.map(|(index, (ends, (&k, &l)))| {
            let [from, to] = self.places(index, p);
            let [at_from, at_to] = ends.map(|tie| match tie {
                Tie::Anchor(_) => None,
                Tie::Node(node) => Some(node),
            });
            laws::Pulled::new([(at_from, from), (at_to, to)], [k, l])
        });
        laws::balance(self.blocks, loads, lines, out.values_mut());
    }

    fn places(&self, line: usize, p: &[T]) -> [Vector3<T>; 2] {
        let ends = self.lines.get(line).copied();
        ends.unwrap_or([Tie::Node(usize::MAX / 3); 2])
            .map(|tie| match tie {
                Tie::Anchor(place) => place.into(),
                Tie::Node(node) => triple(p, 3 * node),
            })
    }
}

/// Three numbers of a list as a vector; zero beyond its end.
pub(crate) fn triple<T: Real>(list: &[T], at: usize) -> Vector3<T> {
    match list.get(at..).and_then(<[T]>::first_chunk) {
        Some(&[x, y, z]) => Vector3::new(x, y, z),
        None => Vector3::zeros(),
    }
}

/// A balance evaluated: one flat list in the order of `Quantity::Equilibrium`, so that a model writes it in one call.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BalanceEvaluation<T> {
    nodes: usize,
    values: Vec<T>,
}

impl<T: Real> BalanceEvaluation<T> {
    /// Room for `nodes` nodes and `blocks` blocks of H.
    #[must_use]
    pub fn new(nodes: usize, blocks: usize) -> Self {
        BalanceEvaluation {
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

    /// The elements of H where there is one node: xx xy xz yy yz zz [N/m].
    #[must_use]
    pub fn only_block(&self) -> Option<[T; 6]> {
        match *self.values.as_slice() {
            [_, _, _, xx, xy, xz, yy, yz, zz, _, _, _] => Some([xx, xy, xz, yy, yz, zz]),
            _ => None,
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
            .unwrap_or_else(T::zero)
    }
}

/// The Euclidean length of a list, safe against overflow and underflow of the squares.
pub(crate) fn norm<T: Float>(list: &[T]) -> T {
    let square = inner(list, list);
    match is_safe(square, T::EPSILON) {
        true => square.sqrt(),
        false if list.iter().all(|x| *x == T::zero()) => T::zero(),
        false => scaled_norm(list),
    }
}

/// The same by the largest of its numbers.
#[cold]
fn scaled_norm<T: Float>(list: &[T]) -> T {
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
    let square = |sum, &x| {
        let scaled = x / largest;
        sum + scaled * scaled
    };
    largest * list.iter().fold(T::zero(), square).sqrt()
}

/// The inner product of two lists.
pub(crate) fn inner<T: Real>(a: &[T], b: &[T]) -> T {
    let products = a.iter().zip(b);
    products.fold(T::zero(), |sum, (&x, &y)| sum + x * y)
}
