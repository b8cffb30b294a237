//! Where everything of a scene is at a row of a history.

use mbd_runtime::Trajectory;
use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::{Numbers, ground};
use mbd_runtime::scene::{Place, Plane, Scene, rotation};

use super::surface::SurfaceSolid;

/// What is nearer to a solid than this share of its distance from the centre of mass touches it.
const CLEAR: f64 = 0.02;
/// Names of positions.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// A scene and a history of it.
pub(super) struct RecordedScene<'a> {
    pub scene: &'a Scene,
    pub trajectory: &'a Trajectory,
    pub numbers: Numbers<f64>,
    /// The motion of every body, as far as the history holds it.
    pub bodies: Vec<Option<Track<'a>>>,
    /// The motion of every point.
    pub points: Vec<Option<Track<'a>>>,
}

/// The columns of a motion.
pub(super) struct Track<'a> {
    /// Along x, y, z [m]; `None` along the normal of a planar scene.
    position: [Option<&'a [f64]>; 3],
    attitude: Option<AttitudeSource<'a>>,
}

/// The columns of an attitude.
enum AttitudeSource<'a> {
    /// w, x, y, z.
    Quaternion([&'a [f64]; 4]),
    /// The angle about the normal of a plane [rad].
    Angle(Plane, &'a [f64]),
}

impl<'a> Track<'a> {
    fn of(trajectory: &'a Trajectory, plane: Option<Plane>, owner: &str) -> Option<Self> {
        let column = |part: &str| trajectory.column(&format!("{owner}.{part}"));
        let mut position = [None; 3];
        for (axis, slot) in position.iter_mut().enumerate() {
            if plane.is_none_or(|plane| plane.normal() != axis) {
                *slot = Some(column(AXES.get(axis)?)?);
            }
        }
        let attitude = match plane {
            Some(plane) => column("angle").map(|angle| AttitudeSource::Angle(plane, angle)),
            None => match ["qw", "qx", "qy", "qz"].map(column) {
                [Some(w), Some(x), Some(y), Some(z)] => {
                    Some(AttitudeSource::Quaternion([w, x, y, z]))
                }
                _ => None,
            },
        };
        Some(Track { position, attitude })
    }

    /// Position [m].
    pub fn position(&self, row: usize) -> Option<Vector3<f64>> {
        let mut place = Vector3::zeros();
        for (axis, column) in self.position.iter().enumerate() {
            if let Some(column) = column {
                place[axis] = *column.get(row)?;
            }
        }
        Some(place)
    }

    /// Attitude as a quaternion w, x, y, z: body axes → world axes.
    pub fn quaternion(&self, row: usize) -> Option<[f64; 4]> {
        match self.attitude.as_ref()? {
            AttitudeSource::Quaternion(parts) => {
                let mut quaternion = [0.0; 4];
                for (number, part) in quaternion.iter_mut().zip(parts) {
                    *number = *part.get(row)?;
                }
                Some(quaternion)
            }
            AttitudeSource::Angle(plane, angle) => {
                let (sin, cos) = (0.5 * angle.get(row)?).sin_cos();
                let [x, y, z] = plane.axis().0;
                Some([cos, x * sin, y * sin, z * sin])
            }
        }
    }

    /// Body axes → world axes.
    pub fn turn(&self, row: usize) -> Option<Matrix3<f64>> {
        match self.attitude.as_ref()? {
            AttitudeSource::Angle(plane, angle) => Some(plane.axis().turn(*angle.get(row)?)),
            AttitudeSource::Quaternion(_) => self.quaternion(row).map(rotation),
        }
    }

    /// All columns.
    pub fn columns(&self) -> impl Iterator<Item = &'a [f64]> + '_ {
        let attitude: &[&[f64]] = match &self.attitude {
            Some(AttitudeSource::Quaternion(parts)) => parts,
            Some(AttitudeSource::Angle(_, angle)) => std::slice::from_ref(angle),
            None => &[],
        };
        let position = self.position.iter().copied().flatten();
        position.chain(attitude.iter().copied())
    }
}

impl<'a> RecordedScene<'a> {
    /// A history of a scene with these params (declaration order, SI).
    pub fn new(scene: &'a Scene, params: &[f64], trajectory: &'a Trajectory) -> Self {
        let track = |name: &str| Track::of(trajectory, scene.planar, name);
        RecordedScene {
            scene,
            trajectory,
            numbers: Numbers::new(scene, params),
            bodies: scene.bodies.iter().map(|body| track(&body.name)).collect(),
            points: scene
                .points
                .iter()
                .map(|point| {
                    // Nodes have three components, in a plane, too.
                    let own = track(&point.name);
                    own.or_else(|| Track::of(trajectory, None, &point.name))
                })
                .collect(),
        }
    }

    /// The solids of a body.
    pub fn solids(&self, body: usize) -> Vec<SurfaceSolid> {
        SurfaceSolid::of_body(self.scene, &self.numbers.params, body)
    }

    /// The frames of a body that are joined to its centre of mass by a line, since no solid of it shows where they are: all of a body without
    /// solids, otherwise those that something is held by and that stand clear of all of them.
    pub fn arms(&self, body: usize) -> Vec<usize> {
        let solids = self.solids(body);
        let Some(numbers) = self.numbers.bodies.get(body) else {
            return Vec::new();
        };
        let scene = self.scene;
        let joints = scene.joints.iter().filter(|joint| joint.law.rows() > 0);
        let joints = joints.flat_map(|joint| [joint.parent, joint.child]);
        let lines = scene.lines.iter().flat_map(|line| [line.from, line.to]);
        let held: Vec<Place> = joints.chain(lines).collect();
        let frames = numbers.frames.iter().enumerate();
        let shown = frames.filter(|(frame, numbers)| {
            let place = &numbers.position;
            let inside = |solid: &SurfaceSolid| solid.contains(place, CLEAR * place.norm());
            let bare = || held.contains(&Place::Body(body, *frame)) && !solids.iter().any(inside);
            place.norm() > 0.0 && (solids.is_empty() || bare())
        });
        shown.map(|(frame, _)| frame).collect()
    }

    /// The column of a thing, `riser.tension`.
    pub fn column(&self, owner: &str, part: &str) -> Option<&'a [f64]> {
        self.trajectory.column(&format!("{owner}.{part}"))
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
            Place::Point(point) => self.points.get(point)?.as_ref()?.position(row),
            Place::Body(body, frame) => {
                let track = self.bodies.get(body)?.as_ref()?;
                let arm = self.numbers.bodies.get(body)?.frames.get(frame)?.position;
                Some(track.position(row)? + track.turn(row)? * arm)
            }
        }
    }
}
