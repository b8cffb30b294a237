//! A run that is driven from outside: what changes between two calls is seen, what is given is kept, what does not fit is refused.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use mbd_runtime::{
    Content, External, Generic, Linearisation, LinearisationError, Model, Options, Quantity,
    RunError, Sampling, Simulation, StepError, Trajectory, model,
};

model! {
    /// A mass that is pushed.
    model Cart {
        units: si;
        gravity: [0, 0, 0];
        input push: force;
        point mass { mass: 1 }
        load by_hand on mass = [push, 0, 0];
    }
}

model! {
    /// A coil at a voltage, beside a point in the wind: inputs that say by their value what they measure.
    model Coil {
        gravity: none;
        input voltage = 6 V;
        input wind = [8, 0, 0] m/s;
        state current = 0 A { rate: (voltage - 2 ohm * current) / (10 mH) }
        point bob { mass: 1 kg }
        load air on bob = 100 kg/s * (wind - bob.velocity);
    }
}

model! {
    /// A capsule on two lines below a massless point that creeps.
    pub model Hoist<T> {
        units: si;
        gravity: [0, 0, -9.81];
        param stiffness = 2000 in 100 ..= 1e5;
        world { frame eye at [0, 0, 5] }
        body cargo {
            mass: 10,
            inertia: diag(1, 1, 1),
            frame left at [-0.5, 0, 0.5],
            frame right at [0.5, 0, 0.5],
        }
        point ring { equilibrium: rate }
        joint loose: free from world to cargo.com;
        line rope from world.eye to ring { free_length: 2, stiffness: stiffness, damping: 200 }
        line sling_left from cargo.left to ring { free_length: 1, stiffness: 3000, damping: 300 }
        line sling_right from cargo.right to ring { free_length: 1, stiffness: 3000, damping: 300 }
        output pull = rope.tension;
    }
}

model! {
    /// One body on a pin.
    model Door {
        units: si;
        gravity: [0, 0, -9.81];
        body leaf { mass: 2, inertia: diag(0.17, 0.17, 0.02), frame top at [0, 0, 0.5] }
        joint pin: hinge from world to leaf.top { axis: [0, 1, 0] };
    }
}

#[test]
fn inputs_of_a_value_hold_it_until_another_is_given() {
    let inputs = CoilInputs::default();
    assert_eq!((inputs.voltage, inputs.wind), (6.0, [8.0, 0.0, 0.0]));
    let model = Coil::new(CoilParams::default()).unwrap();
    let mut run = Simulation::new(&model, Options::tsit5(1e-10)).unwrap();
    // Twenty time constants of the coil, fifty of the air.
    run.run(0.1).unwrap();
    let current = run.state()[6];
    assert!(
        (current - 3.0 * (1.0 - (-20.0_f64).exp())).abs() < 1e-8,
        "{current}"
    );
    run.set_inputs(&CoilInputs {
        voltage: -2.0,
        ..inputs
    })
    .unwrap();
    run.run(0.3).unwrap();
    let [speed, current] = [3, 6].map(|at| run.state()[at]);
    assert!(
        (current + 1.0).abs() < 1e-8 && (speed - 8.0).abs() < 1e-3,
        "{current} {speed}"
    );
}

/// A push in newtons that the test changes between calls.
struct Hand(Arc<AtomicI64>);

impl External<f64> for Hand {
    fn evaluate(&self, _: f64, _: &[f64], out: &mut [f64]) {
        out.fill(self.0.load(Ordering::Relaxed) as f64);
    }
}

/// ±1 N on 1 kg, alternating each 0.1 s, ends at rest after an even number of pushes, each pair 0.01 m further.
#[test]
fn a_push_that_alternates_between_calls_leaves_the_mass_at_rest() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    for options in [
        Options::rk4(0.1),
        Options::rk4(0.01),
        Options::tsit5(1e-3),
        Options::tsit5(1e-9),
    ] {
        let push = Arc::new(AtomicI64::new(1));
        let hand = Hand(push.clone());
        let mut run = Simulation::with_loads(&cart, options, hand).expect("options that fit");
        run.set_state(0.0, &[0.0; 6]).expect("a state");
        for tenth in 1..=20 {
            push.store(if tenth % 2 == 1 { 1 } else { -1 }, Ordering::Relaxed);
            run.run(0.1 * f64::from(tenth)).expect("a smooth motion");
        }
        let (x, v) = (run.state()[0], run.state()[3]);
        assert!(v.abs() < 1e-12, "{options:?}: v = {v}");
        assert!((x - 0.1).abs() < 1e-12, "{options:?}: x = {x}");
    }
}

#[test]
fn single_steps_see_a_changed_input_too() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let push = Arc::new(AtomicI64::new(1));
    let hand = Hand(push.clone());
    let mut run = Simulation::with_loads(&cart, Options::rk4(0.1), hand).expect("options");
    run.step().expect("a step");
    push.store(-1, Ordering::Relaxed);
    run.step().expect("a step");
    assert!(run.state()[3].abs() < 1e-15, "v = {}", run.state()[3]);
    assert!((run.state()[0] - 0.01).abs() < 1e-15);
}

/// A function that gives the same as at the end of the last call leaves the first stage as it is: a step of RK4 evaluates four rates.
#[test]
fn only_what_changed_between_calls_is_evaluated_anew() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let push = Arc::new(AtomicI64::new(1));
    let hand = Hand(push.clone());
    let mut run = Simulation::with_loads(&cart, Options::rk4(0.1), hand).expect("options");
    run.start().expect("a start");
    let mut last = run.statistics().rhs;
    let mut evaluated = || {
        run.step().expect("a step");
        let all = run.statistics().rhs;
        all - std::mem::replace(&mut last, all)
    };
    // What was given before the first call is not known at it.
    assert_eq!([evaluated(), evaluated(), evaluated()], [5, 4, 4]);
    push.store(-1, Ordering::Relaxed);
    assert_eq!([evaluated(), evaluated()], [5, 4]);
}

fn hoist() -> (Hoist, Vec<f64>) {
    let hoist = Hoist::new(HoistParams::default()).expect("defaults");
    let mut state = vec![0.0; hoist.layout().nx()];
    // The load hangs 3.6 m below the eye, swings, and turns.
    state[2] = 1.4;
    state[3] = 1.0;
    state[7] = 0.4;
    state[12] = 0.3;
    (hoist, state)
}

/// A run that is taken up again from its own state goes on with the same velocity of its node: z is where the node is.
#[test]
fn a_run_taken_up_from_its_state_keeps_the_place_of_its_rate_node() {
    let (hoist, state) = hoist();
    let options = Options::tsit5(1e-9);
    let mut run = Simulation::new(&hoist, options).expect("options");
    run.set_state(0.0, &state).expect("a state");
    run.run(0.7).expect("a taut swing");
    let (middle, velocity) = (run.state().to_vec(), run.nodes().to_vec());
    let mut again = Simulation::new(&hoist, options).expect("options");
    again.set_state(0.7, &middle).expect("a state");
    again.start().expect("a start");
    let (nq, nv) = (hoist.layout().nq, hoist.layout().nv);
    // Two slings and a rope lie in a plane, onto which a node is put to rounding.
    for (a, b) in again.state()[nq + nv..].iter().zip(&middle[nq + nv..]) {
        assert!((a - b).abs() < 1e-14, "z is given: {a} {b}");
    }
    for (a, b) in again.nodes().iter().zip(&velocity) {
        assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
    }
    run.run(1.5).expect("it goes on");
    again.run(1.5).expect("it goes on");
    for (a, b) in run.state().iter().zip(again.state()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn where_z_is_not_given_the_node_is_placed_in_balance() {
    let (hoist, state) = hoist();
    let mut run = Simulation::new(&hoist, Options::rk4(1e-3)).expect("options");
    run.set_state(0.0, &state).expect("a state");
    run.start().expect("a start");
    let z = &run.state()[13..];
    assert!(z[2] > 2.0 && z[2] < 3.2, "between eye and load: {z:?}");
}

/// A living run with other parameters is the run that was made with them, to the bit.
#[test]
fn changed_parameters_give_the_run_that_was_made_with_them() {
    let (hoist, state) = hoist();
    let options = Options::rk4(1e-3);
    let stiff = HoistParams { stiffness: 9000.0 };
    let mut made =
        Simulation::new(&Hoist::new(stiff).expect("in range"), options).expect("options");
    let mut changed = Simulation::new(&hoist, options).expect("options");
    changed.set_state(0.0, &state).expect("a state");
    changed.run(0.2).expect("it moves");
    changed.set_params(&[9000.0]).expect("in range");
    for run in [&mut made, &mut changed] {
        run.set_state(0.0, &state).expect("a state");
        run.run(0.5).expect("it moves");
    }
    assert_eq!(made.state(), changed.state());
    let refused = changed.set_params(&[1e9]).expect_err("out of range");
    assert!(refused.to_string().contains("stiffness"), "{refused}");
    let refused = changed.set_params(&[]).expect_err("one number");
    assert!(refused.to_string().contains("1 params"), "{refused}");
    changed.run(0.6).expect("refused parameters change nothing");
    made.run(0.6).expect("the same");
    assert_eq!(made.state(), changed.state());
}

fn cause(result: Result<impl std::fmt::Debug, RunError>) -> StepError {
    result.expect_err("refused").cause
}

#[test]
fn what_does_not_fit_a_run_is_refused_and_changes_nothing() {
    let (hoist, state) = hoist();
    let door = Door::new(DoorParams::default()).expect("defaults");
    let mut run = Simulation::new(&hoist, Options::rk4(1e-2)).expect("options");
    run.set_state(0.0, &state).expect("a state");
    run.run(0.1).expect("it moves");
    let before = run.state().to_vec();

    let other = Simulation::new(&door, Options::rk4(1e-2)).expect("options");
    let mut other = other;
    other.start().expect("it hangs");
    let foreign = cause(run.restore(&other.snapshot()));
    assert!(
        matches!(foreign, StepError::Unsupported { .. }),
        "{foreign:?}"
    );

    // Same sizes, another scene.
    let mut renamed = hoist.scene().clone();
    renamed.bodies[0].name = "parcel".into();
    let renamed = Generic::<f64>::with_defaults(renamed).expect("a scene");
    let mut twin = Simulation::new(&renamed, Options::rk4(1e-2)).expect("options");
    twin.set_state(0.0, &state).expect("a state");
    twin.start().expect("a start");
    let foreign = cause(run.restore(&twin.snapshot()));
    assert!(
        matches!(foreign, StepError::Unsupported { .. }),
        "{foreign:?}"
    );

    let early = cause(run.run(0.05));
    assert!(
        matches!(&early, StepError::Backwards { until, .. } if *until == 0.05),
        "{early:?}"
    );
    for length in [0, 1, 3] {
        let short = cause(run.evaluate(Quantity::Derivative, &mut vec![0.0; length]));
        assert!(
            matches!(&short, StepError::Length { expected: 16, found, .. } if *found == length),
            "{short:?}"
        );
        let short = cause(run.set_state(0.0, &vec![0.0; length]));
        assert!(
            matches!(&short, StepError::Length { found, .. } if *found == length),
            "{short:?}"
        );
    }
    assert_eq!(run.state(), before);
    run.run(0.1).expect("already there");
    run.run(0.2).expect("and on");
}

#[test]
fn derivatives_through_rows_are_there_and_those_of_another_model_are_refused() {
    let door = Door::new(DoorParams::default()).expect("defaults");
    let mut run = Simulation::new(&door, Options::rk4(1e-2)).expect("options");
    run.start().expect("it hangs");
    let mut linear = Linearisation::new(door.layout());
    let at = mbd_runtime::At::of_state(0.0, run.state(), &[]);
    linear
        .evaluate(&door, &at, &mut door.work())
        .expect("it hangs");
    // Rates of the coordinates: the speeds themselves.
    assert_eq!(linear.state().at(0, 7), 1.0);
    // A small angle θ about y moves the centre of mass by −l θ along x and is twice qy: α = −m g l θ/(I + m l²).
    let alpha = -0.5 * linear.state().at(11, 0) + 0.5 * linear.state().at(11, 5);
    assert!(
        (alpha + 2.0 * 9.81 * 0.5 / (0.17 + 2.0 * 0.25)).abs() < 1e-12,
        "{alpha}"
    );
    let other = Cart::new(CartParams::default()).expect("defaults");
    let refused = linear.evaluate(&other, &at, &mut other.work());
    assert_eq!(refused, Err(LinearisationError::OtherModel));
}

/// A run owns what it runs: it is stored, returned and moved to a thread.
#[test]
fn a_run_outlives_the_model_it_was_made_of_and_moves_to_a_thread() {
    struct Shop {
        runs: Vec<Simulation<f64>>,
    }
    fn open() -> Shop {
        let (hoist, state) = hoist();
        let door = Door::new(DoorParams::default()).expect("defaults");
        let mut lift = Simulation::new(&hoist, Options::rk4(1e-3)).expect("options");
        lift.set_state(0.0, &state).expect("a state");
        let hinge = Simulation::new(&door, Options::rk4(1e-3)).expect("options");
        Shop {
            runs: vec![lift, hinge],
        }
    }
    let here = |mut run: Simulation<f64>| {
        run.run(0.1).expect("it moves");
        run.state().to_vec()
    };
    let there = open().runs.into_iter();
    let there: Vec<Vec<f64>> = there
        .map(|run| {
            std::thread::spawn(move || here(run))
                .join()
                .expect("no panic")
        })
        .collect();
    let near: Vec<Vec<f64>> = open().runs.into_iter().map(here).collect();
    assert_eq!(there, near);
}

model! {
    /// A stone that falls from where it is put.
    model Stone {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        point stone { mass: 1 kg }
        output height = stone.position.z;
    }
}

#[test]
fn a_history_takes_no_rows_of_a_run_that_stands_before_its_end() {
    let stone = Stone::new(StoneParams::default()).expect("no params");
    for sampling in [
        Sampling::Steps,
        Sampling::Every(0.25),
        Sampling::At(vec![0.5, 1.0]),
    ] {
        let mut history = Trajectory::new(&stone, sampling, Content::RESULTS);
        let mut run = Simulation::new(&stone, Options::rk4(0.125)).expect("options");
        let falls = |height: f64| height - 0.5 * 9.81;
        let mut end = |height: f64, clears: bool| {
            run.set_state(0.0, &[0.0, 0.0, height, 0.0, 0.0, 0.0])?;
            if clears {
                history.clear();
            }
            run.record(0.5, &mut history)?;
            run.record(1.0, &mut history)?;
            let heights = history.column("height").expect("an output");
            Ok::<f64, RunError>(*heights.last().expect("a row"))
        };
        let first = end(10.0, false).expect("an empty one");
        assert!((first - falls(10.0)).abs() < 1e-12, "{first}");
        // On a grid it would have stayed the history of the first fall.
        let refused = end(20.0, false).expect_err("that of another fall");
        assert!(refused.to_string().contains("`clear` it"), "{refused}");
        let second = end(30.0, true).expect("an empty one");
        assert!((second - falls(30.0)).abs() < 1e-12, "{second}");
    }
}

#[test]
fn a_history_at_times_has_a_row_of_every_one_of_them() {
    let stone = Stone::new(StoneParams::default()).expect("no params");
    let run = || {
        let mut run = Simulation::new(&stone, Options::rk4(0.125)).expect("options");
        run.set_state(1.0, &[0.0, 0.0, 10.0, 0.0, 0.0, 0.0])
            .expect("a state");
        run
    };
    let at =
        |times: &[f64]| Trajectory::new(&stone, Sampling::At(times.to_vec()), Content::RESULTS);
    // Without its first rows the k-th row would be that of another time.
    let mut history = at(&[0.25, 0.5, 1.5, 2.0]);
    let refused = run().record(2.0, &mut history).expect_err("before it");
    let told = refused.to_string();
    assert!(told.contains("0.25 s") && told.contains("1 s"), "{told}");
    assert!(history.is_empty());
    // Asked for, they are left out.
    let sampling = Sampling::At(vec![0.5, 1.0, 1.5]).from_time(1.0);
    assert_eq!(sampling, Sampling::At(vec![1.0, 1.5]));
    let times = [1.0, 1.25, 1.5, 2.0];
    let mut history = at(&times);
    let mut run = run();
    for until in [1.1, 1.5, 2.0] {
        run.record(until, &mut history).expect("it goes on");
    }
    assert_eq!(history.times(), times);
    let heights = history.column("height").expect("an output");
    for (time, height) in times.iter().zip(heights) {
        let fallen = 0.5 * 9.81 * (time - 1.0_f64).powi(2);
        assert!((height - (10.0 - fallen)).abs() < 1e-12, "{time} {height}");
    }
    // Nor is a time left out that passed while nothing was recorded.
    let mut history = at(&[2.25, 2.5, 2.75]);
    run.record(2.25, &mut history).expect("its first row");
    run.run(2.625).expect("it falls");
    let refused = run.record(3.0, &mut history).expect_err("it has passed");
    assert!(refused.to_string().contains("2.5 s"), "{refused}");
    assert_eq!(history.times(), [2.25]);
}

#[test]
fn a_balance_is_found_for_a_model_whatever_its_type_is_known_as() {
    let (hoist, _) = hoist();
    let known: &dyn Model<f64> = &hoist;
    let [one, other] = [
        mbd_runtime::trim(known).solve(),
        mbd_runtime::trim(&hoist).solve(),
    ]
    .map(|rest| rest.expect("it hangs still").state);
    assert_eq!(one, other);
}

#[test]
fn a_history_of_a_run_that_failed_takes_no_rows_of_another() {
    let stone = Stone::new(StoneParams::default()).expect("no params");
    let options = Options {
        max_steps: 3,
        ..Options::rk4(0.125)
    };
    let mut history = Trajectory::new(&stone, Sampling::Every(0.125), Content::RESULTS);
    let mut run = Simulation::new(&stone, options).expect("options");
    let mut falls = |history: &mut Trajectory| {
        run.set_state(0.0, &[0.0, 0.0, 10.0, 0.0, 0.0, 0.0])
            .and_then(|()| run.record(1.0, history))
    };
    let failed = falls(&mut history).expect_err("three steps are not enough");
    assert!(matches!(failed.cause, StepError::TooManySteps { .. }));
    let rows = history.times().to_vec();
    let refused = falls(&mut history).expect_err("the rows of the run before");
    assert!(matches!(refused.cause, StepError::Unsupported { .. }));
    assert_eq!(history.times(), rows);
    history.clear();
    let failed = falls(&mut history).expect_err("three steps are not enough");
    assert!(matches!(failed.cause, StepError::TooManySteps { .. }));
    assert_eq!(history.times(), rows);
}
