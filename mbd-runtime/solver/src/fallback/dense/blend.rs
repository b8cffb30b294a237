//! Accelerations in passing a state where rows lose rank: chosen rows and the power of the motion have the word, the rest is handed in.
//!
//! ```text
//! v̇ = s + δ + κ v,   Φ_c (s + δ) = γ_c with the smallest δ weighted by mass,   v·M v̇ = v·M v̇_c                  (1)
//! ```
//!
//! s are the accelerations handed in, Φ_c the chosen rows, v̇_c what these alone give. Joints do no work on the motion v, so v̇_c is right along
//! it whatever rows were left out; where motion is prescribed they do, and κ is zero.
//! Rejected: the multipliers of all rows handed in instead. Their errors enter every direction, and where one of them grows as the inverse
//! of the distance to the state, as with masses that are not symmetric, half of its force is lost.

use mbd_scene::orthogonal::{dot, subtract};

use super::Dense;
use crate::fallback::limits::FREE;

impl Dense {
    /// Takes v̇, after [`Dense::accelerate`], to (1) for the accelerations `smooth` and the speeds of the state.
    pub(crate) fn blend(&mut self, chosen: &[usize], smooth: &[f64], speeds: &[f64]) {
        let n = self.nv;
        let own = std::mem::replace(&mut self.force, vec![0.0; n]);
        let bias = self.right.clone();
        for &row in chosen {
            self.right[row] = dot(self.row(row), smooth) - bias[row];
        }
        self.correct(chosen);
        self.right = bias;
        subtract(&mut self.force, -1.0, smooth);
        let rows = self.jacobian.chunks_exact(n);
        let [moved, most] = rows.fold([0.0_f64; 2], |[moved, most], row| {
            let terms = row.iter().zip(speeds).map(|(a, v)| (a * v).abs());
            [
                moved.max(dot(row, speeds).abs()),
                most.max(terms.sum::<f64>()),
            ]
        });
        let is_free = moved <= FREE * most;
        let momenta = self.mass.chunks_exact(n).map(|row| dot(row, speeds));
        let momenta: Vec<f64> = momenta.collect();
        let along = (dot(&momenta, &own) - dot(&momenta, &self.force)) / dot(&momenta, speeds);
        if is_free && along.is_finite() {
            subtract(&mut self.force, -along, speeds);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::fallback::dense::tests::pair;

    #[test]
    fn chosen_rows_and_the_power_of_the_motion_outweigh_what_is_handed_in() {
        let mut dense = pair();
        let chosen = [0];
        dense.factor(&chosen);
        dense.accelerate(&chosen);
        let want = dense.force.clone();
        // One row of two bodies leaves one motion: nothing of what is handed in remains.
        dense.blend(&chosen, &[7.0, -3.0], &[1.0, 1.0]);
        for (got, want) in dense.force.iter().zip(&want) {
            assert!((got - want).abs() < 1e-13, "{got} {want}");
        }
        // Speeds that no row allows are prescribed: the sum of momenta is that of what is handed in.
        dense.blend(&chosen, &[7.0, -3.0], &[1.0, -1.0]);
        let (a, b) = (dense.force[0], dense.force[1]);
        assert!((a - b - 0.5).abs() < 1e-13 && (2.0 * a + 3.0 * b - 5.0).abs() < 1e-13);
    }
}
