//! A unit vector in the frame of a joint, and the two that complete it.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::Real;

/// A unit vector in joint axes: fixed numbers, so that aligned axes leave zeros in generated code.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[f64; 3]")]
pub struct Axis(
    /// Its components, of length 1: generated code writes them back as they were read. [`Axis::new`] normalises.
    pub [f64; 3],
);

impl Axis {
    /// (1, 0, 0).
    pub const X: Axis = Axis([1.0, 0.0, 0.0]);
    /// (0, 1, 0).
    pub const Y: Axis = Axis([0.0, 1.0, 0.0]);
    /// (0, 0, 1).
    pub const Z: Axis = Axis([0.0, 0.0, 1.0]);

    /// The direction of `components`, normalised; `None` for a zero vector or one that is not finite.
    #[must_use]
    pub fn new(components: [f64; 3]) -> Option<Self> {
        let largest = components.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if !(components.iter().all(|x| x.is_finite()) && largest > 0.0) {
            return None;
        }
        let square = components.iter().map(|x| x * x).sum::<f64>();
        if (square - 1.0).abs() <= 4.0 * f64::EPSILON {
            // Already normalised: what was read once reads back to the bit. The two zeros are one.
            return Some(Axis(components.map(|x| x + 0.0)));
        }
        let scaled = components.map(|x| x / largest);
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(Axis(scaled.map(|x| x / length + 0.0)))
    }

    /// Axis number `k` of x, y, z; z beyond.
    #[must_use]
    pub const fn unit(k: usize) -> Axis {
        match k {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        }
    }

    /// The axes u, v, self where it is along none of its frame's: a frame rotated by them has it as z.
    #[must_use]
    pub fn to_z(&self) -> Option<Matrix3<f64>> {
        let along_frame = self.0.iter().any(|component| component.abs() == 1.0);
        (!along_frame).then(|| self.frame())
    }

    /// Two unit vectors that complete it to right-handed axes u, v, self. The axis z has x and y, and so on round.
    #[must_use]
    pub fn complement(&self) -> [Axis; 2] {
        let a = self.0;
        let unit = |i: usize| Axis(std::array::from_fn(|j| f64::from(u8::from(i % 3 == j))));
        for (k, &component) in a.iter().enumerate() {
            if component == 1.0 {
                return [unit(k + 1), unit(k + 2)];
            }
            if component == -1.0 {
                return [unit(k + 2), unit(k + 1)];
            }
        }
        let smallest = (0..3).fold(0, |m, i| if a[i].abs() < a[m].abs() { i } else { m });
        let seed = Vector3::from_fn(|i, _| f64::from(u8::from(i == smallest)));
        let axis = Vector3::from(a);
        let u = (seed - axis * a[smallest]).normalize();
        [Axis(u.into()), Axis(axis.cross(&u).into())]
    }

    /// The direction of self × other; a direction across itself where they are parallel.
    #[must_use]
    pub fn cross(&self, other: &Axis) -> Axis {
        let product = Vector3::from(self.0).cross(&Vector3::from(other.0));
        Axis::new(product.into()).unwrap_or(self.complement()[0])
    }

    /// Its components on any scalar.
    #[must_use]
    pub fn vector<S: Real>(&self) -> Vector3<S> {
        Vector3::from(self.0.map(S::from_f64))
    }

    /// The axes u, v, self as columns.
    #[must_use]
    pub fn frame<S: Real>(&self) -> Matrix3<S> {
        let [u, v] = self.complement();
        Matrix3::from_columns(&[u.vector(), v.vector(), self.vector()])
    }

    /// The turn by `angle` [rad] about this axis: cos I + sin ã + (1 − cos) a aᵀ, exact zeros and ones where a has them.
    #[must_use]
    pub fn turn<S: Real>(&self, angle: S) -> Matrix3<S> {
        let (sin, cos) = angle.sin_cos();
        let a = self.0;
        Matrix3::from_fn(|i, j| {
            if i == j {
                let square = a[i] * a[i];
                return S::from_f64(square) + cos * S::from_f64(1.0 - square);
            }
            // ã has −a_k where (i, j, k) turns forwards, a_k where it turns backwards.
            let k = 3 - i - j;
            let sign = if (i + 1) % 3 == j { -1.0 } else { 1.0 };
            S::from_f64(a[i] * a[j]) * (S::one() - cos) + S::from_f64(sign * a[k]) * sin
        })
    }
}

impl Default for Axis {
    fn default() -> Self {
        Axis::Z
    }
}

impl TryFrom<[f64; 3]> for Axis {
    type Error = &'static str;
    fn try_from(components: [f64; 3]) -> Result<Self, Self::Error> {
        Axis::new(components).ok_or("an axis is three finite numbers, not all zero")
    }
}
