//! The same motion wherever the world's origin and axes lie, and whichever components the angular velocity has.

use mbd_compiler::Interpreted;
use mbd_runtime::{Options, Simulation};
use mbd_scene::{AngularVelocity, Formula, Frame, Gravity, LoadKind, Model, Scene, Triple};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use tests::declared::read;
use tests::largest_difference;
use tests::random::Random;

/// A raft and a buoy moored to the world, a knot between all of them; drag, wind, a motor, a couple, weight.
fn mooring(gravity: &str, knot: &str, damping: &str) -> Scene {
    // Ropes go slack and taut, except where steps are fixed and cannot land on it: then they are short.
    let rope = if knot.contains("stepwise") {
        "0.6 m"
    } else {
        "2.2 m"
    };
    read(&format!(
        "model Mooring {{
            gravity: {gravity};
            world {{ frame pier at [3.0, 0.5, 2.0] m, frame post at [-2.0, 1.0, 2.5] m, frame quay at [0.3, -2.5, 1.8] m, }}
            body raft {{
                mass: 7.0 kg,
                inertia: full {{ xx: 2.0, yy: 2.5, zz: 3.0, xy: 0.1, xz: -0.2, yz: 0.15 }} kg*m^2 (matrix elements),
                frame bow at [1.0, 0.1, -0.2] m, frame stern at [-0.9, 0.2, 0.1] m, frame mast at [0.1, -0.1, 0.9] m,
            }}
            body buoy {{
                mass: 3.0 kg,
                inertia: diag(1.0, 1.2, 0.9) kg*m^2,
                frame top at [0.0, 0.1, 0.5] m, frame side at [0.4, 0.0, -0.1] m,
            }}
            point knot {{ {knot} }}
            joint raft_free: free from world to raft.com;
            joint buoy_free: free from world to buoy.com;
            line pier_rope from world.pier to raft.bow {{ free_length: {rope}, stiffness: 300 N/m, damping: 4 N*s/m }}
            line post_rope from world.post to raft.stern {{ free_length: {rope}, stiffness: 350 N/m }}
            line quay_rope from world.quay to buoy.side {{ free_length: {rope}, stiffness: 320 N/m, damping: 5 N*s/m }}
            line one from raft.mast to knot {{ free_length: 0.2 m, stiffness: 400 N/m{damping} }}
            line two from buoy.top to knot {{ free_length: 0.2 m, stiffness: 350 N/m{damping} }}
            line three from world.quay to knot {{ free_length: 0.3 m, stiffness: 80 N/m{damping} }}
            line four from world.pier to knot {{ free_length: 0.3 m, stiffness: 70 N/m{damping} }}
            line five from knot to world.post {{ free_length: 0.3 m, stiffness: 90 N/m{damping} }}
            load drag on raft at mast = -(0.8 kg/m) * norm(raft.mast.velocity) * raft.mast.velocity;
            load wind on buoy at top = [4.0, -3.0, 2.0] N;
            load motor on raft at stern = (6.0 N) * raft.x;
            load couple on buoy at com = [0.3, 0.2, -0.4] N*m;
        }}"
    ))
}

/// x′ = R x + d: another choice of the world's axes and origin.
struct Change {
    rotation: UnitQuaternion<f64>,
    shift: Vector3<f64>,
}

impl Change {
    fn random(random: &mut Random, far: f64) -> Self {
        let [w, i, j, k] = random.attitude();
        Change {
            rotation: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)),
            shift: Vector3::from(random.vector(far)),
        }
    }

    fn direction(&self, v: &mut [f64]) {
        let rotated = self.rotation * Vector3::from_column_slice(v);
        v.copy_from_slice(rotated.as_slice());
    }

    fn place(&self, p: &mut [f64]) {
        let moved = self.rotation * Vector3::from_column_slice(p) + self.shift;
        p.copy_from_slice(moved.as_slice());
    }

    fn place_back(&self, p: &mut [f64]) {
        let back = self.rotation.inverse() * (Vector3::from_column_slice(p) - self.shift);
        p.copy_from_slice(back.as_slice());
    }

    fn formulas(&self, triple: &mut [Formula], change: impl Fn(&mut [f64])) {
        let mut numbers: Vec<f64> = triple.iter().map(number).collect();
        change(&mut numbers);
        triple
            .iter_mut()
            .zip(numbers)
            .for_each(|(f, x)| *f = x.into());
    }

    fn directions(&self, triple: &mut [Formula]) {
        self.formulas(triple, |v| self.direction(v));
    }

    fn places(&self, triple: &mut Triple) {
        self.formulas(triple, |p| self.place(p));
    }

    fn frame(&self, frame: &mut Frame) {
        self.places(&mut frame.position);
        // Columns are the axes of the frame in world components.
        let old = frame.rotation.as_ref().map_or(Matrix3::identity(), |rows| {
            Matrix3::from_fn(|i, j| number(&rows[i][j]))
        });
        let new = self.rotation.to_rotation_matrix() * old;
        frame.rotation = Some(std::array::from_fn(|i| {
            std::array::from_fn(|j| new[(i, j)].into())
        }));
    }

    /// The same scene in the new world.
    fn scene(&self, scene: &Scene) -> Scene {
        let mut moved = scene.clone();
        // Frame 0 is the new world itself.
        moved
            .world_frames
            .iter_mut()
            .skip(1)
            .for_each(|frame| self.frame(frame));
        match &mut moved.gravity {
            Gravity::Uniform { acceleration } => self.directions(acceleration),
            Gravity::PointMass { center, .. } => self.places(center),
            Gravity::Oblate { center, axis, .. } => {
                self.places(center);
                self.directions(axis);
            }
            Gravity::None | Gravity::Field => {}
        }
        for load in &mut moved.loads {
            if let LoadKind::Force(Formula::Vector(parts))
            | LoadKind::Torque(Formula::Vector(parts)) = &mut load.kind
            {
                self.directions(parts);
            }
        }
        moved
    }

    /// A state in the new world (`back`: from there).
    fn state(&self, model: &dyn Model<f64>, state: &[f64], back: bool) -> Vec<f64> {
        let (mut state, layout) = (state.to_vec(), model.layout());
        let turn = if back {
            self.rotation.inverse()
        } else {
            self.rotation
        };
        let in_world = model.scene().angular_velocity == AngularVelocity::World;
        let place = |p: &mut [f64]| {
            if back {
                self.place_back(p);
            } else {
                self.place(p);
            }
        };
        let direction = |v: &mut [f64]| {
            let rotated = turn * Vector3::from_column_slice(v);
            v.copy_from_slice(rotated.as_slice());
        };
        for (_, body) in layout.own_bodies() {
            let (q, v) = (body.q, layout.nq + body.v);
            place(&mut state[q..q + 3]);
            let attitude = Quaternion::new(state[q + 3], state[q + 4], state[q + 5], state[q + 6]);
            let attitude = turn.quaternion() * attitude;
            state[q + 3..q + 7].copy_from_slice(&[attitude.w, attitude.i, attitude.j, attitude.k]);
            direction(&mut state[v..v + 3]);
            if in_world {
                direction(&mut state[v + 3..v + 6]);
            }
        }
        for points in &layout.points {
            if let mbd_scene::PointSlots::Mass(slots) = points {
                place(&mut state[slots.q..slots.q + 3]);
                let v = layout.nq + slots.v;
                direction(&mut state[v..v + 3]);
            }
        }
        let z = layout.nq + layout.nv;
        state[z..].chunks_exact_mut(3).for_each(place);
        state
    }
}

fn number(formula: &Formula) -> f64 {
    match formula {
        Formula::Number(x) => *x,
        _ => f64::NAN,
    }
}

/// Where raft, buoy and knot start.
fn start(model: &dyn Model<f64>) -> Vec<f64> {
    let layout = model.layout();
    let mut state = vec![0.0; layout.nx()];
    state[..7].copy_from_slice(&[0.2, 0.1, 0.3, 0.96, 0.0, 0.28, 0.0]);
    state[7..14].copy_from_slice(&[0.4, -0.9, 0.9, 0.8, 0.6, 0.0, 0.0]);
    let knot = [0.3, -0.5, 1.4];
    if layout.nq == 17 {
        state[14..17].copy_from_slice(&knot);
    }
    let v = layout.nq;
    state[v..v + 6].copy_from_slice(&[0.4, -0.3, 0.2, 0.5, 0.7, -0.6]);
    state[v + 6..v + 12].copy_from_slice(&[-0.1, 0.2, 0.3, -0.4, 0.8, 0.3]);
    if layout.nz == 3 {
        state[v + 12..v + 15].copy_from_slice(&knot);
    }
    state
}

const KNOT: [f64; 3] = [0.3, -0.5, 1.4];

/// The states at ten instants of a run of one second.
fn run(model: &dyn Model<f64>, options: Options, from: &[f64], knot: [f64; 3]) -> Vec<Vec<f64>> {
    let mut simulation = Simulation::new(model, options).expect("options");
    simulation.set_state(0.0, from).expect("a state");
    if model.layout().nz == 0 && !model.layout().nodes.is_empty() {
        simulation.set_nodes(&knot).expect("a guess");
    }
    let instants = (1..=10).map(|tenth| f64::from(tenth) * 0.1);
    instants
        .map(|until| {
            simulation.run(until).unwrap_or_else(|e| panic!("{e}"));
            simulation.state().to_vec()
        })
        .collect()
}

/// What is left between two runs is rounding.
fn tight() -> Options {
    Options::tsit5(1e-13)
}

/// The knots that adaptive steps can carry.
const KNOTS: [(&str, &str); 3] = [
    ("mass: 0.5 kg", ", damping: 6 N*s/m"),
    ("equilibrium: static", ""),
    ("equilibrium: rate", ", damping: 6 N*s/m"),
];

const STEPWISE: (&str, &str) = ("equilibrium: stepwise", ", damping: 6 N*s/m");

const GRAVITY: [&str; 3] = [
    "[0.3, -0.2, -9.81] m/s^2",
    "point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m }",
    "oblate { mu: 4.2828e13 m^3/s^2, center: [1000.0, 0.0, -3404590.0] m, radius: 3396190.0 m, j2: 0.00196, axis: [0.6, 0.0, 0.8] }",
];

/// Largest difference of a state between a scene and the same in another world, seen from the first.
fn difference(scene: &Scene, change: &Change, options: Options) -> f64 {
    let here = Interpreted::new(scene.clone(), &[]).expect("no params");
    let there = Interpreted::new(change.scene(scene), &[]).expect("no params");
    let from = start(&here);
    let mut knot = KNOT;
    change.place(&mut knot);
    let moved = change.state(&here, &from, false);
    let runs = run(&here, options, &from, KNOT)
        .into_iter()
        .zip(run(&there, options, &moved, knot));
    runs.fold(0.0, |worst: f64, (here_now, there_now)| {
        let back = change.state(&here, &there_now, true);
        worst.max(largest_difference(&here_now, &back))
    })
}

#[test]
fn motion_does_not_depend_on_the_origin_or_the_axes_of_the_world() {
    let mut random = Random::new(31);
    let settings = [AngularVelocity::Body, AngularVelocity::World];
    for (index, gravity) in GRAVITY.into_iter().enumerate() {
        for (knot, damping) in KNOTS {
            let mut scene = mooring(gravity, knot, damping);
            scene.angular_velocity = settings[index % 2];
            let change = Change::random(&mut random, 20.0);
            let worst = difference(&scene, &change, tight());
            println!("{gravity}, {knot}, {:?}: {worst:e}", settings[index % 2]);
            assert!(worst <= 1e-10, "{gravity}, {knot}: {worst:e}");
        }
    }
}

#[test]
fn fixed_steps_do_not_depend_on_the_origin_or_the_axes_of_the_world() {
    let scene = mooring(GRAVITY[0], STEPWISE.0, STEPWISE.1);
    let mut change = Change::random(&mut Random::new(32), 20.0);
    // Inside a step quaternions are off unit length; their rotation matrix must turn with the axes all the same.
    for step in [2e-3, 1e-3] {
        let worst = difference(&scene, &change, Options::rk4(step));
        println!("other axes: {worst:e} at {step} s");
        assert!(worst <= 1e-10, "{worst:e} at {step} s");
    }
    for (knot, damping) in &KNOTS[..2] {
        let scene = mooring(GRAVITY[2], knot, damping);
        let worst = difference(&scene, &change, Options::rattle(2e-3));
        println!("{knot}, Rattle: {worst:e}");
        assert!(worst <= 1e-10, "{knot}, Rattle: {worst:e}");
    }
    change.rotation = UnitQuaternion::identity();
    let worst = difference(&scene, &change, Options::rk4(1e-3));
    println!("other origin: {worst:e}");
    assert!(worst <= 1e-10, "{worst:e}");
}

/// Largest difference between the motions with body and with world components of angular velocity.
fn between_components(scene: &Scene, options: Options) -> f64 {
    let set = |components: AngularVelocity| {
        let mut scene = scene.clone();
        scene.angular_velocity = components;
        Interpreted::new(scene, &[]).expect("no params")
    };
    let (body, world) = (set(AngularVelocity::Body), set(AngularVelocity::World));
    // ω = R ω′ for every body.
    let to_world = |state: &[f64]| {
        let mut state = state.to_vec();
        for (_, slots) in body.layout().own_bodies() {
            let (q, v) = (slots.q + 3, body.layout().nq + slots.v + 3);
            let attitude = Quaternion::new(state[q], state[q + 1], state[q + 2], state[q + 3]);
            let attitude = UnitQuaternion::from_quaternion(attitude);
            let omega = attitude * Vector3::from_column_slice(&state[v..v + 3]);
            state[v..v + 3].copy_from_slice(omega.as_slice());
        }
        state
    };
    let from = start(&body);
    let first = run(&body, options, &from, KNOT);
    let second = run(&world, options, &to_world(&from), KNOT);
    let pairs = first.iter().zip(&second);
    pairs.fold(0.0, |worst, (a, b)| {
        worst.max(largest_difference(&to_world(a), b))
    })
}

#[test]
fn body_and_world_components_of_angular_velocity_give_the_same_motion() {
    for (knot, damping) in KNOTS {
        let worst = between_components(&mooring(GRAVITY[0], knot, damping), tight());
        println!("{knot}: {worst:e}");
        assert!(worst <= 1e-10, "{knot}: {worst:e}");
    }
    // Rattle moves bodies, whatever numbers say how they turn.
    let worst = between_components(
        &mooring(GRAVITY[0], KNOTS[0].0, KNOTS[0].1),
        Options::rattle(5e-3),
    );
    println!("Rattle: {worst:e}");
    assert!(worst <= 1e-10, "Rattle: {worst:e}");
    // Fixed steps of RK4 integrate different numbers: the two agree to the error of the method.
    let scene = mooring(GRAVITY[0], STEPWISE.0, STEPWISE.1);
    let [coarse, fine] = [2e-3, 1e-3].map(|step| between_components(&scene, Options::rk4(step)));
    println!("stepwise: {coarse:e} at 2 ms, {fine:e} at 1 ms");
    assert!(fine <= 1e-5 && coarse >= 3.0 * fine, "{coarse:e}, {fine:e}");
}
