//! Starts that are said to be about a value: they are that where the loops close with it, and the nearest that they close with where not.
//!
//! ```text
//! min |a(y) − a0|   with Φ(y) = 0        a the coordinates that are said to be about a0 [rad and m, as numbers]                  (1)
//! y ← y + N z, then closed again         N spans ker Φ_y;  z = argmin |A N z − (a0 − a)|,  A = ∂a/∂y                              (2)
//! ```
//!
//! (2) ends where a step brings nothing nearer: there a0 − a is normal to what the loops allow. It is tried from several places of the coordinates
//! that nobody gave, and the nearest counts. Rejected: rows for a(y) = a0 of a small weight, whose valley a damped step follows too slowly.

use nalgebra::{DMatrix, DVector};

use super::close::{ITERATIONS, OpenRow, REACHES};
use super::{AboutStart, CLOSED, JointStart, Placement, PlacementError};
use crate::Quantity;
use crate::laws::turns::next_to;

/// Singular values of Φ_y below this part of the largest count as zero.
const SINGULAR: f64 = 1e-6;
/// Steps of (2) end where they bring it nearer by less than this part.
const SETTLED: f64 = 1e-12;
/// The least part of a step of (2) that is tried. At the edge of what a loop reaches, a = a1 − c s², a step along s is |a0 − a|/2cs, as long as s is short: what a least
/// part p leaves of a1 − a is p |a0 − a|/4.
const LEAST: f64 = 1e-10;

/// A joint coordinate, and the value that it is said to be about [m or rad].
#[derive(Clone, Copy)]
pub(super) struct Wish {
    pub joint: usize,
    pub coordinate: usize,
    pub value: f64,
}

/// What is said to be about a value.
pub(super) fn wishes(given: &[JointStart]) -> Vec<Wish> {
    let about = given.iter().filter(|start| start.about);
    let wish = about.filter_map(|start| {
        Some(Wish {
            joint: start.joint,
            coordinate: start.coordinate,
            value: start.value?,
        })
    });
    wish.collect()
}

impl Placement<'_> {
    /// Solves (1) from the coordinates as they are.
    pub(super) fn close_near(
        &mut self,
        unknowns: &[(usize, usize)],
        wishes: &[Wish],
        state: &mut [f64],
    ) -> Result<(), PlacementError> {
        let start = self.q.clone();
        let wished = |it: &(usize, usize)| wishes.iter().any(|w| (w.joint, w.coordinate) == *it);
        let others = unknowns.iter().copied().filter(|it| !wished(it));
        let mut others: Vec<(usize, usize)> = others.collect();
        if others.is_empty() {
            others.extend_from_slice(unknowns);
        }
        let (mut open, mut nearest, mut reversed) = (OpenRow::default(), None, None);
        for attempt in 0..REACHES.len() {
            self.q.clone_from(&start);
            self.scatter(&others, attempt);
            let gap = self.descend(unknowns, state);
            if gap.size > CLOSED {
                if gap.size < open.size {
                    open = gap;
                }
                continue;
            }
            self.approach(unknowns, wishes, state);
            if !self.is_on_branch(state) {
                reversed.get_or_insert_with(|| self.q.clone());
                continue;
            }
            let far = self.missing(wishes, state).norm();
            if nearest.as_ref().is_none_or(|(least, _)| far < *least) {
                nearest = Some((far, self.q.clone()));
            }
        }
        let found = nearest.map(|(_, q)| q).or(reversed);
        self.q = found.ok_or_else(|| self.open(open))?;
        Ok(())
    }

    /// Steps of (2), from where the loops are closed.
    fn approach(&mut self, unknowns: &[(usize, usize)], wishes: &[Wish], state: &mut [f64]) {
        for _ in 0..ITERATIONS {
            let missing = self.missing(wishes, state);
            let rows = self.slopes(unknowns, state, &|it, state| {
                it.rows(Quantity::Constraint, state)
            });
            let free = kernel(&rows);
            if free.is_empty() {
                return;
            }
            let moves = self.slopes(unknowns, state, &|it, state| -it.missing(wishes, state));
            let step = (moves * &free).svd(true, true).solve(&missing, SINGULAR);
            let Ok(step) = step.map(|z| free * z) else {
                return;
            };
            let (before, mut part) = (self.q.clone(), 1.0);
            let nearer = loop {
                for (&(joint, k), by) in unknowns.iter().zip(step.iter()) {
                    self.q[joint][k] += part * self.scale(joint, k) * by;
                }
                self.normalise();
                let gap = self.descend(unknowns, state);
                let left = self.missing(wishes, state).norm();
                if gap.size <= CLOSED && left < missing.norm() {
                    break missing.norm() - left;
                }
                self.q.clone_from(&before);
                part *= 0.5;
                if part < LEAST {
                    return;
                }
            };
            if nearer <= SETTLED * missing.norm() {
                return;
            }
        }
    }

    /// Whether what is said to be about a value has it.
    pub(super) fn grants(&mut self, wishes: &[Wish], state: &mut [f64]) -> bool {
        let missing = self.missing(wishes, state);
        let near = |(wish, missing): (&Wish, &f64)| {
            missing.abs() <= CLOSED.sqrt() * self.scale(wish.joint, wish.coordinate)
        };
        wishes.iter().zip(missing.iter()).all(near)
    }

    /// a0 − a of (1).
    fn missing(&mut self, wishes: &[Wish], state: &mut [f64]) -> DVector<f64> {
        let values = self.values(wishes, state);
        let missing = wishes.iter().zip(values);
        DVector::from_iterator(wishes.len(), missing.map(|(wish, x)| wish.value - x))
    }

    /// The coordinates as they are; of joints that close loops as their ends tell them. Angles are those next to what is wished: the turns that the search made
    /// are none of the run, and would make a near place a far one.
    fn values(&mut self, wishes: &[Wish], state: &mut [f64]) -> Vec<f64> {
        let placed: Vec<usize> = self.links.iter().map(|link| link.joint).collect();
        let placing = |wish: &Wish| placed.contains(&wish.joint);
        let told = match wishes.iter().all(placing) {
            true => DVector::zeros(0),
            false => self.rows(Quantity::Coordinates, state),
        };
        let value = |wish: &Wish| {
            let value = match placing(wish) {
                true => self.q[wish.joint][wish.coordinate],
                false => {
                    let value = told.get(self.place_in_coordinates(wish.joint, wish.coordinate));
                    value.copied().unwrap_or(f64::NAN)
                }
            };
            let law = &self.scene.joints[wish.joint].law;
            let of = law.measured().nth(wish.coordinate);
            match of.is_some_and(|coordinate| coordinate.is_periodic()) {
                true => next_to(value, wish.value),
                false => value,
            }
        };
        wishes.iter().map(value).collect()
    }

    /// Where [`Quantity::Coordinates`] has a coordinate; its rate is next.
    pub(super) fn place_in_coordinates(&self, joint: usize, coordinate: usize) -> usize {
        let before = self.scene.joints.iter().take(joint);
        let before: usize = before.map(|joint| joint.law.measured().count()).sum();
        2 * (before + coordinate)
    }

    /// What became of the wishes.
    pub(super) fn granted(&mut self, wishes: &[Wish], state: &mut [f64]) -> Vec<AboutStart> {
        let values = self.values(wishes, state);
        let granted = wishes.iter().zip(values).map(|(wish, taken)| AboutStart {
            joint: wish.joint,
            coordinate: wish.coordinate,
            said: wish.value,
            taken,
        });
        granted.collect()
    }

    /// What became of coordinates that the search only began at: those it is not at, and those that are said to be about a value.
    pub(super) fn gave_way(&mut self, near: &[JointStart], state: &mut [f64]) -> Vec<AboutStart> {
        let begun = near.iter().filter_map(|start| {
            let value = start.value?;
            let (joint, coordinate) = (start.joint, start.coordinate);
            let wish = Wish {
                joint,
                coordinate,
                value,
            };
            Some((wish, start.about))
        });
        let mut told = Vec::new();
        for (wish, about) in begun {
            if about || !self.grants(&[wish], state) {
                told.extend(self.granted(&[wish], state));
            }
        }
        told
    }

    /// Those of the coordinates that nobody gave with which loops close otherwise, too, whatever else stays as it is; of an attitude the first number.
    pub(super) fn undecided(
        &mut self,
        unknowns: &[(usize, usize)],
        state: &mut [f64],
    ) -> Vec<(usize, usize)> {
        if unknowns.is_empty() || self.holds_anywhere() {
            return Vec::new();
        }
        let rows = self.slopes(unknowns, state, &|it, state| {
            it.rows(Quantity::Constraint, state)
        });
        let largest = |rows: &DMatrix<f64>| {
            let norms = rows.column_iter().map(|it| it.norm());
            norms.fold(0.0, f64::max)
        };
        let least = SINGULAR * largest(&rows);
        let free = kernel(&self.with_lengths_of_quaternions(unknowns, &rows));
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (column, &(joint, k)) in unknowns.iter().enumerate() {
            // A coordinate that moves no loop is zero, as said.
            let in_loop = rows.column(column).norm() > least;
            if in_loop && free.row(column).norm() > SINGULAR {
                let attitude = self.scene.joints[joint].law.attitude();
                let first = attitude.filter(|attitude| attitude.contains(&k));
                open.push((joint, first.map_or(k, |attitude| attitude.start)));
            }
        }
        open.dedup();
        open
    }

    /// Rows, and below them those that hold the lengths of the quaternions among the coordinates.
    fn with_lengths_of_quaternions(
        &self,
        unknowns: &[(usize, usize)],
        rows: &DMatrix<f64>,
    ) -> DMatrix<f64> {
        let size = rows.amax();
        let mut held = rows.clone();
        for (joint, declared) in self.scene.joints.iter().enumerate() {
            let Some(attitude) = declared.law.attitude() else {
                continue;
            };
            let row = held.nrows();
            held = held.insert_row(row, 0.0);
            for (column, &(other, k)) in unknowns.iter().enumerate() {
                if other == joint && attitude.contains(&k) {
                    held[(row, column)] = size * self.q[joint][k];
                }
            }
        }
        held
    }
}

/// What a matrix takes to zero: orthonormal columns.
fn kernel(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.ncols() == 0 {
        return DMatrix::zeros(0, 0);
    }
    let normal = (matrix.transpose() * matrix).symmetric_eigen();
    let least = SINGULAR * SINGULAR * normal.eigenvalues.max().max(f64::MIN_POSITIVE);
    let own = normal.eigenvalues.iter().enumerate();
    let zero: Vec<usize> = own.filter(|(_, x)| **x <= least).map(|it| it.0).collect();
    normal.eigenvectors.select_columns(&zero)
}
