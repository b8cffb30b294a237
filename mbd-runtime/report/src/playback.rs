//! What a page needs to show a run as a moving drawing: the things of the scene, and where they are at the rows of the history.

use mbd_runtime::nalgebra::{Matrix3, Vector3};
use mbd_runtime::scene::laws::{BodyNumbers, FrameNumbers, GravityNumbers, constant};
use mbd_runtime::scene::{
    Axis, Coordinate, Formula, Joint, LoadKind, Measure, Place, PointKind, Scene, Triple,
};
use serde::Serialize;

use super::loads::loads;
use super::mechanism::{upwards, views};
use super::packing::Packed;
use super::stage::{AXES, Stage, Track};
use super::svg::visible;
use super::thin::motion_rows;
use super::views::Run;

/// The motions of a page are thinned to about this many bytes, before they become text.
const BYTES: usize = 1_500_000;
/// No history needs more rows than this to be watched.
const ROWS: usize = 20_000;

/// A run as a moving drawing, for [`Report::playback`](crate::Report::playback).
#[derive(Clone, Debug)]
pub struct Playback {
    pub(super) drawn: Drawn,
    pub(super) says: Vec<String>,
}

/// What the script of the page reads. Lengths in metres, forces in newtons, world axes.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Drawn {
    times: Packed,
    /// Up in the world.
    up: [f64; 3],
    /// Where a planar scene is looked at from.
    from: Option<[f64; 3]>,
    bodies: Vec<DrawnBody>,
    points: Vec<DrawnPoint>,
    frames: Vec<DrawnFrame>,
    joints: Vec<DrawnJoint>,
    lines: Vec<DrawnLine>,
    arrows: Vec<DrawnArrow>,
}

/// A place: 0 the world, 1 a body, 2 a point; its number; the number of its frame.
type DrawnPlace = (u8, usize, usize);

#[derive(Clone, Debug, Serialize)]
struct DrawnBody {
    name: String,
    p: Packed,
    q: Packed,
    /// Frames from the centre of mass, body axes.
    arms: Vec<[f64; 3]>,
    /// Their names.
    ends: Vec<String>,
    /// Half axes of the homogeneous ellipsoid of the same mass and inertia, body axes.
    ellipsoid: Option<[[f64; 3]; 3]>,
    /// How far what is drawn around the centre of mass reaches, along body axes.
    reach: [f64; 3],
    shapes: Vec<DrawnShape>,
}

#[derive(Clone, Debug, Serialize)]
struct DrawnShape {
    kind: &'static str,
    size: Vec<f64>,
    at: [f64; 3],
    /// Rows of the matrix from the axes of the shape to those of the body.
    turn: [[f64; 3]; 3],
}

#[derive(Clone, Debug, Serialize)]
struct DrawnPoint {
    name: String,
    node: bool,
    p: Packed,
}

#[derive(Clone, Debug, Serialize)]
struct DrawnFrame {
    name: String,
    /// Whether something is held by it.
    used: bool,
    p: Packed,
}

#[derive(Clone, Debug, Serialize)]
struct DrawnJoint {
    name: String,
    kind: &'static str,
    a: DrawnPlace,
    b: DrawnPlace,
    /// Axes: direction, the body in whose axes it is written (−1: the world), and at which end it lies.
    axes: Vec<([f64; 3], i64, usize)>,
}

#[derive(Clone, Debug, Serialize)]
struct DrawnLine {
    name: String,
    a: DrawnPlace,
    b: DrawnPlace,
    tension: Packed,
    slack: Packed,
}

/// A force or a couple at a place.
#[derive(Clone, Debug, Serialize)]
struct DrawnArrow {
    name: String,
    unit: &'static str,
    at: DrawnPlace,
    v: Packed,
}

impl Playback {
    /// A run of a scene. What the history does not hold is not shown, and the page says so.
    #[must_use]
    pub fn new(run: &Run<'_>) -> Self {
        let stage = Stage::new(run.scene, run.params, run.trajectory);
        let rows = rows(&stage);
        let acting = loads((run.scene, run.params), run.inputs, (run.trajectory, &rows));
        let film = Film {
            stage: &stage,
            rows: &rows,
        };
        let mut drawn = film.drawn();
        drawn
            .arrows
            .extend(acting.shown.iter().filter_map(|shown| film.load(shown)));
        let mut says = says(&stage, &rows);
        says.extend(acting.says);
        Playback { says, drawn }
    }
}

/// The rows that are shown.
pub(super) fn rows(stage: &Stage<'_>) -> Vec<usize> {
    let scene = stage.scene;
    let tracks = stage.bodies.iter().chain(&stage.points).flatten();
    let lines = scene.lines.iter();
    let tensions = lines.filter_map(|line| stage.column(&line.name, "tension"));
    let signals: Vec<&[f64]> = tracks.flat_map(Track::columns).chain(tensions).collect();
    let moving = scene.world_frames.iter().filter(|frame| frame.moves(scene));
    let a_row = 4
        + 20 * scene.bodies.len()
        + 12 * (scene.points.len() + moving.count())
        + 5 * scene.lines.len()
        + 24 * scene.joints.len();
    motion_rows(
        stage.trajectory.times(),
        &signals,
        (BYTES / a_row).clamp(2, ROWS),
    )
}

/// What is shown of the run, and what is not.
fn says(stage: &Stage<'_>, rows: &[usize]) -> Vec<String> {
    let times = stage.trajectory.times();
    let mut says = Vec::new();
    match (times, rows.len()) {
        ([], _) => says.push("The history has no rows: nothing is shown.".to_string()),
        ([first, .., last], shown) if last > first && shown < times.len() => says.push(format!(
            "{shown} of {} rows are shown, those among them where the motion bends most; the motion between two rows is drawn straight.",
            times.len()
        )),
        ([first, .., last], _) if last > first => {}
        ([first, ..], _) => says.push(format!(
            "The history is one instant, {first} s: it does not move."
        )),
    }
    let lost = |names: Vec<&str>| match names.as_slice() {
        [] => None,
        [one] => Some(format!("`{one}`")),
        [one, others @ ..] => Some(format!("`{one}` and {} others", others.len())),
    };
    let scene = stage.scene;
    let bodies = scene.bodies.iter().zip(&stage.bodies);
    let bodies = bodies.filter(|(_, track)| track.is_none());
    let points = scene.points.iter().zip(&stage.points);
    let points = points.filter(|(_, track)| track.is_none());
    let absent = bodies.map(|(body, _)| body.name.as_str());
    let absent = absent.chain(points.map(|(point, _)| point.name.as_str()));
    if let (Some(names), false) = (lost(absent.collect()), times.is_empty()) {
        says.push(format!(
            "Not shown: {names}, whose motion the history does not hold; record it with `Content::ALL`."
        ));
    }
    let tracks = stage.bodies.iter().chain(&stage.points).flatten();
    let gaps = |track: &Track<'_>| {
        let mut columns = track.columns();
        columns.any(|column| column.iter().any(|x| !x.is_finite()))
    };
    if tracks.into_iter().any(gaps) {
        says.push(
            "The history has gaps: where a number is missing, what hangs on it is not drawn."
                .to_string(),
        );
    }
    says
}

/// The rows of a history that are shown.
struct Film<'a> {
    stage: &'a Stage<'a>,
    rows: &'a [usize],
}

impl Film<'_> {
    fn drawn(&self) -> Drawn {
        let scene = self.stage.scene;
        let upwards = upwards(scene, &self.stage.numbers);
        let mut up = [0.0; 3];
        // Gravity may point along +z: up is where it does not point.
        up[upwards] = match &self.stage.numbers.gravity {
            GravityNumbers::Uniform(pull) if pull[upwards] > 0.0 => -1.0,
            _ => 1.0,
        };
        let times = self.stage.trajectory.times();
        let from = scene.planar.and_then(|plane| {
            let mut extents = Vector3::repeat(1.0);
            extents[plane.normal()] = 0.0;
            let [across, above] = *views(extents, Some(plane), upwards).first()?;
            let axis = |k: usize| Vector3::from_fn(|i, _| f64::from(u8::from(i == k)));
            Some(axis(across).cross(&axis(above)).into())
        });
        // What flies freely is held by nothing.
        let held = scene.joints.iter().filter(|joint| joint.law.rows() > 0);
        Drawn {
            times: Packed::floats(self.rows.iter().filter_map(|row| times.get(*row).copied())),
            up,
            from,
            bodies: (0..scene.bodies.len())
                .filter_map(|k| self.body(k))
                .collect(),
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
    fn vectors(&self, at: impl Fn(usize) -> Option<Vector3<f64>>) -> Packed {
        let vector = |row: &usize| at(*row).unwrap_or_else(|| Vector3::repeat(f64::NAN));
        Packed::floats(
            self.rows
                .iter()
                .flat_map(|row| <[f64; 3]>::from(vector(row))),
        )
    }

    fn body(&self, index: usize) -> Option<DrawnBody> {
        let (scene, numbers) = (self.stage.scene, &self.stage.numbers);
        let (body, numbers) = (scene.bodies.get(index)?, numbers.bodies.get(index)?);
        let track = self.stage.bodies.get(index)?.as_ref();
        let quaternion = |row: &usize| {
            let parts = track.and_then(|track| track.quaternion(*row));
            parts.unwrap_or([1.0, 0.0, 0.0, 0.0])
        };
        let ellipsoid = ellipsoid(numbers);
        let shapes = shapes(scene, &self.stage.numbers.params, index);
        let reach = |k: usize| {
            let axes = ellipsoid.iter().flatten();
            let own = axes.map(|axis| axis[k] * axis[k]).sum::<f64>().sqrt();
            // Of a shape its largest size, whatever way it lies.
            let sizes = shapes.iter().map(|shape| {
                let largest = shape.size.iter().copied().fold(0.0, f64::max);
                shape.at[k].abs() + largest
            });
            match shapes.is_empty() {
                true => own,
                false => sizes.fold(0.0, f64::max),
            }
        };
        Some(DrawnBody {
            name: safe(&body.name),
            p: self.vectors(|row| track?.position(row)),
            q: Packed::shares(self.rows.iter().flat_map(quaternion)),
            arms: numbers
                .frames
                .iter()
                .map(|frame| frame.position.into())
                .collect(),
            ends: body.frames.iter().map(|frame| safe(&frame.name)).collect(),
            reach: [0, 1, 2].map(reach),
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
                false => Packed::floats(place(0).map(<[f64; 3]>::from).into_iter().flatten()),
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
        let turned = |frame: &FrameNumbers<f64>| match frame.rotation {
            Some(rotation) => rotation * axis,
            None => axis,
        };
        match place {
            Place::World(frame) => {
                let declared = self.stage.scene.world_frames.get(frame)?;
                let still = declared.rotation.is_none() || !declared.moves(self.stage.scene);
                let frame = numbers.world_frames.get(frame).filter(|_| still)?;
                Some((turned(frame).into(), -1))
            }
            Place::Body(body, frame) => {
                let frame = numbers.bodies.get(body)?.frames.get(frame)?;
                Some((turned(frame).into(), body as i64))
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
        let slack = |row: &usize| one_way && stretch.get(*row).is_some_and(|x| *x <= 0.0);
        let pulls = self
            .rows
            .iter()
            .filter_map(|row| tension.get(*row).copied());
        Some(DrawnLine {
            name: safe(&line.name),
            a: place(line.from),
            b: place(line.to),
            tension: Packed::floats(pulls),
            slack: Packed::flags(self.rows.iter().map(slack)),
        })
    }

    /// A load that is not zero all the time.
    fn load(&self, (index, values): &(usize, Vec<[f64; 3]>)) -> Option<DrawnArrow> {
        let load = self.stage.scene.loads.get(*index)?;
        let unit = match load.kind {
            LoadKind::Torque(_) => "N m",
            LoadKind::Force(_) | LoadKind::External => "N",
        };
        let acts = values.iter().flatten().any(|x| *x != 0.0);
        acts.then(|| DrawnArrow {
            name: format!("load {}", safe(&load.name)),
            unit,
            at: place(load.at),
            v: Packed::floats(values.iter().flatten().copied()),
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
        [("force", "N"), ("torque", "N m")]
            .into_iter()
            .filter_map(arrow)
            .collect()
    }
}

fn place(place: Place) -> DrawnPlace {
    match place {
        Place::World(frame) => (0, frame, 0),
        Place::Body(body, frame) => (1, body, frame),
        Place::Point(point) => (2, point, 0),
    }
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

/// The declared shapes of a body.
fn shapes(scene: &Scene, params: &[f64], body: usize) -> Vec<DrawnShape> {
    let number = |formula: &Formula| constant(scene, params, formula);
    let triple = |triple: &Triple| triple.each_ref().map(number);
    let own = scene.shapes.iter().filter(|shape| shape.body == body);
    own.map(|shape| DrawnShape {
        kind: shape.solid.keyword(),
        size: shape.sizes.iter().map(number).collect(),
        at: triple(&shape.position),
        turn: match &shape.rotation {
            Some(rows) => rows.each_ref().map(triple),
            None => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        },
    })
    .collect()
}

/// A name without characters that turn the direction of writing.
pub(super) fn safe(name: &str) -> String {
    name.chars().map(visible).collect()
}
