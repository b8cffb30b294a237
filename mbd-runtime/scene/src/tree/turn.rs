//! The rotation between a link and the link that carries it: one matrix, or two one after the other where that takes fewer operations.
//!
//! ```text
//! E = E_f R12        E_f: how the joint is mounted; R12: what its coordinates rotate           (1)
//! ```
//!
//! Where both are about one axis of their frames each, six operations take a vector through each of them, and twenty a symmetric matrix; a full
//! matrix takes fifteen and seventy-five. Source: Featherstone, Rigid Body Dynamics Algorithms, appendix A.4.

use nalgebra::{Matrix3, Vector3};

use crate::Real;

/// E of (1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn<S: Real> {
    outer: Matrix3<S>,
    inner: Option<Matrix3<S>>,
}

impl<S: Real> Turn<S> {
    /// By one matrix.
    pub fn by(matrix: Matrix3<S>) -> Self {
        Turn {
            outer: matrix,
            inner: None,
        }
    }

    /// (1).
    pub fn of(fixed: Matrix3<S>, moved: Matrix3<S>) -> Self {
        match [&fixed, &moved].map(axis) {
            [Some(_), Some(_)] => Turn {
                outer: fixed,
                inner: Some(moved),
            },
            _ => Turn::by(labelled(fixed * moved)),
        }
    }

    /// E as a matrix.
    pub fn matrix(&self) -> Matrix3<S> {
        match self.inner {
            Some(inner) => labelled(self.outer * inner),
            None => self.outer,
        }
    }

    /// E v: to the axes of the link that carries.
    pub fn apply(&self, v: &Vector3<S>) -> Vector3<S> {
        match self.inner {
            Some(inner) => self.outer * (inner * v),
            None => self.outer * v,
        }
    }

    /// Eᵀ v: to the axes of the link.
    pub fn back(&self, v: &Vector3<S>) -> Vector3<S> {
        let own = self.outer.transpose() * v;
        self.inner.map_or(own, |inner| inner.transpose() * own)
    }

    /// E I Eᵀ of a symmetric matrix.
    pub fn congruent(&self, symmetric: &Matrix3<S>) -> Matrix3<S> {
        let inner = self
            .inner
            .map_or(*symmetric, |inner| congruent(&inner, symmetric));
        congruent(&self.outer, &inner)
    }

    /// E M Eᵀ.
    pub fn similar(&self, matrix: &Matrix3<S>) -> Matrix3<S> {
        let inner = self
            .inner
            .map_or(*matrix, |inner| inner * matrix * inner.transpose());
        self.outer * inner * self.outer.transpose()
    }
}

/// The axis that a rotation is about, if it is one of the frame's; also of one that takes the axes to each other.
fn axis<S: Real>(rotation: &Matrix3<S>) -> Option<[usize; 2]> {
    let places = (0..9).map(|k| [k / 3, k % 3]);
    let mut fixed = places.filter(|&[i, j]| {
        let others = |k: usize| k != i && !rotation[(k, j)].is_zero();
        (rotation[(i, j)].is_one() || (-rotation[(i, j)]).is_one()) && !(0..3).any(others)
    });
    fixed.next()
}

/// R I Rᵀ, of which about an axis of the frame the two elements across change without their sum.
fn congruent<S: Real>(rotation: &Matrix3<S>, symmetric: &Matrix3<S>) -> Matrix3<S> {
    let half = rotation * symmetric;
    let mut moved = half * rotation.transpose();
    if let Some([row, column]) = axis(rotation) {
        let [a, b] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        if !rotation[(a, c)].is_zero() && !rotation[(a, d)].is_zero() {
            let sum = symmetric[(c, c)] + symmetric[(d, d)];
            moved[(b, b)] = sum - moved[(a, a)];
            moved[(b, a)] = moved[(a, b)];
        }
    }
    Matrix3::from_fn(|i, j| moved[(i.max(j), i.min(j))])
}

/// The elements of E.
fn labelled<S: Real>(turn: Matrix3<S>) -> Matrix3<S> {
    const NAMES: [[&str; 3]; 3] = [
        ["e11", "e12", "e13"],
        ["e21", "e22", "e23"],
        ["e31", "e32", "e33"],
    ];
    Matrix3::from_fn(|row, column| turn[(row, column)].label(NAMES[row][column]))
}
