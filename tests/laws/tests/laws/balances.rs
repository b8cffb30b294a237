//! Energy, momentum, and the power of loads, by what every body and point adds.

use laws::assert_close;
use laws::instant::Instant;
use laws::mechanism::{
    Instance, Seat, add_body, add_frame, add_point, empty, evaluate_at, frame, inertia, layout,
    state,
};
use laws::random::Random;
use mbd_scene::laws::Numbers;
use mbd_scene::{
    AngularVelocity, Formula, Function, LineKind, Load, LoadKind, NodeModel, Part, Place, Quantity,
    Scene, Scratch,
};
use nalgebra::{Matrix3, Vector3};

use crate::things::{line, node, vector_output};

const COMPONENTS: [AngularVelocity; 2] = [AngularVelocity::Body, AngularVelocity::World];
const FORCES: [[f64; 3]; 4] = [
    [1.0, -2.0, 3.0],
    [0.5, 0.7, -0.9],
    [-1.5, 2.5, 0.5],
    [4.0, 3.0, -2.0],
];

/// Two bodies and a point, with loads of every kind.
struct Loaded {
    scene: Scene,
    masses: [f64; 3],
    inertias: [Matrix3<f64>; 2],
    seat: Seat,
}

fn given(force: [f64; 3]) -> Formula {
    Formula::Vector(force.map(Formula::Number).to_vec())
}

fn loaded(components: AngularVelocity, random: &mut Random) -> Loaded {
    let mut scene = empty([0.0; 3], components);
    let masses = [1.3, 2.7, 0.6];
    let inertias = [inertia(random), inertia(random)];
    let seat = Seat::random(random);
    for (mass, inertia) in masses.iter().zip(&inertias) {
        add_body(&mut scene, *mass, inertia);
    }
    let off = add_frame(&mut scene, Some(0), seat.declared("off"));
    let point = add_point(&mut scene, masses[2]);
    let mut load = |at: Place, kind: LoadKind| {
        scene.loads.push(Load {
            name: "load".to_owned(),
            doc: String::new(),
            at,
            kind,
        });
    };
    load(off, LoadKind::Force(given(FORCES[0])));
    load(Place::Body(1, 0), LoadKind::Torque(given(FORCES[1])));
    load(point, LoadKind::Force(given(FORCES[2])));
    load(off, LoadKind::External);
    load(point, LoadKind::External);
    Loaded {
        scene,
        masses,
        inertias,
        seat,
    }
}

/// External force and couple on the body, force on the point.
const GIVEN: [f64; 9] = [0.3, -0.6, 0.9, 1.1, 0.2, -0.5, 2.0, -1.0, 0.4];

fn three(list: &[f64]) -> Vector3<f64> {
    Vector3::from_column_slice(list)
}

#[test]
fn energy_and_momentum_are_sums_over_what_moves_and_loads_give_force_times_velocity() {
    let mut random = Random::new(51);
    for components in COMPONENTS {
        for _ in 0..10 {
            let loaded = loaded(components, &mut random);
            let scene = &loaded.scene;
            let bodies = [Instance::random(&mut random), Instance::random(&mut random)];
            let point = Instance::random(&mut random);
            let at = Instant {
                state: state(scene, &bodies, &[point]),
                inputs: GIVEN.to_vec(),
                ..Instant::default()
            };
            let (mut kinetic, mut moved, mut turned) = (0.0, 0.0, 0.0);
            let (mut p, mut l, mut centre) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
            let whole: f64 = loaded.masses.iter().sum();
            for (index, (part, mass)) in
                bodies.iter().chain([&point]).zip(loaded.masses).enumerate()
            {
                let spin = loaded
                    .inertias
                    .get(index)
                    .map_or(Vector3::zeros(), |inertia| {
                        let r = part.rotation();
                        r * inertia * r.transpose() * part.omega
                    });
                let linear = part.velocity * mass;
                kinetic += 0.5 * (mass * part.velocity.norm_squared());
                if index < 2 {
                    kinetic += 0.5 * part.omega.dot(&spin);
                }
                p += linear;
                l += part.position.cross(&linear) + spin;
                centre += part.position * (mass / whole);
                moved += linear.norm();
                turned += part.position.norm() * linear.norm() + spin.norm();
            }
            let arm = bodies[0].rotation() * loaded.seat.point;
            let (at_seat, forces) = (bodies[0].position + arm, FORCES.map(Vector3::from));
            let on_seat = forces[0] + three(&GIVEN[0..3]);
            let couple = three(&GIVEN[3..6]);
            let on_point = forces[2] + three(&GIVEN[6..9]);
            let power = on_seat.dot(&(bodies[0].velocity + bodies[0].omega.cross(&arm)))
                + couple.dot(&bodies[0].omega)
                + forces[1].dot(&bodies[1].omega)
                + on_point.dot(&point.velocity);
            let energy = evaluate_at(scene, Quantity::Energy, &at.at());
            assert_close(
                &energy,
                &[kinetic, 0.0, 0.0, power, 0.0, 0.0],
                1e-12,
                1e-12,
                "energy",
            );
            let told = evaluate_at(scene, Quantity::Momentum, &at.at());
            assert_close(&told[..3], p.as_slice(), 1e-12, 0.0, "momentum");
            assert_close(&told[3..], l.as_slice(), 1e-12, 0.0, "angular momentum");
            let told = evaluate_at(scene, Quantity::CentreOfMass, &at.at());
            assert_close(&told[..3], centre.as_slice(), 1e-12, 1e-14, "centre");
            assert_close(
                &told[3..],
                (p / whole).as_slice(),
                1e-12,
                1e-14,
                "its velocity",
            );
            // Loads in all: force, and torque about the world origin.
            let (layout, numbers) = (layout(scene), Numbers::new(scene, &[]));
            let mut got = vec![0.0; 14];
            let mut scratch = Scratch::new(&layout);
            mbd_scene::impulses(scene, &layout, &numbers, &at.at(), &mut scratch, &mut got);
            let force = on_seat + on_point;
            let torque =
                at_seat.cross(&on_seat) + point.position.cross(&on_point) + couple + forces[1];
            assert_close(&got[..3], p.as_slice(), 1e-12, 0.0, "momentum");
            assert_close(&got[3..6], l.as_slice(), 1e-12, 0.0, "angular momentum");
            assert_close(&got[6..9], force.as_slice(), 1e-12, 1e-13, "force");
            assert_close(&got[9..12], torque.as_slice(), 1e-12, 1e-13, "torque");
            assert_close(&got[12..], &[moved, turned], 1e-12, 0.0, "how much moves");
            // And along the speeds.
            let got = evaluate_at(scene, Quantity::Forces, &at.at());
            let seen = |body: &Instance, torque| body.in_components(torque, components);
            let mut want = Vec::new();
            want.extend(on_seat.iter());
            want.extend(seen(&bodies[0], arm.cross(&on_seat) + couple).iter());
            want.extend([0.0; 3]);
            want.extend(seen(&bodies[1], forces[1]).iter());
            want.extend(on_point.iter());
            assert_close(&got, &want, 1e-12, 1e-13, "forces");
        }
    }
}

#[test]
fn loads_on_nodes_count_as_forces_and_work_as_the_node_goes_with_its_anchors() {
    let mut random = Random::new(52);
    let mut scene = empty([0.0; 3], AngularVelocity::Body);
    let anchors = [0, 1, 2].map(|_| add_point(&mut scene, 1.0));
    let knot = node(&mut scene, NodeModel::Static);
    for anchor in anchors {
        // Of no free length and alike: the node is at the mean of its anchors, and goes with it.
        let numbers = [0.0, 200.0, 0.0];
        scene
            .lines
            .push(line(LineKind::Line, [anchor, knot], numbers));
    }
    scene.loads.push(Load {
        name: "weight".to_owned(),
        doc: String::new(),
        at: knot,
        kind: LoadKind::Force(given(FORCES[0])),
    });
    let points: Vec<Instance> = (0..3).map(|_| Instance::random(&mut random)).collect();
    let place = random.vector(0.5);
    let mut at = Instant {
        state: state(&scene, &[], &points),
        nodes: place.to_vec(),
        effective: [200.0, 0.0].repeat(3),
        hold: vec![0.0; 3],
        ..Instant::default()
    };
    at.ends = evaluate_at(&scene, Quantity::AnchorStates, &at.at());
    let mean = points
        .iter()
        .map(|point| point.velocity)
        .sum::<Vector3<f64>>()
        / 3.0;
    let power = Vector3::from(FORCES[0]).dot(&mean);
    let got = evaluate_at(&scene, Quantity::Energy, &at.at())[3];
    assert_close(&[got], &[power], 1e-13, 1e-13, "power");
    let (layout, numbers) = (layout(&scene), Numbers::new(&scene, &[]));
    let mut got = vec![0.0; 14];
    let mut scratch = Scratch::new(&layout);
    mbd_scene::impulses(&scene, &layout, &numbers, &at.at(), &mut scratch, &mut got);
    let force = Vector3::from(FORCES[0]);
    assert_close(&got[6..9], force.as_slice(), 1e-14, 0.0, "force");
    let torque = Vector3::from(place).cross(&force);
    assert_close(&got[9..12], torque.as_slice(), 1e-13, 0.0, "torque");
}

#[test]
fn a_post_that_moves_by_itself_gives_what_its_line_pulls_times_its_velocity() {
    let mut random = Random::new(53);
    let times = |k: f64| Formula::Apply(Function::Mul, vec![k.into(), Formula::Time]);
    let (rates, time) = ([0.7, -0.4, 0.3], 0.8);
    for post_first in [true, false] {
        let mut scene = empty([0.0; 3], AngularVelocity::Body);
        let mut post = frame("post", [0.0; 3], None);
        post.position = rates.map(times);
        let post = add_frame(&mut scene, None, post);
        let point = add_point(&mut scene, 1.0);
        let ends = if post_first {
            [post, point]
        } else {
            [point, post]
        };
        scene
            .lines
            .push(line(LineKind::Line, ends, [0.2, 300.0, 15.0]));
        let own = Instance {
            position: random.vector(2.0).into(),
            ..Instance::random(&mut random)
        };
        let at = Instant {
            time,
            state: state(&scene, &[], &[own]),
            hold: vec![0.0],
            ..Instant::default()
        };
        let velocity = Vector3::from(rates);
        let away = own.position - velocity * time;
        let u = away.normalize();
        let rate = u.dot(&(own.velocity - velocity));
        let tension = (300.0 * (away.norm() - 0.2) + 15.0 * rate).max(0.0);
        let told = evaluate_at(&scene, Quantity::Lines, &at.at());
        assert_close(
            &told[..4],
            &[tension, away.norm(), away.norm() - 0.2, rate],
            1e-12,
            1e-12,
            "line",
        );
        // The post is pulled towards the point, and holds against it.
        let energy = evaluate_at(&scene, Quantity::Energy, &at.at());
        let want = -tension * u.dot(&velocity);
        assert_close(&[energy[5]], &[want], 1e-12, 1e-12, "drive");
    }
}

#[test]
fn what_is_told_does_not_depend_on_the_origin_that_positions_are_measured_from() {
    let mut random = Random::new(54);
    for components in COMPONENTS {
        let mut scene = loaded(components, &mut random).scene;
        scene.gravity = mbd_scene::Gravity::PointMass {
            mu: 50.0.into(),
            center: [9.0, 0.0, 1.0].map(Formula::Number),
        };
        let post = add_frame(&mut scene, None, frame("post", [0.4, -0.3, 0.8], None));
        scene.lines.push(line(
            LineKind::Spring,
            [post, Place::Body(1, 0)],
            [0.5, 90.0, 4.0],
        ));
        for place in [Place::Body(0, 1), Place::Point(0), post] {
            scene.outputs.push(vector_output(Formula::Position(place)));
            scene.outputs.push(vector_output(Formula::Velocity(place)));
        }
        let bodies = [Instance::random(&mut random), Instance::random(&mut random)];
        let point = Instance::random(&mut random);
        let (time, since) = (1.7, 0.4);
        let [start, velocity] = [random.vector(3.0), random.vector(2.0)].map(Vector3::from);
        let shift = start + velocity * (time - since);
        let near = |part: &Instance| Instance {
            position: part.position - shift,
            velocity: part.velocity - velocity,
            ..*part
        };
        let at = Instant {
            time,
            state: state(&scene, &bodies, &[point]),
            inputs: GIVEN.to_vec(),
            hold: vec![0.0],
            ..Instant::default()
        };
        let mut following = scene.clone();
        following.runs.origin = Some(Part::Body(0));
        let mut moved = at.clone();
        moved.state = state(&following, &bodies.each_ref().map(near), &[near(&point)]);
        moved.hold.extend(start.iter());
        moved.hold.extend(velocity.iter());
        moved.hold.push(since);
        for what in [
            Quantity::Energy,
            Quantity::Momentum,
            Quantity::CentreOfMass,
            Quantity::Outputs,
            Quantity::Lines,
            Quantity::Guards,
            Quantity::Forces,
            Quantity::BiasForce,
        ] {
            let want = evaluate_at(&scene, what, &at.at());
            let got = evaluate_at(&following, what, &moved.at());
            assert_close(&got, &want, 1e-12, 1e-12, &format!("{what:?}"));
        }
        let impulses = |scene: &Scene, at: &Instant<f64>| {
            let (layout, numbers) = (layout(scene), Numbers::new(scene, &[]));
            let mut got = vec![0.0; 14];
            let mut scratch = Scratch::new(&layout);
            mbd_scene::impulses(scene, &layout, &numbers, &at.at(), &mut scratch, &mut got);
            got
        };
        assert_close(
            &impulses(&following, &moved),
            &impulses(&scene, &at),
            1e-12,
            1e-12,
            "impulses",
        );
    }
}
