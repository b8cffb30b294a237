//! Joints that are detached and attached: releases, latches, clutches and separations.

use mbd_runtime::{
    Content, Generic, Model, Options, Quantity, Sampling, Simulation, StepError, Trajectory, model,
};
use tests::agreement::{agrees, agrees_along};

use super::{G, methods};

model! {
    /// A pendulum that is let go after 0.7 s.
    pub model Released<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body bob {
            mass: 2.0 kg,
            inertia: diag(0.1, 0.2, 0.15) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world to bob.top {
            axis: y,
            start: 1 rad,
            damping: 0.1 N*m*s,
            stiffness: 2 N*m/rad,
        }
        event let_go = time rises 0.7 s { detach: pin }
        output held = norm(pin.force);
        output stored = energy.potential;
    }
}

model! {
    /// The same in a plane.
    pub model Flat {
        planar: xz;
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body bob {
            mass: 2.0 kg,
            inertia: diag(0.1, 0.2, 0.15) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world to bob.top { axis: y, start: 1 rad }
        event let_go = time rises 0.7 s { detach: pin }
    }
}

model! {
    /// Three links, of which the last two come off together.
    pub model Chain {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body link[i in 0..3] {
            mass: 1.0 kg,
            inertia: diag(0.09, 0.1, 0.02) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame tip at [0.0, 0.0, -0.5] m,
        }
        joint first: hinge from world to link[0].top { axis: y, start: 0.8 rad }
        joint second: spherical from link[0].tip to link[1].top;
        joint third: hinge from link[1].tip to link[2].top { axis: x, start: 0.4 rad }
        event off = time rises 0.5 s { detach: second }
    }
}

model! {
    /// A pendulum that falls into a latch at its lowest point.
    pub model Latched {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame seat at [0.0, 0.0, -0.5] m }
        body bob {
            mass: 2.0 kg,
            inertia: diag(0.1, 0.2, 0.15) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world to bob.top { axis: y, start: 1 rad }
        joint latch: rigid from world.seat to bob.com { at_start: detached }
        event caught = pin.angle falls 0 rad { attach: latch, acts: once }
    }
}

model! {
    /// A flywheel that is clutched to another one at rest after a radian.
    pub model Clutched {
        gravity: none;
        body driver { mass: 2.0 kg, inertia: diag(0.2, 0.2, 0.3) kg*m^2 }
        body driven {
            mass: 1.0 kg,
            inertia: diag(0.1, 0.1, 0.2) kg*m^2,
            frame plate at [0.0, 0.0, 0.0] m rotated rpy(0.0, 0.0, 1.0),
        }
        joint front: hinge from world to driver.com { axis: z, start_rate: 3 rad/s }
        joint back: hinge from world to driven.com { axis: z }
        joint clutch: hinge from driver.com to driven.plate { axis: y, at_start: detached }
        event engaged = front.angle - back.angle rises 1 rad { attach: clutch, acts: once }
    }
}

model! {
    /// Two stages that a compressed spring pushes apart once the clamp opens.
    pub model Staged {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body lower {
            mass: 30 kg,
            inertia: diag(5, 5, 1) kg*m^2,
            frame head at [0.0, 0.0, 1.0] m,
            start at [0.0, 0.0, 100.0] m velocity [2.0, 0.0, 50.0] m/s
                angular_velocity [0.2, 0.1, 1.0] rad/s,
        }
        body upper {
            mass: 10 kg,
            inertia: diag(2, 2, 0.5) kg*m^2,
            frame foot at [0.0, 0.0, -1.0] m,
            start at [0.0, 0.0, 102.0] m velocity [2.0, 0.0, 50.0] m/s
                angular_velocity [0.2, 0.1, 1.0] rad/s,
        }
        joint lower_free: free from world to lower.com;
        joint clamp: rigid from lower.head to upper.foot;
        spring push from lower.com to upper.com { free_length: 2.3 m, stiffness: 4 kN/m }
        event separated = time rises 1 s { detach: clamp }
        event apart = norm(upper.position - lower.position) rises 2.3 m { detach: push }
    }
}

/// Bodies fly on: centre of mass and velocity from the state at one time to another.
fn flown(state: &[f64], t: f64) -> [f64; 6] {
    let [x, v] = [&state[..3], &state[7..10]];
    [
        x[0] + v[0] * t,
        x[1] + v[1] * t,
        x[2] + v[2] * t - 0.5 * G * t * t,
        v[0],
        v[1],
        v[2] - G * t,
    ]
}

#[test]
fn a_pendulum_that_is_let_go_keeps_its_momentum_and_flies_freely() {
    let model = Released::<f64>::new(ReleasedParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let options = Options {
            stop_at_events: true,
            ..options
        };
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let mut history = Trajectory::new(&model, Sampling::Steps, Content::ALL);
        run.record(1.5, &mut history).expect("a swing");
        assert!((run.time() - 0.7).abs() < 1e-13, "{word}");
        // Both sides of the instant have the same state.
        let rows = history.len();
        for name in ["bob.x", "bob.vx", "bob.vz", "bob.omega_body_y"] {
            let column = history.column(name).expect("a column");
            assert_eq!(column[rows - 1], column[rows - 2], "{word}: {name}");
        }
        let held = history.column("held").expect("a column");
        assert!(
            held[rows - 2] > 10.0 && held[rows - 1] == 0.0,
            "{word}: {held:?}"
        );
        let state = run.state().to_vec();
        run.run(1.7).expect("a flight");
        let want = flown(&state, run.time() - 0.7);
        let end = run.state();
        for k in 0..3 {
            assert!((end[k] - want[k]).abs() < 1e-11, "{word}: {end:?} {want:?}");
            assert!(
                (end[7 + k] - want[3 + k]).abs() < 1e-11,
                "{word}: {end:?} {want:?}"
            );
            assert!(
                (end[10 + k] - state[10 + k]).abs() < 1e-11,
                "{word}: it turns on evenly"
            );
        }
        // The spring of the pin went with it.
        let angle = 2.0 * state[5].atan2(state[3]);
        let work = run.actions()[0].work().expect("an energy");
        assert!(
            (work + angle * angle).abs() < 1e-10,
            "{word}: {work} {angle}"
        );
    }
}

#[test]
fn a_planar_pendulum_that_is_let_go_flies_freely() {
    let model = Flat::new(FlatParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let options = Options {
            stop_at_events: true,
            ..options
        };
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(1.5).expect("a swing");
        let x = run.state().to_vec();
        run.run(1.7).expect("a flight");
        let (t, end) = (run.time() - 0.7, run.state());
        let want = [
            x[0] + x[3] * t,
            x[1] + x[4] * t - 0.5 * G * t * t,
            x[2] + x[5] * t,
            x[3],
            x[4] - G * t,
            x[5],
        ];
        assert!(
            tests::largest_difference(end, &want) < 1e-11,
            "{word}: {end:?} {want:?}"
        );
    }
}

/// Linear and angular momentum.
fn momentum(run: &mut Simulation<f64>) -> Vec<f64> {
    let mut out = vec![0.0; 6];
    run.evaluate(Quantity::Momentum, &mut out)
        .expect("momentum");
    out
}

#[test]
fn links_that_come_off_fall_freely_and_the_rest_swings_on() {
    let model = Chain::new(ChainParams::default()).expect("defaults");
    // The same two links alone, from the state at the instant.
    let mut scene = model.scene().clone();
    scene.events.clear();
    scene.joints.remove(1);
    let apart = Generic::with_defaults(scene).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let options = Options {
            stop_at_events: true,
            ..options
        };
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(1.0).expect("a swing");
        let mut other = Simulation::new(&apart, options).expect("options that fit");
        other.set_state(run.time(), run.state()).expect("a state");
        run.run(1.0).expect("two falls and a swing");
        other.run(1.0).expect("two falls and a swing");
        let difference = tests::largest_difference(run.state(), other.state());
        assert!(difference < 1e-9, "{word}: {difference:e}");
        assert_eq!(
            run.actions()[0].work().map(|work| work.abs() < 1e-11),
            Some(true),
            "{word}"
        );
    }
}

#[test]
fn a_latch_takes_all_energy_of_motion_and_holds() {
    let model = Latched::new(LatchedParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(2.0).expect("a swing and rest");
        // m g l (1 − cos 1), l = 0.5 m.
        let fallen = 2.0 * G * 0.5 * (1.0 - 1.0_f64.cos());
        let [acted] = run.actions() else {
            panic!("one action")
        };
        assert!(
            (acted.work().expect("an energy") + fallen).abs() < 1e-8,
            "{word}: {acted:?} {fallen}"
        );
        let state = LatchedState::from_slice(run.state())
            .expect("a state")
            .bob();
        assert!((state.position[2] + 0.5).abs() < 1e-12, "{word}: {state:?}");
        assert!(
            state
                .velocity
                .iter()
                .chain(&state.angular_velocity)
                .all(|x| x.abs() < 1e-12),
            "{word}: {state:?}"
        );
    }
}

#[test]
fn a_clutch_shares_the_angular_momentum_and_loses_what_a_plastic_impact_does() {
    let model = Clutched::new(ClutchedParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let before = momentum(&mut run);
        run.run(1.0).expect("two flywheels");
        assert!((run.events()[0].time - 1.0 / 3.0).abs() < 1e-13, "{word}");
        let lost = 0.5 * 0.3 * 0.2 / 0.5 * 9.0;
        let work = run.actions()[0].work().expect("an energy");
        assert!((work + lost).abs() < 1e-12, "{word}: {work} {lost}");
        let state = ClutchedState::from_slice(run.state()).expect("a state");
        for rate in [
            state.driver().angular_velocity[2],
            state.driven().angular_velocity[2],
        ] {
            assert!((rate - 3.0 * 0.3 / 0.5).abs() < 1e-12, "{word}: {rate}");
        }
        let after = momentum(&mut run);
        assert!(tests::largest_difference(&before, &after) < 1e-12, "{word}");
    }
}

#[test]
fn two_stages_that_separate_keep_their_momentum() {
    let model = Staged::new(StagedParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let [first, ..] = [momentum(&mut run)];
        run.run(2.0).expect("a separation");
        let last = momentum(&mut run);
        // Gravity alone changes it: 40 kg over 2 s; angular momentum about the common centre of mass.
        let scale = 40.0 * 50.0;
        for k in 0..3 {
            let pulled = if k == 2 { -40.0 * G * 2.0 } else { 0.0 };
            assert!(
                (last[k] - first[k] - pulled).abs() < 1e-12 * scale,
                "{word}: {k}"
            );
        }
        let apart: Vec<f64> = run.state()[..3]
            .iter()
            .zip(&run.state()[7..10])
            .map(|(a, b)| a - b)
            .collect();
        let distance = apart.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(distance > 2.5, "{word}: {distance}");
        // Cut at its free length the spring has nothing left to take along.
        let works: Vec<f64> = run.actions().iter().filter_map(|it| it.work()).collect();
        assert!(
            works.iter().all(|work| work.abs() < 1e-9),
            "{word}: {works:?}"
        );
        assert!(
            run.imbalance().is_none_or(|it| it.relative() < 1e-7),
            "{word}: {:?}",
            run.imbalance()
        );
    }
}

#[test]
fn generated_interpreted_and_generic_models_let_go_alike() {
    let model = Released::<f64>::new(ReleasedParams::default()).expect("defaults");
    agrees(&model);
    let start = Simulation::new(&model, Options::rk4(1e-3))
        .expect("options")
        .state()
        .to_vec();
    agrees_along(&model, &start, (200, 0.005), 1e-11);
    let model = Chain::new(ChainParams::default()).expect("defaults");
    agrees(&model);
    let start = Simulation::new(&model, Options::rk4(1e-3))
        .expect("options")
        .state()
        .to_vec();
    agrees_along(&model, &start, (150, 0.005), 1e-9);
    agrees(&Flat::new(FlatParams::default()).expect("defaults"));
    agrees(&Staged::new(StagedParams::default()).expect("defaults"));
}

#[test]
fn single_precision_lets_go_too() {
    let model = Released::<f32>::new(ReleasedParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(2e-3)).expect("options that fit");
    run.run(1.0).expect("a swing and a flight");
    let wide = Released::<f64>::new(ReleasedParams::default()).expect("defaults");
    let mut other = Simulation::new(&wide, Options::rk4(2e-3)).expect("options that fit");
    other.run(1.0).expect("a swing and a flight");
    let pairs = run.state().iter().zip(other.state());
    assert!(
        pairs
            .map(|(a, b)| (f64::from(*a) - b).abs())
            .fold(0.0, f64::max)
            < 1e-3
    );
}

#[test]
fn a_snapshot_of_a_flight_goes_on_to_the_same_bits_and_another_run_begins_on_the_pin() {
    let model = Released::<f64>::new(ReleasedParams::default()).expect("defaults");
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let start = run.state().to_vec();
        run.run(1.0).expect("a swing and a flight");
        let mut other = Simulation::new(&model, options).expect("options that fit");
        other.restore(&run.snapshot()).expect("of the same model");
        for run in [&mut run, &mut other] {
            run.run(1.5).expect("a flight");
        }
        assert_eq!(run.state(), other.state());
        run.set_state(0.0, &start).expect("a state");
        run.run(0.5).expect("a swing");
        let mut fresh = Simulation::new(&model, options).expect("options that fit");
        fresh.set_state(0.0, &start).expect("a state");
        fresh.run(0.5).expect("a swing");
        assert_eq!(run.state(), fresh.state());
    }
}

model! {
    /// A body that is let go and asked back when it is elsewhere.
    model Missed {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body bob {
            mass: 2.0 kg,
            inertia: diag(0.1, 0.2, 0.15) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world to bob.top { axis: y }
        event off = time rises 1 s { detach: pin }
        event back = time rises 1.5 s { attach: pin }
    }
}

#[test]
fn a_joint_whose_ends_are_apart_is_not_attached() {
    let model = Missed::new(MissedParams::default()).expect("defaults");
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let error = run.run(2.0).expect_err("the body fell 1.2 m");
        let StepError::Action { event, why, .. } = &error.cause else {
            panic!("{error}")
        };
        assert_eq!(event, "back");
        assert!(why.contains("`pin`") && why.contains("apart"), "{why}");
        assert!((run.time() - 1.5).abs() < 1e-13);
        assert_eq!(run.actions().len(), 1);
    }
}
