//! Inputs of a run: held, functions of time and state, controllers at samples.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use mbd_runtime::{
    Content, Generic, Inputs, Options, PointState, RunError, Sampling, Simulation, StepError,
    Trajectory, Wrench, model,
};
use nalgebra::{Matrix2, Vector2};

model! {
    /// A mass that is pushed against a wind.
    pub model Cart<T> {
        units: si;
        gravity: none;
        /// Push along x.
        input push: force = 0.5 N;
        input wind: velocity = [0, 2, 0] m/s;
        input cable[i in 1..4]: force;
        point cart { mass: 2 kg }
        load by_hand on cart = [push, 0, 0];
        load drag on cart = 0.25 kg/s * wind;
        load by_cable[i in 1..4] on cart = [0, 0, i * cable[i]];
    }
}

model! {
    /// Forty masses, each with a push of its own.
    model Crowd {
        units: si;
        gravity: none;
        emit: [derivative];
        input push[i in 0..40]: force = 1 N;
        point one[i in 0..40] { mass: 1 kg }
        load by_hand[i in 0..40] on one[i] = [push[i], 0, 0];
    }
}

model! {
    /// A body in a field of gravity, with a thruster.
    model Lander {
        units: si;
        gravity: field;
        body hull { mass: 4, inertia: diag(1, 1, 1), frame jet at [0, 0, -1] }
        point probe { mass: 1 }
        joint loose: free from world to hull.com;
        load thruster on hull at jet: external;
    }
}

model! {
    /// Nothing drives it.
    model Stone {
        units: si;
        gravity: [0, 0, -9.81];
        point stone { mass: 1 }
    }
}

model! {
    /// An oscillator with a push: ω = 2 rad/s.
    model Swing {
        units: si;
        gravity: none;
        input push: force;
        output place = bob.position.x;
        point bob { mass: 1 }
        load pull on bob = -4 N/m * bob.position;
        load by_hand on bob = [push, 0, 0];
    }
}

model! {
    /// Three links of a chain and a slider, driven by torques.
    model Chain<T> {
        units: si;
        gravity: [0, 0, -9.81];
        input torque[i in 0..3]: torque;
        body link[i in 0..3] {
            mass: 1,
            inertia: diag(0.1, 0.1, 0.02),
            frame root at [0, 0, 0.25],
            frame tip at [0, 0, -0.25],
        }
        body sled { mass: 2, inertia: diag(0.1, 0.1, 0.1) }
        joint rail: prismatic from world to sled.com { axis: [1, 0, 0] }
        joint hook: hinge from sled.com to link[0].root { axis: [0, 1, 0], force: torque[0] }
        joint pin[i in 0..2]: hinge from link[i].tip to link[i + 1].root {
            axis: [0, 1, 0],
            force: torque[i + 1],
        }
        output bend[i in 0..2] = pin[i].angle;
        output bend_rate[i in 0..2] = pin[i].angle_rate;
        output slide = rail.slide;
        output slide_rate = rail.slide_rate;
    }
}

fn cart() -> Cart {
    Cart::new(CartParams::default()).expect("defaults")
}

fn at(x: f64, v: f64) -> Vec<f64> {
    let mut state = CartState::at_origin();
    state.set_cart(PointState {
        position: [x, 0.0, 0.0],
        velocity: [v, 0.0, 0.0],
    });
    state.to_vec()
}

fn cause(result: Result<impl std::fmt::Debug, RunError>) -> StepError {
    result.expect_err("refused").cause
}

#[test]
fn declared_defaults_hold_until_others_are_given() {
    for options in [Options::rk4(0.05), Options::tsit5(1e-10)] {
        let mut run = Simulation::new(&cart(), options).expect("options");
        run.run(2.0).expect("a constant force");
        // ½ (f/m) t²: 0.5 N along x, 0.5 N along y.
        assert!((run.state()[0] - 0.5).abs() < 1e-12);
        assert!((run.state()[1] - 0.5).abs() < 1e-12);
        let given = CartInputs {
            push: -0.5,
            wind: [0.0; 3],
            cable: [1.0, 0.0, -1.0],
        };
        run.set_inputs(&given).expect("its inputs");
        run.run(4.0).expect("a constant force");
        assert!(run.state()[3].abs() < 1e-12, "stopped: {}", run.state()[3]);
        assert!((run.state()[4] - 0.5).abs() < 1e-12, "coasts");
        assert!((run.state()[5] + 2.0).abs() < 1e-12, "(1 − 3) N on 2 kg");
        assert_eq!(run.held_inputs(), [-0.5, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0]);
    }
}

#[test]
fn inputs_have_names_defaults_and_forms() {
    let inputs = CartInputs::<f64>::default();
    assert_eq!((inputs.push, inputs.wind), (0.5, [0.0, 2.0, 0.0]));
    assert_eq!(inputs.cable, [0.0; 3]);
    assert_eq!(CartInputs::from_array(inputs.to_array()), inputs);
    assert_eq!(inputs.numbers().as_ref(), inputs.to_array());
    assert_eq!(CartInputs::<f64>::from_numbers(&[0.0; 6]), None);
    // More than serde's own 32.
    let crowd = CrowdInputs {
        push: std::array::from_fn(|i| i as f64),
    };
    let text = serde_json::to_string(&crowd).expect("numbers");
    let back: CrowdInputs = serde_json::from_str(&text).expect("what was written");
    assert_eq!(back, crowd);
    assert!(serde_json::from_str::<CrowdInputs>("{\"push\":[1.0]}").is_err());
    assert!(serde_json::from_str::<CartInputs>("{\"psh\":1.0}").is_err());
}

#[test]
fn a_crowd_takes_a_push_each() {
    let crowd = Crowd::new(CrowdParams::default()).expect("defaults");
    let mut run = Simulation::new(&crowd, Options::rk4(0.1)).expect("options");
    run.set_inputs(&CrowdInputs {
        push: std::array::from_fn(|i| i as f64),
    })
    .expect("its inputs");
    run.run(1.0).expect("constant forces");
    for i in 0..40 {
        assert!((run.state()[3 * i] - 0.5 * i as f64).abs() < 1e-12);
    }
}

#[test]
fn what_cannot_be_held_is_refused_and_changes_nothing() {
    let mut run = Simulation::new(&cart(), Options::rk4(0.1)).expect("options");
    run.run(0.5).expect("it moves");
    let before = run.held_inputs().to_vec();
    let nan = CartInputs {
        wind: [0.0, f64::NAN, 0.0],
        ..CartInputs::default()
    };
    let refused = cause(run.set_inputs(&nan));
    assert!(
        matches!(&refused, StepError::InvalidInput { slot, value } if slot == "wind" && value.is_nan())
    );
    let refused = cause(run.set_inputs(&vec![0.0; 3]));
    assert!(
        matches!(&refused, StepError::Length { list, expected: 7, found: 3 } if list == "inputs")
    );
    let refused = cause(run.set_inputs(&SwingInputs::default()));
    assert!(refused.to_string().contains("`Swing`"), "{refused}");
    assert_eq!(run.held_inputs(), before);
    // The numbers alone, as for a scene that is not compiled.
    run.set_inputs(&[0.0; 7]).expect("seven numbers");
    assert_eq!(run.held_inputs(), [0.0; 7]);
}

#[test]
fn a_scene_without_inputs_refuses_what_drives() {
    let stone = Stone::new(StoneParams::default()).expect("defaults");
    let mut run = Simulation::new(&stone, Options::rk4(0.1)).expect("options");
    let refused = cause(run.control_every(0.1, |_, _: &mut [f64; 0]| ()));
    assert!(refused.to_string().contains("has no inputs"), "{refused}");
    let refused = cause(run.control(|_, _: &mut CartInputs| ()));
    assert!(refused.to_string().contains("`Cart`"), "{refused}");
    run.set_inputs(&[]).expect("none");
    run.run(0.1).expect("it falls");
}

#[test]
fn external_loads_and_gravity_come_from_the_caller_before_a_start() {
    let lander = Lander::new(LanderParams::default()).expect("defaults");
    let start = || Simulation::new(&lander, Options::rk4(0.05)).expect("options");
    let refused = cause(start().run(1.0));
    for name in ["thruster", "gravity at hull", "gravity at probe"] {
        assert!(refused.to_string().contains(name), "{refused}");
    }
    let gravity = |_: [f64; 3]| [0.0, 0.0, -1.5];
    let mut inputs = LanderInputs {
        thruster: Wrench {
            force: [0.0, 0.0, 8.0],
            couple: [0.0; 3],
        },
        ..LanderInputs::default()
    };
    inputs.set_gravity(&LanderState::at_origin(), gravity);
    let mut held = start();
    held.set_inputs(&inputs).expect("its inputs");
    let mut computed = start();
    computed
        .control(move |sample, inputs: &mut LanderInputs| {
            inputs.thruster.force = [0.0, 0.0, 8.0];
            inputs.set_gravity(&sample.state(), gravity);
        })
        .expect("its inputs");
    for run in [&mut held, &mut computed] {
        run.run(2.0).expect("constant forces");
        let state = LanderState::from_slice(run.state()).expect("its state");
        assert!(
            (state.hull().position[2] - 1.0).abs() < 1e-12,
            "8 N / 4 kg − 1.5 m/s²"
        );
        assert!((state.probe().position[2] + 3.0).abs() < 1e-12);
    }
    assert_eq!(held.state(), computed.state());
}

/// u = −K x sampled on a double integrator: x(k+1) = (A − B K) x(k) with A = [1 T; 0 1], B = [T²/2; T]/m.
#[test]
fn a_sampled_controller_is_the_closed_form_of_the_sampled_system() {
    let (period, gain) = (0.05, [3.0, 5.0]);
    let a = Matrix2::new(1.0, period, 0.0, 1.0);
    let b = Vector2::new(period * period / 2.0, period) / 2.0;
    let closed = a - b * Vector2::from(gain).transpose();
    for options in [
        Options::rk4(0.05),
        Options::rk4(0.01),
        // Neither divides the period.
        Options::rk4(0.013),
        Options::rk4(0.7),
        Options::tsit5(1e-6),
        Options::tsit5(1e-11),
    ] {
        let mut run = Simulation::new(&cart(), options).expect("options");
        run.set_state(0.0, &at(1.0, -0.5)).expect("a state");
        run.set_inputs(&CartInputs {
            wind: [0.0; 3],
            ..CartInputs::default()
        })
        .expect("calm");
        let calls = Arc::new(AtomicU64::new(0));
        let counted = calls.clone();
        run.control_every(
            period,
            move |sample: &CartSample, inputs: &mut CartInputs| {
                let k = counted.fetch_add(1, Ordering::Relaxed);
                assert_eq!(sample.time.to_bits(), (k as f64 * period).to_bits());
                let cart = sample.state().cart();
                inputs.push = -(gain[0] * cart.position[0] + gain[1] * cart.velocity[0]);
            },
        )
        .expect("a controller");
        let mut x = Vector2::new(1.0, -0.5);
        for n in 1..=200_u64 {
            run.run(n as f64 * period).expect("it settles");
            x = closed * x;
            let found = Vector2::new(run.state()[0], run.state()[3]);
            assert!(
                (found - x).amax() < 1e-12,
                "{options:?}, sample {n}: {found} {x}"
            );
            assert_eq!(calls.load(Ordering::Relaxed), n);
        }
        // In one go, it is the same.
        assert!(x.amax() < 1e-3, "stable");
    }
}

#[test]
fn samples_do_not_drift_and_one_call_is_many() {
    let run = |until: &[f64]| {
        let mut run = Simulation::new(&cart(), Options::rk4(0.001)).expect("options");
        run.set_state(0.25, &at(0.0, 0.0)).expect("a state");
        let last = Arc::new(AtomicU64::new(0));
        let seen = last.clone();
        let mut k = 0_u64;
        run.control_every(0.001, move |sample, inputs: &mut CartInputs| {
            assert_eq!(sample.time.to_bits(), (0.25 + k as f64 * 0.001).to_bits());
            inputs.push = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            k += 1;
            seen.store(k, Ordering::Relaxed);
        })
        .expect("a controller");
        for &until in until {
            run.run(until).expect("it shakes");
        }
        (run.state().to_vec(), last.load(Ordering::Relaxed))
    };
    // Times that were added up would have other bits before the tenth sample.
    let (whole, samples) = run(&[0.25 + 100_000.0 * 0.001]);
    assert_eq!(samples, 100_000);
    let (cut, again) = run(&[0.25 + 300.0 * 0.001, 0.25 + 100_000.0 * 0.001]);
    assert_eq!((whole, samples), (cut, again));
}

#[test]
fn two_rates_meet_where_their_samples_meet() {
    let mut run = Simulation::new(&cart(), Options::rk4(0.01)).expect("options");
    let log = Arc::new(std::sync::Mutex::new(Vec::new()));
    for (name, period) in [("slow", 0.3), ("fast", 0.1)] {
        let log = log.clone();
        run.control_every(period, move |sample, inputs: &mut CartInputs| {
            inputs.push += 1.0;
            let tenth = (10.0 * sample.time).round() as u64;
            log.lock()
                .expect("one thread")
                .push((name, tenth, inputs.push));
        })
        .expect("a controller");
    }
    run.run(0.6).expect("it moves");
    let log = log.lock().expect("one thread").clone();
    assert_eq!(
        log,
        [
            ("slow", 0, 1.5),
            ("fast", 0, 2.5),
            ("fast", 1, 3.5),
            ("fast", 2, 4.5),
            ("slow", 3, 5.5),
            ("fast", 3, 6.5),
            ("fast", 4, 7.5),
            ("fast", 5, 8.5),
        ]
    );
}

/// What a controller holds is the base of a function of time and state.
#[test]
fn a_function_of_time_acts_on_what_a_controller_holds() {
    let mut run = Simulation::new(&cart(), Options::tsit5(1e-11)).expect("options");
    run.control(|sample, inputs: &mut CartInputs| inputs.push += sample.time.cos())
        .expect("a function");
    run.control_every(0.5, |_, inputs: &mut CartInputs| inputs.push = 2.0)
        .expect("a controller");
    run.run(1.7).expect("it moves");
    let want = (2.0 * 1.7 + 1.7_f64.sin()) / 2.0;
    assert!((run.state()[3] - want).abs() < 1e-9);
    assert_eq!(run.held_inputs()[0], 2.0);
}

/// Without a sample between, an adaptive step is as long as it was before the sample.
#[test]
fn adaptive_steps_keep_their_size_across_samples() {
    let swing = Swing::new(SwingParams::default()).expect("defaults");
    let steps = |period: f64| {
        let mut run = Simulation::new(&swing, Options::tsit5(1e-6)).expect("options");
        run.set_state(0.0, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            .expect("a state");
        run.control_every(period, |sample, inputs: &mut SwingInputs| {
            inputs.push = 1e-3 * sample.state().bob().velocity[0];
        })
        .expect("a controller");
        run.run(20.0).expect("it swings");
        run.statistics()
    };
    let (free, sampled) = (steps(20.0), steps(1.0));
    assert!(
        sampled.steps <= free.steps + 40 && sampled.rejected <= free.rejected + 5,
        "{free:?} {sampled:?}"
    );
}

/// A push that sets in after a long rest is met by a step of its size, not by one of the rest's.
#[test]
fn after_a_jump_an_adaptive_step_is_short_enough() {
    let swing = Swing::new(SwingParams::default()).expect("defaults");
    let mut run = Simulation::new(&swing, Options::tsit5(1e-8)).expect("options");
    run.run(1e6).expect("at rest");
    run.set_inputs(&SwingInputs { push: 4.0 }).expect("a push");
    run.run(1e6 + 3.0).expect("it swings");
    // x = 1 − cos 2t
    assert!((run.state()[0] - (1.0 - 6.0_f64.cos())).abs() < 1e-6);
    assert!(run.statistics().rejected < 5, "{:?}", run.statistics());
}

#[test]
fn a_number_that_is_none_stops_the_run_by_its_name() {
    let mut run = Simulation::new(&cart(), Options::rk4(0.01)).expect("options");
    run.control_every(0.1, |sample, inputs: &mut CartInputs| {
        inputs.push = if sample.time > 0.45 { f64::NAN } else { 1.0 };
    })
    .expect("a controller");
    let stopped = cause(run.run(1.0));
    assert!(stopped.to_string().contains("`push`"), "{stopped}");
    assert!((run.time() - 0.5).abs() < 1e-12, "the last accepted step");
    assert_eq!(run.held_inputs()[0], 1.0, "what was held");
    // Ten numbers where seven are wanted.
    let mut run = Simulation::new(&cart(), Options::rk4(0.01)).expect("options");
    run.control(|_, inputs: &mut Vec<f64>| inputs.push(1.0))
        .expect("any model");
    let stopped = cause(run.run(1.0));
    assert!(matches!(stopped, StepError::NonFinite { .. }), "{stopped}");
    for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = cause(run.control_every(period, |_, _: &mut CartInputs| ()));
        assert!(refused.to_string().contains("sampling period"), "{refused}");
    }
}

#[test]
fn a_snapshot_knows_what_is_held_and_when_the_next_sample_is() {
    let make = || {
        let mut run = Simulation::new(&cart(), Options::tsit5(1e-8)).expect("options");
        run.control_every(0.1, |sample, inputs: &mut CartInputs| {
            inputs.push = -3.0 * sample.x()[0] + sample.time;
        })
        .expect("a controller");
        run
    };
    let mut whole = make();
    whole.run(0.537).expect("it moves");
    let saved = whole.snapshot();
    whole.run(2.0).expect("it moves");
    let mut again = make();
    again
        .restore(&saved)
        .expect("the same model and controllers");
    assert_eq!(again.time(), 0.537);
    again.run(2.0).expect("it moves");
    assert_eq!(whole.state(), again.state());
    let mut bare = Simulation::new(&cart(), Options::tsit5(1e-8)).expect("options");
    assert!(
        cause(bare.restore(&saved))
            .to_string()
            .contains("controllers")
    );
}

/// Recorded rows, located events and single steps see the same samples.
#[test]
fn recording_and_stepping_land_on_the_same_samples() {
    let swing = Swing::new(SwingParams::default()).expect("defaults");
    let make = || {
        let mut run = Simulation::new(&swing, Options::rk4(0.03)).expect("options");
        run.control_every(0.1, |sample, inputs: &mut SwingInputs| {
            inputs.push = (3.0 * sample.time).sin();
        })
        .expect("a controller");
        run
    };
    let (mut recorded, mut stepped, mut plain) = (make(), make(), make());
    let mut rows = Trajectory::new(&swing, Sampling::Every(0.01), Content::ALL);
    recorded.record(1.0, &mut rows).expect("it moves");
    plain.run(1.0).expect("it moves");
    while stepped.time() < 1.0 - 1e-9 {
        stepped.step().expect("a step");
    }
    assert_eq!(recorded.state(), plain.state());
    assert_eq!(stepped.state(), plain.state());
    assert_eq!(
        plain.statistics().steps,
        40,
        "three steps of 30 ms and one of 10 ms a sample"
    );
}

#[test]
fn single_precision_is_driven_alike() {
    let cart: Cart<f32> = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, Options::rk4(0.01)).expect("options");
    run.control_every(
        0.1,
        |sample: &CartSample<f32>, inputs: &mut CartInputs<f32>| {
            inputs.push = -4.0 * (sample.state().cart().velocity[0] - 1.0);
        },
    )
    .expect("a controller");
    run.run(3.0).expect("it settles");
    // v(k+1) = v(k) − 0.2 (v(k) − 1)
    let want = 1.0 - 0.8_f32.powi(30);
    assert!((run.state()[3] - want).abs() < 1e-5, "{}", run.state()[3]);
}

/// A scene that is not compiled is driven by numbers in the order of its inputs.
#[test]
fn a_scene_that_is_not_compiled_is_driven_by_numbers() {
    let generic = Generic::<f64>::with_defaults(Cart::<f64>::scene()).expect("a scene");
    let mut slow = Simulation::new(&generic, Options::rk4(0.01)).expect("options");
    let mut fast = Simulation::new(&cart(), Options::rk4(0.01)).expect("options");
    slow.control_every(0.1, |sample, inputs: &mut Vec<f64>| {
        inputs[0] = -sample.x()[0]
    })
    .expect("a controller");
    fast.control_every(0.1, |sample, inputs: &mut CartInputs| {
        inputs.push = -sample.state().cart().position[0];
    })
    .expect("a controller");
    for run in [&mut slow, &mut fast] {
        run.set_state(0.0, &at(1.0, 0.0)).expect("a state");
        run.run(2.0).expect("it moves");
    }
    for (a, b) in slow.state().iter().zip(fast.state()) {
        assert!((a - b).abs() < 1e-12);
    }
}

/// A controller is shown what the joints measure, as outputs are.
#[test]
fn joint_coordinates_at_a_sample_are_those_of_outputs() {
    let chain: Chain = Chain::new(ChainParams::default()).expect("defaults");
    let generic = Generic::<f64>::with_defaults(Chain::<f64>::scene()).expect("a scene");
    let seen = Arc::new(std::sync::Mutex::new((Vec::new(), Vec::new())));
    let mut run = Simulation::new(&chain, Options::rk4(1e-3)).expect("options");
    let mut plain = Simulation::new(&generic, Options::rk4(1e-3)).expect("options");
    let log = seen.clone();
    run.control_every(0.05, move |sample, inputs: &mut ChainInputs| {
        let joints = sample.coordinates();
        for i in 0..2 {
            inputs.torque[i + 1] = -joints.pin_angle[i] - 0.1 * joints.pin_angle_rate[i];
        }
        log.lock().expect("one thread").0.push([
            joints.pin_angle[0],
            joints.pin_angle[1],
            joints.pin_angle_rate[0],
            joints.pin_angle_rate[1],
            joints.rail_slide,
            joints.rail_slide_rate,
        ]);
    })
    .expect("its inputs");
    let log = seen.clone();
    plain
        .control_every(0.05, move |sample, inputs: &mut [f64; 3]| {
            // In the order of the joints: rail, hook, pin[0], pin[1].
            let joints = sample.coordinates();
            for i in 0..2 {
                inputs[i + 1] = -joints[4 + 2 * i] - 0.1 * joints[5 + 2 * i];
            }
            let log = &mut log.lock().expect("one thread").1;
            log.push([4, 6, 5, 7, 0, 1].map(|place| joints[place]));
        })
        .expect("three numbers");
    for run in [&mut run, &mut plain] {
        run.set_joints(&[
            ("hook.angle", 0.4),
            ("pin[1].angle", -0.7),
            ("rail.slide", 0.2),
        ])
        .expect("an open chain");
        for tenth in 1..=10 {
            let mut outputs = [0.0; 6];
            run.evaluate(mbd_runtime::Quantity::Outputs, &mut outputs)
                .expect("outputs");
            run.run(0.05 * f64::from(tenth)).expect("it swings");
            let seen = seen.lock().expect("one thread");
            let found = seen.0.len().max(seen.1.len());
            let last = if seen.1.is_empty() {
                seen.0[found - 1]
            } else {
                *seen.1.last().expect("a sample")
            };
            for (a, b) in last.iter().zip(outputs) {
                assert!((a - b).abs() < 1e-12, "{last:?} {outputs:?}");
            }
        }
    }
    for (a, b) in run.state().iter().zip(plain.state()) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}
