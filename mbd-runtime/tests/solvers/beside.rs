//! Batches in lanes: a case gives the same bits whatever is beside it, however many lanes and threads there are.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::same_bits::{assert_same_bits, bits, fly};
use mbd_runtime::{Batch, Case, Content, InLanes, Model, Options, Sampling, Simulation, model};

model! {
    /// A stone in wind and thin air, drawn to a place; it is noticed where it passes two heights.
    pub model Stone<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
        param drag = 0.02 kg/m in 0.0 kg/m ..= 1.0 kg/m;
        input push: force;
        point stone { mass: mass, start at [0.3, 0.1, 30.0] m }
        load air on stone =
            -drag * norm(stone.velocity) * stone.velocity * exp(-stone.position.z / 8000 m);
        load pull on stone =
            -3.0 N * [tanh(stone.position.x / 1 m), sin(stone.position.y / 1 m), 0.0]
            + [push, 0.0, 0.0];
        event low = stone.position.z falls 20.0 m;
        event lower = stone.position.z falls 12.0 m { set: drag = 0.5 kg/m }
        output height = stone.position.z;
        metric fastest = max norm(stone.velocity);
        metric aside = value stone.position.x { at: lower };
        metric above = time_above stone.position.z { level: 15 m };
    }
}

model! {
    /// A stone that is pushed from some instants on.
    pub model Pushed<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
        point stone { mass: mass }
        load push on stone = if(time > 0.6 s, 1 N, 0 N) * [1.0, 0.3, 0.0]
            + if(time > 1.1 s, 2 N, 0 N) * [0.0, 0.0, 1.0];
        load air on stone = -0.02 kg/m * norm(stone.velocity) * stone.velocity;
    }
}

model! {
    /// A chain of four links on hinges about crossed axes.
    pub model Chain<T> {
        units: si;
        gravity: [0.0, 0.0, -9.81];
        coordinates: relative;
        param length = 1.0 in 0.5 ..= 2.0;
        body link[i in 0..4] {
            mass: 1.0,
            inertia: diag(0.083, 0.083, 0.001),
            frame top at [0.0, 0.0, 0.5 * length],
            frame end at [0.0, 0.0, -0.5 * length],
        }
        joint first: hinge from world to link[0].top { axis: y, damping: 0.1 }
        joint bend[i in 0..3]: hinge from link[i].end to link[i + 1].top { axis: x, damping: 0.05 }
    }
}

model! {
    /// A body that tumbles.
    pub model Tumbler<T> {
        gravity: none;
        param mass = 2.0 kg in 1.0 kg ..= 5.0 kg;
        body top { mass: mass, inertia: diag(0.1, 0.2, 0.25) kg*m^2 }
        joint afloat: free from world to top.com;
    }
}

model! {
    /// A lamp on a cord from a knot without mass, in air; lines go slack and taut.
    pub model Lamp<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 2.0 kg in 0.5 kg ..= 5.0 kg;
        param stiffness = 5 kN/m in 1 kN/m ..= 20 kN/m;
        input wind: speed;
        world {
            frame left at [-1.0, -0.6, 2.0] m,
            frame right at [1.1, -0.5, 2.1] m,
            frame back at [0.1, 1.2, 2.0] m,
        }
        point lamp { mass: mass, start at [0.1, 0.1, 0.8] m }
        point knot;
        line a from world.left to knot {
            free_length: 1.3 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line b from world.right to knot {
            free_length: 1.35 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line c from world.back to knot {
            free_length: 1.3 m,
            stiffness: stiffness,
            damping: 20 N*s/m,
        }
        line cord from knot to lamp { free_length: 0.5 m, stiffness: stiffness, damping: 20 N*s/m }
        load air on lamp =
            0.05 kg/m * ([wind, 0.0, 0.0] - lamp.velocity) * norm([wind, 0.0, 0.0] - lamp.velocity);
        output pull = cord.tension;
        metric peak = max a.tension;
        metric carried = mean cord.tension { from: 0.2 s };
    }
}

model! {
    /// A mass on a line to the world, without equilibrium points: it bounces up, and the line goes slack.
    pub model Bob<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
        world { frame hook at [0.0, 0.0, 1.0] m }
        point bob { mass: mass, start at [0.3, 0.0, 0.9] m }
        line cord from world.hook to bob { free_length: 0.5 m, stiffness: 2 kN/m, damping: 3 N*s/m }
        output pull = cord.tension;
    }
}

const METHODS: [fn() -> Options; 4] = [
    || Options::rk4(0.01),
    || Options::tsit5(1e-7),
    || Options::vern7(1e-8),
    || Options::auto(1e-7),
];

fn methods() -> Vec<Options> {
    METHODS.iter().map(|options| options()).collect()
}

#[test]
fn stones_that_pass_events_and_end_at_other_times_are_what_they_are_alone() {
    let stone = Stone::new(StoneParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..21_u32).map(|k| {
            let k = f64::from(k);
            let start = vec![0.3, -0.1 * k, 30.0 + k, 4.0, 1.0 + k, 5.0 - k];
            Case::new()
                .params([0.4 + 0.3 * k, 0.01 * k])
                .inputs(&StoneInputs { push: 0.1 * k })
                // Others begin later, and so have less to fly.
                .state(0.05 * (k % 7.0), start)
        })
    };
    assert_same_bits(&stone, &methods(), 0.9, cases);
}

#[test]
fn stones_under_a_push_that_jumps_in_time_are_what_they_are_alone() {
    let pushed = Pushed::new(PushedParams::default())
        .expect("params")
        .in_lanes();
    let cases = || (0..11_u32).map(|k| Case::new().params([0.4 + 0.3 * f64::from(k)]));
    // The step that ends on the jump sees nothing of what is behind it, and counts once.
    let options = [Options::tsit5(1e-7), Options::vern7(1e-8)];
    assert_same_bits(&pushed, &options, 0.5, cases);
}

#[test]
fn chains_in_relative_coordinates_are_what_they_are_alone() {
    let chain = Chain::new(ChainParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..11_u32).map(|k| {
            let start: Vec<f64> = (0..8).map(|at| 0.1 * f64::from(k + at) - 0.3).collect();
            Case::new()
                .params([0.6 + 0.1 * f64::from(k)])
                .state(0.0, start)
        })
    };
    assert_same_bits(
        &chain,
        &[Options::rk4(5e-3), Options::tsit5(1e-6)],
        0.9,
        cases,
    );
}

/// Each spins faster than the one before, next to its second axis.
fn tumblers() -> impl Iterator<Item = Case> + Send {
    (0..10_u32).map(|k| {
        let mut start = vec![0.0; 13];
        (start[3], start[11], start[12]) = (1.0, 2.0 + f64::from(k), 0.01);
        Case::new().state(0.0, start)
    })
}

#[test]
fn attitudes_are_what_they_are_alone() {
    let tumbler = Tumbler::new(TumblerParams::default())
        .expect("params")
        .in_lanes();
    assert_same_bits(&tumbler, &methods(), 0.9, tumblers);
}

#[test]
fn lines_at_an_equilibrium_point_that_go_slack_are_what_they_are_alone() {
    let lamp = Lamp::new(LampParams::default()).expect("params").in_lanes();
    let cases = || {
        (0..13_u32).map(|k| {
            let k = f64::from(k);
            let mut start = LampState::at_origin();
            start.set_lamp(mbd_runtime::PointState {
                position: [0.1 + 0.01 * k, 0.1, 0.85],
                velocity: [0.0, 0.1 * k, 0.1 * k],
            });
            Case::new()
                .params([0.6 + 0.17 * k, 2000.0 + 300.0 * k])
                .inputs(&LampInputs { wind: 0.3 * k })
                .state(0.0, start.to_vec())
        })
    };
    // With two lines that carry the knot follows rules of its own, which are not in lanes.
    assert_same_bits(
        &lamp,
        &[Options::rk4(2e-3), Options::tsit5(1e-6)],
        0.2,
        cases,
    );
}

#[test]
fn lines_between_masses_that_go_slack_are_what_they_are_alone() {
    let bob = Bob::new(BobParams::default()).expect("params").in_lanes();
    let cases = || (1..12_u32).map(|k| Case::new().params([0.3 * f64::from(k)]));
    assert_same_bits(
        &bob,
        &[Options::rk4(2e-3), Options::tsit5(1e-6)],
        0.9,
        cases,
    );
}

/// One tight and one loose.
fn stiff() -> [Options; 2] {
    [Options::rodas5p(1e-4), Options::rodas5p(1e-7)]
}

model! {
    /// A capsule that swings below a canopy; their lines meet in a point of little mass, and go slack where it is thrown up.
    pub model Swinging<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param m_point = 0.1 kg in 0.01 kg ..= 10.0 kg;
        param stiffness = 20 kN/m in 1 kN/m ..= 100 kN/m;
        param damping = 20 N*s/m in 0 N*s/m ..= 1000 N*s/m;
        input wind: speed;
        body canopy {
            mass: 8.0 kg,
            inertia: diag(4.0, 4.0, 6.0) kg*m^2,
            frame left at [-1.0, 0.3, -0.2] m,
            frame right at [1.0, 0.3, -0.2] m,
            frame back at [0.0, -1.0, -0.2] m,
        }
        body capsule {
            mass: 40.0 kg,
            inertia: diag(3.0, 2.0, 2.5) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint canopy_free: free from world to canopy.com;
        joint capsule_free: free from world to capsule.com;
        point confluence { mass: m_point }
        line left from canopy.left to confluence {
            free_length: 2.0 m,
            stiffness: stiffness,
            damping: damping,
        }
        line right from canopy.right to confluence {
            free_length: 2.0 m,
            stiffness: stiffness,
            damping: damping,
        }
        line back from canopy.back to confluence {
            free_length: 2.0 m,
            stiffness: stiffness,
            damping: damping,
        }
        line riser from confluence to capsule.top {
            free_length: 1.0 m,
            stiffness: stiffness,
            damping: damping,
        }
        load drag on canopy = -30 kg/m * norm(canopy.velocity - [wind, 0.0, 0.0])
            * (canopy.velocity - [wind, 0.0, 0.0]);
        event fast = capsule.position.z falls -6.0 m { set: stiffness = 25 kN/m }
        output pull = riser.tension;
        metric peak = max riser.tension;
        metric loud = time_above riser.tension { level: 400 N };
    }
}

#[test]
fn stiff_steps_of_a_light_point_between_lines_are_what_they_are_alone() {
    let swinging = Swinging::new(SwingingParams::default())
        .expect("params")
        .in_lanes();
    let cases = |dampings: [f64; 9]| {
        (0..9_u32).zip(dampings).map(|(k, damping)| {
            let k = f64::from(k);
            let mut start = SwingingState::at_origin();
            let upright = |position: [f64; 3], velocity: [f64; 3]| mbd_runtime::BodyState {
                position,
                orientation: [1.0, 0.0, 0.0, 0.0],
                velocity,
                angular_velocity: [0.02 * k, -0.1, 0.03 * k],
            };
            start.set_canopy(upright([0.0, 0.0, 0.0], [0.1 * k, 0.0, -2.0]));
            start.set_capsule(upright([0.0, 0.0, -3.52], [0.0, 0.05 * k, 0.3 - 0.2 * k]));
            start.set_confluence(mbd_runtime::PointState {
                position: [0.0, 0.0, -1.95],
                velocity: [0.0, 0.0, -0.2 * k],
            });
            Case::new()
                .params([0.05 + 0.05 * k, 15e3 + 1e3 * k, damping])
                .inputs(&SwingingInputs { wind: 0.5 * k })
                .state(0.03 * (k % 5.0), start.to_vec())
        })
    };
    let soft = std::array::from_fn(|k| 40.0 + 10.0 * k as f64);
    assert_same_bits(&swinging, &[Options::rodas5p(1e-4)], 0.5, || cases(soft));
    // Of Auto every other one is stiff soon, and makes its steps alone from then on.
    let mixed = std::array::from_fn(|k| if k % 2 == 0 { 20.0 } else { 1000.0 });
    let auto = Options::auto(1e-3);
    assert_same_bits(&swinging, &[auto], 0.1, || cases(mixed));
    let sampling = Sampling::Every(0.5);
    for (k, case) in fly(&swinging, auto, sampling, cases(mixed), (1, 4))
        .iter()
        .enumerate()
    {
        let part = case.beside as f64 / case.statistics.steps as f64;
        println!("{k}: {part}");
        // The last of nine may have nobody beside it.
        assert!(k == 8 || (part > 0.8) == (k % 2 == 0), "{k}: {part}");
    }
}

#[test]
fn stiff_steps_that_are_rejected_pass_events_and_switches_are_what_they_are_alone() {
    let stone = Stone::new(StoneParams::default())
        .expect("params")
        .in_lanes();
    let stones = || {
        (0..21_u32).map(|k| {
            let k = f64::from(k);
            let start = vec![0.3, -0.1 * k, 30.0 + k, 4.0, 1.0 + k, 5.0 - k];
            Case::new()
                .params([0.4 + 0.3 * k, 0.01 * k])
                .inputs(&StoneInputs { push: 0.1 * k })
                .state(0.05 * (k % 7.0), start)
        })
    };
    assert_same_bits(&stone, &stiff(), 0.5, stones);
    let bob = Bob::new(BobParams::default()).expect("params").in_lanes();
    let bobs = || (1..12_u32).map(|k| Case::new().params([0.3 * f64::from(k)]));
    assert_same_bits(&bob, &stiff(), 0.3, bobs);
    let tumbler = Tumbler::new(TumblerParams::default())
        .expect("params")
        .in_lanes();
    assert_same_bits(&tumbler, &stiff(), 0.9, tumblers);
}

#[test]
fn stiff_steps_whose_derivatives_are_more_than_a_partial_one_are_made_alone() {
    // ∂f/∂t; accelerations that are solved for; a knot without mass.
    let pushed = Pushed::new(PushedParams::default())
        .expect("params")
        .in_lanes();
    let chain = Chain::new(ChainParams::default())
        .expect("params")
        .in_lanes();
    let lamp = Lamp::new(LampParams::default()).expect("params").in_lanes();
    for model in [&pushed, &chain, &lamp] {
        let fly = |lanes| {
            let cases = (0..3).map(|_| Case::new());
            let sampling = Sampling::Every(0.1);
            fly(model, Options::rodas5p(1e-5), sampling, cases, (1, lanes))
        };
        let (alone, beside) = (fly(1), fly(4));
        assert_eq!(bits(&alone), bits(&beside));
        assert!(beside.iter().all(|it| it.result.is_ok() && it.beside == 0));
    }
}

#[test]
fn a_stiff_case_that_fails_disturbs_none_beside_it() {
    let bob = Bob::new(BobParams::default()).expect("params").in_lanes();
    let fly = |lanes: usize| {
        let cases = (0..9_u32).map(|k| match k {
            // At the place that its line goes to, where that has no direction; speeds whose squares overflow.
            3 => Case::new().state(0.0, vec![0.0, 0.0, 0.9, 0.0, 0.0, 1e200]),
            5 => Case::new().state(0.0, vec![1e160, 0.0, 0.0, 0.0, 0.0, 0.0]),
            k => Case::new().params([0.3 + 0.2 * f64::from(k)]),
        });
        let sampling = Sampling::Steps;
        fly(&bob, Options::rodas5p(1e-5), sampling, cases, (1, lanes))
    };
    let (alone, beside) = (fly(1), fly(4));
    assert_eq!(bits(&alone), bits(&beside));
    let failed = beside.iter().filter(|it| it.result.is_err());
    let failed: Vec<usize> = failed.map(|it| it.case).collect();
    println!("{failed:?}");
    assert!(!failed.is_empty());
    assert!(beside.iter().any(|it| it.beside > 0));
}

#[test]
fn a_case_that_fails_explodes_or_panics_disturbs_none_beside_it() {
    let stone = Stone::new(StoneParams::default())
        .expect("params")
        .in_lanes();
    let samples = AtomicUsize::new(0);
    let fly = |lanes: usize| {
        let cases = (0..12_u32).map(|k| match k {
            // Out of range; a push that overflows; faster than any step can follow.
            2 => Case::new().params([20.0, 0.0]),
            5 => Case::new().inputs(&StoneInputs { push: 1e308 }),
            7 => Case::new().state(0.0, vec![0.0, 0.0, 30.0, 0.0, 0.0, 1e9]),
            k => Case::new().params([0.5 + 0.2 * f64::from(k), 0.02]),
        });
        Batch::new(&stone, Options::rk4(0.01), 1.5)
            .cases(cases)
            .threads(1)
            .lanes(lanes)
            .prepare(|case, run: &mut Simulation<f64>| {
                if case.number() == 9 {
                    samples.fetch_add(1, Ordering::Relaxed);
                    return run.control_every(0.5, |sample, _: &mut StoneInputs| {
                        assert!(sample.time < 0.9, "the ninth breaks");
                    });
                }
                Ok(())
            })
            .run(|_, history| history.column("height").unwrap_or_default().to_vec())
    };
    let (alone, beside) = (fly(1), fly(8));
    assert_eq!(bits(&beside), bits(&alone));
    let failed: Vec<(usize, &str)> = beside
        .iter()
        .filter_map(|it| Some((it.case, it.result.as_ref().err()?.why.status())))
        .collect();
    println!("{failed:?}");
    let numbers: Vec<usize> = failed.iter().map(|(case, _)| *case).collect();
    assert_eq!(numbers, [2, 5, 7, 9]);
    assert_eq!(failed[0].1, "params");
    assert_eq!(failed[3].1, "panic");
}

#[test]
fn other_scalars_and_models_without_lanes_are_run_one_by_one_with_the_same_numbers() {
    let stone = Stone::<f64>::new(StoneParams::default()).expect("params");
    let fly = |model: &dyn Model<f64>| {
        let masses = [0.5, 1.0, 2.0];
        Batch::new(model, Options::rk4(0.01), 1.0)
            .cases(masses.map(|mass| Case::new().params([mass, 0.02])))
            .lanes(8)
            .run(|_, history| history.column("height").unwrap_or_default().to_vec())
    };
    let alone = fly(&stone);
    assert!(alone.iter().all(|it| it.beside == 0));
    assert_eq!(bits(&alone), bits(&fly(&stone.clone().in_lanes())));
    let single = Stone::<f32>::new(StoneParams::default()).expect("params");
    let single = Batch::new(&single, Options::rk4(0.01), 1.0)
        .cases([Case::new(), Case::new()])
        .lanes(8)
        .run(|_, history| history.len());
    assert!(
        single
            .iter()
            .all(|it| it.result == Ok(101) && it.beside == 0)
    );
}

model! {
    /// Four damped lines meet in a point without mass, their damping differenced from step to step; below hangs a mass from another such point.
    pub model Bundle<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 20.0 kg in 5.0 kg ..= 50.0 kg;
        param damping = 100 N*s/m in 0 N*s/m ..= 1000 N*s/m;
        world { frame hook[i in 0..3] at polar(1.0 m, i * 120 deg, 3.0 m) }
        point bob { mass: mass, start at [0.0, 0.0, 0.86] m }
        point knot { equilibrium: stepwise { formula: bdf2, clamp: positive } }
        point other { mass: 2.0 kg, start at [0.0, 0.0, -0.57] m }
        point middle { equilibrium: static }
        line stay[i in 0..3] from world.hook[i] to knot {
            free_length: 1.5 m,
            stiffness: 20 kN/m,
            damping: damping,
        }
        line cord from knot to bob { free_length: 1.0 m, stiffness: 10 kN/m, damping: damping }
        line upper from bob to middle { free_length: 0.7 m, stiffness: 3 kN/m }
        line lower from middle to other { free_length: 0.7 m, stiffness: 4 kN/m }
        load weight on middle = [0.0, 0.0, -0.5] N;
        output pull = cord.tension;
        output below = lower.tension;
        metric most = max cord.tension;
        metric least = min lower.tension { from: 0.1 s, to: 1.3 s };
        metric squared = rms cord.tension;
        metric loud = time_above lower.tension { level: 25 N };
        metric highest = max bob.position.z;
    }
}

#[test]
fn points_in_balance_solved_beside_each_other_are_where_they_are_alone() {
    let bundle = Bundle::new(BundleParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..13_u32).map(|k| {
            let k = f64::from(k);
            let start = |place: [f64; 3], up: f64| mbd_runtime::PointState {
                position: place,
                velocity: [0.0, 0.05 * k, up],
            };
            let mut state = BundleState::at_origin();
            state.set_bob(start([0.05, 0.0, 0.86], 0.05 * k));
            state.set_other(start([0.05, 0.0, -0.57], 0.05 * k));
            Case::new()
                .params([10.0 + 2.0 * k, 10.0 * k])
                .state(0.0, state.to_vec())
                .nodes([0.0, 0.0, 1.87, 0.05, 0.0, 0.15])
        })
    };
    // A point whose lines pull little next to their stiffness is found by a factorisation, which is not in lanes.
    assert_same_bits(&bundle, &[Options::rk4(2e-3)], 0.4, cases);
}

#[test]
fn the_largest_of_a_scene_with_stepwise_points_is_its_value_at_the_end_of_a_step() {
    let bundle = Bundle::new(BundleParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..9_u32).map(|k| {
            let start = |place: [f64; 3], up: f64| mbd_runtime::PointState {
                position: place,
                velocity: [0.0, 0.02 * f64::from(k), up],
            };
            let mut state = BundleState::at_origin();
            state.set_bob(start([0.05, 0.0, 0.86], 0.1));
            state.set_other(start([0.05, 0.0, -0.57], 0.1));
            Case::new()
                .state(0.0, state.to_vec())
                .nodes([0.0, 0.0, 1.87, 0.05, 0.0, 0.15])
        })
    };
    for lanes in [1, 4, 8] {
        let finished = Batch::new(&bundle, Options::rk4(2e-3), 1.0)
            .cases(cases())
            .lanes(lanes)
            .record(Sampling::Steps, Content::RESULTS)
            .run(|_, history| {
                let metrics = history.metrics(bundle.scene());
                let pull = history.column("pull").unwrap_or_default();
                let largest = pull.iter().fold(f64::NAN, |most, x| x.max(most));
                (metrics[0].value.ok(), largest)
            });
        for case in finished {
            let (metric, largest) = case.result.expect("a run");
            assert_eq!(metric, Some(largest), "{lanes}");
        }
    }
}

model! {
    /// A mass below a point without mass on three damped lines; between the rows of its history nobody reads where it is.
    pub model Sling<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 20.0 kg in 5.0 kg ..= 50.0 kg;
        param damping = 100 N*s/m in 0 N*s/m ..= 1000 N*s/m;
        world { frame hook[i in 0..3] at polar(1.0 m, i * 120 deg, 3.0 m) }
        point bob { mass: mass, start at [0.05, 0.0, 0.86] m }
        point knot { equilibrium: stepwise { formula: bdf2, clamp: positive } }
        line stay[i in 0..3] from world.hook[i] to knot {
            free_length: 1.5 m,
            stiffness: 20 kN/m,
            damping: damping,
        }
        line cord from knot to bob { free_length: 1.0 m, stiffness: 10 kN/m, damping: damping }
        output pull = cord.tension;
        metric most = max cord.tension;
        metric least = min stay[1].tension { from: 0.1 s, to: 1.3 s };
        metric loud = time_above cord.tension { level: 200 N };
        metric lowest = final bob.position.z;
    }
}

#[test]
fn steps_whose_ends_nobody_reads_leave_the_state_that_they_leave_alone() {
    let sling = Sling::new(SlingParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..13_u32).map(|k| {
            let k = f64::from(k);
            let mut state = SlingState::at_origin();
            state.set_bob(mbd_runtime::PointState {
                position: [0.05, 0.0, 0.86],
                velocity: [0.0, 0.03 * k, 0.01 * k],
            });
            Case::new()
                .params([10.0 + 2.0 * k, 20.0 * k])
                .state(0.0, state.to_vec())
        })
    };
    // Neither rows nor the end of the run fall on steps.
    assert_same_bits(&sling, &[Options::rk4(2.3e-3)], 0.9, cases);
}

model! {
    /// The same beside a point that nothing holds.
    pub model Strayed<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame hook[i in 0..3] at polar(1.0 m, i * 120 deg, 3.0 m) }
        point bob { mass: 20 kg, start at [0.05, 0.0, 0.86] m }
        point stray { mass: 1 kg, start at [5.0, 0.0, 0.0] m }
        point knot { equilibrium: stepwise { formula: bdf2, clamp: positive } }
        line stay[i in 0..3] from world.hook[i] to knot {
            free_length: 1.5 m,
            stiffness: 20 kN/m,
            damping: 100 N*s/m,
        }
        line cord from knot to bob { free_length: 1.0 m, stiffness: 10 kN/m, damping: 100 N*s/m }
        metric pull = max cord.tension;
    }
}

/// A point 1e8 m away at 3 µm/s: no step of 2.3 ms moves it, whose numbers are 15 nm apart there. That is found by looks at every tenth step, which nobody
/// else reads.
#[test]
fn a_case_that_a_look_back_refuses_ends_where_it_does_alone() {
    let strayed = Strayed::new(StrayedParams::default())
        .expect("params")
        .in_lanes();
    let cases = || {
        (0..8_u32).map(|k| {
            let mut state = StrayedState::at_origin();
            state.set_bob(mbd_runtime::PointState {
                position: [0.05, 0.0, 0.86],
                velocity: [0.0, 0.03 * f64::from(k), 0.0],
            });
            let (from, speed) = match k {
                2 | 5 => (1e8, 3e-6),
                _ => (5.0, 0.1),
            };
            state.set_stray(mbd_runtime::PointState {
                position: [from, 0.0, 0.0],
                velocity: [speed, 0.0, 0.0],
            });
            Case::new().state(0.0, state.to_vec())
        })
    };
    let fly = |lanes| {
        let rows = Sampling::Every(0.5);
        fly(&strayed, Options::rk4(2.3e-3), rows, cases(), (1, lanes))
    };
    let (alone, beside) = (fly(1), fly(8));
    assert_eq!(bits(&beside), bits(&alone));
    for case in &beside {
        let steps = case.statistics.steps;
        assert!(10 * case.beside > 9 * steps, "{} of {steps}", case.beside);
        match (case.case, &case.result) {
            (2 | 5, Err(failed)) => {
                println!("{}", failed.why);
                assert_eq!(failed.why.status(), "large_state");
                assert_eq!(steps % 10, 0, "{steps}");
            }
            (2 | 5, Ok(_)) => panic!("{steps} steps that move nothing"),
            (number, result) => assert!(result.is_ok(), "{number}"),
        }
    }
}
