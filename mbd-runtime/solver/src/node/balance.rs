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

    /// All of it where there is one node.
    #[inline]
    #[must_use]
    pub(crate) fn of_one(&self) -> Option<OneNode<T>> {
        match *self.values.as_slice() {
            [
                gx,
                gy,
                gz,
                xx,
                xy,
                xz,
                yy,
                yz,
                zz,
                tension,
                floor,
                stretched,
            ] => Some(OneNode {
                gradient: [gx, gy, gz],
                stiffness: [xx, xy, xz, yy, yz, zz],
                pulls: Pulls {
                    tension,
                    floor,
                    stretched,
                    nodes: 1,
                },
            }),
            _ => None,
        }
    }

    /// The sums over its lines.
    #[inline]
    #[must_use]
    pub(crate) fn pulls(&self) -> Pulls<T> {
        let [tension, floor, stretched] = match self.values.last_chunk() {
            Some(sums) => *sums,
            None => [T::zero(); 3],
        };
        Pulls {
            tension,
            floor,
            stretched,
            nodes: self.nodes,
        }
    }

    /// Σ T over the taut lines [N].
    #[must_use]
    pub fn tension(&self) -> T {
        self.pulls().tension
    }

    /// Σ K (d + |p|₁) over the taut lines [N]: what one unit of relative rounding in the lengths amounts to.
    #[must_use]
    pub fn floor(&self) -> T {
        self.pulls().floor
    }

    /// Number of lines with positive stretch.
    #[must_use]
    pub fn stretched(&self) -> T {
        self.pulls().stretched
    }
}

/// The sums of a balance over its lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulls<T> {
    /// [`BalanceEvaluation::tension`].
    pub tension: T,
    /// [`BalanceEvaluation::floor`].
    pub floor: T,
    /// [`BalanceEvaluation::stretched`].
    pub stretched: T,
    /// Of how many nodes.
    pub nodes: usize,
}

/// The balance of one node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneNode<T> {
    /// g [N].
    pub gradient: [T; 3],
    /// The elements of H: xx xy xz yy yz zz [N/m].
    pub stiffness: [T; 6],
    /// The sums over its lines.
    pub pulls: Pulls<T>,
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
