//! Eigenvalues of the linear system, with what moves.
//!
//! ```text
//! A r = λ r,   lᵀ A = λ lᵀ                                                     (1)
//! p_k = |l_k r_k| / Σ |l_k r_k|       no unit: r_k has that of state k, l_k its inverse       (2)
//! ```
//!
//! Source: (2) Pérez-Arriaga, Verghese, Schweppe, Selective modal analysis, IEEE Transactions on Power Apparatus and Systems 101 (1982).
//! Rejected: the largest component of r, which compares metres with radians.

use mbd_scene::random::SplitMix64;
use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix, DVector};

use super::StateSpace;

/// Steps of the QR iteration for each eigenvalue before another basis is taken; and bases.
const STEPS: usize = 60;
const BASES: u64 = 8;

/// An eigenvalue of A and how the scene moves with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Vibration {
    /// Real part [1/s]: negative where it dies out.
    pub real: f64,
    /// Imaginary part [rad/s], ≥ 0: of a conjugate pair one is listed.
    pub imaginary: f64,
    /// Per state real and imaginary part of its share, the largest being 1.
    pub shape: Vec<[f64; 2]>,
    /// Per state how much it takes part, whatever its unit: (2), of which the sum is 1.
    pub participation: Vec<f64>,
}

impl Vibration {
    /// |λ| [rad/s]: the frequency without damping of an oscillation.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.real.hypot(self.imaginary)
    }

    /// The frequency at which it is seen to oscillate, Im λ/2π [Hz].
    #[must_use]
    pub fn hertz(&self) -> f64 {
        self.imaginary / std::f64::consts::TAU
    }

    /// −Re λ/|λ|: 0 without damping, 1 from critical damping on, negative where it grows; 0 for λ = 0.
    #[must_use]
    pub fn damping(&self) -> f64 {
        match self.frequency() {
            frequency if frequency > 0.0 => -self.real / frequency,
            _ => 0.0,
        }
    }
}

impl StateSpace {
    /// The eigenvalues of A with their shapes, slowest first; of each conjugate pair the one with Im λ > 0. None where A is not finite.
    #[must_use]
    pub fn vibrations(&self) -> Vec<Vibration> {
        if self.a.is_empty() || self.a.iter().any(|x| !x.is_finite()) {
            return Vec::new();
        }
        let scale = self.a.norm().max(f64::MIN_POSITIVE);
        let rounding = f64::EPSILON * scale;
        // Below rounding it is zero: of a pair that is, both are.
        let values = eigenvalues(&self.a).into_iter().map(|value| {
            let is_zero = value.norm() <= rounding;
            if is_zero { Complex::default() } else { value }
        });
        let upper = values.filter(|value| value.im >= 0.0 || value.im.is_nan());
        let mut found: Vec<Vibration> = upper
            .map(|value| {
                let shape = vector(&self.a, value, scale);
                let left = vector(&self.a.transpose(), value, scale);
                let shares = shape.iter().zip(&left).map(|(r, l)| r.norm() * l.norm());
                let shares: Vec<f64> = shares.collect();
                let sum: f64 = shares.iter().sum();
                Vibration {
                    real: value.re,
                    imaginary: value.im,
                    shape: shape.iter().map(|x| [x.re, x.im]).collect(),
                    participation: shares.iter().map(|share| share / sum).collect(),
                }
            })
            .collect();
        let key = |one: &Vibration| [one.frequency(), one.real];
        found.sort_by(|a, b| {
            let [a, b] = [key(a), key(b)];
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        found
    }
}

/// The eigenvalues of a matrix of finite numbers.
///
/// The shifts of the QR iteration stand still where eigenvalues lie symmetrically about zero, ±σ ± iω: in another basis they do not. Where no basis leads
/// to an end they are no numbers.
fn eigenvalues(a: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = a.nrows();
    let found = (0..BASES).find_map(|number| {
        let basis = basis(n, number);
        let rotated = &basis * a * basis.transpose();
        Schur::try_new(rotated, f64::EPSILON, STEPS * n)
    });
    match found {
        Some(schur) => schur.complex_eigenvalues().iter().copied().collect(),
        None => vec![Complex::new(f64::NAN, f64::NAN); n],
    }
}

/// An orthogonal matrix: of number 0 the unit matrix, of others a product of reflections in directions that look random.
fn basis(n: usize, number: u64) -> DMatrix<f64> {
    let mut random = SplitMix64(number);
    let reflections = 3 * usize::from(number > 0);
    (0..reflections).fold(DMatrix::identity(n, n), |basis, _| {
        let normal = DVector::from_fn(n, |_, _| random.number());
        let square = normal.norm_squared().max(f64::MIN_POSITIVE);
        let along = normal.transpose() * &basis;
        basis - normal * along * (2.0 / square)
    })
}

/// The eigenvector of an eigenvalue, by inverse iterations beside it; its largest component is 1.
fn vector(a: &DMatrix<f64>, value: Complex<f64>, scale: f64) -> Vec<Complex<f64>> {
    let n = a.nrows();
    // Beside the eigenvalue by some rounding units, so that the matrix can be inverted.
    let beside = value + Complex::new(1e-13 * scale, 0.0);
    let shifted = DMatrix::from_fn(n, n, |i, j| {
        let own = if i == j { beside } else { Complex::default() };
        Complex::new(a[(i, j)], 0.0) - own
    });
    let factor = shifted.lu();
    let mut shape = DVector::from_fn(n, |k, _| Complex::new(1.0 + 0.37 * k as f64, 0.0));
    for _ in 0..3 {
        let Some(next) = factor.solve(&shape) else {
            break;
        };
        let largest = next.iter().fold(Complex::new(0.0, 0.0), |most, x| {
            if x.norm_sqr() > most.norm_sqr() {
                *x
            } else {
                most
            }
        });
        let size = largest.norm_sqr();
        if size == 0.0 || !size.is_finite() {
            break;
        }
        shape = next.map(|x| x / largest);
    }
    shape.iter().copied().collect()
}
