//! Cases beside each other in lanes: what each gives alone, to the bit.

use super::beside::{Chain, ChainParams};
use mbd_runtime::{
    Lanes, Lanes4, Lanes8, LockStep, Model, Options, Real, Simulation, StepError, model,
};

model! {
    /// A stone in wind and thin air, drawn to a place.
    pub model Stone<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 1.0 kg in 0.1 kg ..= 10.0 kg;
        param drag = 0.02 kg/m in 0.0 kg/m ..= 1.0 kg/m;
        point stone { mass: mass }
        load air on stone =
            -drag * norm(stone.velocity) * stone.velocity * exp(-stone.position.z / 8000 m);
        load pull on stone =
            -3.0 N * [tanh(stone.position.x / 1 m), sin(stone.position.y / 1 m), 0.0];
    }
}

model! {
    /// A body that tumbles.
    pub model Tumbler<T> {
        gravity: none;
        body top { mass: 2.0 kg, inertia: diag(0.1, 0.2, 0.25) kg*m^2 }
        joint afloat: free from world to top.com;
    }
}

model! {
    /// A body that is pushed beside its centre.
    pub model Leaning<T> {
        gravity: none;
        body top {
            mass: 2.0 kg,
            inertia: diag(0.1, 0.2, 0.25) kg*m^2,
            frame rim at [0.3, 0.1, 0.0] m,
        }
        joint afloat: free from world to top.com;
        load push on top at rim = [0 N, 1 N, 2 N];
    }
}

model! {
    /// A mass on two lines.
    pub model Hung<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world { frame hook at [0.0, 0.0, 1.0] m }
        point knot;
        point bob { mass: 1.0 kg }
        line upper from world.hook to knot { free_length: 0.5 m, stiffness: 1 kN/m }
        line lower from knot to bob { free_length: 0.5 m, stiffness: 1 kN/m }
    }
}

model! {
    /// A mass that is pushed.
    pub model Pushed<T> {
        gravity: none;
        input push: force = 1 N;
        point mass { mass: 1.0 kg }
        load thrust on mass = push * [1.0, 0.0, 0.0];
    }
}

model! {
    /// Two masses on springs, one of them about a joint: nothing of it may let go.
    pub model Sprung<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        coordinates: relative;
        param k = 40 N/m in 1 N/m ..= 1 kN/m;
        body arm {
            mass: 1.0 kg,
            inertia: diag(0.083, 0.083, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame end at [0.0, 0.0, -0.5] m,
        }
        joint pin: hinge from world to arm.top { axis: y, stiffness: 3 N*m/rad, rest: 0.2 rad }
        point bob { mass: 0.5 kg }
        spring cord from arm.end to bob { free_length: 0.3 m, stiffness: k, damping: 0.2 N*s/m }
    }
}

mod apart {
    #![allow(deprecated, reason = "nothing attaches the spring, which is told")]

    mbd_runtime::model! {
        /// A spring that is not there.
        pub model Apart<T> {
            gravity: none;
            point bob { mass: 0.5 kg, start at [0.4, 0.0, 0.0] m }
            spring cord from world to bob {
                free_length: 0.3 m,
                stiffness: 40 N/m,
                at_start: detached,
            }
        }
    }
}

model! {
    /// A mass on a line.
    pub model Tied<T> {
        gravity: none;
        point bob { mass: 0.5 kg, start at [0.4, 0.0, 0.0] m }
        line cord from world to bob { free_length: 0.3 m, stiffness: 40 N/m }
    }
}

/// The end of a run of RK4 alone.
fn alone(model: &dyn Model<f64>, start: &[f64], step: f64, until: f64) -> Vec<f64> {
    let mut run = Simulation::new(model, Options::rk4(step)).expect("offered");
    run.set_state(0.0, start).expect("a state");
    run.run(until).expect("nothing stops it");
    run.state().to_vec()
}

/// Starts that differ from lane to lane, beside each other.
fn beside<L: Lanes>(starts: &[Vec<f64>]) -> Vec<L> {
    let lane = |at: usize| L::each(|lane| starts[lane][at]);
    (0..starts[0].len()).map(lane).collect()
}

fn assert_same<L: Lanes>(name: &str, state: &[L], lane: usize, expected: &[f64]) {
    for (at, (x, expected)) in state.iter().zip(expected).enumerate() {
        let found = x.lane(lane);
        assert_eq!(
            found.to_bits(),
            expected.to_bits(),
            "{name}, lane {lane}, {at}: {found:e} {expected:e}"
        );
    }
}

fn stones_fly_alike<L: Lanes>() {
    let mass = |lane: usize| 0.4 + 0.3 * lane as f64;
    let drag = |lane: usize| 0.01 * lane as f64;
    let stones = Stone::unchecked(StoneParams {
        mass: L::each(mass),
        drag: L::each(drag),
    });
    let starts: Vec<Vec<f64>> = (0..L::WIDTH)
        .map(|lane| vec![0.3, -0.1 * lane as f64, 100.0, 4.0, 1.0 + lane as f64, 5.0])
        .collect();
    let one = Stone::new(StoneParams {
        mass: 1.0,
        drag: 0.0,
    })
    .expect("params");
    let rates = |_: f64, x: &[L], out: &mut [L]| {
        let state = StoneState::from_slice(x).expect("a state");
        out.copy_from_slice(&stones.derivative(&state).to_vec());
    };
    let mut run =
        LockStep::new(one.layout(), 0.01, beside(&starts), rates).expect("nothing happens");
    run.run(3.0).expect("an end");
    assert_eq!(run.time(), 3.0);
    for (lane, start) in starts.iter().enumerate() {
        let stone = Stone::new(StoneParams {
            mass: mass(lane),
            drag: drag(lane),
        })
        .expect("params");
        assert_same("stone", run.state(), lane, &alone(&stone, start, 0.01, 3.0));
    }
}

#[test]
fn a_stone_in_a_lane_flies_as_it_does_alone_whatever_is_beside_it() {
    stones_fly_alike::<Lanes4>();
    stones_fly_alike::<Lanes8>();
}

#[test]
fn a_chain_in_a_lane_swings_as_it_does_alone() {
    let length = |lane: usize| 0.7 + 0.1 * lane as f64;
    let chains = Chain::unchecked(ChainParams {
        length: Lanes8::each(length),
    });
    let starts: Vec<Vec<f64>> = (0..8)
        .map(|lane| (0..8).map(|at| 0.1 * (lane + at) as f64 - 0.3).collect())
        .collect();
    let one = Chain::<f64>::new(ChainParams::default()).expect("params");
    let mut run =
        LockStep::of_model(chains, one.layout(), 1e-3, beside(&starts)).expect("an open tree");
    run.run(0.5).expect("an end");
    for (lane, start) in starts.iter().enumerate() {
        let chain = Chain::new(ChainParams {
            length: length(lane),
        })
        .expect("params");
        assert_same("chain", run.state(), lane, &alone(&chain, start, 1e-3, 0.5));
    }
}

#[test]
fn attitudes_stay_unit_quaternions_in_every_lane() {
    let one = Tumbler::<f64>::new(TumblerParams::default()).expect("no params");
    let tumblers = Tumbler::<Lanes4>::unchecked(TumblerParams::default());
    let starts: Vec<Vec<f64>> = (0..4)
        .map(|lane| {
            let mut start = vec![0.0; 13];
            (start[3], start[11], start[12]) = (1.0, 2.0 + lane as f64, 0.01);
            start
        })
        .collect();
    let rates = |_: f64, x: &[Lanes4], out: &mut [Lanes4]| {
        let state = TumblerState::from_slice(x).expect("a state");
        out.copy_from_slice(&tumblers.derivative(&state).to_vec());
    };
    let mut run = LockStep::new(one.layout(), 0.01, beside(&starts), rates).expect("a free body");
    run.run(2.0).expect("an end");
    for (lane, start) in starts.iter().enumerate() {
        assert_same("tumbler", run.state(), lane, &alone(&one, start, 0.01, 2.0));
        let size: f64 = run.state()[3..7].iter().map(|x| x.lane(lane).powi(2)).sum();
        assert!((size - 1.0).abs() < 1e-15);
    }
}

/// A run refuses such a start; in lock-step the body had other axes in the first step, and nothing told it. What a few digits make of it is normalised.
#[test]
fn a_start_that_is_no_attitude_is_refused_and_one_of_few_digits_is_normalised() {
    let one = Leaning::<f64>::new(LeaningParams::default()).expect("no params");
    let begin = |sizes: [f64; 4]| {
        let start = |size: f64| {
            let mut start = vec![0.0; 13];
            (start[3], start[4], start[11]) = (0.8 * size, 0.6 * size, 2.0);
            start
        };
        let starts: Vec<Vec<f64>> = sizes.map(start).to_vec();
        let over_lanes = Leaning::<Lanes4>::unchecked(LeaningParams::default());
        let run = LockStep::of_model(over_lanes, one.layout(), 0.01, beside(&starts));
        (starts, run)
    };
    for size in [1.5, 0.0, 0.9] {
        let (_, run) = begin([1.0, 1.0, size, 1.0]);
        let refused = run.err().expect("no attitude");
        assert!(refused.to_string().contains("quaternion"), "{refused}");
    }
    let (starts, run) = begin([1.0, 1.0 + 1e-6, 1.0 - 1e-6, 1.0 + 1e-12]);
    let mut run = run.expect("attitudes");
    run.run(1.0).expect("an end");
    for (lane, start) in starts.iter().enumerate() {
        assert_same("leaning", run.state(), lane, &alone(&one, start, 0.01, 1.0));
    }
}

#[test]
fn a_lane_that_explodes_disturbs_no_other() {
    let one = Stone::<f64>::new(StoneParams::default()).expect("params");
    let fly = |third: f64| {
        let masses = Lanes4::from([1.0, 2.0, third, 3.0]);
        let stones = Stone::unchecked(StoneParams {
            mass: masses,
            drag: Lanes4::from_f64(0.02),
        });
        let start = beside(&vec![vec![0.3, 0.1, 10.0, 4.0, 1.0, 5.0]; 4]);
        let rates = move |_: f64, x: &[Lanes4], out: &mut [Lanes4]| {
            let state = StoneState::from_slice(x).expect("a state");
            out.copy_from_slice(&stones.derivative(&state).to_vec());
        };
        let mut run = LockStep::new(one.layout(), 0.01, start, rates).expect("nothing happens");
        run.run(1.0).expect("an end");
        let finite: Vec<bool> = (0..4).map(|lane| run.is_finite(lane)).collect();
        (finite, run.state().to_vec())
    };
    let (finite, exploded) = fly(f64::NAN);
    assert_eq!(finite, [true, true, false, true]);
    let (_, calm) = fly(1.5);
    for (a, b) in exploded.iter().zip(&calm) {
        for lane in [0, 1, 3] {
            assert_eq!(a.lane(lane).to_bits(), b.lane(lane).to_bits());
        }
    }
}

fn springs_swing_alike<L: Lanes>() {
    let stiffness = |lane: usize| 30.0 + 5.0 * lane as f64;
    let starts: Vec<Vec<f64>> = (0..L::WIDTH)
        .map(|lane| {
            let far = 0.1 * lane as f64;
            // The angle and the place, and their rates.
            vec![0.3 + far, 0.1, 0.0, -1.2 - far, -0.2, 0.0, 0.3, 0.1]
        })
        .collect();
    let one = Sprung::new(SprungParams { k: 40.0 }).expect("params");
    let over_lanes = Sprung::unchecked(SprungParams {
        k: L::each(stiffness),
    });
    let mut run = LockStep::of_model(over_lanes, one.layout(), 2e-3, beside(&starts))
        .expect("nothing lets go");
    run.run(1.5).expect("an end");
    for (lane, start) in starts.iter().enumerate() {
        let model = Sprung::new(SprungParams { k: stiffness(lane) }).expect("params");
        let expected = alone(&model, start, 2e-3, 1.5);
        assert_same("springs", run.state(), lane, &expected);
    }
}

#[test]
fn springs_which_cannot_let_go_swing_in_lock_step_as_they_do_alone() {
    springs_swing_alike::<Lanes4>();
    springs_swing_alike::<Lanes8>();
}

#[test]
fn what_cannot_be_run_in_lock_step_is_refused_with_its_reason() {
    let hung = Hung::<f64>::new(HungParams::default()).expect("no params");
    let start = vec![Lanes4::from_f64(0.0); hung.layout().nx()];
    let nothing = |_: f64, _: &[Lanes4], _: &mut [Lanes4]| {};
    let refused = LockStep::new(hung.layout(), 0.01, start, nothing)
        .err()
        .expect("a node");
    assert!(
        refused.to_string().contains("equilibrium points"),
        "{refused}"
    );
    let start = vec![Lanes4::from_f64(0.0); 6];
    let apart = apart::Apart::<f64>::new(apart::ApartParams::default()).expect("no params");
    let tied = Tied::<f64>::new(TiedParams::default()).expect("no params");
    for (layout, why) in [
        (apart.layout(), "springs that are detached"),
        (tied.layout(), "lines, which may slacken"),
    ] {
        let refused = LockStep::new(layout, 0.01, start.clone(), nothing);
        let refused = refused.err().expect("not in lock-step").to_string();
        assert!(refused.contains(why), "{refused}");
    }
    let stone = Stone::<f64>::new(StoneParams::default()).expect("params");
    let short = vec![Lanes4::from_f64(0.0); 5];
    let refused = LockStep::new(stone.layout(), 0.01, short, nothing)
        .err()
        .expect("too short");
    assert!(
        refused.to_string().contains("it has 6 in this model"),
        "{refused}"
    );
    let start = vec![Lanes4::from_f64(0.0); 6];
    assert!(LockStep::new(stone.layout(), -1.0, start.clone(), nothing).is_err());
    let pushed = Pushed::<f64>::new(PushedParams::default()).expect("no params");
    let over_lanes = Pushed::<Lanes4>::unchecked(PushedParams::default());
    let refused = LockStep::of_model(over_lanes, pushed.layout(), 0.01, start)
        .err()
        .expect("an input");
    assert!(refused.to_string().contains("inputs"), "{refused}");
    // The state of another model, which the rates of this one did not read: it stayed where it was, without a word.
    for other in [stone.layout(), hung.layout()] {
        let start = vec![Lanes4::from_f64(0.0); other.nx()];
        let over_lanes = Leaning::<Lanes4>::unchecked(LeaningParams::default());
        let refused = LockStep::of_model(over_lanes, other, 0.01, start);
        let refused = refused.err().expect("another layout").to_string();
        assert!(refused.contains("layout of another model"), "{refused}");
    }
}

#[test]
fn a_run_in_lock_step_to_no_time_or_to_one_behind_is_refused_and_stays() {
    let stone = Stone::<f64>::new(StoneParams::default()).expect("params");
    let start = vec![Lanes4::from_f64(1.0); 6];
    let falls = |_: f64, state: &[Lanes4], rates: &mut [Lanes4]| rates.copy_from_slice(state);
    let mut run = LockStep::new(stone.layout(), 0.01, start, falls).expect("nothing happens");
    run.run(0.5).expect("an end");
    let before = run.state()[0];
    for until in [f64::INFINITY, f64::NAN] {
        let refused = run.run(until).expect_err("no end");
        assert!(refused.to_string().contains("end time"), "{refused}");
    }
    let refused = run.run(0.25).expect_err("behind");
    assert!(matches!(refused, StepError::Backwards { .. }), "{refused}");
    assert_eq!((run.time(), run.state()[0].lane(0)), (0.5, before.lane(0)));
    run.run(0.5).expect("it is there");
}
