//! Motors that follow inputs: three inputs, or a command behind a filter; a Stewart platform in position control.

use mbd_runtime::{Options, Quantity, Simulation, StepError, linearise, model};
use tests::agreement::{agrees, agrees_along};

model! {
    /// A slider that follows a command through a filter, and an arm on it that hangs free.
    pub model Slider<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param tau = 50 ms in 1 ms ..= 1 s;
        input wish: length = 0.1 m;
        body cart { mass: 4.0 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body arm {
            mass: 1.0 kg,
            inertia: diag(0.02, 0.02, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint rail: prismatic from world to cart.com { axis: x, motor: wish, filter: tau }
        joint pin: hinge from cart.com to arm.top { axis: y, start: 0 deg }
        output lag = wish - rail.command;
        output push = rail.motor_force;
        output place = cart.position.x;
    }
}

model! {
    /// A wheel on a shaft whose angle, rate and acceleration are inputs.
    pub model Shaft {
        gravity: none;
        input turn: angle;
        input spin: angular_velocity;
        input gain: angular_acceleration;
        body wheel { mass: 2.0 kg, inertia: diag(0.3, 0.3, 0.5) kg*m^2 }
        joint pin: hinge from world to wheel.com { axis: z, motor: [turn, spin, gain] }
        output effort = pin.motor_torque;
        output turned = pin.angle;
    }
}

/// Where the filter is after a step of one: 1 − (1 + t/τ) exp(−t/τ).
fn response(time: f64) -> f64 {
    1.0 - (1.0 + time) * (-time).exp()
}

#[test]
fn a_command_is_followed_by_the_step_response_of_the_filter() {
    let model = Slider::<f64>::new(SliderParams::default()).expect("defaults");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-11)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    run.start().expect("a start");
    let start = SliderState::from_slice(run.state()).expect("a state");
    assert!(
        (start.cart().position[0] - 0.1).abs() < 1e-15,
        "at the default of the command"
    );
    let energy = |run: &mut Simulation<f64>| {
        let mut out = [0.0; 6];
        run.evaluate(Quantity::Energy, &mut out).expect("energies");
        out[..3].iter().sum::<f64>()
    };
    let before = energy(&mut run);
    run.set_inputs(&SliderInputs { wish: 0.6 })
        .expect("a number");
    for tenth in 1..=6 {
        let t = 0.02 * f64::from(tenth);
        run.run(t).expect("a smooth motion");
        let x = SliderState::from_slice(run.state())
            .expect("a state")
            .cart();
        let want = 0.1 + 0.5 * response(t / 0.05);
        assert!(
            (x.position[0] - want).abs() < 1e-9,
            "{t} s: {} {want}",
            x.position[0]
        );
        let rate = 0.5 * t / (0.05 * 0.05) * (-t / 0.05).exp();
        assert!(
            (x.velocity[0] - rate).abs() < 1e-8,
            "{t} s: {} {rate}",
            x.velocity[0]
        );
    }
    let gained = energy(&mut run) - before;
    let [_, _, drives] = run.work().expect("asked for");
    assert!(
        drives > 0.1 && (gained - drives).abs() < 1e-7,
        "{gained} J of {drives} J"
    );
}

#[test]
fn three_inputs_give_the_torque_of_their_acceleration() {
    let model = Shaft::new(ShaftParams::default()).expect("defaults");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-10)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    // φ = 3 t²/2 + sin t: two turns and more.
    run.control(|now, inputs: &mut ShaftInputs| {
        let t = now.time;
        inputs.turn = 1.5 * t * t + t.sin();
        inputs.spin = 3.0 * t + t.cos();
        inputs.gain = 3.0 - t.sin();
    })
    .expect("inputs of this model");
    run.start().expect("a start");
    run.run(3.0).expect("a smooth motion");
    let wheel = ShaftState::from_slice(run.state())
        .expect("a state")
        .wheel();
    let want = 9.0 + 3.0_f64.cos();
    assert!((wheel.angular_velocity[2] - want).abs() < 1e-9, "{want}");
    let mut effort = [0.0; 2];
    run.evaluate(Quantity::Outputs, &mut effort)
        .expect("outputs");
    assert!(
        (effort[0] - 0.5 * (3.0 - 3.0_f64.sin())).abs() < 1e-9,
        "{effort:?}"
    );
    let [_, _, drives] = run.work().expect("asked for");
    let gained = 0.25 * (want * want - 1.0);
    assert!(
        (drives - gained).abs() < 1e-7,
        "{drives} J against {gained} J"
    );
}

/// The refusal of a run, and where it stands.
fn refused(run: &mut Simulation<f64>, until: f64) -> (StepError, f64) {
    let error = run
        .run(until)
        .expect_err("commands that contradict each other");
    (error.cause, run.time())
}

#[test]
fn commands_that_contradict_each_other_are_refused_before_a_body_is_carried_along() {
    let model = Shaft::new(ShaftParams::default()).expect("defaults");
    let angle = |run: &mut Simulation<f64>| {
        let mut out = [0.0; 2];
        run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
        out[1]
    };
    for options in [Options::rk4(0.01), Options::tsit5(1e-6)] {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(0.5).expect("at rest");
        // A jump of the angle, then one of the rate; what is taken back goes on.
        for [turn, spin] in [[0.1, 0.0], [0.0, 0.3]] {
            let jump = ShaftInputs {
                turn,
                spin,
                ..ShaftInputs::default()
            };
            run.set_inputs(&jump).expect("numbers");
            let (cause, time) = refused(&mut run, 1.0);
            let told = cause.to_string();
            assert!(
                matches!(&cause, StepError::Command { motor, .. } if motor == "pin.angle"),
                "{told}"
            );
            assert!(cause.advice().contains("filter: 20 ms"), "{told}");
            assert_eq!((time, angle(&mut run)), (0.5, 0.0));
        }
        run.set_inputs(&ShaftInputs::default()).expect("numbers");
        run.run(1.0).expect("at rest again");
        // A rate that the held angle does not have.
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.set_inputs(&ShaftInputs {
            spin: 0.3,
            ..ShaftInputs::default()
        })
        .expect("numbers");
        let (cause, time) = refused(&mut run, 1.0);
        assert_eq!(time, 0.0, "{cause}");
    }
}

#[test]
fn smooth_commands_are_followed_at_six_steps_a_period() {
    let model = Shaft::new(ShaftParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1.0 / 6.0)).expect("options that fit");
    run.control(|now, inputs: &mut ShaftInputs| {
        let phase = std::f64::consts::TAU * now.time + 0.4;
        let omega = std::f64::consts::TAU;
        inputs.turn = 0.2 * phase.sin();
        inputs.spin = 0.2 * omega * phase.cos();
        inputs.gain = -0.2 * omega * omega * phase.sin();
    })
    .expect("inputs of this model");
    run.run(5.0).expect("a smooth motion");
}

#[test]
fn a_motor_by_input_is_the_same_in_every_execution() {
    let slider = Slider::<f64>::new(SliderParams::default()).expect("defaults");
    agrees(&slider);
    agrees(&Shaft::new(ShaftParams::default()).expect("defaults"));
    let mut run = Simulation::new(&slider, Options::tsit5(1e-6)).expect("options");
    run.start().expect("a start");
    agrees_along(&slider, run.state(), (20, 1e-3), 1e-12);
}

#[test]
fn a_linear_system_knows_what_motors_follow() {
    let model = Slider::<f64>::new(SliderParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("options");
    run.start().expect("a start");
    let space = linearise(&model, 0.0, run.state(), &[0.1]).expect("regular rows");
    let names: Vec<&str> = space.states.iter().map(|name| name.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "pin.angle",
            "pin.angle_rate",
            "rail.command",
            "rail.command_rate"
        ]
    );
    // 1 kg at 0.5 m with 0.02 kg m² of its own; the filter pushes its pivot.
    let (inertia, tau) = (0.02 + 0.25, 0.05_f64);
    let swing = 9.81 * 0.5 / inertia;
    assert!((space.a[(1, 0)] + swing).abs() < 1e-9, "{}", space.a);
    let push = 0.5 / inertia / (tau * tau);
    assert!(
        (space.b[(1, 0)].abs() - push).abs() < 1e-9 * push,
        "{}",
        space.b
    );
    assert!(
        (space.a[(1, 2)] + space.b[(1, 0)]).abs() < 1e-9 * push,
        "{}",
        space.a
    );
    assert!((space.b[(3, 0)] - 400.0).abs() < 1e-9, "{}", space.b);
    // The cart is where the command is.
    assert!((space.c[(2, 2)] - 1.0).abs() < 1e-12, "{}", space.c);
    let shaft = Shaft::new(ShaftParams::default()).expect("defaults");
    let state = ShaftState::at_origin().to_vec();
    let space = linearise(&shaft, 0.0, &state, &[0.0; 3]).expect("regular rows");
    assert!((space.d[(1, 0)] - 1.0).abs() < 1e-12, "{}", space.d);
    assert!((space.d[(0, 2)] - 0.5).abs() < 1e-12, "{}", space.d);
}

#[test]
fn a_filter_in_single_precision_follows_to_single_precision() {
    let model = Slider::<f32>::new(SliderParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-4)).expect("options that fit");
    run.start().expect("a start");
    run.set_inputs(&SliderInputs { wish: 0.6_f32 })
        .expect("a number");
    run.run(0.1).expect("a smooth motion");
    let x = SliderState::from_slice(run.state())
        .expect("a state")
        .cart();
    let want = 0.1 + 0.5 * response(2.0);
    assert!(
        (f64::from(x.position[0]) - want).abs() < 1e-3,
        "{}",
        x.position[0]
    );
}

#[test]
fn a_command_that_is_no_number_stops_the_run_by_name() {
    let model = Slider::<f64>::new(SliderParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("options that fit");
    let refused = run
        .set_inputs(&SliderInputs { wish: f64::NAN })
        .expect_err("no number");
    assert!(refused.to_string().contains("wish"), "{refused}");
}
