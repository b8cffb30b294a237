//! Accelerations and reactions as quantities of outputs and events, against closed forms; generated and generic models agree.

use mbd_runtime::{Generic, Happening, Model, Options, PointState, Quantity, Simulation, model};
use tests::agreement::agrees;

model! {
    /// A rod on a pin, a stone that falls, a body that flies and turns.
    pub model Things<T> {
        units: si;
        gravity: [0, 0, -9.81];
        world { frame shaken at [0.1 * sin(3 * time), 0, 5] }
        body rod {
            mass: 2,
            inertia: diag(0.14, 0.15, 0.02),
            frame top at [0, 0, 0.6],
            frame end at [0.1, 0, -0.6],
        }
        body top { mass: 1, inertia: diag(0.2, 0.2, 0.2), frame rim at [0.3, 0, 0] }
        body seat { mass: 1, inertia: diag(0.2, 0.2, 0.2), frame up at [0, 0, 1] }
        point stone { mass: 0.5 }
        joint pin: hinge from world to rod.top { axis: y }
        joint flies: free from world to top.com;
        joint hangs: hinge from world.shaken to seat.up { axis: y }
        output pull = pin.force;
        output couple = pin.torque;
        output bend = pin.angle_acceleration;
        output middle = rod.acceleration;
        output end = rod.end.acceleration;
        output spin = rod.angular_acceleration;
        output fall = stone.acceleration;
        output rim = top.rim.acceleration;
        output shake = world.shaken.acceleration;
        output swing = hangs.angle_acceleration;
        event heavy = norm(pin.force) rises 30;
    }
}

/// The rod at an angle [rad] and an angular velocity about y [rad/s], on its pin.
fn state(angle: f64, rate: f64) -> ThingsState {
    let mut state = ThingsState::at_origin();
    let (sin, cos) = angle.sin_cos();
    let mut rod = state.rod();
    // The centre is 0.6 m below the pin, rotated about y.
    rod.position = [-0.6 * sin, 0.0, -0.6 * cos];
    rod.orientation = [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0];
    rod.velocity = [-0.6 * cos * rate, 0.0, 0.6 * sin * rate];
    rod.angular_velocity = [0.0, rate, 0.0];
    state.set_rod(rod);
    let mut top = state.top();
    top.angular_velocity = [0.0, 0.0, 5.0];
    state.set_top(top);
    let mut seat = state.seat();
    seat.position = [0.0, 0.0, 4.0];
    seat.velocity = [0.3, 0.0, 0.0];
    state.set_seat(seat);
    state.set_stone(PointState {
        position: [1.0, 2.0, 3.0],
        velocity: [1.0, 0.0, 0.0],
    });
    state
}

fn near(found: [f64; 3], expected: [f64; 3], what: &str) {
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-11, "{what}: {found:?}, {expected:?}");
    }
}

#[test]
fn a_pendulum_is_pulled_by_its_pin_as_newton_says() {
    let model = Things::<f64>::new(ThingsParams::default()).expect("defaults");
    let (angle, rate) = (0.7_f64, 1.3);
    let (sin, cos) = angle.sin_cos();
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
    run.set_state(0.0, &state(angle, rate).to_vec())
        .expect("a state");
    let mut columns = vec![0.0; model.layout().len(Quantity::Outputs)];
    run.evaluate(Quantity::Outputs, &mut columns)
        .expect("outputs");
    let found = ThingsOutputs::from_array(columns.try_into().expect("all columns"));
    // (I + m l²) θ̈ = −m g l sin θ.
    let (m, g, l, i) = (2.0, 9.81, 0.6, 0.15);
    let second = -m * g * l * sin / (i + m * l * l);
    assert!(
        (found.bend - second).abs() < 1e-12,
        "{} {second}",
        found.bend
    );
    near(found.spin, [0.0, second, 0.0], "angular acceleration");
    let middle = [
        l * (-cos * second + sin * rate * rate),
        0.0,
        l * (sin * second + cos * rate * rate),
    ];
    near(found.middle, middle, "acceleration of the centre");
    near(
        found.pull,
        [m * middle[0], 0.0, m * (middle[2] + g)],
        "force of the pin",
    );
    near(found.couple, [0.0; 3], "torque of the pin");
    // The end: arm (0.1, −0.6) in body axes, rotated about y.
    let arm = [0.1 * cos - 0.6 * sin, 0.0, -0.1 * sin - 0.6 * cos];
    let end = [
        middle[0] + second * arm[2] - rate * rate * arm[0],
        0.0,
        middle[2] - second * arm[0] - rate * rate * arm[2],
    ];
    near(found.end, end, "acceleration of a frame");
    near(found.fall, [0.0, 0.0, -9.81], "free fall");
    near(
        found.rim,
        [-0.3 * 25.0, 0.0, -9.81],
        "centripetal acceleration",
    );
    near(found.shake, [0.0; 3], "the support at t = 0");
    assert!(found.swing.abs() < 1e-12, "{}", found.swing);
}

#[test]
fn generated_interpreted_and_generic_models_accelerate_alike() {
    agrees(&Things::<f64>::new(ThingsParams::default()).expect("defaults"));
}

#[test]
fn a_reaction_that_grows_is_an_event_at_its_instant() {
    let model = Things::<f64>::new(ThingsParams::default()).expect("defaults");
    let generic = Generic::<f64>::with_defaults(Things::<f64>::scene()).expect("defaults");
    let mut times = Vec::new();
    for model in [&model as &dyn Model<f64>, &generic] {
        let mut run = Simulation::new(model, Options::tsit5(1e-11)).expect("options that fit");
        run.set_state(0.0, &state(1.4, 0.0).to_vec())
            .expect("a state");
        run.run(1.0).expect("a smooth motion");
        let first = run
            .events()
            .iter()
            .find(|event| event.what == Happening::Declared(0));
        times.push(first.expect("the force passes 30 N").time);
        // The force at the instant: continue to it and look.
        let mut again = Simulation::new(model, Options::tsit5(1e-11)).expect("options that fit");
        again
            .set_state(0.0, &state(1.4, 0.0).to_vec())
            .expect("a state");
        again.run(times[0]).expect("a smooth motion");
        let mut columns = vec![0.0; model.layout().len(Quantity::Outputs)];
        again
            .evaluate(Quantity::Outputs, &mut columns)
            .expect("outputs");
        let force = columns[..3].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((force - 30.0).abs() < 1e-7, "{force}");
    }
    assert!((times[0] - times[1]).abs() < 1e-9, "{times:?}");
}

#[test]
fn a_model_in_single_precision_accelerates_to_single_precision() {
    let model = Things::<f32>::new(ThingsParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-4)).expect("options that fit");
    let start: Vec<f32> = state(0.7, 1.3).to_vec().iter().map(|x| *x as f32).collect();
    run.set_state(0.0, &start).expect("a state");
    let mut columns = vec![0.0; model.layout().len(Quantity::Outputs)];
    run.evaluate(Quantity::Outputs, &mut columns)
        .expect("outputs");
    let found = ThingsOutputs::<f32>::from_array(columns.try_into().expect("all columns"));
    let second = -2.0 * 9.81 * 0.6 * 0.7_f32.sin() / (0.15 + 2.0 * 0.36);
    assert!(
        (found.bend - second).abs() < 1e-4,
        "{} {second}",
        found.bend
    );
}
