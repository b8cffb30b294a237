//! The conditions that a method of a given order meets, one for every rooted tree, generated and tested when this crate is built.
//!
//! A tree with more than one node is a smaller tree, the *rest*, with one more branch at its root. With the branches of every root in an order that
//! does not rise each tree is made once: 1, 1, 2, 4, 9, 20, 48 trees of 1 … 7 nodes. A method of order p meets, for every tree τ of at most p nodes,
//!
//! ```text
//! Σ_i b_i Φ_i(τ) = 1/γ(τ)                  γ: product of the numbers of nodes of all subtrees                           (1)
//! Φ_i(τ) = Σ_j β_ij Φ_j(branch)            one branch at the root                                                       (2)
//! Φ_i(τ) = Π over branches of Σ_j α_ij Φ_j(branch)         several                                                      (3)
//! ```
//!
//! where α are the coefficients of the arguments of f and β = α + Γ those with the coefficients Γ of the Jacobian; of an explicit method β = α.
//! An interpolant b(θ) of order p meets Σ_i b_i(θ) Φ_i(τ) = θ^n/γ(τ), n the nodes of τ, as polynomials.
//!
//! Source: J. C. Butcher, *Numerical Methods for Ordinary Differential Equations*, the theory of rooted trees; E. Hairer, G. Wanner, *Solving
//! Ordinary Differential Equations II*, IV.7, for the Jacobian.

/// The most nodes of a tree: no method of higher order is checked.
pub(super) const HIGHEST: usize = 7;
/// How many trees have at most so many nodes.
pub(super) const COUNT: usize = 85;

/// The largest accepted |Σ_i b_i Φ_i − 1/γ| / (1 + Σ_i |b_i Φ_i|): rounding of published sixteen-digit coefficients.
const TOLERANCE: f64 = 1e-14;

/// A rooted tree.
#[derive(Clone, Copy)]
struct RootedTree {
    /// The tree without its last branch, and that branch, by number; of the single node both are itself.
    rest: usize,
    branch: usize,
    /// Number of nodes.
    order: usize,
    /// γ.
    density: f64,
}

/// All trees, by their number of nodes.
const TREES: [RootedTree; COUNT] = grow();

const fn grow() -> [RootedTree; COUNT] {
    let node = RootedTree {
        rest: 0,
        branch: 0,
        order: 1,
        density: 1.0,
    };
    let mut trees = [node; COUNT];
    let mut count = 1;
    let mut order = 2;
    while order <= HIGHEST {
        let known = count;
        let mut branch = 0;
        while branch < known {
            let mut rest = 0;
            while rest < known {
                let (r, b) = (trees[rest], trees[branch]);
                if r.order + b.order == order && (rest == 0 || r.branch <= branch) {
                    trees[count] = RootedTree {
                        rest,
                        branch,
                        order,
                        density: r.density / r.order as f64 * b.density * order as f64,
                    };
                    count += 1;
                }
                rest += 1;
            }
            branch += 1;
        }
        order += 1;
    }
    assert!(count == COUNT, "every tree was made once");
    trees
}

/// Φ_i of every tree at every stage of a method.
pub(super) struct Weights<const N: usize>([[f64; N]; COUNT]);

impl<const N: usize> Weights<N> {
    /// By (2) and (3).
    pub(super) const fn new(alpha: &[[f64; N]; N], beta: &[[f64; N]; N]) -> Self {
        let mut found = [[1.0; N]; COUNT];
        // The product of (3) even where a tree has one branch: what a further branch multiplies.
        let mut products = [[1.0; N]; COUNT];
        let mut t = 1;
        while t < COUNT {
            let RootedTree { rest, branch, .. } = TREES[t];
            let mut i = 0;
            while i < N {
                products[t][i] = products[rest][i] * weighted(&alpha[i], &found[branch]).0;
                found[t][i] = match rest {
                    0 => weighted(&beta[i], &found[branch]).0,
                    _ => products[t][i],
                };
                i += 1;
            }
            t += 1;
        }
        Weights(found)
    }

    /// Whether the weights of a step meet (1) up to an order.
    pub(super) const fn step(&self, weights: &[f64; N], order: usize) -> bool {
        self.meet(weights, order, 0)
    }

    /// Whether the weights of an interpolant, by powers of θ from one on, do.
    pub(super) const fn inside<const D: usize>(
        &self,
        powers: &[[f64; D]; N],
        order: usize,
    ) -> bool {
        let mut power = 1;
        while power <= D {
            let mut weights = [0.0; N];
            let mut i = 0;
            while i < N {
                weights[i] = powers[i][power - 1];
                i += 1;
            }
            if !self.meet(&weights, order, power) {
                return false;
            }
            power += 1;
        }
        true
    }

    /// (1) for the coefficients of one power of θ; for a whole step with power 0.
    const fn meet(&self, weights: &[f64; N], order: usize, power: usize) -> bool {
        assert!(order <= HIGHEST, "orders above 7 need more trees");
        let mut t = 0;
        while t < COUNT && TREES[t].order <= order {
            let expected = if power == 0 || TREES[t].order == power {
                1.0 / TREES[t].density
            } else {
                0.0
            };
            let (sum, size) = weighted(weights, &self.0[t]);
            if !same(sum, expected, size) {
                return false;
            }
            t += 1;
        }
        true
    }
}

/// Σ w_i v_i and Σ |w_i v_i|.
pub(super) const fn weighted<const N: usize>(weights: &[f64; N], values: &[f64; N]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut size = 0.0;
    let mut i = 0;
    while i < N {
        sum += weights[i] * values[i];
        size += (weights[i] * values[i]).abs();
        i += 1;
    }
    (sum, size)
}

/// Whether two numbers agree, of which one is a sum of terms of this size.
pub(super) const fn same(a: f64, b: f64, size: f64) -> bool {
    (a - b).abs() <= TOLERANCE * (1.0 + size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_rooted_trees_as_cayley_counted() {
        for (order, count) in (1..).zip([1, 1, 2, 4, 9, 20, 48]) {
            let found = TREES.iter().filter(|tree| tree.order == order).count();
            assert_eq!(found, count, "{order} nodes");
        }
    }

    #[test]
    fn the_exact_solution_meets_every_condition() {
        // Σ over the trees of n nodes of α(τ) = (n − 1)!, and α = n!/(γ σ): the symmetry σ from the branches.
        let mut symmetry = vec![1.0_f64; COUNT];
        let mut repeats = vec![0_u32; COUNT];
        let mut sums = [0.0; HIGHEST + 1];
        for (t, tree) in TREES.iter().enumerate() {
            if t > 0 {
                let again = tree.rest != 0 && TREES[tree.rest].branch == tree.branch;
                repeats[t] = if again { repeats[tree.rest] + 1 } else { 1 };
                symmetry[t] = symmetry[tree.rest] * symmetry[tree.branch] * f64::from(repeats[t]);
            }
            let factorial: f64 = (1..=tree.order).map(|n| n as f64).product();
            sums[tree.order] += factorial / (tree.density * symmetry[t]);
        }
        for (order, sum) in sums.into_iter().enumerate().skip(1) {
            let expected: f64 = (1..order).map(|n| n as f64).product();
            assert!((sum - expected).abs() < 1e-9 * expected, "{order}: {sum}");
        }
    }
}
