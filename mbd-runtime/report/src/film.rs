//! The instants of a history that a page shows: every thing of the scene at each of them.

use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::{BodyNumbers, FrameNumbers, GravityNumbers};
use mbd_runtime::scene::{Axis, Coordinate, Joint, LoadKind, Measure, Place, PointKind};

use super::drawn::{
    Drawn, DrawnArrow, DrawnBody, DrawnFrame, DrawnJoint, DrawnLine, DrawnPoint, DrawnShape,
    DrawnSolid, place, safe,
};
use super::mechanism::{upwards, views};
use super::packing::PackedArray;
use super::stage::{AXES, RecordedScene};

/// An instant between two rows of a history.
#[derive(Clone, Copy)]
struct FilmInstant {
    time: f64,
    row: usize,
    next: usize,
    /// The share of the way to the next row; not a number beyond the history.
    share: f64,
}

/// The instants of a history that are shown.
pub(super) struct Film<'a> {
    stage: &'a RecordedScene<'a>,
    instants: Vec<FilmInstant>,
}

impl<'a> Film<'a> {
    /// Rows as they are.
    pub fn of_rows(stage: &'a RecordedScene<'a>, rows: &[usize]) -> Self {
        let times = stage.trajectory.times();
        let instant = |row: &usize| {
            Some(FilmInstant {
                time: *times.get(*row)?,
                row: *row,
                next: *row,
                share: 0.0,
            })
        };
        Film {
            stage,
            instants: rows.iter().filter_map(instant).collect(),
        }
    }

    /// Times, straight between the rows around them; no numbers before the first row and after the last.
    pub fn at_times(stage: &'a RecordedScene<'a>, wanted: &[f64]) -> Self {
        let times = stage.trajectory.times();
        let instant = |time: f64| {
            let next = times
                .partition_point(|t| *t < time)
                .min(times.len().saturating_sub(1));
            let row = next.saturating_sub(1);
            let [from, to] = [row, next].map(|row| times.get(row).copied().unwrap_or(f64::NAN));
            let share = match to > from {
                _ if time < from || time > to => f64::NAN,
                true => (time - from) / (to - from),
                false => 0.0,
            };
            FilmInstant {
                time,
                row,
                next,
                share,
            }
        };
        Film {
            stage,
            instants: wanted.iter().map(|time| instant(*time)).collect(),
        }
    }

    /// A number at every instant.
    fn numbers(&self, column: &[f64]) -> PackedArray {
        let at = |instant: &FilmInstant| {
            let [a, b] =
                [instant.row, instant.next].map(|row| column.get(row).copied().unwrap_or(f64::NAN));
            if instant.share == 0.0 {
                a
            } else {
                a + instant.share * (b - a)
            }
        };
        PackedArray::floats(self.instants.iter().map(at))
    }

    pub fn drawn(&self) -> Drawn {
        let scene = self.stage.scene;
        let upwards = upwards(scene, &self.stage.numbers);
        let mut up = [0.0; 3];
        // Gravity may point along +z: up is where it does not point.
        up[upwards] = match &self.stage.numbers.gravity {
            GravityNumbers::Uniform(pull) if pull[upwards] > 0.0 => -1.0,
            _ => 1.0,
        };
        let from = scene.planar.and_then(|plane| {
            let mut extents = Vector3::repeat(1.0);
            extents[plane.normal()] = 0.0;
            let [across, above] = *views(extents, Some(plane), upwards).first()?;
            let axis = |k: usize| Vector3::from_fn(|i, _| f64::from(u8::from(i == k)));
            Some(axis(across).cross(&axis(above)).into())
        });
        // What flies freely is held by nothing.
        let held = scene.joints.iter().filter(|joint| joint.law.rows() > 0);
        let mut solids = Vec::new();
        let bodies = (0..scene.bodies.len()).filter_map(|k| self.body(k, &mut solids));
        Drawn {
            bodies: bodies.collect(),
            solids,
            times: PackedArray::floats(self.instants.iter().map(|instant| instant.time)),
            up,
            from,
            points: (0..scene.points.len())
                .filter_map(|k| self.point(k))
                .collect(),
            frames: (0..scene.world_frames.len())
                .filter_map(|k| self.frame(k))
                .collect(),
            joints: held.map(|joint| self.joint(joint)).collect(),
            lines: (0..scene.lines.len())
                .filter_map(|k| self.line(k))
                .collect(),
            arrows: scene
                .joints
                .iter()
                .flat_map(|joint| self.reactions(joint))
                .collect(),
        }
    }

    /// Three numbers a row; not numbers where the history does not hold them.
    fn vectors(&self, at: impl Fn(usize) -> Option<Vector3<f64>>) -> PackedArray {
        let place = |row| at(row).unwrap_or_else(|| Vector3::repeat(f64::NAN));
        let vector = |instant: &FilmInstant| match instant.share == 0.0 {
            true => place(instant.row),
            false => place(instant.row).lerp(&place(instant.next), instant.share),
        };
        let instants = self.instants.iter();
        PackedArray::floats(instants.flat_map(|instant| <[f64; 3]>::from(vector(instant))))
    }

    /// A body; what its shapes look like is added to the solids, if it is not among them.
    fn body(&self, index: usize, solids: &mut Vec<DrawnSolid>) -> Option<DrawnBody> {
        let (scene, numbers) = (self.stage.scene, &self.stage.numbers);
        let (body, numbers) = (scene.bodies.get(index)?, numbers.bodies.get(index)?);
        let track = self.stage.bodies.get(index)?.as_ref();
        let attitude = |row| {
            let parts = track.and_then(|track| track.quaternion(row));
            parts.unwrap_or([1.0, 0.0, 0.0, 0.0])
        };
        let quaternion = |instant: &FilmInstant| {
            let (a, b) = (attitude(instant.row), attitude(instant.next));
            match instant.share == 0.0 {
                true => a,
                false => between(a, b, instant.share),
            }
        };
        let ellipsoid = ellipsoid(numbers);
        let mut reach = Vector3::zeros();
        let mut extend = |place: Vector3<f64>| reach = place.abs().sup(&reach);
        let mut shapes = Vec::new();
        for placed in self.stage.solids(index) {
            let surface = placed.surface();
            let places = surface.places.iter();
            places.for_each(|place| extend(placed.on_body(place)));
            let drawn = DrawnSolid::of(&surface);
            let known = solids.iter().position(|solid| *solid == drawn);
            let solid = known.unwrap_or_else(|| {
                solids.push(drawn);
                solids.len() - 1
            });
            let rows = [0, 1, 2].map(|k| placed.turn.row(k).transpose().into());
            shapes.push(DrawnShape {
                solid,
                at: placed.at.into(),
                turn: rows,
            });
        }
        if shapes.is_empty() {
            let axes = ellipsoid.iter().flatten().map(|axis| Vector3::from(*axis));
            let squares = axes.map(|axis| axis.component_mul(&axis));
            extend(squares.sum::<Vector3<f64>>().map(f64::sqrt));
        }
        Some(DrawnBody {
            name: safe(&body.name),
            p: self.vectors(|row| track?.position(row)),
            q: PackedArray::shares(self.instants.iter().flat_map(quaternion)),
            arms: numbers
                .frames
                .iter()
                .map(|frame| frame.position.into())
                .collect(),
            rods: self.stage.arms(index),
            ends: body.frames.iter().map(|frame| safe(&frame.name)).collect(),
            reach: reach.into(),
            ellipsoid,
            shapes,
        })
    }

    fn point(&self, index: usize) -> Option<DrawnPoint> {
        let point = self.stage.scene.points.get(index)?;
        let track = self.stage.points.get(index)?.as_ref();
        Some(DrawnPoint {
            name: safe(&point.name),
            node: matches!(point.kind, PointKind::Node(_)),
            p: self.vectors(|row| track?.position(row)),
        })
    }

    fn frame(&self, index: usize) -> Option<DrawnFrame> {
        let scene = self.stage.scene;
        let frame = scene.world_frames.get(index)?;
        let here = Place::World(index);
        let rows = scene.joints.iter().filter(|joint| joint.law.rows() > 0);
        let mut ends = rows.flat_map(|joint| [joint.parent, joint.child]);
        let mut lines = scene.lines.iter().flat_map(|line| [line.from, line.to]);
        let place = |row| self.stage.world_frame(index, row);
        Some(DrawnFrame {
            name: safe(&frame.name),
            used: ends.any(|end| end == here) || lines.any(|end| end == here),
            p: match frame.moves(scene) {
                true => self.vectors(place),
                false => PackedArray::floats(place(0).map(<[f64; 3]>::from).into_iter().flatten()),
            },
        })
    }

    fn joint(&self, joint: &Joint) -> DrawnJoint {
        let coordinates = (0..6).filter_map(|k| joint.law.coordinate(k));
        let mut axes = Vec::new();
        for (axis, end) in coordinates.filter_map(|coordinate| axis(&coordinate)) {
            let place = [joint.parent, joint.child][end];
            if let Some((direction, body)) = self.direction(place, axis)
                && !axes.contains(&(direction, body, end))
            {
                axes.push((direction, body, end));
            }
        }
        DrawnJoint {
            name: safe(&joint.name),
            kind: joint.law.keyword(),
            a: place(joint.parent),
            b: place(joint.child),
            axes,
        }
    }

    /// An axis of a frame in the axes of its body; of a frame of the world that turns there is none.
    fn direction(&self, place: Place, axis: Vector3<f64>) -> Option<([f64; 3], i64)> {
        let numbers = &self.stage.numbers;
        let along = |frame: &FrameNumbers<f64>| match frame.rotation {
            Some(rotation) => rotation * axis,
            None => axis,
        };
        match place {
            Place::World(frame) => {
                let declared = self.stage.scene.world_frames.get(frame)?;
                let still = declared.rotation.is_none() || !declared.moves(self.stage.scene);
                let frame = numbers.world_frames.get(frame).filter(|_| still)?;
                Some((along(frame).into(), -1))
            }
            Place::Body(body, frame) => {
                let frame = numbers.bodies.get(body)?.frames.get(frame)?;
                Some((along(frame).into(), body as i64))
            }
            Place::Point(_) => None,
        }
    }

    fn line(&self, index: usize) -> Option<DrawnLine> {
        let line = self.stage.scene.lines.get(index)?;
        let [tension, stretch] =
            ["tension", "stretch"].map(|part| self.stage.column(&line.name, part));
        let (tension, stretch) = (tension?, stretch?);
        let one_way = line.kind.is_unilateral();
        let slack = |instant: &FilmInstant| {
            let stretch = stretch.get(instant.row);
            one_way && stretch.is_some_and(|x| *x <= 0.0)
        };
        Some(DrawnLine {
            name: safe(&line.name),
            a: place(line.from),
            b: place(line.to),
            tension: self.numbers(tension),
            slack: PackedArray::flags(self.instants.iter().map(slack)),
        })
    }

    /// A load that is not zero all the time.
    pub fn load(&self, (index, values): &(usize, Vec<[f64; 3]>)) -> Option<DrawnArrow> {
        let load = self.stage.scene.loads.get(*index)?;
        let unit = match load.kind {
            LoadKind::Torque(_) => "N*m",
            LoadKind::Force(_) | LoadKind::External => "N",
        };
        let acts = values.iter().flatten().any(|x| *x != 0.0);
        acts.then(|| DrawnArrow {
            name: format!("load {}", safe(&load.name)),
            unit,
            at: place(load.at),
            v: PackedArray::floats(values.iter().flatten().copied()),
        })
    }

    /// Force and torque of a joint on its child, where the history holds them and they are not zero all the time.
    fn reactions(&self, joint: &Joint) -> Vec<DrawnArrow> {
        let arrow = |(part, unit): (&str, &'static str)| {
            let owner = format!("{}.{part}", joint.name);
            let [x, y, z] = AXES.map(|axis| self.stage.column(&owner, axis));
            let (x, y, z) = (x?, y?, z?);
            let acts = [x, y, z]
                .iter()
                .any(|column| column.iter().any(|v| *v != 0.0));
            let vector = |row: usize| Some(Vector3::new(*x.get(row)?, *y.get(row)?, *z.get(row)?));
            acts.then(|| DrawnArrow {
                name: format!("{part} of {} on its child", safe(&joint.name)),
                unit,
                at: place(joint.child),
                v: self.vectors(vector),
            })
        };
        [("force", "N"), ("torque", "N*m")]
            .into_iter()
            .filter_map(arrow)
            .collect()
    }
}

/// Between two attitudes the shorter way, of unit length.
fn between(a: [f64; 4], b: [f64; 4], share: f64) -> [f64; 4] {
    let along: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    let mixed = [0, 1, 2, 3].map(|k| a[k] + share * (sign * b[k] - a[k]));
    let length = mixed.iter().map(|x| x * x).sum::<f64>().sqrt();
    mixed.map(|x| x / length)
}

/// The axis of a coordinate, and in the frame of which end: 0 the parent's, 1 the child's.
fn axis(coordinate: &Coordinate) -> Option<(Vector3<f64>, usize)> {
    let vector = |axis: &Axis| Vector3::from(axis.0);
    match &coordinate.measure {
        Measure::Slide(axis) | Measure::Thread { axis, .. } => Some((vector(axis), 0)),
        Measure::Angle { cosine, sine } => (0..2).find_map(|end| {
            let across = vector(&cosine[end]).cross(&vector(&sine[end]));
            (across.norm() > 1e-6).then(|| (across.normalize(), end))
        }),
    }
}

/// Half axes of the homogeneous ellipsoid of the same mass and inertia, body axes [m]: a² = 5 (I₂ + I₃ − I₁) / 2m along the first principal axis.
/// `None` of what is no such body.
pub(super) fn ellipsoid(numbers: &BodyNumbers<f64>) -> Option<[[f64; 3]; 3]> {
    let (mass, inertia): (f64, Matrix3<f64>) = (numbers.mass, numbers.inertia);
    if !(mass > 0.0 && mass.is_finite() && inertia.iter().all(|x| x.is_finite())) {
        return None;
    }
    let principal = inertia.symmetric_eigen();
    let moments = principal.eigenvalues;
    let axis = |k: usize| {
        let square = 2.5 * (moments.sum() - 2.0 * moments[k]) / mass;
        let axis: Vector3<f64> = principal.eigenvectors.column(k) * square.max(0.0).sqrt();
        <[f64; 3]>::from(axis)
    };
    let axes = [0, 1, 2].map(axis);
    axes.iter().any(|axis| length(axis) > 0.0).then_some(axes)
}

fn length([x, y, z]: &[f64; 3]) -> f64 {
    x.hypot(*y).hypot(*z)
}
