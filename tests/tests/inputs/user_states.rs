//! States of the user's own: first-order equations of motors, controllers and filters beside the mechanics, against their closed forms.

use mbd_runtime::{
    Content, Generic, Linearisation, Model, Options, Quantity, RunError, Sampling, Simulation,
    StepError, Trajectory, model,
};
use tests::agreement::{agrees, agrees_along};

model! {
    /// A direct-current motor on a flywheel: L di/dt = u − R i − k ω, J dω/dt = k i.
    pub model Motor<T> {
        units: si;
        gravity: none;
        param resistance = 2;
        param inductance = 0.1;
        param k = 0.5;
        param i0 = 0.3;
        input u: number;
        body rotor { mass: 1, inertia: diag(0.05, 0.05, 0.05) }
        joint pin: hinge from world to rotor.com { axis: z, force: k * current }
        /// Current in the winding.
        state current = i0 { rate: (u - resistance * current - k * pin.angle_rate) / inductance }
        output heat = resistance * current^2;
        event strong = current rises 0.8;
    }
}

/// Current and speed of the motor under a constant voltage: the solution of ẋ = A x + b by the eigenvalues of A.
fn closed_form(t: f64) -> [f64; 2] {
    let (r, l, k, j, u, i0) = (2.0, 0.1, 0.5, 0.05, 12.0, 0.3);
    // i' = (u − R i − k ω)/L, ω' = k i/J: i'' + R/L i' + k²/(L J) i = 0.
    let (sum, product): (f64, f64) = (-r / l, k * k / (l * j));
    let root = (0.25 * sum * sum - product).sqrt();
    let [a, b] = [0.5 * sum + root, 0.5 * sum - root];
    let rate = (u - r * i0) / l;
    let ca = (rate - b * i0) / (a - b);
    let cb = i0 - ca;
    let current = ca * (a * t).exp() + cb * (b * t).exp();
    let speed = k / j * (ca / a * ((a * t).exp() - 1.0) + cb / b * ((b * t).exp() - 1.0));
    [current, speed]
}

/// 12 V from the start on.
fn motor<T: mbd_runtime::Scalar>(
    model: &impl Model<T>,
    options: Options,
) -> Result<Simulation<T>, RunError> {
    let mut run = Simulation::new(model, options)?;
    run.set_inputs(&vec![T::from_f64(12.0)])?;
    Ok(run)
}

#[test]
fn a_direct_current_motor_follows_its_closed_form() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    for options in [Options::tsit5(1e-12), Options::rk4(1e-4)] {
        let mut run = motor(&model, options).expect("options that fit");
        let spin = MotorState::<f64>::at_origin();
        assert_eq!(spin.current(), 0.3, "it starts where the declaration says");
        for tenth in 1..=10 {
            let t = 0.1 * f64::from(tenth);
            run.run(t).expect("a smooth motion");
            let state = MotorState::from_slice(run.state()).expect("a state");
            let [current, speed] = closed_form(t);
            let found = [state.current(), state.rotor().angular_velocity[2]];
            assert!(
                (found[0] - current).abs() < 1e-10,
                "{t} s: {found:?}, {current}"
            );
            assert!(
                (found[1] - speed).abs() < 1e-10,
                "{t} s: {found:?}, {speed}"
            );
        }
    }
}

#[test]
fn generated_interpreted_and_generic_models_have_the_same_states() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    agrees(&model);
    assert_eq!(Motor::<f64>::NS, 1);
    assert_eq!(Motor::<f64>::STATES[0].name, "current");
    let chain = Tanks::new(TanksParams::default()).expect("defaults");
    agrees(&chain);
    agrees_along(&chain, &TanksState::at_origin().to_vec(), (50, 0.01), 1e-12);
}

#[test]
fn a_motor_in_single_precision_is_right_to_single_precision() {
    let model = Motor::<f32>::new(MotorParams::default()).expect("defaults");
    let mut run = motor(&model, Options::tsit5(1e-5)).expect("options that fit");
    run.run(0.5).expect("a smooth motion");
    let state = MotorState::<f32>::from_slice(run.state()).expect("a state");
    let [current, speed] = closed_form(0.5);
    assert!((f64::from(state.current()) - current).abs() < 1e-4);
    assert!((f64::from(state.rotor().angular_velocity[2]) - speed).abs() < 1e-3);
}

#[test]
fn an_event_on_a_state_is_located() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    let mut run = motor(&model, Options::tsit5(1e-10)).expect("options that fit");
    run.run(0.05).expect("a smooth motion");
    let time = run.events().first().expect("0.8 A are passed").time;
    assert!((closed_form(time)[0] - 0.8).abs() < 1e-8, "{time}");
}

#[test]
fn a_state_starts_where_the_parameters_say() {
    let params = MotorParams {
        i0: -1.5,
        ..MotorParams::default()
    };
    let model = Motor::<f64>::new(params).expect("parameters");
    let run = motor(&model, Options::tsit5(1e-8)).expect("options that fit");
    assert_eq!(run.state().last(), Some(&-1.5));
}

#[test]
fn a_start_that_is_no_number_is_refused_by_name() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    let mut run = motor(&model, Options::tsit5(1e-8)).expect("options that fit");
    let mut state = MotorState::<f64>::at_origin();
    state.set_current(f64::NAN);
    let refused = run.set_state(0.0, &state.to_vec()).expect_err("no number");
    assert!(
        matches!(&refused.cause, StepError::InvalidInput { slot, .. } if slot == "current"),
        "{refused}"
    );
}

#[test]
fn a_snapshot_keeps_the_states_and_a_trajectory_has_a_column_for_each() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    let mut run = motor(&model, Options::tsit5(1e-8)).expect("options that fit");
    let mut rows = Trajectory::new(&model, Sampling::Steps, Content::ALL);
    run.record(0.3, &mut rows).expect("a smooth motion");
    let column = rows.column("current").expect("a column of the current");
    assert_eq!(column.first(), Some(&0.3));
    let saved = run.snapshot();
    run.run(0.6).expect("a smooth motion");
    let end = run.state().to_vec();
    run.restore(&saved).expect("its own snapshot");
    run.run(0.6).expect("a smooth motion");
    assert_eq!(run.state(), end);
}

model! {
    /// A mass that a controller with proportional and integral part moves to 1 m, on a ground that drags.
    model Cart {
        units: si;
        gravity: none;
        point mass { mass: 1 }
        state missed = 0 { rate: 1 - mass.position.x }
        state seen = 0 { rate: (mass.velocity.x - seen) / 0.05 }
        load control on mass = [6 * (1 - mass.position.x) + 2 * missed - 4 * seen - 3, 0, 0];
    }
}

#[test]
fn the_integral_part_of_a_controller_takes_out_a_steady_error() {
    let model = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options that fit");
    run.run(60.0).expect("a smooth motion");
    let state = CartState::from_slice(run.state()).expect("a state");
    // At rest the force is zero: 2 N/(m s) · missed = 3 N.
    assert!((state.mass().position[0] - 1.0).abs() < 1e-8);
    assert!((state.missed() - 1.5).abs() < 1e-8);
    assert!(state.seen().abs() < 1e-8);
}

model! {
    /// Sixty-four tanks that empty into each other, and nothing else.
    model Tanks {
        units: si;
        gravity: none;
        param rate = 2;
        state first = 1 { rate: -rate * first }
        state level[i in 1..64] = 0 {
            rate: rate * (if(i < 2, first, level[max(i - 1, 1)]) - level[i]),
        }
        output last = level[63];
    }
}

#[test]
fn a_chain_of_sixty_four_states_alone_follows_the_poisson_law() {
    let model = Tanks::new(TanksParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options that fit");
    run.run(20.0).expect("a smooth motion");
    let state = TanksState::from_slice(run.state()).expect("a state");
    // Level n of a chain of equal tanks: (k t)ⁿ e^(−k t)/n!.
    let (mut expected, kt) = ((-40.0_f64).exp(), 40.0);
    for n in 1..64 {
        expected *= kt / f64::from(n);
        let found = state.level(n as usize).expect("a tank");
        assert!((found - expected).abs() < 1e-10, "{n}: {found} {expected}");
    }
    assert_eq!(state.level(64), None);
}

model! {
    /// A buoy on a line whose other end creeps, pulled by a thruster that lags behind its command.
    model Buoy {
        units: si;
        gravity: [0, 0, -9.81];
        point buoy { mass: 2 }
        point ring { equilibrium: rate }
        world { frame eye at [0, 0, 3], frame side at [1, 0.5, 3], frame back at [0.5, -0.7, 3] }
        line rope from world.eye to ring { free_length: 1, stiffness: 200, damping: 20 }
        line stay from world.side to ring { free_length: 1, stiffness: 200, damping: 20 }
        line brace from world.back to ring { free_length: 1, stiffness: 200, damping: 20 }
        line hang from ring to buoy { free_length: 1, stiffness: 200, damping: 20 }
        state thrust = 0 { rate: (5 + 0.1 * rope.tension + ring.position.x - thrust) / 0.2 }
        load push on buoy = [thrust, 0, 0];
        load wind on ring = [0.1 * thrust, 0, 0];
        output pull = thrust + hang.tension;
    }
}

#[test]
fn states_read_nodes_and_load_them() {
    let model = Buoy::new(BuoyParams::default()).expect("defaults");
    agrees(&model);
    let generic = Generic::<f64>::with_defaults(Buoy::scene()).expect("defaults");
    let mut start = BuoyState::at_origin();
    let mut buoy = start.buoy();
    buoy.position = [0.5, 0.0, 0.8];
    start.set_buoy(buoy);
    let ends: Vec<Vec<f64>> = [&model as &dyn Model<f64>, &generic]
        .into_iter()
        .map(|model| {
            let mut run = Simulation::new(model, Options::tsit5(1e-9)).expect("options that fit");
            run.set_state(0.0, &start.to_vec()).expect("a state");
            run.run(2.0).expect("a smooth motion");
            run.state().to_vec()
        })
        .collect();
    for (a, b) in ends[0].iter().zip(&ends[1]) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    // The thruster has come to its command.
    let end = BuoyState::from_slice(&ends[0]).expect("a state");
    assert!(end.thrust() > 4.0 && end.thrust() < 9.0, "{}", end.thrust());
}

#[test]
fn states_are_in_the_derivatives() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut linear = Linearisation::new(cart.layout());
    let state = CartState::at_origin().to_vec();
    let at = mbd_runtime::At::of_state(0.0, &state, &[]);
    linear
        .evaluate(&cart, &at, &mut cart.work())
        .expect("a smooth place");
    // x = [x y z | vx vy vz | missed seen]: v̇x = … − 6 x + 2 missed − 4 seen, missed' = −x, seen' = (vx − seen)/0.05.
    let entry = |row: usize, column: usize| linear.state().at(row, column);
    assert_eq!([entry(3, 0), entry(3, 6), entry(3, 7)], [-6.0, 2.0, -4.0]);
    assert_eq!([entry(6, 0), entry(7, 3), entry(7, 7)], [-1.0, 20.0, -20.0]);
}

/// A cart on a spring of half a turn a second, and two states that turn about each other.
fn beside_a_cart(rate: f64) -> (u64, f64) {
    let scene = tests::declared::read(&format!(
        "model Beside {{
            units: si;
            gravity: none;
            body cart {{ mass: 1, inertia: diag(1, 1, 1) }}
            joint rail: prismatic from world to cart.com {{ axis: x, stiffness: 9.87, start: 0.3 }}
            state cosine = 1 {{ rate: -{rate:.1} * sine }}
            state sine = 0 {{ rate: {rate:.1} * cosine }}
        }}"
    ));
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-6)).expect("options that fit");
    run.run(2.0).expect("a smooth motion");
    let x = run.state();
    let (sin, cos) = (2.0 * rate).sin_cos();
    let error = (x[x.len() - 2] - cos).hypot(x[x.len() - 1] - sin);
    (run.statistics().steps, error)
}

#[test]
fn a_fast_state_beside_slow_mechanics_limits_the_step() {
    let [slow, fast] = [3.0, 300.0].map(beside_a_cart);
    assert!(slow.1 < 1e-4 && fast.1 < 1e-2, "{slow:?} {fast:?}");
    // A hundred times the rate: steps are a hundred times as short where the state is what is judged.
    assert!(fast.0 > 40 * slow.0, "{slow:?} {fast:?}");
}

#[test]
fn a_motor_in_amperes_volts_and_ohms_is_the_motor_in_plain_numbers() {
    let scene = tests::declared::read(
        "model Wound {
            gravity: none;
            const R = 2 ohm; const L = 0.1 V*s/A; const k = 0.5 N*m/A;
            input u: voltage = 0.012 kV;
            body rotor { mass: 1 kg, inertia: diag(0.05, 0.05, 0.05) kg*m^2 }
            joint pin: hinge from world to rotor.com { axis: z, force: k * i }
            state i = 300 mA { rate: (u - R * i - k * pin.angle_rate) / L }
            output heat = R * i^2 in kW;
            output speed = pin.angle_rate;
        }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-11)).expect("options that fit");
    run.run(0.3).expect("a smooth motion");
    let mut outputs = [0.0; 2];
    run.evaluate(Quantity::Outputs, &mut outputs)
        .expect("no node");
    let [current, speed] = closed_form(0.3);
    let want = [2e-3 * current * current, speed];
    for (got, want) in outputs.iter().zip(want) {
        assert!(
            (got - want).abs() < 1e-8 * (1.0 + want.abs()),
            "{got} {want}"
        );
    }
}

model! {
    /// Numbers along joints that change in a run, and the same that do not.
    model Changing {
        units: si;
        gravity: none;
        input level: force = 3;
        state seat = 0 m { rate: 0.4 }
        state one = 1 { rate: 0 }
        body a { mass: 2, inertia: diag(1, 1, 1) }
        body b { mass: 1, inertia: diag(1, 1, 1) }
        body c[i in 0..2] { mass: 1, inertia: diag(1, 1, 1) }
        body d[i in 0..2] { mass: 1, inertia: diag(1, 1, 1) }
        /// A spring whose other end is carried along.
        joint carried: prismatic from world to a { axis: x, stiffness: 18, rest: seat }
        /// A damper that loses its grip.
        joint losing: prismatic from world to b { axis: x, damping: 3 / (1 + time), start_rate: 2 }
        joint braked: prismatic from world to c[0] {
            axis: y,
            friction: 3,
            friction_rate: 0.2,
            start_rate: 1,
        }
        joint braking: prismatic from world to c[1] {
            axis: y,
            friction: level,
            friction_rate: 0.2,
            start_rate: 1,
        }
        joint sprung: prismatic from world to d[0] {
            axis: y,
            stiffness: 5,
            rest: 0.1,
            damping: 0.2,
            force: 0.5,
        }
        joint springy: prismatic from world to d[1] {
            axis: y,
            stiffness: 5 * one,
            rest: 0.1,
            damping: 0.2 * one,
            force: 0.5,
        }
        output places = [
            carried.slide, losing.slide_rate, braked.slide, braking.slide, sprung.slide,
            springy.slide,
        ];
    }
}

#[test]
fn what_changes_along_a_joint_in_a_run_is_a_force_by_the_same_law() {
    let model = Changing::new(ChangingParams::default()).expect("defaults");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-12)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    let mut history = Trajectory::new(&model, Sampling::Every(0.25), Content::RESULTS);
    run.record(2.0, &mut history).expect("a smooth motion");
    let column = |k: usize| history.column(&format!("places[{k}]")).expect("a column");
    let omega = (18.0_f64 / 2.0).sqrt();
    for (row, t) in history.times().iter().enumerate() {
        // m ẍ = −k (x − u t) from rest; m v̇ = −3 v/(1 + t).
        let carried = 0.4 * t - 0.4 / omega * (omega * t).sin();
        let losing = 2.0 / (1.0 + t).powi(3);
        assert!((column(0)[row] - carried).abs() < 1e-10, "{t} s");
        assert!((column(1)[row] - losing).abs() < 1e-10, "{t} s");
        assert!((column(2)[row] - column(3)[row]).abs() < 1e-10, "{t} s");
        assert!((column(4)[row] - column(5)[row]).abs() < 1e-10, "{t} s");
    }
    assert!(column(3)[8] > 0.05 && column(5)[8].abs() > 0.05);
    let imbalance = run.imbalance().expect("a balance of energy");
    assert!(imbalance.relative() < 1e-9, "{imbalance:?}");
}

model! {
    /// As many states and inputs as the motor has, and other ones.
    model Plant {
        gravity: none;
        input valve: number = 1;
        point tank { mass: 1 kg }
        load flow on tank = [valve * 1 N, 0, 0];
    }
}

#[test]
fn params_and_inputs_are_given_by_their_structs() {
    let model = Motor::<f64>::new(MotorParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
    let other = MotorParams {
        k: 0.25,
        ..MotorParams::default()
    };
    run.set_params(&other).expect("params that can be run");
    assert_eq!(run.model().params(), other.to_array());
    let refused = run
        .set_params(&TanksParams::default())
        .expect_err("of tanks");
    assert!(
        refused.to_string().contains("these are params of `Tanks`"),
        "{refused}"
    );
    let state = run.state().to_vec();
    let inputs = MotorInputs { u: 3.0 };
    let space = mbd_runtime::linearise(&model, 0.0, &state, &inputs).expect("a linear system");
    let listed = mbd_runtime::linearise(&model, 0.0, &state, &[3.0]).expect("a linear system");
    assert_eq!((space.a, space.b), (listed.a, listed.b));
    let refused = mbd_runtime::linearise(&model, 0.0, &state, &PlantInputs::default())
        .expect_err("of a plant");
    assert!(
        refused.to_string().contains("the inputs of `Plant`"),
        "{refused}"
    );
    let heats = mbd_runtime::Batch::new(&model, Options::tsit5(1e-9), 0.1)
        .cases([
            mbd_runtime::Case::new()
                .params(other.clone())
                .inputs(&inputs),
            mbd_runtime::Case::new()
                .params(other.to_array())
                .inputs(&inputs),
            mbd_runtime::Case::new().params(TanksParams::default()),
        ])
        .run(|_case, history| history.column("heat").and_then(|heat| heat.last().copied()));
    let [typed, listed, wrong] = &heats[..] else {
        panic!("three cases");
    };
    assert_eq!(typed.result, listed.result);
    assert!(matches!(&wrong.result, Err(failed) if failed.why.status() == "params"));
}
