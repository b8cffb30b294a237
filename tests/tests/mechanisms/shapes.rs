//! Mass, centre of mass and inertia that follow from shapes, generated, interpreted and from a TOML document.

use std::f64::consts::PI;

use mbd_compiler::{Interpreted, read_text, read_toml, write_toml};
use mbd_runtime::nalgebra::Matrix3;
use mbd_runtime::scene::Scene;
use mbd_runtime::scene::laws::Numbers;
use mbd_runtime::{Model, Options, Simulation, model};
use tests::assert_close;

model! {
    /// A rod with a ball at its end, as shapes.
    model Even {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param radius = 10 cm in 5 cm ..= 20 cm;
        body pendulum {
            density: 1000 kg/m^3,
            shape: [
                cylinder { radius: 2 cm, length: 1 m } at [0.0, 0.0, -0.5] m,
                sphere { radius: radius } at bob,
            ],
            frame pivot at [0.0, 0.0, 0.0] m,
            frame bob at [0.0, 0.0, -1.0] m,
        }
        joint pin: hinge from world to pendulum.pivot { axis: y, start: 30 deg }
    }
}

model! {
    /// The same, its numbers written by hand.
    model ByHand {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param radius = 10 cm in 5 cm ..= 20 cm;
        const RHO = 1000 kg/m^3;
        const ROD = 0.4 * RHO * 3.141592653589793 * (1e-3 m^3);
        let ball = RHO * 4 / 3 * 3.141592653589793 * radius^3;
        let center = (0.5 m * ROD + 1 m * ball) / (ROD + ball);
        let across = ROD * (3 * (2 cm)^2 + 1 m^2) / 12 + ROD * (center - 0.5 m)^2
            + 0.4 * ball * radius^2 + ball * (1 m - center)^2;
        body pendulum {
            mass: ROD + ball,
            center_of_mass: [0 m, 0 m, -center],
            inertia: diag(across, across, ROD * (2 cm)^2 / 2 + 0.4 * ball * radius^2),
            frame pivot at [0.0, 0.0, 0.0] m,
        }
        joint pin: hinge from world to pendulum.pivot { axis: y, start: 30 deg }
    }
}

/// Mass, inertia and the place of the pivot of the only body.
fn numbers(scene: &Scene, params: &[f64]) -> (f64, Matrix3<f64>, f64) {
    let numbers = Numbers::<f64>::new(scene, params);
    let body = &numbers.bodies[0];
    (body.mass, body.inertia, body.frames[1].position.z)
}

#[test]
fn shapes_give_what_is_computed_by_hand_for_every_param() {
    for radius in [0.05, 0.1, 0.2] {
        let (mass, inertia, pivot) = numbers(&Even::scene(), &[radius]);
        let (by_hand, moments, place) = numbers(&ByHand::scene(), &[radius]);
        assert_close(
            &[mass, pivot],
            &[by_hand, place],
            1e-13,
            0.0,
            "mass and pivot",
        );
        let [inertia, moments] = [inertia, moments].map(|m| m.as_slice().to_vec());
        assert_close(&inertia, &moments, 1e-12, 0.0, "inertia");
    }
    let ball = 4.0 / 3.0 * PI * 0.001;
    let (mass, ..) = numbers(&Even::scene(), &[0.1]);
    let wanted = 1000.0 * (PI * 4e-4 + ball);
    assert_close(&[mass], &[wanted], 1e-14, 0.0, "mass");
}

#[test]
fn a_pendulum_of_shapes_swings_as_the_one_computed_by_hand() {
    let fly = |model: &dyn Model<f64>| {
        let mut run = Simulation::new(model, Options::vern7(1e-11)).expect("a model that runs");
        run.run(2.0).expect("a run that ends");
        run.state().to_vec()
    };
    let even = Even::new(EvenParams { radius: 0.15 }).expect("a param in its range");
    let by_hand = ByHand::new(ByHandParams { radius: 0.15 }).expect("a param in its range");
    let interpreted = Interpreted::<f64>::new(Even::scene(), &[0.15]).expect("the same");
    let wanted = fly(&by_hand);
    for found in [fly(&even), fly(&interpreted)] {
        assert_close(&found, &wanted, 1e-9, 0.0, "state after two seconds");
    }
}

#[test]
fn shapes_survive_a_document_and_what_follows_from_them_stays() {
    let scene = Even::scene();
    let read = read_toml(&write_toml(&scene));
    assert!(read.errors.is_empty(), "{:?}", read.errors);
    assert_eq!(read.scene, Some(scene));
}

#[test]
fn a_single_shape_in_its_middle_moves_no_frame_and_leaves_zeros() {
    let text = "model M { gravity: none; body b { mass: 3 kg, shape: box [1.0, 2.0, 3.0] m, frame f at [1.0, 0.0, 0.0] m } joint j: free from world to b.f; }";
    let scene = read_text(text).scene.expect("a scene");
    let numbers = Numbers::<f64>::new(&scene, &[]);
    let wanted = Matrix3::new(3.25, 0.0, 0.0, 0.0, 2.5, 0.0, 0.0, 0.0, 1.25);
    assert_eq!(numbers.bodies[0].inertia, wanted);
    assert_eq!(numbers.bodies[0].frames[1].position.x, 1.0);
}
