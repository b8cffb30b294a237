//! What is made of a linear system: the sampled system and the frequency response, against closed forms and runs; and linear systems, trims and
//! inputs of scenes that are larger, planar, filtered.

use mbd_runtime::{External, Generic, Options, Simulation, StateSpace, linearise, trim};
use nalgebra::{Complex, DMatrix, DVector};
use tests::declared::read;

fn generic(text: &str) -> Generic<f64> {
    Generic::with_defaults(read(text)).expect("defaults")
}

/// A mass on a rail with a spring and a damper, pushed.
fn oscillator(stiffness: f64, damping: f64) -> (Generic<f64>, StateSpace) {
    let model = generic(&format!(
        "model Rail {{
            gravity: none;
            input push: force = 0 N;
            body cart {{ mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }}
            joint rail: prismatic from world to cart.com {{ axis: x, stiffness: {stiffness} N/m, damping: {damping} N*s/m, force: push }}
            output place = rail.slide;
        }}"
    ));
    let space = trim(&model)
        .fix("rail.slide", 0.0)
        .solve()
        .expect("at rest")
        .space;
    (model, space)
}

#[test]
fn a_mass_without_a_spring_is_sampled_as_the_double_integrator() {
    let (_, space) = oscillator(0.0, 0.0);
    let [a, b] = space.sampled(0.3).expect("a period");
    let want = DMatrix::from_row_slice(2, 2, &[1.0, 0.3, 0.0, 1.0]);
    assert!((a - want).amax() < 1e-15);
    let want = DMatrix::from_column_slice(2, 1, &[0.5 * 0.09 / 2.0, 0.3 / 2.0]);
    assert!((b - want).amax() < 1e-15);
}

#[test]
fn a_damped_oscillator_is_sampled_as_its_exponential() {
    let (_, space) = oscillator(50.0, 4.0);
    let (period, decay, square) = (0.1_f64, 1.0, 25.0_f64);
    let [a, b] = space.sampled(period).expect("a period");
    let omega = (square - decay * decay).sqrt();
    let (sin, cos) = (omega * period).sin_cos();
    let fall = (-decay * period).exp();
    let free = [
        fall * (cos + decay / omega * sin),
        fall * sin / omega,
        -fall * square / omega * sin,
        fall * (cos - decay / omega * sin),
    ];
    assert!((&a - DMatrix::from_row_slice(2, 2, &free)).amax() < 1e-14);
    // A held unit force ends at 1/50 m.
    let held = [(1.0 - free[0]) / 50.0, -free[2] / 50.0];
    assert!((b - DMatrix::from_column_slice(2, 1, &held)).amax() < 1e-15);
}

#[test]
fn a_run_with_a_sampled_controller_is_the_sampled_system() {
    let (model, space) = oscillator(50.0, 4.0);
    let [a, b] = space.sampled(0.05).expect("a period");
    let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options");
    run.set_joints(&[("rail.slide", 0.1)])
        .expect("a coordinate");
    run.control_every(0.05, |sample, inputs: &mut Vec<f64>| {
        inputs[0] = -30.0 * sample.x()[0];
    })
    .expect("a controller");
    let mut s = DVector::from_column_slice(&[0.1, 0.0]);
    for step in 1..=20 {
        s = &a * &s + &b * (-30.0 * s[0]);
        run.run(0.05 * f64::from(step)).expect("a smooth motion");
        assert!((run.state()[0] - s[0]).abs() < 1e-9, "{step}");
    }
}

#[test]
fn the_response_of_an_oscillator_is_its_transfer_function_and_none_at_its_pole() {
    let (_, space) = oscillator(50.0, 4.0);
    for omega in [0.0, 1.0, 5.0, 40.0] {
        let found = space.response(omega).expect("no pole")[(0, 0)];
        let want = Complex::new(1.0, 0.0) / Complex::new(50.0 - 2.0 * omega * omega, 4.0 * omega);
        assert!((found - want).norm() < 1e-14, "{omega}: {found} {want}");
    }
    let (_, free) = oscillator(0.0, 0.0);
    assert!(free.response(0.0).is_none());
    assert!(free.response(f64::NAN).is_none() && free.sampled(f64::NAN).is_none());
    assert!(free.sampled(0.0).is_none() && free.sampled(-1.0).is_none());
}

#[test]
fn external_loads_and_a_controller_of_plain_numbers_act_together() {
    struct Weight;
    impl External<f64> for Weight {
        fn evaluate(&self, _: f64, _: &[f64], out: &mut [f64]) {
            out.fill(0.0);
            out[2] = -3.0;
        }
    }
    let model = generic(
        "model Pushed {
            gravity: none;
            input push: force = 0 N;
            point mass { mass: 2 kg }
            load drive on mass = [push, 0, 0];
            load other on mass: external;
        }",
    );
    let mut run = Simulation::with_loads(&model, Options::rk4(0.01), Weight).expect("options");
    run.control(|_, inputs: &mut Vec<f64>| inputs[0] = 4.0)
        .expect("a function of plain numbers");
    run.run(1.0).expect("a smooth motion");
    let place = &run.state()[..3];
    let want = [1.0, -0.75, 0.0];
    assert!(
        place.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12),
        "{place:?}"
    );
}

#[test]
fn sixty_four_links_hang_with_the_lowest_frequency_of_a_chain() {
    let model = generic(
        "model Chain {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            planar: xz;
            const N = 64;
            const L = 1 m / 64;
            body link[i in 0..N] { mass: 0.1 kg, inertia: diag(1e-9, 1e-9, 1e-9) kg*m^2, frame up at [0, 0, L / 2], frame down at [0, 0, -L / 2] }
            joint top: hinge from world to link[0].up { axis: y }
            joint pin[i in 1..N]: hinge from link[i - 1].down to link[i].up { axis: y }
        }",
    );
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.start().expect("hanging");
    let space = linearise(&model, 0.0, run.state(), &[]).expect("a linear system");
    assert_eq!(space.states.len(), 128);
    let slowest = space
        .vibrations()
        .iter()
        .map(|v| v.frequency())
        .fold(f64::INFINITY, f64::min);
    // J₀(2 ω √(L/g)) = 0 of the continuous chain; links of L/64 with half of it rigid are off by their square.
    let want = 2.404_825_557_695_773 / 2.0 * 9.81_f64.sqrt();
    assert!(
        (slowest / want - 1.0).abs() < 2e-3,
        "{slowest} against {want}"
    );
}

#[test]
fn a_filtered_motor_is_trimmed_to_what_it_is_commanded() {
    let model = generic(
        "model Arm {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input wish: angle = 0.4 rad;
            body arm { mass: 3 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0, 0, 0.5] m, frame tip at [0, 0, -0.5] m }
            body bob { mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2, frame top at [0, 0, 0.3] m }
            joint shoulder: hinge from world to arm.root { axis: y, motor: wish, filter: 50 ms, start: -1 rad }
            joint elbow: hinge from arm.tip to bob.top { axis: y, damping: 0.1 N*m*s }
            output effort = shoulder.motor_torque;
        }",
    );
    let trimmed = trim(&model).solve().expect("a balance");
    let state = trimmed.state.clone();
    let (command, rate) = (state[state.len() - 2], state[state.len() - 1]);
    assert!(
        (command - 0.4).abs() < 1e-9 && rate.abs() < 1e-9,
        "{command} {rate}"
    );
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
    run.set_state(0.0, &state).expect("a state");
    run.run(1.0).expect("at rest");
    let moved = run
        .state()
        .iter()
        .zip(&state)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(moved < 1e-7, "{moved}");
    let mut effort = [0.0];
    run.evaluate(mbd_runtime::Quantity::Outputs, &mut effort)
        .expect("no node");
    // The arm at half a metre, the bob below its end.
    let want = 9.81 * 0.4_f64.sin() * (3.0 * 0.5 + 1.0);
    assert!((effort[0].abs() - want).abs() < 1e-6, "{effort:?} {want}");
}

#[test]
fn a_motor_of_inputs_is_trimmed_at_what_they_say_on_its_own_side() {
    let model = generic(
        "model Shaft {
            gravity: [0.0, 0.0, -9.81] m/s^2;
            input turn: angle;
            input spin: angular_velocity;
            input gain: angular_acceleration;
            body arm { mass: 2 kg, inertia: diag(0.3, 0.3, 0.5) kg*m^2, frame root at [0, 0, 0.4] m }
            joint pin: hinge from world to arm.root { axis: y, motor: [turn, spin, gain] }
            output seen = pin.angle;
        }",
    );
    for turn in [0.5, 1.7, 2.5, -3.0] {
        let trimmed = trim(&model).input("turn", turn).solve().expect("a balance");
        let mut run = Simulation::new(&model, Options::rk4(0.01)).expect("options");
        run.set_inputs(&vec![turn, 0.0, 0.0]).expect("numbers");
        run.set_state(0.0, &trimmed.state).expect("a state");
        run.start().expect("the motor is on its own side");
        let mut seen = [0.0];
        run.evaluate(mbd_runtime::Quantity::Outputs, &mut seen)
            .expect("no node");
        assert!((seen[0] - turn).abs() < 1e-9, "{seen:?} {turn}");
    }
}

#[test]
fn a_state_of_the_user_in_a_plane_filters_what_moves_there() {
    let model = generic(
        "model Filtered {
            gravity: [0.0, 0.0, -10.0] m/s^2;
            planar: xz;
            body stone { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2, start at [0, 0, 5] m angular_velocity [0, 2, 0] rad/s }
            joint loose: free from world to stone.com;
            state seen = 5 m { rate: (stone.position.z - seen) / (0.5 s) }
            state turned = 0 rad*s { rate: stone.angle }
            output behind = stone.position.z - seen;
        }",
    );
    let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options");
    run.run(1.0).expect("free fall");
    let state = run.state();
    let (seen, turned) = (state[state.len() - 2], state[state.len() - 1]);
    // z = 5 − 5 t²: τ ṡ + s = z has s = 5 − 5 (t² − 2 τ t + 2 τ² (1 − e^{−t/τ})).
    let want = 5.0 - 5.0 * (1.0 - 1.0 + 0.5 * (1.0 - (-2.0_f64).exp()));
    assert!((seen - want).abs() < 1e-9, "{seen} {want}");
    assert!((turned - 1.0).abs() < 1e-9, "{turned}");
    let space = linearise(&model, 1.0, state, &[]).expect("a linear system");
    let last = space.states.len() - 2;
    assert!((space.a[(last, last)] + 2.0).abs() < 1e-12, "{}", space.a);
}
