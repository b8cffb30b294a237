//! Outputs that a controller sees at its samples.

use std::sync::{Arc, Mutex};

use mbd_runtime::{Generic, Options, Quantity, Simulation, model};
use tests::declared::read;

model! {
    /// A lamp on a cord from a knot between two walls, pushed aside.
    pub model Hung<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: force = 1 N;
        world { frame left at [-1.0, 0.0, 2.0] m, frame right at [1.5, 0.0, 2.2] m }
        point lamp { mass: 2 kg, start at [0.15, 0.0, 0.9] m velocity [0.3, 0.0, 0.0] m/s }
        point knot;
        line a from world.left to knot { free_length: 1.2 m, stiffness: 5 kN/m }
        line b from world.right to knot { free_length: 1.6 m, stiffness: 5 kN/m }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: 5 kN/m }
        load aside on lamp = [push, 0 N, 0 N];
        output pull = a.tension;
        output speed = lamp.velocity;
        output jerked = lamp.acceleration.x;
    }
}

#[test]
fn a_controller_sees_the_outputs_of_its_instant_under_the_inputs_up_to_it() {
    let model = Hung::<f64>::new(HungParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    let seen = Arc::new(Mutex::new(Vec::new()));
    let notes = seen.clone();
    run.control_every(0.05, move |sample, inputs: &mut HungInputs| {
        let outputs = sample.outputs().expect("at a sample");
        notes
            .lock()
            .expect("one thread")
            .push((outputs.pull, outputs.jerked));
        inputs.push = 0.02 * outputs.pull - 3.0 * outputs.speed[0];
    })
    .expect("a controller");
    for step in 1..=10 {
        // The run ends on a sample, whose controller is called when it goes on.
        run.run(0.05 * f64::from(step)).expect("a swing");
        let mut out = [0.0; 5];
        run.evaluate(Quantity::Outputs, &mut out)
            .expect("a balance");
        run.run(0.05 * f64::from(step) + 1e-6).expect("a swing");
        let (pull, jerked) = seen.lock().expect("one thread")[step as usize];
        assert!(
            (pull - out[0]).abs() <= 1e-8 * out[0].abs(),
            "{step}: {pull} {out:?}"
        );
        assert!(
            (jerked - out[4]).abs() < 1e-6,
            "{step}: acceleration {jerked} {out:?}"
        );
    }
}

#[test]
fn a_function_of_time_and_state_is_given_no_outputs_since_they_would_depend_on_it() {
    let model = Hung::<f64>::new(HungParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
    run.control(|sample, inputs: &mut HungInputs| {
        inputs.push = if sample.outputs().is_none() {
            2.0
        } else {
            f64::NAN
        };
    })
    .expect("a function");
    run.run(0.1).expect("a swing");
}

#[test]
fn a_scene_that_is_not_compiled_gives_its_outputs_as_a_list() {
    let scene = read(
        "model Cart {
            gravity: none;
            planar: xz;
            input push: force = 0 N;
            body cart { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2, start at [1, 0, 0] m }
            joint rail: prismatic from world to cart.com { axis: x }
            load drive on cart = [push, 0 N, 0 N];
            output place = cart.position.x;
        }",
    );
    let model = Generic::<f32>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
    run.control_every(0.1, |sample, inputs: &mut Vec<f32>| {
        inputs[0] = -sample.outputs().map_or(f32::NAN, |columns| columns[0]);
    })
    .expect("a controller");
    // x(k + 1) = x + T ẋ − T² x/4 at a force of −x on 2 kg.
    let (mut x, mut v) = (1.0_f32, 0.0_f32);
    for step in 1..=10 {
        run.run(0.1 * f64::from(step)).expect("a smooth motion");
        (x, v) = (x + 0.1 * v - 0.0025 * x, v - 0.05 * x);
        assert!((run.state()[0] - x).abs() < 1e-5, "{step}");
    }
}
