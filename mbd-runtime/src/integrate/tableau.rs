//! Explicit Runge–Kutta methods as data that checks itself.
//!
//! A method with coefficients a, c takes k_i = f(t + c_i h, x + h Σ_j a_ij k_j). The **last row of a is the step itself**: stage S lies at the
//! new state, so it is the first stage of the next step and costs nothing (x⁺ = x + h Σ_j a_Sj k_j).
//! Inside a step x(t + θh) = x + h Σ_i b_i(θ) k_i with b_i(θ) = Σ_p dense_ip θ^p.
//!
//! A method of order p meets one condition for every rooted tree τ with at most p nodes: Σ_i b_i Φ_i(τ) = 1/γ(τ), where Φ_i(τ) is a product over the
//! branches of the root of Σ_j a_ij Φ_j(branch), and γ(τ) the product of the sizes of all subtrees. [`Tableau::checked`] tests all of them in a
//! `const fn`: a wrong number does not build.
//!
//! Source: J. C. Butcher, *Numerical Methods for Ordinary Differential Equations*, the theory of rooted trees.

/// A tree is a list of branches, each a tree by index; [`TREES`] is sorted so that branches come first. `order` is the number of nodes,
/// `density` is γ.
struct Tree {
    branches: [usize; 4],
    count: usize,
    order: usize,
    density: f64,
}

/// Index of "no branch".
const NONE: usize = usize::MAX;

const fn tree(branches: [usize; 4], count: usize, order: usize, density: f64) -> Tree {
    Tree {
        branches,
        count,
        order,
        density,
    }
}

/// All 17 rooted trees with at most five nodes.
const TREES: [Tree; 17] = [
    tree([NONE; 4], 0, 1, 1.0),
    tree([0, NONE, NONE, NONE], 1, 2, 2.0),
    tree([0, 0, NONE, NONE], 2, 3, 3.0),
    tree([1, NONE, NONE, NONE], 1, 3, 6.0),
    tree([0, 0, 0, NONE], 3, 4, 4.0),
    tree([0, 1, NONE, NONE], 2, 4, 8.0),
    tree([2, NONE, NONE, NONE], 1, 4, 12.0),
    tree([3, NONE, NONE, NONE], 1, 4, 24.0),
    tree([0, 0, 0, 0], 4, 5, 5.0),
    tree([0, 0, 1, NONE], 3, 5, 10.0),
    tree([0, 2, NONE, NONE], 2, 5, 15.0),
    tree([0, 3, NONE, NONE], 2, 5, 30.0),
    tree([1, 1, NONE, NONE], 2, 5, 20.0),
    tree([4, NONE, NONE, NONE], 1, 5, 20.0),
    tree([5, NONE, NONE, NONE], 1, 5, 40.0),
    tree([6, NONE, NONE, NONE], 1, 5, 60.0),
    tree([7, NONE, NONE, NONE], 1, 5, 120.0),
];

/// The largest accepted |Σ_i b_i Φ_i − 1/γ| / (1 + Σ_i |b_i Φ_i|): rounding of published sixteen-digit coefficients.
const TOLERANCE: f64 = 1e-14;

/// Degree of the interpolants.
pub(crate) const DEGREE: usize = 4;

/// An explicit Runge–Kutta method with S stages, the last of which lies at the end of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tableau<const S: usize> {
    /// Stage weights a_ij, j < i.
    pub a: [[f64; S]; S],
    /// Stage times c_i.
    pub c: [f64; S],
    /// Weights of the error estimate, b − b̂; all zero for a method without one.
    pub error: [f64; S],
    /// Coefficients of θ, θ², θ³, θ⁴ in b_i(θ).
    pub dense: [[f64; DEGREE]; S],
    /// Order of the step.
    pub order: usize,
    /// Order of the embedded step b̂; zero: there is none.
    pub embedded: usize,
    /// Order of the interpolant: its error at a fixed θ is O(h^(dense_order + 1)).
    pub dense_order: usize,
}

impl<const S: usize> Tableau<S> {
    /// The same tableau, after checking that it is explicit, that rows sum to c, that step, embedded step and interpolant have the orders they
    /// claim, and that the interpolant ends at the step. A violation stops the build.
    pub(crate) const fn checked(self) -> Self {
        assert!(S >= 2 && self.order <= 5, "orders above 5 need more trees");
        assert!(
            self.c[S - 1] == 1.0,
            "the last stage is the end of the step"
        );
        let mut i = 0;
        while i < S {
            let mut j = i;
            while j < S {
                assert!(
                    self.a[i][j] == 0.0,
                    "an explicit method uses earlier stages only"
                );
                j += 1;
            }
            let (sum, size) = weighted(&self.a[i], &[1.0; S]);
            assert!(
                absolute(sum - self.c[i]) <= TOLERANCE * (1.0 + size),
                "a row does not sum to its c"
            );
            i += 1;
        }
        let elementary = self.elementary();
        assert!(
            meets(&self.a[S - 1], &elementary, self.order),
            "the step misses an order condition"
        );
        if self.embedded > 0 {
            let mut embedded = self.a[S - 1];
            let mut i = 0;
            while i < S {
                embedded[i] -= self.error[i];
                i += 1;
            }
            assert!(
                meets(&embedded, &elementary, self.embedded),
                "the embedded step misses an order condition"
            );
        }
        self.check_dense(&elementary);
        self
    }

    /// Φ_i(τ) of every tree τ at every stage i.
    const fn elementary(&self) -> [[f64; S]; 17] {
        let mut value = [[1.0; S]; 17];
        let mut t = 1;
        while t < 17 {
            let mut branch = 0;
            while branch < TREES[t].count {
                let below = value[TREES[t].branches[branch]];
                let mut i = 0;
                while i < S {
                    let mut sum = 0.0;
                    let mut j = 0;
                    while j < i {
                        sum += self.a[i][j] * below[j];
                        j += 1;
                    }
                    value[t][i] *= sum;
                    i += 1;
                }
                branch += 1;
            }
            t += 1;
        }
        value
    }

    /// Σ_i b_i(θ) Φ_i(τ) = θ^order(τ) / γ(τ) as polynomials, for every tree of the claimed order; and b(1) = b.
    const fn check_dense(&self, elementary: &[[f64; S]; 17]) {
        let mut power = 1;
        while power <= DEGREE {
            let mut weights = [0.0; S];
            let mut i = 0;
            while i < S {
                weights[i] = self.dense[i][power - 1];
                i += 1;
            }
            let mut t = 0;
            while t < 17 && TREES[t].order <= self.dense_order {
                let expected = if TREES[t].order == power {
                    1.0 / TREES[t].density
                } else {
                    0.0
                };
                let (sum, size) = weighted(&weights, &elementary[t]);
                assert!(
                    absolute(sum - expected) <= TOLERANCE * (1.0 + size),
                    "the interpolant misses an order condition"
                );
                t += 1;
            }
            power += 1;
        }
        let mut i = 0;
        while i < S {
            let mut end = 0.0;
            let mut size = 0.0;
            let mut power = 0;
            while power < DEGREE {
                end += self.dense[i][power];
                size += absolute(self.dense[i][power]);
                power += 1;
            }
            assert!(
                absolute(end - self.a[S - 1][i]) <= TOLERANCE * (1.0 + size),
                "the interpolant does not end at the step"
            );
            i += 1;
        }
    }
}

/// Whether weights meet every condition up to an order.
const fn meets<const S: usize>(
    weights: &[f64; S],
    elementary: &[[f64; S]; 17],
    order: usize,
) -> bool {
    let mut t = 0;
    while t < 17 && TREES[t].order <= order {
        let (sum, size) = weighted(weights, &elementary[t]);
        if absolute(sum - 1.0 / TREES[t].density) > TOLERANCE * (1.0 + size) {
            return false;
        }
        t += 1;
    }
    true
}

/// Σ w_i v_i and Σ |w_i v_i|.
const fn weighted<const S: usize>(weights: &[f64; S], values: &[f64; S]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut size = 0.0;
    let mut i = 0;
    while i < S {
        sum += weights[i] * values[i];
        size += absolute(weights[i] * values[i]);
        i += 1;
    }
    (sum, size)
}

const fn absolute(x: f64) -> f64 {
    if x < 0.0 { -x } else { x }
}
