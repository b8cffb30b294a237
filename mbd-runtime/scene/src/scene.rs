//! What a scene is: everything a declaration says, resolved to indices and SI numbers, nothing derived.

mod queries;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use crate::event::{Detachable, Event};
use crate::joints::{JointForces, JointLaw};
use crate::lines::LineKind;
use crate::metrics::Metric;
use crate::solids::Shape;
use crate::{AngularVelocity, Fixed, Formula, Part, Place, Plane, Table, Unit};

/// Three scalar formulas: a vector known in components.
pub type Triple = [Formula; 3];

/// Everything one declaration says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The name of the model.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The coordinates the equations are written in.
    pub coordinates: Coordinates,
    /// The components of angular velocities in the state.
    pub angular_velocity: AngularVelocity,
    /// The plane in which everything moves; `None`: space.
    #[serde(default)]
    pub planar: Option<Plane>,
    /// The acceleration of gravity.
    pub gravity: Gravity,
    /// Numbers that fold into generated code, in declaration order.
    pub consts: Vec<Constant>,
    /// Numbers that stay live, in declaration order.
    pub params: Vec<Parameter>,
    /// Time-varying quantities that the caller supplies at each evaluation.
    pub inputs: Vec<Input>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Named expressions, in declaration order. One may name others in any order, but not itself through them.
    #[serde(default)]
    pub lets: Vec<Let>,
    /// First-order states of controllers, actuators, filters and the like, in declaration order.
    #[serde(default)]
    pub states: Vec<State>,
    /// Frames of the world, fixed or moving as a function of time. Index 0 is the world itself: origin, axes, name `world`.
    pub world_frames: Vec<Frame>,
    /// Rigid bodies.
    pub bodies: Vec<Body>,
    /// Points, with mass or massless.
    pub points: Vec<Point>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Lines and springs.
    pub lines: Vec<Line>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Outputs.
    pub outputs: Vec<Output>,
    /// Events.
    pub events: Vec<Event>,
    /// Where a run starts, as far as it is declared.
    #[serde(default)]
    pub starts: Starts,
    /// Bodies, by their index, whose inertia need not be that of a rigid body: in absolute coordinates its principal moments are positive, and no more is
    /// asked of them; in relative ones they, and the mass, may be zero where what the body carries gives its joints an inertia.
    #[serde(default)]
    pub unchecked: Vec<usize>,
    /// Shapes of bodies, in their order: what is drawn. Mass and inertia are those of the bodies, whether they follow from shapes or not.
    #[serde(default)]
    pub shapes: Vec<Shape>,
    /// What is said of its runs. The last of all, so that scenes that say nothing are packed as if it were not there.
    #[serde(
        default,
        skip_serializing_if = "OfRuns::is_empty",
        deserialize_with = "something"
    )]
    pub runs: OfRuns,
}

/// What a scene says of its runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OfRuns {
    /// Numbers that are told of every run.
    pub metrics: Vec<Metric>,
    /// The body or the point with mass that the origin of positions follows: [`laws::origin`](crate::laws::origin); `None`: it stays in the world.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "some"
    )]
    pub origin: Option<Part>,
}

impl OfRuns {
    /// Whether it says nothing.
    fn is_empty(&self) -> bool {
        self.metrics.is_empty() && self.origin.is_none()
    }
}

/// What is only written where there is one.
fn some<'d, D: Deserializer<'d>>(from: D) -> Result<Option<Part>, D::Error> {
    let part = Option::deserialize(from)?;
    part.map_or_else(
        || Err(Error::custom("none is left out")),
        |part| Ok(Some(part)),
    )
}

/// What is only written where it says something.
fn something<'d, D: Deserializer<'d>>(from: D) -> Result<OfRuns, D::Error> {
    let runs = OfRuns::deserialize(from)?;
    match runs.is_empty() {
        false => Ok(runs),
        true => Err(Error::custom("what says nothing is left out")),
    }
}

/// Where a run starts: formulas of consts and params.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Starts {
    /// Bodies and points with mass, bodies first, in their order.
    pub parts: Vec<PartStart>,
    /// Joint coordinates, in the order of joints and coordinates.
    pub coordinates: Vec<CoordinateStart>,
    /// What is detached until an event attaches it, in rising order.
    #[serde(default)]
    pub detached: Vec<Detachable>,
}

impl Starts {
    /// Whether no place and no motion is declared.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty() && self.coordinates.is_empty()
    }
}

/// Where a body or a point with mass stands at the start, and how it moves. What is not given is at the world origin, unturned, at rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartStart {
    /// The body or the point.
    pub part: Part,
    /// Position of the centre of mass, world axes [m].
    pub position: Option<Triple>,
    /// Rotation from body axes to world axes: rows of the matrix.
    pub rotation: Option<[Triple; 3]>,
    /// Velocity of the centre of mass, world axes [m/s].
    pub velocity: Option<Triple>,
    /// Angular velocity [rad/s], in the axes of the state: [`Scene::angular_velocity`].
    pub angular_velocity: Option<Triple>,
}

impl PartStart {
    /// Nothing said of a body or a point.
    #[must_use]
    pub fn of(part: Part) -> Self {
        PartStart {
            part,
            position: None,
            rotation: None,
            velocity: None,
            angular_velocity: None,
        }
    }

    /// Every formula, to be changed.
    pub fn formulas_mut(&mut self) -> impl Iterator<Item = &mut Formula> {
        let PartStart {
            part: _,
            position,
            rotation,
            velocity,
            angular_velocity,
        } = self;
        let triples = [position, velocity, angular_velocity].into_iter();
        let rows = rotation.iter_mut().flatten().flatten();
        triples.flatten().flatten().chain(rows)
    }
}

/// A coordinate of a joint at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoordinateStart {
    /// The joint, by index.
    pub joint: usize,
    /// The coordinate, by number.
    pub coordinate: usize,
    /// Its value [m or rad].
    pub value: Option<Formula>,
    /// Its rate [m/s or rad/s].
    pub rate: Option<Formula>,
    /// Whether its value is `about` that: it gives way where loops do not close with it.
    #[serde(default)]
    pub about: bool,
}

/// The family of coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Coordinates {
    /// Every body carries position and quaternion; joints are rows.
    #[default]
    Absolute,
    /// Joint coordinates of a spanning tree.
    Relative,
}

impl Coordinates {
    /// Its word, `relative`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Coordinates::Absolute => "absolute",
            Coordinates::Relative => "relative",
        }
    }
}

/// The acceleration of gravity at a position r, world axes [m/s²].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Gravity {
    /// None.
    #[default]
    None,
    /// The same everywhere.
    Uniform {
        /// Acceleration [m/s²].
        acceleration: Triple,
    },
    /// A point mass: −μ d/|d|³, d = r − center. The offset keeps positions small: planet-centred ones cost digits.
    PointMass {
        /// Gravitational parameter [m³/s²].
        mu: Formula,
        /// Place of the mass in world coordinates [m], for example (0, 0, −3.4e6).
        center: Triple,
    },
    /// A point mass with the J2 term of an oblate planet.
    Oblate {
        /// Gravitational parameter [m³/s²].
        mu: Formula,
        /// Place of the planet's centre in world coordinates [m].
        center: Triple,
        /// Equatorial radius [m].
        radius: Formula,
        /// J2 [1].
        j2: Formula,
        /// Unit vector along the planet's axis, world components.
        axis: Triple,
    },
    /// Supplied by the caller for every body and point with mass (three input slots each).
    Field,
}

/// A number or a vector that folds into the code.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Constant {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Value [SI].
    pub value: Fixed,
    /// Unit as declared.
    pub unit: Unit,
}

/// A named expression: what it says is said once, wherever its name stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Let {
    /// Name; repeated ones are `pull[0]`, `pull[1]`, ….
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// What it stands for.
    pub value: Formula,
    /// 1 or 3 components.
    pub components: usize,
    /// SI unit.
    pub unit: Unit,
}

/// A number that stays a live field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Default [SI].
    pub default: f64,
    /// Smallest and largest accepted value [SI].
    pub range: Option<[f64; 2]>,
    /// Unit as declared.
    pub unit: Unit,
}

/// A quantity the caller supplies at each evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// 1 or 3 components.
    pub components: usize,
    /// SI unit.
    pub unit: Unit,
    /// What holds until the caller gives another value [SI]; of one component the first.
    #[serde(default)]
    pub default: [f64; 3],
}

/// A state of the user's own: one number s with its rate, ṡ = `rate`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Name; repeated states are `level[0]`, `level[1]`, ….
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Its value at the start [SI]: a formula of numbers, consts and params.
    pub start: Formula,
    /// Unit as declared.
    pub unit: Unit,
    /// Its rate [SI unit/s]: what a load may read, it may read.
    pub rate: Formula,
}

/// A place and axes on a body or in the world. The formulas of a frame of the world may contain time, those of a body may not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Name; repeated frames are `bridle[0]`, `bridle[1]`, ….
    pub name: String,
    /// Origin from the centre of mass, body axes (from the world origin, world axes) [m].
    pub position: Triple,
    /// Rotation from frame axes to body axes: rows of the matrix; columns are the frame's axes. `None`: parallel to the body.
    pub rotation: Option<[Triple; 3]>,
}

impl Frame {
    /// Whether it depends on time.
    #[must_use]
    pub fn moves(&self, scene: &Scene) -> bool {
        let mut all = self.position.iter();
        self.turns(scene) || all.any(|formula| scene.depends_on_time(formula))
    }

    /// Whether its axes depend on time.
    #[must_use]
    pub fn turns(&self, scene: &Scene) -> bool {
        let mut all = self.rotation.iter().flatten().flatten();
        all.any(|formula| scene.depends_on_time(formula))
    }
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Mass [kg].
    pub mass: Formula,
    /// Inertia about the centre of mass along body axes [kg m²].
    pub inertia: Inertia,
    /// Frames; index 0 is `com`.
    pub frames: Vec<Frame>,
}

/// Inertia about the centre of mass: elements of the symmetric matrix (xy = −∫xy dm) [kg m²].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inertia {
    /// Element xx.
    pub xx: Formula,
    /// Element yy.
    pub yy: Formula,
    /// Element zz.
    pub zz: Formula,
    /// Element xy.
    pub xy: Formula,
    /// Element xz.
    pub xz: Formula,
    /// Element yz.
    pub yz: Formula,
}

/// A point where lines end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// With mass, or an equilibrium point.
    pub kind: PointKind,
}

/// What holds a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PointKind {
    /// Newton's law: three coordinates, three speeds.
    Mass(Formula),
    /// The balance of its lines: a node.
    Node(NodeModel),
}

/// How a node treats the damping of its lines (`static`, `stepwise`, `rate`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NodeModel {
    /// Damping ignored: the node minimises the elastic energy of its lines at every stage.
    Static,
    /// Damping by differences against the last accepted step; fixed steps only.
    Stepwise {
        /// The difference formula.
        formula: Difference,
        /// What is clamped.
        clamp: Clamp,
    },
    /// The node's velocity follows from the balance of the damped lines: three more states.
    Rate,
}

/// A backward difference formula for the stretch rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Difference {
    /// First order.
    Euler,
    /// Second order.
    #[default]
    Bdf2,
}

/// What the differenced damping acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Clamp {
    /// The positive part of the stretch: monotone, zero when slack.
    #[default]
    Positive,
    /// The length, as printed in AAS 03-163: lets slack lines pull; for comparison only.
    Literal,
}

/// A joint between two places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Its law.
    pub law: JointLaw,
    /// Place on the parent.
    pub parent: Place,
    /// Place on the child.
    pub child: Place,
    /// What acts along its coordinates: at most one entry a coordinate, in their order.
    #[serde(default)]
    pub forces: Vec<JointForces>,
    /// Whether the declaration marks it `loop`: it closes a loop, and a spanning tree is cut here.
    #[serde(default)]
    pub cut: bool,
}

impl Joint {
    /// The coordinates that motors drive: number of the coordinate and its course ([`JointForces::motor`]); in the order of their rows.
    pub fn motors(&self) -> impl Iterator<Item = (usize, &Formula)> {
        let forces = self.forces.iter();
        forces.filter_map(|forces| Some((forces.coordinate, forces.motor.as_ref()?)))
    }
}

/// A line (tension only) or a spring (both ways) with damping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// Name; repeated lines are `leg[0]`, `leg[1]`, ….
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Its law.
    pub kind: LineKind,
    /// First end.
    pub from: Place,
    /// Second end.
    pub to: Place,
    /// Free length L0 [m], ≥ 0: of consts and params, or where the line is wound of inputs, states and time; a [`Formula::Vector`] of two is the
    /// free length and its rate [m/s].
    pub free_length: Formula,
    /// Stiffness K [N/m], > 0; the number 0 where the law follows a table.
    pub stiffness: Formula,
    /// Damping C [N s/m], ≥ 0; the number 0 when none is declared.
    pub damping: Formula,
}

impl Line {
    /// The free length, and its rate where it is declared.
    #[must_use]
    pub fn free_length_and_rate(&self) -> (&Formula, Option<&Formula>) {
        match &self.free_length {
            Formula::Vector(parts) => match parts.as_slice() {
                [length, rate] => (length, Some(rate)),
                _ => (&self.free_length, None),
            },
            length => (length, None),
        }
    }

    /// Whether the line is wound: its free length changes during a run.
    #[must_use]
    pub fn is_wound(&self, scene: &Scene) -> bool {
        let changes =
            |part: &Formula| matches!(part, Formula::Time | Formula::Input(_) | Formula::State(_));
        match &self.free_length {
            Formula::Number(_) | Formula::Const(_) | Formula::Param(_) => false,
            Formula::Vector(_) => true,
            length => scene.contains(length, changes),
        }
    }
}

/// A load on a body or a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Where it acts: a frame of a body, or a point.
    pub at: Place,
    /// What acts.
    pub kind: LoadKind,
}

/// What a load is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum LoadKind {
    /// A force [N], world axes, at the place.
    Force(Formula),
    /// A couple [N m], world axes.
    Torque(Formula),
    /// A force at the place and a couple, world axes, from the caller: six input slots (three on a point).
    External,
}

impl LoadKind {
    /// What it is, where the declaration says so.
    #[must_use]
    pub fn formula(&self) -> Option<&Formula> {
        match self {
            LoadKind::Force(formula) | LoadKind::Torque(formula) => Some(formula),
            LoadKind::External => None,
        }
    }
}

/// A named result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Name.
    pub name: String,
    /// Documentation.
    pub doc: String,
    /// Value, in `unit`.
    pub value: Formula,
    /// 1 or 3 components.
    pub components: usize,
    /// Unit of the column: SI, or the one the declaration asks for (`in deg`).
    pub unit: Unit,
}
