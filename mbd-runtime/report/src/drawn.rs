//! What the script of a page reads of a run: the things of the scene, and where they are at each instant.

use mbd_runtime::scene::Place;
use serde::Serialize;

use super::packing::PackedArray;
use super::surface::Surface;
use super::svg::visible;

/// What the script of the page reads. Lengths in metres, forces in newtons, world axes.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Drawn {
    pub times: PackedArray,
    /// Up in the world.
    pub up: [f64; 3],
    /// Where a planar scene is looked at from.
    pub from: Option<[f64; 3]>,
    /// Every solid once.
    pub solids: Vec<DrawnSolid>,
    pub bodies: Vec<DrawnBody>,
    pub points: Vec<DrawnPoint>,
    pub frames: Vec<DrawnFrame>,
    pub joints: Vec<DrawnJoint>,
    pub lines: Vec<DrawnLine>,
    pub arrows: Vec<DrawnArrow>,
}

/// A place: 0 the world, 1 a body, 2 a point; its number; the number of its frame.
pub(super) type DrawnPlace = (u8, usize, usize);

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnBody {
    pub name: String,
    pub p: PackedArray,
    pub q: PackedArray,
    /// Frames from the centre of mass, body axes.
    pub arms: Vec<[f64; 3]>,
    /// Which of them are joined to the centre of mass by a line.
    pub rods: Vec<usize>,
    /// Their names.
    pub ends: Vec<String>,
    /// Half axes of the homogeneous ellipsoid of the same mass and inertia, body axes.
    pub ellipsoid: Option<[[f64; 3]; 3]>,
    /// How far what is drawn around the centre of mass reaches, along body axes.
    pub reach: [f64; 3],
    pub shapes: Vec<DrawnShape>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnShape {
    /// Which of the solids.
    pub solid: usize,
    pub at: [f64; 3],
    /// Rows of the matrix from the axes of the shape to those of the body.
    pub turn: [[f64; 3]; 3],
}

/// The surface of a solid, in its own axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct DrawnSolid {
    /// Radius and length of a ball that is parted along z: it needs no faces.
    pub ball: Option<[f64; 2]>,
    /// Corners.
    pub p: PackedArray,
    /// Faces by their corners, per part.
    pub parts: Vec<Vec<Vec<usize>>>,
}

impl DrawnSolid {
    pub fn of(surface: &Surface) -> Self {
        let (places, parts): (&[_], &[_]) = match surface.ball {
            Some(_) => (&[], &[]),
            None => (&surface.places, &surface.parts),
        };
        let corners = places.iter().flat_map(|place| <[f64; 3]>::from(*place));
        DrawnSolid {
            ball: surface.ball,
            p: PackedArray::floats(corners),
            parts: parts.iter().map(|part| part.faces.clone()).collect(),
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnPoint {
    pub name: String,
    pub node: bool,
    pub p: PackedArray,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnFrame {
    pub name: String,
    /// Whether something is held by it.
    pub used: bool,
    pub p: PackedArray,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnJoint {
    pub name: String,
    pub kind: &'static str,
    pub a: DrawnPlace,
    pub b: DrawnPlace,
    /// Axes: direction, the body in whose axes it is written (−1: the world), and at which end it lies.
    pub axes: Vec<([f64; 3], i64, usize)>,
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnLine {
    pub name: String,
    pub a: DrawnPlace,
    pub b: DrawnPlace,
    pub tension: PackedArray,
    pub slack: PackedArray,
}

/// A force or a couple at a place.
#[derive(Clone, Debug, Serialize)]
pub(super) struct DrawnArrow {
    pub name: String,
    pub unit: &'static str,
    pub at: DrawnPlace,
    pub v: PackedArray,
}

impl Drawn {
    /// With a label before all names.
    pub fn labelled(mut self, label: &str) -> Self {
        let bodies = self.bodies.iter_mut().map(|body| &mut body.name);
        let points = self.points.iter_mut().map(|point| &mut point.name);
        let joints = self.joints.iter_mut().map(|joint| &mut joint.name);
        let lines = self.lines.iter_mut().map(|line| &mut line.name);
        let arrows = self.arrows.iter_mut().map(|arrow| &mut arrow.name);
        let names = bodies
            .chain(points)
            .chain(joints)
            .chain(lines)
            .chain(arrows);
        names.for_each(|name| *name = format!("{}: {name}", safe(label)));
        self
    }

    /// Adds the things of another drawing at the same times.
    pub fn append(&mut self, other: Drawn) {
        let (bodies, points, frames) = (self.bodies.len(), self.points.len(), self.frames.len());
        let moved = |(kind, index, frame): DrawnPlace| {
            (
                kind,
                index + [frames, bodies, points][usize::from(kind)],
                frame,
            )
        };
        let solids = self.solids.len();
        self.solids.extend(other.solids);
        self.bodies.extend(other.bodies.into_iter().map(|mut body| {
            for shape in &mut body.shapes {
                shape.solid += solids;
            }
            body
        }));
        self.points.extend(other.points);
        self.frames.extend(other.frames);
        self.joints.extend(other.joints.into_iter().map(|joint| {
            DrawnJoint {
                a: moved(joint.a),
                b: moved(joint.b),
                axes: (joint.axes.into_iter())
                    .map(|(axis, body, end)| {
                        (
                            axis,
                            if body < 0 { body } else { body + bodies as i64 },
                            end,
                        )
                    })
                    .collect(),
                ..joint
            }
        }));
        self.lines
            .extend(other.lines.into_iter().map(|line| DrawnLine {
                a: moved(line.a),
                b: moved(line.b),
                ..line
            }));
        self.arrows
            .extend(other.arrows.into_iter().map(|arrow| DrawnArrow {
                at: moved(arrow.at),
                ..arrow
            }));
    }
}

/// A place as the script has it.
pub(super) fn place(place: Place) -> DrawnPlace {
    match place {
        Place::World(frame) => (0, frame, 0),
        Place::Body(body, frame) => (1, body, frame),
        Place::Point(point) => (2, point, 0),
    }
}

/// A name without characters that turn the direction of writing.
pub(super) fn safe(name: &str) -> String {
    name.chars().map(visible).collect()
}
