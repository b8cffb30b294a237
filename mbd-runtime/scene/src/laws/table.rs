//! Tables as functions: what a table of a declaration is worth, on any scalar.
//!
//! ```text
//! x_k ≤ x < x_{k+1}:   o = x − x_k,  h = x_{k+1} − x_k,  s = (y_{k+1} − y_k)/h
//! straight   y = y_k + s o                                                                                        (1)
//! smooth     y = y_k + m_k o + (3s − 2m_k − m_{k+1}) o²/h + (m_k + m_{k+1} − 2s) o³/h²                            (2)
//! x < x_0, x ≥ x_n:   y = y_0, y_n                                                                                (3)
//! ```
//!
//! The slopes m_k of a smooth table are zero at both ends, so that (2) meets (3) without a kink, and zero where the entries turn; elsewhere
//! they are the harmonic means of the secants on both sides, weighted by 2h_k + h_{k−1} and h_k + 2h_{k−1}. Then (2) rises where its
//! entries rise: it neither overshoots nor turns between them (F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17, 1980; the slopes
//! of F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984).
//!
//! With two arguments (1) or (2) runs along the first at every entry of the second, then along the second through the numbers found. Of
//! a smooth table the slopes m along the second argument are carried over from their entries by (2) with m = 0 for them: value and both
//! slopes are continuous everywhere; along the lines of the grid it neither overshoots nor turns.
//!
//! An entry belongs to what lies above it: there the derivative is the one to the right. The coefficients are selected, then one polynomial
//! is evaluated: at an entry the value is that of the table to the bit. Rejected: a sum over clamped parts of the argument. It adds
//! up what cancels later, in `f32` all of a density that falls by seven decades.

use crate::{Real, Table};

impl Table {
    /// The value at these arguments [SI]. NaN at an argument that is NaN, and for a wrong number of arguments.
    pub fn at<S: Real>(&self, arguments: &[S]) -> S {
        match (arguments, &self.second) {
            (&[x], None) => self.along_first(x, 0),
            (&[x, z], Some(second)) => {
                let node = |j: usize| {
                    let slope = match self.smooth {
                        true => self.carried_slope(x, &second.z, j),
                        false => S::zero(),
                    };
                    [self.along_first(x, j), slope]
                };
                interpolate(z, &second.z, self.smooth, &node, |coefficient| coefficient)
            }
            _ => S::from_f64(f64::NAN),
        }
    }

    /// Along the first argument, at entry `j` of the second.
    fn along_first<S: Real>(&self, x: S, j: usize) -> S {
        let value = |i: usize| self.entry(i, j);
        let node = |i: usize| [value(i), slope(&self.x, i, &value)];
        interpolate(x, &self.x, self.smooth, &node, S::from_f64)
    }

    /// Slope along the second argument at its entry `j`, carried over along the first.
    fn carried_slope<S: Real>(&self, x: S, z: &[f64], j: usize) -> S {
        let node = |i: usize| [slope(z, j, &|j| self.entry(i, j)), 0.0];
        interpolate(x, &self.x, true, &node, S::from_f64)
    }
}

/// m_k of a smooth table.
fn slope(x: &[f64], k: usize, value: &dyn Fn(usize) -> f64) -> f64 {
    let (Some(&before), Some(&here), Some(&after)) = (
        k.checked_sub(1).and_then(|k| x.get(k)),
        x.get(k),
        x.get(k + 1),
    ) else {
        return 0.0;
    };
    let (h0, h1) = (here - before, after - here);
    let s0 = (value(k) - value(k - 1)) / h0;
    let s1 = (value(k + 1) - value(k)) / h1;
    if s0 * s1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / s0 + w1 / s1)
}

/// (1) to (3) through nodes [y_k, m_k]; `lift` makes the scalar of the argument from theirs.
fn interpolate<V: Real, S: Real>(
    x: S,
    grid: &[f64],
    smooth: bool,
    node: &dyn Fn(usize) -> [V; 2],
    lift: fn(V) -> S,
) -> S {
    let Some(&first) = grid.first() else {
        return S::from_f64(f64::NAN);
    };
    let mut from = node(0);
    let mut chosen: Option<(S, [S; 4])> = None;
    for (k, &start) in grid.iter().enumerate() {
        let coefficients = match grid.get(k + 1) {
            Some(end) => {
                let to = node(k + 1);
                let coefficients = polynomial(end - start, from, to, smooth);
                from = to;
                coefficients
            }
            None => [from[0], V::zero(), V::zero(), V::zero()],
        };
        let start = S::from_f64(start);
        let mut here = coefficients.map(lift);
        chosen = Some(match chosen {
            None => (start, here),
            Some((low, below)) => {
                let reached = start.le(x);
                for (here, below) in here.iter_mut().zip(below) {
                    *here = S::select(reached, *here, below);
                }
                (S::select(reached, start, low), here)
            }
        });
    }
    match chosen {
        Some((low, [y, c1, c2, c3])) => {
            let o = x.max(S::from_f64(first)) - low;
            y + o * (c1 + o * (c2 + o * c3))
        }
        None => S::from_f64(f64::NAN),
    }
}

/// The coefficients of (1) or (2).
fn polynomial<V: Real>(h: f64, [y0, m0]: [V; 2], [y1, m1]: [V; 2], smooth: bool) -> [V; 4] {
    let number = V::from_f64;
    let s = (y1 - y0) / number(h);
    if !smooth {
        return [y0, s, V::zero(), V::zero()];
    }
    let two = number(2.0);
    let c2 = (number(3.0) * s - two * m0 - m1) / number(h);
    let c3 = (m0 + m1 - two * s) / number(h * h);
    [y0, m0, c2, c3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dual, SecondArgument, Unit};

    fn table(x: &[f64], y: &[f64], z: Option<&[f64]>, smooth: bool) -> Table {
        Table {
            name: "f".into(),
            doc: String::new(),
            x: x.to_vec(),
            y: y.to_vec(),
            x_unit: Unit::default(),
            y_unit: Unit::default(),
            second: z.map(|z| SecondArgument {
                z: z.to_vec(),
                unit: Unit::default(),
            }),
            smooth,
        }
    }

    /// Value and slope at a number.
    fn slope_at(table: &Table, x: f64) -> [f64; 2] {
        let at = table.at(&[Dual::<f64, 1>::variable(x, 0)]);
        [at.value, at.slopes[0]]
    }

    #[test]
    fn an_entry_belongs_to_what_lies_above_it() {
        let straight = table(&[0.0, 1.0, 3.0], &[1.0, 3.0, 2.0], None, false);
        for (x, want) in [
            (-1.0, [1.0, 0.0]),
            (0.0, [1.0, 2.0]),
            (0.5, [2.0, 2.0]),
            (1.0, [3.0, -0.5]),
            (2.0, [2.5, -0.5]),
            (3.0, [2.0, 0.0]),
            (9.0, [2.0, 0.0]),
        ] {
            assert_eq!(slope_at(&straight, x), want, "at {x}");
        }
        assert!(straight.at(&[f64::NAN]).is_nan());
        assert!(straight.at(&[0.0, 0.0f64]).is_nan());
    }

    #[test]
    fn every_entry_is_met_in_single_precision_however_far_it_has_fallen() {
        let x: Vec<f64> = (0..12).map(f64::from).collect();
        let y: Vec<f64> = (0..12).map(|k| 1.2 * 10f64.powi(-k)).collect();
        for smooth in [false, true] {
            let density = table(&x, &y, None, smooth);
            for (x, y) in x.iter().zip(&y) {
                assert_eq!(density.at(&[*x as f32]), *y as f32);
            }
        }
    }

    #[test]
    fn with_two_arguments_a_straight_table_is_bilinear_in_every_cell() {
        let (x, z) = ([0.0, 2.0, 3.0], [-1.0, 1.0]);
        let y = |x: f64, z: f64| 2.0 - x + 3.0 * z + 0.5 * x * z;
        let values: Vec<f64> = x.iter().flat_map(|&x| z.map(|z| y(x, z))).collect();
        let plane = table(&x, &values, Some(&z), false);
        for (at_x, at_z) in [(0.0, -1.0), (0.7, 0.3), (2.0, 0.9), (2.4, -0.2)] {
            let x = Dual::<f64, 2>::variable(at_x, 0);
            let z = Dual::<f64, 2>::variable(at_z, 1);
            let found = plane.at(&[x, z]);
            assert!((found.value - y(at_x, at_z)).abs() < 1e-14);
            assert!((found.slopes[0] - (-1.0 + 0.5 * at_z)).abs() < 1e-14);
            assert!((found.slopes[1] - (3.0 + 0.5 * at_x)).abs() < 1e-14);
        }
        assert_eq!(plane.at(&[9.0, 9.0]), y(3.0, 1.0));
        assert_eq!(plane.at(&[-9.0, -9.0]), y(0.0, -1.0));
        assert!(plane.at(&[0.0, f64::NAN]).is_nan());
        assert!(plane.at(&[f64::NAN, 0.0]).is_nan());
    }

    #[test]
    fn between_two_entries_with_level_ends_a_smooth_table_is_the_cubic_step() {
        let step = table(&[1.0, 3.0], &[2.0, 6.0], None, true);
        for x in [1.0, 1.3, 2.0, 2.9, 3.0] {
            let t: f64 = (x - 1.0) / 2.0;
            let want = [2.0 + 4.0 * t * t * (3.0 - 2.0 * t), 12.0 * t * (1.0 - t)];
            let found = slope_at(&step, x);
            assert!((found[0] - want[0]).abs() < 1e-14 && (found[1] - want[1]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_smooth_table_has_the_harmonic_mean_of_its_secants_and_no_kink() {
        let x = [0.0, 1.0, 3.0, 4.0, 5.0];
        let smooth = table(&x, &[0.0, 2.0, 3.0, 3.0, 1.0], None, true);
        // Secants 2 and 1/2 over 1 and 2: weights 2·2 + 1 = 5 and 2 + 2·1 = 4.
        let want = 9.0 / (5.0 / 2.0 + 4.0 / 0.5);
        assert!((slope_at(&smooth, 1.0)[1] - want).abs() < 1e-15);
        for (x, want) in [(0.0, 0.0), (3.0, 0.0), (4.0, 0.0), (5.0, 0.0)] {
            assert_eq!(slope_at(&smooth, x)[1], want, "at {x}");
        }
        for x in x {
            let [below, above] = [x - 1e-9, x + 1e-9].map(|x| slope_at(&smooth, x)[1]);
            assert!((below - above).abs() < 1e-7, "at {x}: {below}, {above}");
        }
    }

    #[test]
    fn a_smooth_table_rises_where_its_entries_rise() {
        let rising = table(
            &[0.0, 0.1, 2.0, 2.1, 5.0],
            &[0.0, 5.0, 5.1, 9.0, 9.01],
            None,
            true,
        );
        for k in 0..=5000 {
            let [value, slope] = slope_at(&rising, f64::from(k) * 1e-3);
            assert!((0.0..=9.01).contains(&value) && slope >= -1e-12);
        }
    }

    #[test]
    fn a_smooth_table_of_two_arguments_has_no_kink_along_either_and_follows_its_lines() {
        let (x, z) = ([0.0, 1.0, 3.0], [0.0, 2.0, 2.5]);
        let y = [0.0, 1.0, 4.0, 2.0, 2.5, 3.0, 5.0, 1.0, 6.0];
        let both = table(&x, &y, Some(&z), true);
        for (i, &at) in x.iter().enumerate() {
            let line = table(&z, &y[3 * i..3 * i + 3], None, true);
            for k in 0..=25 {
                let z = 0.1 * f64::from(k);
                assert!((both.at(&[at, z]) - line.at(&[z])).abs() < 1e-13);
            }
        }
        let slopes = |x: f64, z: f64| {
            let x = Dual::<f64, 2>::variable(x, 0);
            both.at(&[x, Dual::<f64, 2>::variable(z, 1)]).slopes
        };
        for k in 0..=30 {
            let along = 0.1 * f64::from(k) + 0.05;
            for edge in x {
                let [below, above] = [edge - 1e-9, edge + 1e-9].map(|x| slopes(x, along));
                assert!((below[0] - above[0]).abs() + (below[1] - above[1]).abs() < 1e-6);
            }
            for edge in z {
                let [below, above] = [edge - 1e-9, edge + 1e-9].map(|z| slopes(along, z));
                assert!((below[0] - above[0]).abs() + (below[1] - above[1]).abs() < 1e-6);
            }
        }
    }
}
