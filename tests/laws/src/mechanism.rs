//! Mechanisms of bodies and joints built in code, and their motions: arbitrary ones, and ones that obey a joint.

use mbd_scene::Scratch;
use mbd_scene::joints::{Axis, Coupled, Gear, JointLaw, Relative, Twist};
use mbd_scene::laws::Numbers;
use mbd_scene::{
    AngularVelocity, At, Body, Formula, Frame, Gravity, Inertia, Joint, Layout, Load, LoadKind,
    Place, Plane, Point, PointKind, Quantity, Real, Scene, Triple,
};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use std::any::Any;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use crate::jet::Jet;
use crate::random::Random;

fn triple(v: [f64; 3]) -> Triple {
    v.map(Formula::Number)
}

/// A frame at `position` with axes the columns of `rotation`.
#[must_use]
pub fn frame(name: &str, position: [f64; 3], rotation: Option<Matrix3<f64>>) -> Frame {
    Frame {
        name: name.to_owned(),
        position: triple(position),
        rotation: rotation
            .map(|r| std::array::from_fn(|i| triple(std::array::from_fn(|j| r[(i, j)])))),
    }
}

/// An empty scene with a world frame and uniform gravity.
#[must_use]
pub fn empty(gravity: [f64; 3], components: AngularVelocity) -> Scene {
    Scene {
        name: "Mechanism".to_owned(),
        angular_velocity: components,
        gravity: Gravity::Uniform {
            acceleration: triple(gravity),
        },
        world_frames: vec![frame("world", [0.0; 3], None)],
        ..Scene::default()
    }
}

/// Adds a body; hands back its index.
pub fn add_body(scene: &mut Scene, mass: f64, inertia: &Matrix3<f64>) -> usize {
    let i = |a: usize, b: usize| Formula::Number(inertia[(a, b)]);
    let index = scene.bodies.len();
    scene.bodies.push(Body {
        name: format!("body{index}"),
        doc: String::new(),
        mass: mass.into(),
        inertia: Inertia {
            xx: i(0, 0),
            yy: i(1, 1),
            zz: i(2, 2),
            xy: i(0, 1),
            xz: i(0, 2),
            yz: i(1, 2),
        },
        frames: vec![frame("com", [0.0; 3], None)],
    });
    index
}

/// Adds a point with mass; hands back its place.
pub fn add_point(scene: &mut Scene, mass: f64) -> Place {
    let index = scene.points.len();
    scene.points.push(Point {
        name: format!("point{index}"),
        doc: String::new(),
        kind: PointKind::Mass(mass.into()),
    });
    Place::Point(index)
}

/// Adds a frame to a body (`None`: the world); hands back its place.
pub fn add_frame(scene: &mut Scene, body: Option<usize>, frame: Frame) -> Place {
    match body {
        Some(body) => {
            scene.bodies[body].frames.push(frame);
            Place::Body(body, scene.bodies[body].frames.len() - 1)
        }
        None => {
            scene.world_frames.push(frame);
            Place::World(scene.world_frames.len() - 1)
        }
    }
}

/// Adds a joint.
pub fn add_joint(scene: &mut Scene, law: JointLaw, parent: Place, child: Place) {
    let name = format!("{}{}", law.keyword(), scene.joints.len());
    scene.joints.push(Joint {
        name,
        doc: String::new(),
        law,
        parent,
        child,
        forces: Vec::new(),
        cut: false,
    });
}

/// Couples coordinates of joints by a gear: the one that follows, then the one that leads, each by joint and number.
pub fn add_gear(scene: &mut Scene, couples: [(usize, usize); 2], ratio: Formula, offset: f64) {
    let Joint { parent, child, .. } = scene.joints[couples[0].0];
    let law = JointLaw::Gear(Gear {
        couples,
        ratio,
        offset: offset.into(),
    });
    add_joint(scene, law, parent, child);
}

/// Adds an external force and couple at the centre of mass of every body, and a force on every point.
pub fn add_external_loads(scene: &mut Scene) {
    let bodies = (0..scene.bodies.len()).map(|body| Place::Body(body, 0));
    let points = (0..scene.points.len()).map(Place::Point);
    for (index, at) in bodies.chain(points).enumerate() {
        scene.loads.push(Load {
            name: format!("push{index}"),
            doc: String::new(),
            at,
            kind: LoadKind::External,
        });
    }
}

/// The same scene with angular velocities in other components.
#[must_use]
pub fn with_components(scene: &Scene, components: AngularVelocity) -> Scene {
    Scene {
        angular_velocity: components,
        ..scene.clone()
    }
}

/// A body at an instant: pose, velocity, acceleration; all vectors in world axes.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Centre of mass.
    pub position: Vector3<f64>,
    /// Body axes → world axes.
    pub attitude: UnitQuaternion<f64>,
    /// Velocity.
    pub velocity: Vector3<f64>,
    /// Angular velocity.
    pub omega: Vector3<f64>,
    /// Acceleration.
    pub acceleration: Vector3<f64>,
    /// Angular acceleration.
    pub alpha: Vector3<f64>,
}

impl Instance {
    /// At rest at the origin.
    #[must_use]
    pub fn rest() -> Self {
        Instance {
            position: Vector3::zeros(),
            attitude: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            omega: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            alpha: Vector3::zeros(),
        }
    }

    /// Anywhere, moving anyhow.
    #[must_use]
    pub fn random(random: &mut Random) -> Self {
        let mut vector = |size: f64| Vector3::from(random.vector(size));
        Instance {
            position: vector(1.0),
            velocity: vector(2.0),
            omega: vector(2.0),
            acceleration: vector(3.0),
            alpha: vector(3.0),
            attitude: attitude(random),
        }
    }

    /// Rotation body → world.
    #[must_use]
    pub fn rotation(&self) -> Matrix3<f64> {
        self.attitude.to_rotation_matrix().into_inner()
    }

    /// The angular part of a speed or an acceleration in the components of a state.
    #[must_use]
    pub fn in_components(&self, v: Vector3<f64>, components: AngularVelocity) -> Vector3<f64> {
        match components {
            AngularVelocity::World => v,
            AngularVelocity::Body => self.rotation().transpose() * v,
        }
    }
}

/// A random attitude.
pub fn attitude(random: &mut Random) -> UnitQuaternion<f64> {
    let [w, x, y, z] = random.attitude();
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// A random realisable inertia.
pub fn inertia(random: &mut Random) -> Matrix3<f64> {
    let r = attitude(random).to_rotation_matrix().into_inner();
    let half: [f64; 3] = std::array::from_fn(|_| random.uniform(0.05, 0.4));
    let moments = Vector3::new(half[1] + half[2], half[0] + half[2], half[0] + half[1]);
    r * Matrix3::from_diagonal(&moments) * r.transpose()
}

/// Scenes that are remembered.
const REMEMBERED: usize = 4;

/// A scene with its layout and, for every scalar that it was evaluated on, its numbers and its room.
struct Remembered {
    scene: Scene,
    layout: Rc<Layout>,
    rooms: Vec<Box<dyn Any>>,
}

/// The numbers of a scene at the defaults of its parameters, and room for its evaluations.
struct Room<S: Real> {
    numbers: Numbers<S>,
    scratch: Scratch<S>,
}

thread_local! {
    /// The scenes that were laid out last: finding repeated rows takes longer than an evaluation, and so does making numbers and room.
    static LAST: RefCell<VecDeque<Remembered>> = const { RefCell::new(VecDeque::new()) };
}

/// Uses what is remembered of a scene.
fn remembered<T>(scene: &Scene, what: impl FnOnce(&mut Remembered) -> T) -> T {
    LAST.with_borrow_mut(|last| {
        let at = last.iter().position(|known| known.scene == *scene);
        let at = at.unwrap_or_else(|| {
            last.push_front(Remembered {
                scene: scene.clone(),
                layout: Rc::new(Layout::new(scene)),
                rooms: Vec::new(),
            });
            last.truncate(REMEMBERED);
            0
        });
        what(&mut last[at])
    })
}

/// The layout of a scene.
#[must_use]
pub fn layout(scene: &Scene) -> Rc<Layout> {
    remembered(scene, |known| known.layout.clone())
}

/// The state [q | v] of bodies (points: positions and velocities alone).
#[must_use]
pub fn state(scene: &Scene, bodies: &[Instance], points: &[Instance]) -> Vec<f64> {
    jets(scene, bodies, points)
        .iter()
        .map(|jet| jet.0[0])
        .collect()
}

/// v̇ of the same, in the components of the state.
#[must_use]
pub fn accelerations(scene: &Scene, bodies: &[Instance], points: &[Instance]) -> Vec<f64> {
    let nq = layout(scene).nq;
    let jets = jets(scene, bodies, points);
    jets[nq..].iter().map(|jet| jet.0[1]).collect()
}

/// The state with its first two derivatives: positions to the second, speeds to the first (their second is NaN). Of a planar scene the bodies
/// are rotated about its normal.
#[must_use]
pub fn jets(scene: &Scene, bodies: &[Instance], points: &[Instance]) -> Vec<Jet> {
    let layout = layout(scene);
    let mut list = vec![Jet::constant(0.0); layout.nx()];
    for ((_, slots), body) in layout.own_bodies().zip(bodies) {
        let components = scene.angular_velocity;
        let omega = body.in_components(body.omega, components);
        let alpha = body.in_components(body.alpha, components);
        let (q, w, a) = (
            body.attitude.into_inner(),
            Quaternion::from_imag(body.omega),
            Quaternion::from_imag(body.alpha),
        );
        let rate = w * q * 0.5;
        let curve = a * q * 0.5 + w * rate * 0.5;
        let parts = |q: &Quaternion<f64>| [q.w, q.i, q.j, q.k];
        let (moves, turns) = (
            layout.directions.translations(),
            layout.directions.rotations(),
        );
        let attitude = slots.q + moves.len();
        match layout.directions.plane.map(Plane::normal) {
            None => {
                for k in 0..4 {
                    list[attitude + k] = Jet([parts(&q)[k], parts(&rate)[k], parts(&curve)[k]]);
                }
            }
            Some(n) => {
                let angle = 2.0 * parts(&q)[1 + n].atan2(q.w);
                list[attitude] = Jet([angle, body.omega[n], body.alpha[n]]);
            }
        }
        for (at, &k) in moves.iter().enumerate() {
            list[slots.q + at] = Jet([body.position[k], body.velocity[k], body.acceleration[k]]);
            let v = layout.nq + slots.v + at;
            list[v] = Jet([body.velocity[k], body.acceleration[k], f64::NAN]);
        }
        for (at, &k) in turns.iter().enumerate() {
            let v = layout.nq + slots.v + moves.len() + at;
            list[v] = Jet([omega[k], alpha[k], f64::NAN]);
        }
    }
    for (slots, point) in layout.points.iter().zip(points) {
        if let mbd_scene::PointSlots::Mass(slots) = slots {
            for (at, &k) in layout.directions.translations().iter().enumerate() {
                let jet = Jet([point.position[k], point.velocity[k], point.acceleration[k]]);
                list[slots.q + at] = jet;
                list[layout.nq + slots.v + at] = Jet([jet.0[1], jet.0[2], f64::NAN]);
            }
        }
    }
    list
}

/// Arguments with a state alone, besides inputs and rows.
#[must_use]
pub fn at<'a, S: Real>(state: &'a [S], inputs: &'a [S], rows: &'a [S]) -> At<'a, S> {
    At {
        rows,
        ..At::of_state(S::zero(), state, inputs)
    }
}

/// A frame somewhere on a body, or in the world.
pub fn random_seat(scene: &mut Scene, body: Option<usize>, random: &mut Random) -> Place {
    let seat = Seat::random(random);
    add_frame(scene, body, seat.declared("seat"))
}

/// Adds a body that hangs on an earlier one or on the world by one of the laws: that law, its place there, its place on the body. The joint
/// is left to the caller.
pub fn hang(scene: &mut Scene, laws: &[JointLaw], random: &mut Random) -> (JointLaw, [Place; 2]) {
    let mass = random.uniform(0.5, 2.0);
    let inertia = inertia(random);
    let body = add_body(scene, mass, &inertia);
    let parent = random.below(body + 1).checked_sub(1);
    let places = [
        random_seat(scene, parent, random),
        random_seat(scene, Some(body), random),
    ];
    (laws[random.below(laws.len())].clone(), places)
}

/// Bodies of any inertia hinged on one another anywhere, about any axis.
#[must_use]
pub fn hinged_anyhow(n: usize) -> Scene {
    let mut scene = empty([0.0, 0.0, -9.81], AngularVelocity::Body);
    let mut random = Random::new(3);
    for index in 0..n {
        let body = add_body(&mut scene, random.uniform(0.5, 2.0), &inertia(&mut random));
        let [near, far] = [index.checked_sub(1), Some(body)]
            .map(|owner| random_seat(&mut scene, owner, &mut random));
        let axis = Axis::new(random.vector(1.0)).expect("a direction");
        let law = JointLaw::Hinge(mbd_scene::joints::Hinge { axis });
        add_joint(&mut scene, law, near, far);
    }
    scene
}

/// A quantity by the laws, at a state; inputs zero if none are given.
#[must_use]
pub fn evaluate<S: Real>(
    scene: &Scene,
    what: Quantity,
    state: &[S],
    inputs: &[S],
    rows: &[S],
) -> Vec<S> {
    evaluate_at(scene, what, &at(state, inputs, rows))
}

/// A quantity by the laws, at a time and a state; inputs zero.
#[must_use]
pub fn evaluate_in_time<S: Real>(scene: &Scene, what: Quantity, time: S, state: &[S]) -> Vec<S> {
    let at = At {
        time,
        ..at(state, &[], &[])
    };
    evaluate_at(scene, what, &at)
}

/// A quantity by the laws, at anything; parameters at their defaults, inputs zero if none are given.
#[must_use]
pub fn evaluate_at<S: Real>(scene: &Scene, what: Quantity, at: &At<'_, S>) -> Vec<S> {
    remembered(scene, |known| {
        let layout = &known.layout;
        let is_of_scalar = |room: &Box<dyn Any>| room.is::<Room<S>>();
        let index = known.rooms.iter().position(is_of_scalar);
        let index = index.unwrap_or_else(|| {
            let params = scene.params.iter().map(|p| S::from_f64(p.default));
            known.rooms.push(Box::new(Room {
                numbers: Numbers::new(scene, &params.collect::<Vec<S>>()),
                scratch: Scratch::<S>::new(layout),
            }));
            known.rooms.len() - 1
        });
        let room = known.rooms[index].downcast_mut::<Room<S>>();
        let Room { numbers, scratch } = room.expect("of this scalar");
        let none = vec![S::zero(); layout.ni];
        let inputs = if at.inputs.is_empty() {
            &none[..]
        } else {
            at.inputs
        };
        let mut out = vec![S::zero(); layout.len(what)];
        let at = At { inputs, ..*at };
        mbd_scene::evaluate(what, scene, layout, numbers, &at, scratch, &mut out);
        out
    })
}

/// Joint coordinates, speeds and their rates.
#[derive(Clone, Debug)]
pub struct Coordinates {
    /// q.
    pub q: Vec<f64>,
    /// u.
    pub u: Vec<f64>,
    /// u̇.
    pub rate: Vec<f64>,
    /// Numbers of the joint.
    pub numbers: Vec<f64>,
}

impl Coordinates {
    /// Random ones; attitudes are unit quaternions.
    #[must_use]
    pub fn random(law: &JointLaw, numbers: Vec<f64>, random: &mut Random) -> Self {
        let mut list = |n: usize| {
            (0..n)
                .map(|_| random.uniform(-1.2, 1.2))
                .collect::<Vec<f64>>()
        };
        let (n, m) = (law.coordinates(), law.freedoms());
        let (mut q, u, rate) = (list(n), list(m), list(m));
        if n == m + 1 {
            q[n - 4..].copy_from_slice(&random.attitude());
        }
        Coordinates {
            q,
            u,
            rate,
            numbers,
        }
    }

    /// As the joint takes them.
    #[must_use]
    pub fn relative(&self) -> Relative<'_, f64> {
        Relative {
            q: &self.q,
            u: &self.u,
            numbers: &self.numbers,
        }
    }
}

/// Where a joint sits: its point and frame on a body.
#[derive(Clone, Copy, Debug)]
pub struct Seat {
    /// Origin of the joint frame, body axes.
    pub point: Vector3<f64>,
    /// Joint frame → body axes.
    pub frame: Matrix3<f64>,
}

impl Seat {
    /// Anywhere.
    #[must_use]
    pub fn random(random: &mut Random) -> Self {
        Seat {
            point: Vector3::from(random.vector(0.5)),
            frame: attitude(random).to_rotation_matrix().into_inner(),
        }
    }

    /// The frame of a scene.
    #[must_use]
    pub fn declared(&self, name: &str) -> Frame {
        frame(name, self.point.into(), Some(self.frame))
    }
}

/// Σ columns u.
fn combine(columns: &[Twist<f64>], u: &[f64]) -> Twist<f64> {
    columns
        .iter()
        .zip(u)
        .fold(Twist::zero(), |sum, (column, u)| Twist {
            linear: sum.linear + column.linear * *u,
            angular: sum.angular + column.angular * *u,
        })
}

/// The columns of H of a joint.
#[must_use]
pub fn subspace(law: &JointLaw, at: &Coordinates) -> Vec<Twist<f64>> {
    let mut columns = vec![Twist::zero(); law.freedoms()];
    law.subspace(&at.relative(), &mut columns);
    columns
}

/// The child that a joint carries: pose, velocity and acceleration by composition.
#[must_use]
pub fn carried(law: &JointLaw, seats: [Seat; 2], parent: &Instance, at: &Coordinates) -> Instance {
    let (pose, columns, bias) = (
        law.motion(&at.relative()),
        subspace(law, at),
        law.bias(&at.relative()),
    );
    let (velocity, change) = (combine(&columns, &at.u), combine(&columns, &at.rate));
    let frame = parent.rotation() * seats[0].frame;
    let rotation = frame * pose.rotation * seats[1].frame.transpose();
    let (x, k) = (frame * velocity.linear, frame * velocity.angular);
    let (xx, kk) = (
        frame * (change.linear + bias.linear),
        frame * (change.angular + bias.angular),
    );
    let (omega, arm) = (
        parent.omega,
        parent.rotation() * seats[0].point + frame * pose.position,
    );
    let s2 = rotation * seats[1].point;
    let (spin, alpha) = (omega + k, parent.alpha + kk + omega.cross(&k));
    Instance {
        position: parent.position + arm - s2,
        attitude: UnitQuaternion::from_matrix(&rotation),
        velocity: parent.velocity + omega.cross(&arm) + x - spin.cross(&s2),
        omega: spin,
        acceleration: parent.acceleration
            + parent.alpha.cross(&arm)
            + omega.cross(&omega.cross(&arm))
            + omega.cross(&x) * 2.0
            + xx
            - alpha.cross(&s2)
            - spin.cross(&spin.cross(&s2)),
        alpha,
    }
}

/// Every joint of the list that joins two places, with its numbers, aligned and along odd axes.
#[must_use]
pub fn all_joints() -> Vec<(JointLaw, Vec<f64>)> {
    struct Values {
        odd: bool,
        numbers: Vec<f64>,
    }
    impl mbd_scene::joints::Fields for Values {
        fn axis(&mut self, _: &'static str, default: Axis) -> Axis {
            let odd = Axis::new([0.3, -0.5, 0.7]).expect("not zero");
            if self.odd { odd } else { default }
        }
        fn axes(&mut self, _: &'static str, default: [Axis; 2], _: bool) -> [Axis; 2] {
            let odd = [
                Axis::new([0.6, 0.8, 0.0]).expect("not zero"),
                Axis::new([-0.8, 0.6, 0.5]).expect("not zero"),
            ];
            if self.odd { odd } else { default }
        }
        fn number(&mut self, field: &'static mbd_scene::joints::Field) -> Formula {
            let value = if field.name == "pitch" { 1.3 } else { 0.8 };
            self.numbers.push(value);
            value.into()
        }
        fn coordinates(&mut self) -> [(usize, usize); 2] {
            Default::default()
        }
        fn coupled(&mut self, field: &'static mbd_scene::joints::Field, _: Coupled) -> Formula {
            self.number(field)
        }
    }
    let read = |keyword: &&str, odd: bool| {
        let mut values = Values {
            odd,
            numbers: Vec::new(),
        };
        let law = JointLaw::read(keyword, &mut values).expect("a keyword of the list");
        (law, values.numbers)
    };
    let keywords = JointLaw::KEYWORDS;
    [false, true]
        .iter()
        .flat_map(|&odd| keywords.iter().map(move |keyword| read(keyword, odd)))
        .filter(|(law, _)| law.couples().is_empty())
        .collect()
}
