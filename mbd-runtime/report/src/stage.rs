//! Where everything of a scene is at a row of a history.

use mbd_runtime::Trajectory;
use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::{Numbers, ground};
use mbd_runtime::scene::{Place, Scene, rotation};

/// Names of positions.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// What is needed to place things.
pub(super) struct Stage<'a> {
    pub scene: &'a Scene,
    pub trajectory: &'a Trajectory,
    pub numbers: Numbers<f64>,
}

impl<'a> Stage<'a> {
    /// A history of a scene with these params (declaration order, SI).
    pub fn new(scene: &'a Scene, params: &[f64], trajectory: &'a Trajectory) -> Self {
        Stage {
            scene,
            trajectory,
            numbers: Numbers::new(scene, params),
        }
    }

    pub fn read<const N: usize>(
        &self,
        owner: &str,
        parts: [&str; N],
        row: usize,
    ) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for (number, part) in numbers.iter_mut().zip(parts) {
            *number = *self
                .trajectory
                .column(&format!("{owner}.{part}"))?
                .get(row)?;
        }
        Some(numbers)
    }

    pub fn position(&self, owner: &str, row: usize) -> Option<Vector3<f64>> {
        let Some(plane) = self.scene.planar else {
            return self.read(owner, AXES, row).map(Vector3::from);
        };
        let mut position = Vector3::zeros();
        for axis in (0..3).filter(|&axis| axis != plane.normal()) {
            let [number] = self.read(owner, [*AXES.get(axis)?], row)?;
            position[axis] = number;
        }
        Some(position)
    }

    /// Body axes → world axes.
    pub fn turn(&self, owner: &str, row: usize) -> Option<Matrix3<f64>> {
        match self.scene.planar {
            None => Some(rotation(self.read(owner, ["qw", "qx", "qy", "qz"], row)?)),
            Some(plane) => {
                let [angle] = self.read(owner, ["angle"], row)?;
                Some(plane.axis().turn(angle))
            }
        }
    }

    /// A frame of the world, which may move [m].
    pub fn world_frame(&self, frame: usize, row: usize) -> Option<Vector3<f64>> {
        if !self.scene.world_frames.get(frame)?.moves(self.scene) {
            return Some(self.numbers.world_frames.get(frame)?.position);
        }
        let time = *self.trajectory.times().get(row)?;
        let mut moving = Vec::new();
        ground(self.scene, &self.numbers, time, &mut moving);
        Some(moving.get(frame)?.as_ref()?.position)
    }

    /// A place in world axes [m].
    pub fn place(&self, place: Place, row: usize) -> Option<Vector3<f64>> {
        match place {
            Place::World(frame) => self.world_frame(frame, row),
            Place::Point(point) => self.position(&self.scene.points.get(point)?.name, row),
            Place::Body(body, frame) => {
                let name = &self.scene.bodies.get(body)?.name;
                let arm = self.numbers.bodies.get(body)?.frames.get(frame)?.position;
                Some(self.position(name, row)? + self.turn(name, row)? * arm)
            }
        }
    }
}
