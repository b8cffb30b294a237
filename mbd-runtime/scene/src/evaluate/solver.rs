//! What the equations of motion are solved by: one for each family of coordinates, the same questions to both.

use nalgebra::Vector3;

use super::derivative::derivative;
use super::residual::residual;
use crate::elimination::Constraints;
use crate::laws::evaluation::Evaluation;
use crate::laws::forces::AppliedForces;
use crate::laws::mass;
use crate::tree::TreeSystem;
use crate::{Layout, Quantity, Real};

/// The equations of motion of one scene. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub(super) enum MotionSolver<S: Real> {
    /// Every body by itself, joints as rows.
    Absolute(Box<Constraints<S>>),
    /// Bodies carried along a tree.
    Relative(Box<TreeSystem<S>>),
}

use MotionSolver::{Absolute, Relative};

impl<S: Real> MotionSolver<S> {
    /// Room for the scene of a layout.
    pub fn new(layout: &Layout) -> Self {
        match layout.tree {
            None => Absolute(Box::new(Constraints::new(layout))),
            Some(_) => Relative(Box::new(TreeSystem::new(layout))),
        }
    }

    /// Solves for accelerations and multipliers, where anything has to be solved.
    pub fn accelerate(&mut self, evaluation: &Evaluation<'_, S>, assembly: &AppliedForces<S>) {
        match self {
            Absolute(_) if evaluation.layout.nc == 0 => {}
            Absolute(constraints) => constraints.accelerate(evaluation, assembly),
            Relative(tree) => tree.accelerate(evaluation, assembly),
        }
    }

    /// Writes ẋ, after [`MotionSolver::accelerate`].
    pub fn write_derivative(
        &self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        match self {
            Absolute(constraints) => derivative(evaluation, assembly, constraints, out),
            Relative(tree) => tree.write_derivative(evaluation, out),
        }
    }

    /// Accelerations of every body for v̇, where they are no part of it.
    pub fn body_accelerations(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        rates: &[S],
        out: &mut Vec<[Vector3<S>; 2]>,
    ) {
        match self {
            Absolute(_) => out.clear(),
            Relative(tree) => tree.body_accelerations(evaluation, rates, out),
        }
    }

    /// Writes multipliers or reactions, after [`MotionSolver::accelerate`].
    pub fn write_solved(
        &mut self,
        what: Quantity,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        match self {
            Absolute(constraints) => constraints.write_forces(what, evaluation, out),
            Relative(tree) => tree.write_solved(what, evaluation, assembly, out),
        }
    }

    /// Power that prescribed motions put in through the joints [W], after [`MotionSolver::accelerate`].
    pub fn drive_power(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
    ) -> S {
        match self {
            Absolute(constraints) => constraints.drive_power(evaluation),
            Relative(tree) => tree.drive_power(evaluation, assembly),
        }
    }

    /// Writes M.
    pub fn write_mass(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(_) => mass::mass_matrix(evaluation, out),
            Relative(tree) => tree.write_mass(evaluation, out),
        }
    }

    /// Writes h.
    pub fn write_bias(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(_) => mass::bias_force(evaluation, out),
            Relative(tree) => tree.write_bias(evaluation, out),
        }
    }

    /// Writes the applied forces f.
    pub fn write_applied(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        match self {
            Absolute(_) => mass::applied_forces(evaluation, assembly, out),
            Relative(tree) => tree.write_forces(evaluation, assembly, out),
        }
    }

    /// Writes Φ, Φ_v, Φ_v v + Φ_t or γ.
    pub fn write_rows(&mut self, what: Quantity, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(constraints) => constraints.write(what, evaluation, out),
            Relative(tree) => tree.write_rows(what, evaluation, out),
        }
    }

    /// Writes the projection step and the margin of the factor.
    pub fn correct(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(constraints) => constraints.correct(evaluation, out),
            Relative(tree) => tree.correct(evaluation, out),
        }
    }

    /// Writes the equations of motion before they are solved.
    pub fn write_residual(
        &mut self,
        evaluation: &Evaluation<'_, S>,
        assembly: &AppliedForces<S>,
        out: &mut [S],
    ) {
        match self {
            Absolute(constraints) => residual(evaluation, assembly, constraints, out),
            Relative(tree) => tree.write_residual(evaluation, assembly, out),
        }
    }

    /// Eliminates and writes the factor.
    pub fn write_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(constraints) => constraints.write_factor(evaluation, out),
            Relative(tree) => tree.write_factor(evaluation, out),
        }
    }

    /// Solves by a factor.
    pub fn solve_by_factor(&mut self, evaluation: &Evaluation<'_, S>, out: &mut [S]) {
        match self {
            Absolute(constraints) => constraints.solve_by_factor(evaluation, out),
            Relative(tree) => tree.solve_by_factor(evaluation, out),
        }
    }

    /// The scratch of the tree.
    pub fn tree(&mut self) -> Option<&mut TreeSystem<S>> {
        match self {
            Absolute(_) => None,
            Relative(tree) => Some(tree),
        }
    }
}
