//! Bodies without mass: whether what they carry gives every joint an inertia.

use mbd_scene::{Float, Layout, Place, Quantity, Scene};
use nalgebra::{Cholesky, DMatrix, Dyn};

use super::System;
use crate::columns::state_names;
use crate::error::StepError;

/// What is left of an inertia, relative, that is all rounding.
const ROUNDED: f64 = 1e-12;

/// What is left of one that vanishes where steps have shrunk to nothing: accelerations grow as its inverse.
const VANISHING: f64 = 1e-6;

impl<T: Float> System<T> {
    /// Whether the mass matrix of a scene with such bodies is positive at a state.
    ///
    /// # Errors
    /// The first speed whose inertia, with all before it free to move, is none.
    pub(crate) fn check_inertia(&mut self, time: f64, state: &[T]) -> Result<(), StepError> {
        self.lost_inertia((time, state), ROUNDED)
            .map_or(Ok(()), Err)
    }

    /// The same where steps have shrunk to nothing: whether it is an inertia that vanishes there.
    #[cold]
    pub(crate) fn vanishing_inertia(&mut self, time: f64, state: &[T]) -> Option<StepError> {
        self.lost_inertia((time, state), VANISHING)
    }

    fn lost_inertia(&mut self, (time, state): (f64, &[T]), least: f64) -> Option<StepError> {
        let model = self.model.clone();
        let (scene, layout) = (model.scene(), model.layout());
        if !(0..scene.bodies.len()).any(|body| scene.is_carried(body)) {
            return None;
        }
        let mut mass = vec![0.0; layout.len(Quantity::MassMatrix)];
        self.by_laws(Quantity::MassMatrix, time, state, &mut mass);
        let mass = DMatrix::from_row_slice(layout.nv, layout.nv, &mass);
        let speed = without_inertia(&mass, least)?;
        let name = state_names(scene, layout)
            .into_iter()
            .nth(layout.nq + speed);
        let speed = name.map_or_else(String::new, |speed| speed.name);
        let loops = closing(scene, layout);
        Some(StepError::NoInertia { time, speed, loops })
    }
}

/// The joints that close loops by rows on bodies that may be without mass, with these bodies.
fn closing(scene: &Scene, layout: &Layout) -> Vec<[String; 2]> {
    let of_tree: Vec<usize> = layout.joint_links().map(|(joint, _)| joint).collect();
    let joints = scene.joints.iter().enumerate();
    let closing = joints.filter(|(joint, own)| {
        let has_rows = layout.joints.get(*joint).is_some_and(|rows| rows.len > 0);
        has_rows && own.law.couples().is_empty() && !of_tree.contains(joint)
    });
    let ends = closing.flat_map(|(_, own)| [own.parent, own.child].map(|end| (own, end)));
    let on_carried = ends.filter_map(|(joint, end)| match end {
        Place::Body(body, _) if scene.is_carried(body) => {
            Some([joint.name.clone(), scene.bodies.get(body)?.name.clone()])
        }
        _ => None,
    });
    on_carried.collect()
}

/// The first of n speeds of whose inertia no more than a part is left where all before it are free to move.
fn without_inertia(mass: &DMatrix<f64>, least: f64) -> Option<usize> {
    let is_positive = |speeds: usize| {
        let own = mass.view((0, 0), (speeds, speeds)).into_owned();
        let positive = |factor: Cholesky<f64, Dyn>| {
            let lower = factor.l_dirty();
            (0..speeds).all(|k| lower[(k, k)].powi(2) > least * mass[(k, k)])
        };
        own.cholesky().is_some_and(positive)
    };
    let n = mass.nrows();
    match is_positive(n) {
        true => None,
        false => (0..n).find(|speed| !is_positive(speed + 1)),
    }
}
