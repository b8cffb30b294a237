//! Gravity: what falls, the energy it falls with, and the force and torque on everything.

use laws::assert_close;
use laws::mechanism::{
    Instance, add_body, add_point, empty, evaluate, evaluate_at, inertia, layout, state,
};
use laws::random::Random;
use mbd_scene::laws::Numbers;
use mbd_scene::{AngularVelocity, Formula, Gravity, Quantity, Scene, Scratch};
use nalgebra::Vector3;

use crate::things::{at_state, direction};

const MU: f64 = 4.0e5;
const RADIUS: f64 = 60.0;
const J2: f64 = 0.08;
const MASSES: [f64; 2] = [2.5, 3.0];

/// A law of gravity with the acceleration that it gives and the energy of a unit of mass, both at a place in the world.
struct Case {
    gravity: Gravity,
    center: Vector3<f64>,
    acceleration: Box<dyn Fn(Vector3<f64>) -> Vector3<f64>>,
    energy: Box<dyn Fn(Vector3<f64>) -> f64>,
}

fn triple(v: Vector3<f64>) -> [Formula; 3] {
    [v.x, v.y, v.z].map(Formula::Number)
}

fn cases(random: &mut Random) -> Vec<Case> {
    let none = Case {
        gravity: Gravity::None,
        center: Vector3::zeros(),
        acceleration: Box::new(|_| Vector3::zeros()),
        energy: Box::new(|_| 0.0),
    };
    let g = Vector3::new(0.4, -1.1, -9.7);
    let uniform = Case {
        gravity: Gravity::Uniform {
            acceleration: triple(g),
        },
        center: Vector3::zeros(),
        acceleration: Box::new(move |_| g),
        energy: Box::new(move |r| -g.dot(&r)),
    };
    let mut all = vec![none, uniform];
    for center in [Vector3::zeros(), Vector3::new(10.0, -70.0, 45.0)] {
        // Energies count from the world origin where that is not the centre itself.
        let level = match center.norm() {
            0.0 => 0.0,
            distance => MU / distance,
        };
        let sphere = move |r: Vector3<f64>| level - MU / (r - center).norm();
        all.push(Case {
            gravity: Gravity::PointMass {
                mu: MU.into(),
                center: triple(center),
            },
            center,
            acceleration: Box::new(move |r| {
                let d = r - center;
                -d * (MU / d.norm().powi(3))
            }),
            energy: Box::new(sphere),
        });
        let axis = direction(random);
        all.push(Case {
            gravity: Gravity::Oblate {
                mu: MU.into(),
                center: triple(center),
                radius: RADIUS.into(),
                j2: J2.into(),
                axis: triple(axis),
            },
            center,
            // D. Vallado, Fundamentals of Astrodynamics and Applications: along the equator −μ x/r³ (1 − k (5 z²/r² − 1)), along the axis with 3
            // in place of 1, k = 3/2 J2 (R/r)².
            acceleration: Box::new(move |r| {
                let d = r - center;
                let (height, k) = (d.dot(&axis), 1.5 * J2 * (RADIUS / d.norm()).powi(2));
                let ratio = 5.0 * (height / d.norm()).powi(2);
                let (polar, flat) = (axis * height, d - axis * height);
                let pull = -MU / d.norm().powi(3);
                (flat * (1.0 - k * (ratio - 1.0)) + polar * (1.0 - k * (ratio - 3.0))) * pull
            }),
            energy: Box::new(move |r| {
                let d = r - center;
                let sine = d.dot(&axis) / d.norm();
                let legendre = (3.0 * sine * sine - 1.0) / 2.0;
                sphere(r) + MU / d.norm() * J2 * (RADIUS / d.norm()).powi(2) * legendre
            }),
        });
    }
    all
}

/// A body of any inertia and a point, as free as they can be.
fn pair(gravity: Gravity, random: &mut Random) -> Scene {
    let mut scene = empty([0.0; 3], AngularVelocity::Body);
    scene.gravity = gravity;
    add_body(&mut scene, MASSES[0], &inertia(random));
    add_point(&mut scene, MASSES[1]);
    scene
}

/// Somewhere 0.9 to 3 radii from a centre, moving anyhow.
fn around(center: Vector3<f64>, random: &mut Random) -> Instance {
    Instance {
        position: center + direction(random) * random.uniform(0.9, 3.0) * RADIUS,
        ..Instance::random(random)
    }
}

#[test]
fn bodies_and_points_fall_as_newton_and_the_oblate_planet_make_them() {
    let mut random = Random::new(11);
    for case in cases(&mut random) {
        let scene = pair(case.gravity, &mut random);
        for _ in 0..20 {
            let (body, point) = (
                around(case.center, &mut random),
                around(case.center, &mut random),
            );
            let x = state(&scene, &[body], &[point]);
            let rates = evaluate(&scene, Quantity::Derivative, &x, &[], &[]);
            let want = [body, point].map(|part| (case.acceleration)(part.position));
            let name = format!("{:?}", scene.gravity);
            assert_close(&rates[10..13], want[0].as_slice(), 1e-13, 0.0, &name);
            assert_close(&rates[16..19], want[1].as_slice(), 1e-13, 0.0, &name);
            // What holds them at rest.
            let held = evaluate(&scene, Quantity::GravityForce, &x, &[], &[]);
            let mut hold = vec![0.0; 9];
            hold[0..3].copy_from_slice((-MASSES[0] * want[0]).as_slice());
            hold[6..9].copy_from_slice((-MASSES[1] * want[1]).as_slice());
            assert_close(&held, &hold, 1e-13, 0.0, &name);
        }
    }
}

#[test]
fn the_energy_of_gravity_is_the_potential_whose_slope_is_the_force() {
    let mut random = Random::new(12);
    for case in cases(&mut random) {
        let scene = pair(case.gravity, &mut random);
        for _ in 0..20 {
            let parts = [0, 1].map(|_| around(case.center, &mut random));
            let x = state(&scene, &parts[..1], &parts[1..]);
            let energy = evaluate(&scene, Quantity::Energy, &x, &[], &[])[1];
            let want: f64 = parts
                .iter()
                .zip(MASSES)
                .map(|(part, mass)| mass * (case.energy)(part.position))
                .sum();
            let scale = MU / RADIUS;
            assert_close(&[energy], &[want], 1e-12, 1e-13 * scale, "potential energy");
            // The slope, by the closed forms alone.
            let r = parts[0].position;
            for axis in 0..3 {
                let step = Vector3::from_fn(|i, _| if i == axis { 1e-3 } else { 0.0 });
                let rise = (case.energy)(r + step) - (case.energy)(r - step);
                let force = -(case.acceleration)(r)[axis];
                assert!((rise / 2e-3 - force).abs() < 1e-5 * scale / RADIUS);
            }
        }
    }
}

#[test]
fn weight_and_its_torque_are_those_of_every_mass_where_it_is() {
    let mut random = Random::new(13);
    for case in cases(&mut random) {
        let scene = pair(case.gravity, &mut random);
        let layout = layout(&scene);
        let parts = [0, 1].map(|_| around(case.center, &mut random));
        let x = state(&scene, &parts[..1], &parts[1..]);
        let numbers = Numbers::new(&scene, &[]);
        let mut got = vec![0.0; 14];
        let at = at_state(x, 0);
        let mut scratch = Scratch::new(&layout);
        mbd_scene::impulses(&scene, &layout, &numbers, &at.at(), &mut scratch, &mut got);
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (part, mass) in parts.iter().zip(MASSES) {
            let weight = mass * (case.acceleration)(part.position);
            force += weight;
            torque += part.position.cross(&weight);
        }
        assert_close(&got[6..9], force.as_slice(), 1e-12, 1e-12, "weight");
        assert_close(&got[9..12], torque.as_slice(), 1e-12, 1e-10, "torque");
    }
}

#[test]
fn a_field_that_the_caller_gives_acts_on_each_as_given_and_stores_nothing() {
    let mut random = Random::new(14);
    let scene = pair(Gravity::Field, &mut random);
    let parts = [0, 1].map(|_| around(Vector3::zeros(), &mut random));
    let x = state(&scene, &parts[..1], &parts[1..]);
    let given = [0.3, -0.4, 0.5, 1.1, 1.2, -1.3];
    let mut at = at_state(x, 0);
    at.inputs = given.to_vec();
    let rates = evaluate_at(&scene, Quantity::Derivative, &at.at());
    assert_close(&rates[10..13], &given[..3], 1e-15, 0.0, "body");
    assert_close(&rates[16..19], &given[3..], 1e-15, 0.0, "point");
    assert_eq!(evaluate_at(&scene, Quantity::Energy, &at.at())[1], 0.0);
}
