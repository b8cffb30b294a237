//! The last resort where rows lose rank: all of them, each allowed to give way a little, and what gave way asked for again.
//!
//! ```text
//! y_i = L⁻¹ φ_iᵀ / |L⁻¹ φ_iᵀ|,  g_i = γ_i / |L⁻¹ φ_iᵀ|,  w₀ = L⁻¹ (f − h)      of a size not below its least   (1)
//! (Y Yᵀ + ε) Δ = g − Y w,   w ← w + Yᵀ Δ                     until the residual no longer halves           (2)
//! v̇ = L⁻ᵀ w,  λ_i = Σ Δ_i / |L⁻¹ φ_iᵀ|
//! ```
//!
//! Directions with σ² well above ε are solved in a few rounds; those well below, where a slightly inconsistent row would ask for 1/σ times
//! as much, are left as they are. Where rows contradict each other the residual stalls at the contradiction: the caller must look at it.
//! Source: the proximal method of multipliers (Rockafellar 1976), as Pinocchio uses it for constrained dynamics. Inside a step it costs
//! order (four becomes two), and its multipliers say nothing about reactions: they serve for the power of prescribed motions only, which is
//! the same for every solution.

use mbd_scene::orthogonal::{dot, subtract};

use super::{Dense, largest, span, units};
use crate::fallback::limits::{GIVE, LEAST, ROUNDS};

impl Dense {
    /// v̇ by (2) into `force`, from `mass`, `jacobian`, `right` and `force`, whose numbers are good to `epsilon`; the largest row that is left,
    /// over the size of g and w. NaN where a number is.
    pub(crate) fn accelerate_regularised(&mut self, epsilon: f64) -> f64 {
        let (n, nc) = (self.nv, self.nc);
        let give = GIVE.max(100.0 * epsilon);
        self.factor_mass();
        Self::forward(&self.lower, &self.begins, &mut self.force);
        for row in 0..nc {
            let unit = &mut self.units[row * n..(row + 1) * n];
            unit.copy_from_slice(&self.jacobian[row * n..(row + 1) * n]);
            Self::forward(&self.lower, &self.begins, unit);
            // A row that is all but gone asks for next to nothing.
            let size = dot(unit, unit).max(self.least[row]).sqrt();
            self.spare[row] = if size > 0.0 { size } else { 1.0 };
            if size > 0.0 {
                unit.iter_mut().for_each(|x| *x /= size);
                self.right[row] /= size;
            }
            self.spans[row] = span(unit);
        }
        for i in 0..nc {
            for j in 0..=i {
                let shared = self.shared(i, j);
                self.mix[i * nc + j] = if i == j { shared + give } else { shared };
            }
        }
        Self::begins(&mut self.mix_begins, &self.mix, nc);
        Self::factor_square(&mut self.mix, &self.mix_begins, nc);
        let scale = largest(&self.right) + dot(&self.force, &self.force).sqrt();
        self.multipliers.fill(0.0);
        let mut before = f64::INFINITY;
        for round in 0..ROUNDS {
            let rows = units(&self.units, n, &self.spans).zip(&self.right);
            for (((first, unit), right), left) in rows.zip(&mut self.along) {
                *left = right - dot(unit, &self.force[first..]);
            }
            let left = largest(&self.along);
            let stalls = round >= LEAST && left > 0.5 * before;
            before = left;
            if stalls || left <= epsilon * scale || left.is_nan() {
                break;
            }
            Self::forward(&self.mix, &self.mix_begins, &mut self.along);
            Self::backward(&self.mix, &mut self.along);
            let news = self.multipliers.iter_mut().zip(&self.along);
            for ((multiplier, more), size) in news.zip(&self.spare) {
                *multiplier += more / size;
            }
            let rows = units(&self.units, n, &self.spans);
            for ((first, unit), more) in rows.zip(&self.along) {
                subtract(&mut self.force[first..], -more, unit);
            }
        }
        Self::backward(&self.lower, &mut self.force);
        if before == 0.0 { 0.0 } else { before / scale }
    }

    /// The inner product of two rows of Y.
    fn shared(&self, i: usize, j: usize) -> f64 {
        let (a, b) = (&self.spans[i], &self.spans[j]);
        let both = a.start.max(b.start)..a.end.min(b.end);
        if both.is_empty() {
            return 0.0;
        }
        let part = |row: usize| &self.units[row * self.nv..][both.clone()];
        dot(part(i), part(j))
    }
}

#[cfg(test)]
mod tests {
    use crate::fallback::dense::tests::pair;

    #[test]
    fn rows_that_repeat_are_solved_together_and_a_contradiction_is_left_over() {
        let mut dense = pair();
        let left = dense.accelerate_regularised(f64::EPSILON);
        let (a, b) = (dense.force[0], dense.force[1]);
        assert!(left < 1e-14, "{left:e}");
        assert!((a - b - 0.5).abs() < 1e-13 && (2.0 * a + 3.0 * b - 10.0).abs() < 1e-13);
        let push = dense.multipliers[0] + 2.0 * dense.multipliers[1];
        assert!((3.0 * b + push).abs() < 1e-12, "{push}");
        let mut dense = pair();
        dense.right[1] = 3.0;
        let left = dense.accelerate_regularised(f64::EPSILON);
        // a − b cannot be 0.5 and 1.5: both rows miss by half a metre per second squared.
        assert!(left > 0.05, "{left:e}");
    }
}
