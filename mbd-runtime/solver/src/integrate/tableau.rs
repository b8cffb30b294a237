//! Explicit Runge–Kutta methods as data that checks itself.
//!
//! A method with coefficients a, c takes k_i = f(t + c_i h, x + h Σ_j a_ij k_j). **Row S of a is the step itself**: stage S lies at the
//! new state, so it is the first stage of the next step and costs nothing (x⁺ = x + h Σ_j a_Sj k_j).
//! Inside a step x(t + θh) = x + h Σ_i b_i(θ) k_i with b_i(θ) = Σ_p dense_ip θ^p, i = 1 … N: stages beyond S serve the interpolant alone, and are
//! evaluated in the steps that somebody looks into.
//!
//! [`Tableau::checked`] tests the conditions of [`trees`](super::trees) in a `const fn`: a wrong number does not build.

use super::trees::{Weights, same, weighted};
use crate::list::MOST_TERMS;

/// An explicit Runge–Kutta method with S stages, the last of which lies at the end of the step, N with those of its interpolant of degree D.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tableau<const S: usize, const N: usize, const D: usize> {
    /// Stage weights a_ij, j < i.
    pub a: [[f64; N]; N],
    /// Stage times c_i.
    pub c: [f64; N],
    /// Weights of the error estimate, b − b̂; all zero for a method without one.
    pub error: [f64; S],
    /// Coefficients of θ, θ², … in b_i(θ).
    pub dense: [[f64; D]; N],
    /// Order of the step.
    pub order: usize,
    /// Order of the embedded step b̂; zero: there is none.
    pub embedded: usize,
    /// Order of the interpolant: its error at a fixed θ is O(h^(dense_order + 1)).
    pub dense_order: usize,
    /// Two stages at the same time, by index: they show how stiff the system is.
    pub alike: [usize; 2],
    /// |hλ| on the negative real axis up to which a step does not grow: where R(hλ) first leaves ±1.
    pub stable: f64,
}

impl<const S: usize, const N: usize, const D: usize> Tableau<S, N, D> {
    /// The same tableau, after checking that it is explicit, that rows sum to c, that step, embedded step and interpolant have the orders they
    /// claim, that the interpolant ends at the step, that the stages which are said to be at the same time are, and that steps begin to grow where it is
    /// said. A violation stops the build.
    pub(crate) const fn checked(self) -> Self {
        assert!(
            S >= 2 && N >= S && N <= MOST_TERMS,
            "a step has stages, and not more than there is room for"
        );
        assert!(
            self.c[S - 1] == 1.0,
            "the last stage is the end of the step"
        );
        let mut i = 0;
        while i < N {
            let mut j = i;
            while j < N {
                assert!(
                    self.a[i][j] == 0.0,
                    "an explicit method uses earlier stages only"
                );
                j += 1;
            }
            let (sum, size) = weighted(&self.a[i], &[1.0; N]);
            assert!(same(sum, self.c[i], size), "a row does not sum to its c");
            i += 1;
        }
        let weights = Weights::new(&self.a, &self.a);
        assert!(
            weights.step(&self.a[S - 1], self.order),
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
                weights.step(&embedded, self.embedded),
                "the embedded step misses an order condition"
            );
        }
        assert!(
            weights.inside(&self.dense, self.dense_order),
            "the interpolant misses an order condition"
        );
        let mut i = 0;
        while i < N {
            let (end, size) = weighted(&self.dense[i], &[1.0; D]);
            assert!(
                same(end, self.a[S - 1][i], size),
                "the interpolant does not end at the step"
            );
            i += 1;
        }
        let [one, other] = self.alike;
        assert!(
            one < other && other < S && self.c[one] == self.c[other],
            "stages that are compared are at the same time"
        );
        let (at, beyond) = (
            self.growth(-self.stable),
            self.growth(-1.000_001 * self.stable),
        );
        assert!(
            (at.abs() - 1.0).abs() < 1e-9 && beyond.abs() > 1.0,
            "steps do not begin to grow where it is said"
        );
        self
    }

    /// R(z) = x⁺/x of ẋ = λx for a step with hλ = z.
    pub(crate) const fn growth(&self, z: f64) -> f64 {
        let mut stages = [0.0; N];
        let mut i = 0;
        while i < S {
            stages[i] = z * (1.0 + weighted(&self.a[i], &stages).0);
            i += 1;
        }
        1.0 + weighted(&self.a[S - 1], &stages).0
    }
}
