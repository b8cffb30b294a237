//! Loops are closed by the coordinates that nobody gave: (3) of [`super`].

use nalgebra::{DMatrix, DVector};

use super::{CLOSED, FREE, JointStart, Placement, PlacementError, PlacementReport, about};
use crate::Quantity;
use crate::laws::turns::next_to;
use crate::laws::{branch, row_units};

/// Iterations that close the loops.
pub(super) const ITERATIONS: usize = 100;
/// Starts of y that are tried: zero, then others, ever further away [rad, or parts of the size of the mechanism].
pub(super) const REACHES: [f64; 8] = [0.0, 0.1, 0.3, 0.3, 1.0, 1.0, 2.0, 3.0];
/// Rates contradict each other where they leave the rows more than this part of what one of them asks for; less is what their digits leave.
const CONTRADICTION: f64 = 1e-3;
/// The step of the differences that linearise (3) [rad, or parts of the size of the mechanism].
const DIFFERENCE: f64 = 1e-6;

/// What stays open most.
#[derive(Clone, Copy)]
pub(super) struct OpenRow {
    pub size: f64,
    joint: usize,
    unit: &'static str,
}

impl Default for OpenRow {
    fn default() -> Self {
        OpenRow {
            size: f64::INFINITY,
            joint: 0,
            unit: "m",
        }
    }
}

impl Placement<'_> {
    pub(super) fn solve(
        &mut self,
        given: &[JointStart],
        state: &mut [f64],
    ) -> Result<PlacementReport, PlacementError> {
        let find = |joint: usize, coordinate: usize| {
            let mut starts = given.iter();
            starts.find(|start| (start.joint, start.coordinate) == (joint, coordinate))
        };
        let (mut unknowns, mut yielding) = (Vec::new(), Vec::new());
        let (mut said_rates, mut rates) = (Vec::new(), Vec::new());
        let in_loops = self.in_loops();
        for link in &self.links {
            let joint = link.joint;
            // What flies closes no loop.
            if self.scene.joints[joint].law.freedoms() == FREE {
                continue;
            }
            for k in 0..self.q[joint].len() {
                let start = find(joint, k);
                let open = start.and_then(|start| start.value).is_none();
                if open && in_loops.contains(&joint) {
                    unknowns.push((joint, k));
                }
                if start.is_some_and(|start| start.about && start.value.is_some()) {
                    yielding.push((joint, k));
                }
            }
            for k in 0..self.u[joint].len() {
                match find(joint, k).and_then(|start| start.rate) {
                    Some(_) => said_rates.push((joint, k)),
                    None => rates.push((joint, k)),
                }
            }
        }
        let wishes = about::wishes(given);
        let begun = self.q.clone();
        let closed = self.close(&unknowns, state);
        if wishes.is_empty() {
            closed?;
        } else if closed != Ok(true) || !self.grants(&wishes, state) {
            self.q.clone_from(&begun);
            let all: Vec<(usize, usize)> = unknowns.iter().chain(&yielding).copied().collect();
            self.close_near(&all, &wishes, state)?;
        }
        for coordinate in unknowns.iter().chain(&yielding) {
            self.take_out_turns(*coordinate, &begun, state);
        }
        self.close_rates([&said_rates, &rates], state)?;
        let assembly = PlacementReport {
            about: self.granted(&wishes, state),
            undecided: self.undecided(&unknowns, state),
        };
        self.walk(state);
        Ok(assembly)
    }

    /// Whether every joint is on the branch it means: rows have more roots than that.
    pub(super) fn is_on_branch(&self, state: &mut [f64]) -> bool {
        self.walk(state);
        let place = self.here(state);
        let at = place.at();
        let mut held = (0..self.layout.joints.len()).filter(|&j| self.layout.starts_joined(j));
        held.all(|joint| {
            let signs = branch(self.scene, self.layout, &self.numbers, &at, joint);
            signs.iter().all(|sign| *sign > 0.0)
        })
    }

    /// Whether the loops close on the branches that joints mean half a turn of one angle from here; where none does, nothing is changed.
    fn turns_back(&mut self, unknowns: &[(usize, usize)], state: &mut [f64]) -> bool {
        let here = self.q.clone();
        for &(joint, k) in unknowns {
            let mut measured = self.scene.joints[joint].law.measured();
            if !measured
                .nth(k)
                .is_some_and(|coordinate| coordinate.is_angle())
            {
                continue;
            }
            self.q[joint][k] += std::f64::consts::PI;
            let gap = self.descend(unknowns, state);
            if gap.size <= CLOSED && self.is_on_branch(state) {
                return true;
            }
            self.q.clone_from(&here);
        }
        false
    }

    /// An angle next to where the search for it began: full turns that the search made are none of the mechanism, and springs and stops would count them.
    fn take_out_turns(
        &mut self,
        (joint, k): (usize, usize),
        begun: &[Vec<f64>],
        state: &mut [f64],
    ) {
        let mut measured = self.scene.joints[joint].law.measured();
        if !measured.nth(k).is_some_and(|it| it.is_periodic()) {
            return;
        }
        let found = self.q[joint][k];
        let next = next_to(found, begun[joint][k]);
        if next != found {
            self.q[joint][k] = next;
            // Where a coupling holds it at its turn, it stays.
            if self.rows(Quantity::Constraint, state).amax() > CLOSED {
                self.q[joint][k] = found;
            }
        }
    }

    /// Moves coordinates away from where they are, each attempt further; the first leaves them.
    pub(super) fn scatter(&mut self, unknowns: &[(usize, usize)], attempt: usize) {
        let reach = REACHES.get(attempt).copied().unwrap_or_default();
        for (number, &(joint, k)) in unknowns.iter().enumerate() {
            // Any numbers do that are unlike: no coordinate at the same place twice.
            let turn = 2.4 * (number + 7 * attempt) as f64;
            self.q[joint][k] += reach * self.scale(joint, k) * turn.sin();
        }
        self.normalise();
    }

    /// Solves (3) for the coordinates; whether every joint is on the branch it means. Where it closes only with joints reversed, which a start refuses
    /// by name, that is what stays.
    fn close(
        &mut self,
        unknowns: &[(usize, usize)],
        state: &mut [f64],
    ) -> Result<bool, PlacementError> {
        let start = self.q.clone();
        let mut best = OpenRow::default();
        let mut other_branch = None;
        for attempt in 0..REACHES.len() {
            self.q.clone_from(&start);
            self.scatter(unknowns, attempt);
            let gap = self.descend(unknowns, state);
            if gap.size <= CLOSED {
                if self.is_on_branch(state) || self.turns_back(unknowns, state) {
                    return Ok(true);
                }
                other_branch.get_or_insert_with(|| self.q.clone());
            } else if gap.size < best.size {
                best = gap;
            }
        }
        match other_branch {
            Some(q) => self.q = q,
            None => return Err(self.open(best)),
        }
        Ok(false)
    }

    /// Damped least squares from here; what stays open most.
    pub(super) fn descend(&mut self, unknowns: &[(usize, usize)], state: &mut [f64]) -> OpenRow {
        let mut gaps = self.rows(Quantity::Constraint, state);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            if gaps.amax() <= CLOSED || unknowns.is_empty() {
                break;
            }
            let slopes = self.slopes(unknowns, state, &|it, state| {
                it.rows(Quantity::Constraint, state)
            });
            let normal = slopes.transpose() * &slopes;
            let right = slopes.transpose() * &gaps;
            let scale = normal.diagonal().max();
            let damped = normal
                + DMatrix::from_diagonal_element(unknowns.len(), unknowns.len(), damping * scale);
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&right)) else {
                break;
            };
            let before = self.q.clone();
            for (&(joint, k), step) in unknowns.iter().zip(step.iter()) {
                self.q[joint][k] -= self.scale(joint, k) * step;
            }
            self.normalise();
            let tried = self.rows(Quantity::Constraint, state);
            if tried.norm() < gaps.norm() {
                gaps = tried;
                damping = (damping * 0.1).max(1e-14);
            } else {
                self.q = before;
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        let size = gaps.amax();
        if size <= CLOSED {
            return OpenRow {
                size,
                joint: 0,
                unit: "m",
            };
        }
        let worst = gaps.iamax();
        let joint = self.joint_of(worst);
        let size = if size.is_finite() {
            size
        } else {
            f64::INFINITY
        };
        let unit = self.unit_of(joint, worst, state);
        OpenRow { size, joint, unit }
    }

    /// What is said of a loop that stays open.
    pub(super) fn open(&self, row: OpenRow) -> PlacementError {
        PlacementError::Open {
            joint: row.joint,
            gap: match row.unit {
                "m" => row.size * self.length,
                _ => row.size,
            },
            unit: row.unit,
        }
    }

    /// The unit of a row of a joint.
    fn unit_of(&self, joint: usize, row: usize, state: &[f64]) -> &'static str {
        let place = self.here(state);
        let units = row_units(self.scene, self.layout, &self.numbers, &place.at(), joint);
        let first = self.layout.joints.get(joint).map_or(0, |slots| slots.row);
        units.get(row.saturating_sub(first)).copied().unwrap_or("m")
    }

    /// Solves (3) for the rates: the smallest that do. Rates that are `said` and contradict each other by more than their digits are told.
    fn close_rates(
        &mut self,
        [said, rates]: [&[(usize, usize)]; 2],
        state: &mut [f64],
    ) -> Result<(), PlacementError> {
        if self.rows(Quantity::ConstraintRate, state).amax() <= CLOSED {
            return Ok(());
        }
        for &(joint, k) in rates {
            self.u[joint][k] = 0.0;
        }
        let mut gaps = self.rows(Quantity::ConstraintRate, state);
        if !rates.is_empty() {
            let mut slopes = DMatrix::zeros(gaps.len(), rates.len());
            for (column, &(joint, k)) in rates.iter().enumerate() {
                self.u[joint][k] = 1.0;
                slopes.set_column(
                    column,
                    &(self.rows(Quantity::ConstraintRate, state) - &gaps),
                );
                self.u[joint][k] = 0.0;
            }
            if let Ok(found) = slopes.svd(true, true).solve(&gaps, 1e-9) {
                for (&(joint, k), rate) in rates.iter().zip(found.iter()) {
                    self.u[joint][k] = -rate;
                }
            }
            gaps = self.rows(Quantity::ConstraintRate, state);
        }
        // What each of them alone asks of the rows: the size that a contradiction is measured by.
        let mut size: f64 = 0.0;
        for &(joint, k) in said {
            let rate = std::mem::take(&mut self.u[joint][k]);
            let without = self.rows(Quantity::ConstraintRate, state);
            self.u[joint][k] = rate;
            size = size.max((&gaps - without).amax());
        }
        match !said.is_empty() && gaps.amax() > CONTRADICTION * size {
            true => Err(PlacementError::Rates {
                joint: self.joint_of(gaps.iamax()),
            }),
            false => Ok(()),
        }
    }

    /// The joint of a row.
    fn joint_of(&self, row: usize) -> usize {
        let mut rows = self.layout.joints.iter();
        let joint = rows.position(|slots| (slots.row..slots.row + slots.len).contains(&row));
        joint.unwrap_or(0)
    }

    /// The derivative of what the coordinates decide by some of them, by differences; the coordinates as parts of their [scales](Self::scale). The
    /// length of a quaternion decides nothing: rows of one that is no unit say what depends on how they are written.
    pub(super) fn slopes(
        &mut self,
        unknowns: &[(usize, usize)],
        state: &mut [f64],
        of: &dyn Fn(&mut Self, &mut [f64]) -> DVector<f64>,
    ) -> DMatrix<f64> {
        let mut columns = Vec::with_capacity(unknowns.len());
        for &(joint, k) in unknowns {
            let here = self.q[joint].clone();
            let by = DIFFERENCE * self.scale(joint, k);
            let mut at = |by: f64| {
                self.q[joint].clone_from(&here);
                self.q[joint][k] += by;
                self.normalise_joint(joint);
                of(self, state)
            };
            let difference = at(by) - at(-by);
            self.q[joint] = here;
            columns.push(difference / (2.0 * DIFFERENCE));
        }
        match columns.is_empty() {
            true => DMatrix::zeros(of(self, state).len(), 0),
            false => DMatrix::from_columns(&columns),
        }
    }
}
