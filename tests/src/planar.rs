//! Planar scenes: mechanisms in any of the three planes, and the same mechanisms in space.

use mbd_runtime::{Generic, Options, Simulation};
use mbd_scene::{Layout, Plane, PointSlots, Scene};

use crate::declared::read;
use crate::mechanism::layout;
use crate::random::Random;

/// The planes.
pub const PLANES: [Plane; 3] = [Plane::Xy, Plane::Yz, Plane::Xz];

/// A planar mechanism: its declaration in plane coordinates, and a state that is near one.
///
/// In the text `V(a, b)` is a vector with the components a and b along the two axes after the normal, which is `NORMAL`; its first and
/// second axis are `FIRST` and `SECOND`.
#[derive(Clone, Copy, Debug)]
pub struct Mechanism {
    /// Its name.
    pub name: &'static str,
    /// The items of its declaration.
    pub items: &'static str,
    /// Along the first axis, along the second, angle: of every body.
    pub poses: &'static [[f64; 3]],
}

/// Four-bar linkage with a spring and a driven crank; its window is no parallelogram.
pub const FOUR_BAR: Mechanism = Mechanism {
    name: "four-bar",
    items: "
        world { frame pivot at V(1.0, 0.0) m }
        body crank { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2,
            frame left at V(-0.15, 0.0) m, frame right at V(0.15, 0.0) m }
        body coupler { mass: 2 kg, inertia: diag(0.13, 0.12, 0.11) kg*m^2,
            frame left at V(-0.45, 0.05) m, frame right at V(0.45, 0.05) m }
        body rocker { mass: 1.5 kg, inertia: diag(0.08, 0.09, 0.1) kg*m^2,
            frame left at V(-0.4, 0.0) m, frame right at V(0.4, 0.0) m }
        joint crank_pin: hinge from world to crank.left { axis: NORMAL, damping: 0.1 N*m*s }
        joint coupler_pin: hinge from crank.right to coupler.left { axis: NORMAL }
        joint rocker_pin: hinge from coupler.right to rocker.right { axis: NORMAL, stiffness: 3 N*m/rad }
        joint ground_pin: hinge from world.pivot to rocker.left { axis: NORMAL }
        spring pull from world to coupler.com { free_length: 0.2 m, stiffness: 30 N/m, damping: 0.5 N*s/m }
        load drive on crank at right = 2 * V(0.3, 1.0) * 1 N;
        load brake on rocker = -0.3 * rocker.omega_world * 1 N*m*s;
        output tip = rocker.right.position;
        output turn = crank_pin.angle in deg;
        output speed = coupler.left.velocity;
    ",
    poses: &[
        [0.075, 0.1299, 60.0_f64.to_radians()],
        [0.4832, 0.5, 0.6306],
        [0.9384, 0.3952, 1.726],
    ],
};

/// Slider and crank: a rod between a hinge and a slide.
pub const SLIDER: Mechanism = Mechanism {
    name: "slider-crank",
    items: "
        body crank { mass: 0.5 kg, inertia: diag(0.003, 0.004, 0.005) kg*m^2,
            frame left at V(-0.1, 0.0) m, frame right at V(0.1, 0.0) m }
        body rod { mass: 1 kg, inertia: diag(0.013, 0.012, 0.011) kg*m^2,
            frame left at V(-0.3, 0.0) m, frame right at V(0.3, 0.0) m }
        body piston { mass: 2 kg, inertia: diag(0.008, 0.009, 0.01) kg*m^2 }
        joint crank_pin: hinge from world to crank.left { axis: NORMAL }
        joint rod_pin: hinge from crank.right to rod.left { axis: NORMAL }
        joint wrist: hinge from rod.right to piston.com { axis: NORMAL }
        joint guide: prismatic from world to piston.com {
            axis: FIRST, stiffness: 20 N/m, rest: 0.5 m, stops: [none, 0.75 m], stop_stiffness: 1 kN/m }
        output way = guide.slide;
    ",
    poses: &[
        [0.0707, 0.0707, 0.785],
        [0.4243, 0.0707, -0.238],
        [0.7243, 0.0, 0.0],
    ],
};

/// Two rods hanging one below the other, with a point with mass on a line.
pub const PENDULUM: Mechanism = Mechanism {
    name: "double pendulum",
    items: "
        body upper { mass: 1 kg, inertia: full { xx: 0.03, yy: 0.04, zz: 0.05, xy: 0.004, yz: 0.003 } kg*m^2 (matrix elements),
            frame top at V(0.0, 0.5) m, frame end at V(0.1, -0.5) m }
        body lower { mass: 2 kg, inertia: diag(0.13, 0.12, 0.11) kg*m^2, frame top at V(0.0, 0.4) m, frame end at V(0.0, -0.4) m }
        point weight { mass: 0.3 kg }
        joint hold: hinge from world to upper.top { axis: NORMAL }
        joint elbow: hinge from upper.end to lower.top { axis: NORMAL }
        line cord from lower.end to weight { free_length: 0.4 m, stiffness: 200 N/m, damping: 1 N*s/m }
        output fall = weight.position;
    ",
    poses: &[[0.1, -0.4, 0.2], [0.5, -1.2, 0.6]],
};

/// Three cranks of equal length below one beam: in the plane one row repeats others.
pub const PARALLEL: Mechanism = Mechanism {
    name: "three parallel cranks",
    items: "
        world { frame b at V(1.0, 0.0) m, frame c at V(1.7, 0.0) m }
        body one { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame root at V(0.0, -0.25) m, frame tip at V(0.0, 0.25) m }
        body two { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame root at V(0.0, -0.25) m, frame tip at V(0.0, 0.25) m }
        body three { mass: 1 kg, inertia: diag(0.03, 0.04, 0.05) kg*m^2, frame root at V(0.0, -0.25) m, frame tip at V(0.0, 0.25) m }
        body beam { mass: 2 kg, inertia: diag(0.3, 0.4, 0.5) kg*m^2,
            frame a at V(-0.85, 0.0) m, frame b at V(0.15, 0.0) m, frame c at V(0.85, 0.0) m }
        joint root_one: hinge from world to one.root { axis: NORMAL }
        joint root_two: hinge from world.b to two.root { axis: NORMAL }
        joint root_three: hinge from world.c to three.root { axis: NORMAL }
        joint tip_one: hinge from one.tip to beam.a { axis: NORMAL }
        joint tip_two: hinge from two.tip to beam.b { axis: NORMAL }
        joint tip_three: hinge from three.tip to beam.c { axis: NORMAL }
    ",
    poses: &[
        [-0.12, 0.22, 0.5],
        [0.88, 0.22, 0.5],
        [1.58, 0.22, 0.5],
        [0.61, 0.44, 0.0],
    ],
};

/// All of them.
pub const MECHANISMS: [Mechanism; 4] = [FOUR_BAR, SLIDER, PENDULUM, PARALLEL];

/// The two axes after the normal: an angle turns from the first to the second.
#[must_use]
pub fn axes(plane: Plane) -> [usize; 2] {
    [1, 2].map(|k| (plane.normal() + k) % 3)
}

/// Items with their vectors in a plane.
#[must_use]
pub fn placed(items: &str, plane: Plane) -> String {
    let names = ["x", "y", "z"];
    let [first, second] = axes(plane);
    let mut text = items
        .replace("NORMAL", names[plane.normal()])
        .replace("FIRST", names[first])
        .replace("SECOND", names[second]);
    while let Some(at) = text.find("V(") {
        let end = at + text[at..].find(')').expect("a closed vector");
        let parts: Vec<&str> = text[at + 2..end].split(',').map(str::trim).collect();
        let mut components = ["0.0"; 3];
        (components[first], components[second]) = (parts[0], parts[1]);
        text.replace_range(at..=end, &format!("[{}]", components.join(", ")));
    }
    text
}

impl Mechanism {
    /// Its scene in a plane, gravity against the second axis.
    #[must_use]
    pub fn scene(&self, plane: Plane, settings: &str) -> Scene {
        let gravity = placed("gravity: V(0.0, -9.81) m/s^2;", plane);
        let items = placed(self.items, plane);
        read(&format!(
            "model Planar {{ planar: {}; {gravity} {settings} {items} }}",
            plane.word()
        ))
    }

    /// A random state on the joints near its pose: with it the joints hold, and so do the speeds.
    #[must_use]
    pub fn state(&self, scene: &Scene, random: &mut Random) -> Vec<f64> {
        let generic = Generic::with_defaults(scene.clone()).expect("defaults");
        let layout = Layout::new(scene);
        let mut state = vec![0.0; layout.nx()];
        let plane = scene.planar.expect("a planar scene");
        for ((_, slots), pose) in layout.own_bodies().zip(self.poses) {
            let mut random = |size: f64| random.uniform(-size, size);
            for (k, axis) in layout.directions.translations().iter().enumerate() {
                let place = axes(plane).iter().position(|own| own == axis);
                state[slots.q + k] = pose[place.expect("an axis of the plane")];
            }
            state[slots.q + 2] = pose[2] + random(0.05);
            (0..3).for_each(|k| state[layout.nq + slots.v + k] = random(2.0));
        }
        for slots in &layout.points {
            if let PointSlots::Mass(slots) = slots {
                let places = [0, 1].map(|_| random.uniform(-2.0, 2.0));
                state[slots.q..slots.q + 2].copy_from_slice(&places);
                let speeds = layout.nq + slots.v;
                let places = [0, 1].map(|_| random.uniform(-2.0, 2.0));
                state[speeds..speeds + 2].copy_from_slice(&places);
            }
        }
        settled(&generic, &state)
    }
}

/// The consistent state that a run starts from.
#[must_use]
pub fn settled(generic: &Generic<f64>, state: &[f64]) -> Vec<f64> {
    let mut run = Simulation::new(generic, Options::rk4(1e-3)).expect("options");
    run.set_state(0.0, state).expect("a state");
    run.start().expect("a consistent start");
    run.state()[..state.len()].to_vec()
}

/// The same scene in space.
#[must_use]
pub fn in_space(scene: &Scene) -> Scene {
    Scene {
        planar: None,
        ..scene.clone()
    }
}

/// The state of the scene in space that is this state of a planar scene.
#[must_use]
pub fn lifted(scene: &Scene, state: &[f64]) -> Vec<f64> {
    let (flat, space) = (layout(scene), layout(&in_space(scene)));
    let normal = scene.planar.expect("a planar scene").normal();
    let mut out = vec![0.0; space.nx()];
    for (from, to) in flat
        .own_bodies()
        .map(|own| own.1)
        .zip(space.own_bodies().map(|own| own.1))
    {
        for (k, &axis) in flat.directions.translations().iter().enumerate() {
            out[to.q + axis] = state[from.q + k];
            out[space.nq + to.v + axis] = state[flat.nq + from.v + k];
        }
        let (sin, cos) = (0.5 * state[from.q + 2]).sin_cos();
        (out[to.q + 3], out[to.q + 4 + normal]) = (cos, sin);
        out[space.nq + to.v + 3 + normal] = state[flat.nq + from.v + 2];
    }
    for (from, to) in flat.points.iter().zip(&space.points) {
        if let (PointSlots::Mass(from), PointSlots::Mass(to)) = (from, to) {
            for (k, &axis) in flat.directions.translations().iter().enumerate() {
                out[to.q + axis] = state[from.q + k];
                out[space.nq + to.v + axis] = state[flat.nq + from.v + k];
            }
        }
    }
    out
}

/// The accelerations of a planar scene among those of the same scene in space.
#[must_use]
pub fn flattened(scene: &Scene, accelerations: &[f64]) -> Vec<f64> {
    let (flat, space) = (layout(scene), layout(&in_space(scene)));
    let normal = scene.planar.expect("a planar scene").normal();
    let mut out = vec![0.0; flat.nv];
    for (to, from) in flat
        .own_bodies()
        .map(|own| own.1)
        .zip(space.own_bodies().map(|own| own.1))
    {
        for (k, &axis) in flat.directions.translations().iter().enumerate() {
            out[to.v + k] = accelerations[from.v + axis];
        }
        out[to.v + 2] = accelerations[from.v + 3 + normal];
    }
    for (to, from) in flat.points.iter().zip(&space.points) {
        if let (PointSlots::Mass(to), PointSlots::Mass(from)) = (to, from) {
            for (k, &axis) in flat.directions.translations().iter().enumerate() {
                out[to.v + k] = accelerations[from.v + axis];
            }
        }
    }
    out
}
