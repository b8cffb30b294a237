//! Rattle: its order, what it keeps over long runs, time that runs backwards, and what it refuses.

use mbd_compiler::Interpreted;
use mbd_runtime::{
    Content, Generic, Model, Options, Quantity, Sampling, Simulation, Stabilise, StepError,
    Trajectory, model,
};
use tests::declared::read;
use tests::largest_difference;

/// A chain of rods on spherical joints, thrown sideways.
fn chain(links: usize) -> String {
    let mut text = String::from("model Chain { gravity: [0, 0, -9.81] m/s^2; ");
    for index in 0..links {
        let from = match index {
            0 => "world".to_owned(),
            _ => format!("b{}.end", index - 1),
        };
        text += &format!(
            "body b{index} {{ mass: 1 kg, inertia: diag(0.084, 0.084, 0.01) kg*m^2,
             frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m,
             start at [0, 0, {}] m velocity [{}, 0.2, 0] m/s angular_velocity [0.3, -0.8, 2.0] rad/s }}
             joint j{index}: spherical from {from} to b{index}.top; ",
            -0.5 - index as f64,
            0.8 * (index as f64 + 1.0)
        );
    }
    text + "}"
}

/// Two rods on hinges.
const DOUBLE: &str = "model Double { gravity: [0, 0, -9.81] m/s^2;
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
    body b { mass: 2 kg, inertia: diag(0.2, 0.2, 0.03) kg*m^2, frame top at [0, 0, 0.6] m }
    joint p: hinge from world to a.top { axis: y, start: 1.2 rad }
    joint q: hinge from a.end to b.top { axis: y, start: -0.7 rad } }";

/// A body that tumbles, in these components, with these products of inertia [kg m²].
fn free(components: &str, products: [f64; 3]) -> String {
    let [xy, xz, yz] = products;
    format!(
        "model Free {{ angular_velocity: {components}; gravity: none;
         body b {{ mass: 1 kg, inertia: full {{ xx: 1, yy: 2, zz: 2.6, xy: {xy}, xz: {xz}, yz: {yz} }} kg*m^2 (matrix elements),
         start at [0, 0, 0] m velocity [0.1, 0.2, 0.3] m/s angular_velocity [0.4, 1.3, -0.5] rad/s }}
         joint loose: free from world to b.com; }}"
    )
}

fn interpreted(text: &str) -> Interpreted<f64> {
    Interpreted::new(read(text), &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The state at the end of a run from the declared start.
fn end(model: &dyn Model<f64>, options: Options, until: f64) -> Vec<f64> {
    let mut run = Simulation::new(model, options).unwrap_or_else(|error| panic!("{error}"));
    run.run(until).unwrap_or_else(|error| panic!("{error}"));
    run.state().to_vec()
}

/// The orders between four runs whose steps halve from `step`.
fn orders(text: &str, step: f64, until: f64) -> Vec<f64> {
    let model = interpreted(text);
    let exact = end(&model, Options::vern7(1e-13), until);
    let errors: Vec<f64> = (0..4)
        .map(|k| {
            let run = end(&model, Options::rattle(step / f64::from(1 << k)), until);
            largest_difference(&run, &exact)
        })
        .collect();
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    println!("{}: {errors:?} {orders:?}", model.scene().name);
    orders
}

#[test]
fn steps_are_of_order_four_on_what_swings_and_turns() {
    for (text, step) in [
        (chain(4), 0.01),
        (DOUBLE.to_owned(), 0.01),
        (free("body", [0.0; 3]), 0.1),
        (free("body", [0.1, -0.2, 0.15]), 0.1),
        (free("world", [0.1, -0.2, 0.15]), 0.1),
    ] {
        let orders = orders(&text, step, 1.0);
        let last = orders.last().copied().unwrap_or(f64::NAN);
        assert!((last - 4.0).abs() < 0.15, "{text}: {orders:?}");
    }
}

/// Energy [J] and angular momentum about the origin [kg m²/s].
fn kept(run: &mut Simulation<f64>) -> (f64, [f64; 3]) {
    let (mut energy, mut momentum) = ([0.0; 6], [0.0; 6]);
    run.evaluate(Quantity::Energy, &mut energy)
        .expect("no nodes");
    run.evaluate(Quantity::Momentum, &mut momentum)
        .expect("no nodes");
    let [.., x, y, z] = momentum;
    (energy[..3].iter().sum(), [x, y, z])
}

/// Largest relative changes of energy and of angular momentum, and the largest deviation of the quaternion from length 1, over steps of this size of a
/// body that tumbles with this angular velocity.
fn tumble(inertia: [f64; 3], spin: [f64; 3], step: f64, steps: usize) -> [f64; 3] {
    let [a, b, c] = inertia;
    let model = interpreted(&format!(
        "model Free {{ gravity: none; body b {{ mass: 1 kg, inertia: diag({a:?}, {b:?}, {c:?}) kg*m^2 }}
         joint loose: free from world to b.com; output w = b.x; }}"
    ));
    let options = Options {
        watch: false,
        ..Options::rattle(step)
    };
    let mut run = Simulation::new(&model, options).expect("options");
    let mut state = run.state().to_vec();
    state[10..13].copy_from_slice(&spin);
    run.set_state(0.0, &state).expect("state");
    let (energy, momentum) = kept(&mut run);
    let size = momentum.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut worst = [0.0_f64; 3];
    for look in 1..=100 {
        run.run(step * (steps * look / 100) as f64)
            .expect("it turns");
        let (e, l) = kept(&mut run);
        let q = run.state()[3..7].iter().map(|x| x * x).sum::<f64>().sqrt();
        let off = [
            (e - energy).abs() / energy,
            largest_difference(&l, &momentum) / size,
            (q - 1.0).abs(),
        ];
        for (worst, off) in worst.iter_mut().zip(off) {
            *worst = worst.max(off);
        }
    }
    println!("{inertia:?} {spin:?} h = {step:e}, {steps} steps: {worst:?}");
    worst
}

#[test]
fn a_body_that_tumbles_keeps_energy_and_momentum() {
    let steps = 100_000;
    for (inertia, spin, step, goals) in [
        ([1.0, 2.0, 3.0], [1e-3, 1.0, 1e-3], 0.1, [1e-7, 1e-11]),
        ([1.0, 2.0, 3.0], [1e-3, 1.0, 1e-3], 0.01, [1e-10, 1e-11]),
        ([1.0, 2.0, 3.0], [10.0, 1e4, 10.0], 1e-4, [1e-3, 1e-11]),
        ([2.0, 2.0, 3.0], [0.3, 0.0, 1.0], 0.1, [1e-7, 1e-11]),
        ([1.0, 1.0, 1.0], [0.3, 0.1, 1.0], 0.1, [1e-11, 1e-11]),
    ] {
        let found = tumble(inertia, spin, step, steps);
        assert!(
            found[0] <= goals[0] && found[1] <= goals[1] && found[2] <= 1e-14,
            "{found:?}"
        );
    }
}

/// A damper, drag, a spring, a declared state, a push that changes with time: all that depends on speeds or time.
const BUSY: &str = "model Busy { gravity: [0, 0, -9.81] m/s^2;
    world { frame post at [1, 0, 1] m }
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
    body b { mass: 2 kg, inertia: diag(0.2, 0.2, 0.03) kg*m^2, frame top at [0, 0, 0.6] m, frame end at [0, 0.1, -0.6] m }
    joint p: hinge from world to a.top { axis: y, start: 1.2 rad, damping: 0.5 N*m*s }
    joint q: spherical from a.end to b.top;
    spring rope from world.post to b.end { free_length: 1 m, stiffness: 50 N/m, damping: 2 N*s/m }
    state seen = 0 m { rate: (b.end.position.x - seen) / (0.3 s) }
    load drag on b at end = -(0.3 kg/m) * norm(b.end.velocity) * b.end.velocity;
    load push on a at end = [3 N * cos(2 rad/s * time), 1 N, (2 N/m) * seen]; }";

/// The first of two rods turned by a motor, the second one follows.
const DRIVEN: &str = "model Driven { gravity: [0, 0, -9.81] m/s^2;
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
    body b { mass: 2 kg, inertia: diag(0.2, 0.2, 0.03) kg*m^2, frame top at [0, 0, 0.6] m }
    joint p: hinge from world to a.top { axis: y, motor: 0.8 rad * sin(2 rad/s * time) }
    joint q: spherical from a.end to b.top; }";

/// A point mass on the springs of a knot without mass.
const STATIC: &str = "model Static { gravity: [0, 0, -9.81] m/s^2;
    world { frame left at [-1, 0.1, 2] m, frame right at [1.5, 0, 2.2] m }
    point lamp { mass: 2 kg, start at [0.2, 0.1, 1.45] m velocity [0.3, 0.2, 0] m/s }
    point knot { equilibrium: static }
    line a from world.left to knot { free_length: 0.8 m, stiffness: 200 N/m }
    line b from world.right to knot { free_length: 1 m, stiffness: 200 N/m }
    line cord from knot to lamp { free_length: 0.3 m, stiffness: 200 N/m } }";

/// Two rods in a plane, a point on a spring, and central gravity.
const FLAT: &str = "model Flat { planar: xz; gravity: point_mass { mu: 4e1 m^3/s^2, center: [0, 0, -6] m };
    body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
    body b { mass: 2 kg, inertia: diag(0.2, 0.2, 0.03) kg*m^2, frame top at [0, 0, 0.6] m, frame end at [0, 0, -0.6] m }
    point bob { mass: 0.5 kg, start at [0.5, 0, -2.2] m }
    joint p: hinge from world to a.top { axis: y, start: 0.4 rad }
    joint q: hinge from a.end to b.top { axis: y, start: -0.2 rad }
    spring s from b.end to bob { free_length: 0.3 m, stiffness: 100 N/m } }";

#[test]
fn steps_are_of_order_four_with_dampers_motors_states_nodes_and_in_a_plane() {
    for (text, step) in [(BUSY, 0.02), (DRIVEN, 0.02), (STATIC, 0.02), (FLAT, 0.005)] {
        let orders = orders(text, step, 1.0);
        let last = orders.last().copied().unwrap_or(f64::NAN);
        assert!((last - 4.0).abs() < 0.15, "{text}: {orders:?}");
    }
}

/// A run out, all speeds turned round, and back: how far it ends from its start, and what rounding may make of that. Each step rounds the state by ε of
/// its largest number, some ten times; 2 N steps leave √(2 N) of that, and the motion multiplies it by what it makes of a nudge at the
/// turn.
fn there_and_back(text: &str, step: f64, steps: usize) -> [f64; 2] {
    let model = interpreted(text);
    let options = Options {
        watch: false,
        ..Options::rattle(step)
    };
    let nq = model.layout().nq;
    let until = step * steps as f64;
    // Start, turn and end of a run whose speeds are nudged at the turn.
    let travel = |nudge: f64| {
        let mut run = Simulation::new(&model, options).expect("options");
        run.start().expect("it starts");
        let start = run.state().to_vec();
        run.run(until).unwrap_or_else(|error| panic!("{error}"));
        let turned = |run: &Simulation<f64>, nudge: f64| {
            let mut state = run.state().to_vec();
            let speeds = state.iter_mut().skip(nq).zip([1.0, -0.7].iter().cycle());
            speeds.for_each(|(speed, part)| *speed = nudge * part - *speed);
            state
        };
        run.set_state(0.0, &turned(&run, nudge)).expect("state");
        run.start().expect("it starts");
        let turn = run.state().to_vec();
        run.run(until).unwrap_or_else(|error| panic!("{error}"));
        [start, turn, turned(&run, 0.0)]
    };
    let [[start, turn, end], [_, other_turn, other_end]] = [travel(0.0), travel(1e-7)];
    let off = largest_difference(&end, &start);
    let growth = largest_difference(&other_end, &end) / largest_difference(&other_turn, &turn);
    let numbers = start.iter().chain(&turn);
    let largest = numbers.fold(0.0, |most: f64, x| most.max(x.abs()));
    let walk = 10.0 * (2.0 * steps as f64).sqrt() * f64::EPSILON * largest;
    let bound = walk * growth.max(1.0);
    println!(
        "{}: {off:e} of {bound:e}, a nudge grows {growth:.2}-fold",
        model.scene().name
    );
    [off, bound]
}

#[test]
fn time_runs_backwards_to_the_start() {
    let tumbling = free("body", [0.1, -0.2, 0.15]);
    for text in [&chain(2), DOUBLE, &tumbling, FLAT, STATIC] {
        let [off, bound] = there_and_back(text, 1e-3, 2000);
        assert!(off < bound && bound < 1e-10, "{text}: {off:e} of {bound:e}");
    }
}

#[test]
fn a_chain_keeps_its_energy_and_its_joints() {
    let model = interpreted(&chain(2));
    let mut run = Simulation::new(&model, Options::rattle(2e-3)).expect("options");
    let before = kept(&mut run).0;
    let mut worst: f64 = 0.0;
    for look in 1..=20 {
        run.run(3.0 * f64::from(look))
            .unwrap_or_else(|error| panic!("{error}"));
        worst = worst.max((kept(&mut run).0 - before).abs());
    }
    println!("{worst:e} J of {before:e} J");
    assert!(worst < 1e-9, "{worst:e} J");
}

#[test]
fn masses_may_differ_by_nine_decades() {
    for ratio in [1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9] {
        let text = format!(
            "model Uneven {{ gravity: [0, 0, -9.81] m/s^2;
             body a {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }}
             body b {{ mass: {ratio:e} kg, inertia: diag({0:e}, {0:e}, {1:e}) kg*m^2, frame top at [0, 0, 0.5] m }}
             joint p: spherical from world to a.top; joint q: hinge from a.end to b.top {{ axis: y, start: 1 rad }} }}",
            0.1 * ratio, 0.02 * ratio
        );
        let model = interpreted(&text);
        let mut run = Simulation::new(&model, Options::rattle(1e-3)).expect("options");
        run.run(5.0)
            .unwrap_or_else(|error| panic!("{ratio:e}: {error}"));
        let lost = run.imbalance().expect("a scene with an energy").relative();
        println!("{ratio:e}: {lost:e}");
        assert!(lost < 1e-6, "{ratio:e}: {lost:e}");
    }
}

/// The largest error of rows between the steps, against a tight run.
fn between(step: f64) -> f64 {
    let model = interpreted(&chain(2));
    let rows = |options: Options| {
        let mut history = Trajectory::new(&model, Sampling::Every(0.003), Content::ALL);
        let mut run = Simulation::new(&model, options).expect("options");
        run.record(0.9, &mut history).expect("it swings");
        let columns = ["b1.x", "b1.y", "b1.z", "b1.vx"];
        let columns = columns.map(|name| history.column(name).expect("a column").to_vec());
        columns.concat()
    };
    largest_difference(&rows(Options::rattle(step)), &rows(Options::vern7(1e-13)))
}

#[test]
fn rows_between_steps_are_of_order_four() {
    let errors = [0.02, 0.01, 0.005].map(between);
    let order = (errors[1] / errors[2]).log2();
    println!("{errors:?} {order}");
    assert!(order > 3.85, "{errors:?}");
}

#[test]
fn a_run_goes_on_from_a_snapshot_to_the_same_bits() {
    for text in [chain(2).as_str(), BUSY, STATIC, FLAT] {
        let model = interpreted(text);
        let options = Options {
            work: true,
            ..Options::rattle(3e-3)
        };
        let mut whole = Simulation::new(&model, options).expect("options");
        whole.run(0.5).expect("it moves");
        let snapshot = whole.snapshot();
        let mut other = Simulation::new(&model, options).expect("options");
        other.restore(&snapshot).expect("the same run");
        for run in [&mut whole, &mut other] {
            run.run(1.0).expect("it moves");
        }
        assert_eq!(whole.snapshot(), other.snapshot(), "{text}");
    }
}

model! {
    /// A cart that its caller pushes, and a pendulum on it.
    pub model Cart {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: force;
        body cart { mass: 2 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m }
        joint rail: prismatic from world to cart.com { axis: x, force: push }
        joint pin: hinge from cart.com to rod.top { axis: y, start: 0.5 rad }
    }
}

#[test]
fn feedback_by_a_function_of_time_and_state_is_of_order_four() {
    let cart = Cart::new(CartParams::default()).expect("no params");
    let end = |options: Options| {
        let mut run = Simulation::new(&cart, options).expect("options");
        let law = |sample: &mbd_runtime::Sample<'_, CartInputs, f64>, inputs: &mut CartInputs| {
            let cart = sample.state().cart();
            let held = inputs.push;
            inputs.push =
                held - 20.0 * cart.position[0] - 3.0 * cart.velocity[0] + sample.time.cos();
        };
        run.control(law).expect("an input");
        run.run(1.0).expect("it moves");
        run.state().to_vec()
    };
    let exact = end(Options::vern7(1e-13));
    let errors =
        [0.02, 0.01, 0.005].map(|step| largest_difference(&end(Options::rattle(step)), &exact));
    let order = (errors[1] / errors[2]).log2();
    println!("{errors:?} {order}");
    assert!((order - 4.0).abs() < 0.15, "{errors:?}");
}

#[test]
fn a_generated_model_moves_as_the_interpreted_and_the_generic_one() {
    let cart = Cart::new(CartParams::default()).expect("no params");
    let scene = cart.scene().clone();
    let generated = end(&cart, Options::rattle(0.01), 2.0);
    let interpreted = Interpreted::new(scene.clone(), &[]).expect("no params");
    assert_eq!(generated, end(&interpreted, Options::rattle(0.01), 2.0));
    let generic = Generic::<f64>::with_defaults(scene).expect("no params");
    let off = largest_difference(&generated, &end(&generic, Options::rattle(0.01), 2.0));
    assert!(off < 1e-11, "{off:e}");
}

#[test]
fn a_closed_loop_with_rows_that_repeat_others_keeps_its_energy() {
    let params = models::scenes::four_bar::FourBarParams {
        drive_gain: 0.0,
        ..Default::default()
    };
    let linkage = models::scenes::four_bar::FourBar::new(params).expect("in range");
    let mut run = Simulation::new(&linkage, Options::rattle(2e-3)).expect("options");
    run.set_joints(&[("crank_pin.angle", -1.0)])
        .expect("a linkage that closes");
    run.run(20.0).unwrap_or_else(|error| panic!("{error}"));
    let lost = run.imbalance().expect("a scene with an energy").relative();
    println!("{lost:e} {:?}", run.statistics());
    assert!(lost < 1e-6, "{lost:e}");
}

#[test]
fn what_cannot_run_backwards_is_refused_by_name() {
    let refused = |text: &str, options: Options| {
        let model = interpreted(text);
        let error = Simulation::new(&model, options).err().expect("refused");
        assert_eq!(error.cause.status(), "unsupported");
        format!("{}; {}", error.cause, error.cause.advice())
    };
    for kind in ["rate", "stepwise"] {
        let text = STATIC
            .replace("equilibrium: static", &format!("equilibrium: {kind}"))
            .replace("N/m }", "N/m, damping: 10 N*s/m }");
        let told = refused(&text, Options::rattle(0.01));
        assert!(
            told.contains("Rattle with the node `knot`") && told.contains("`static`"),
            "{told}"
        );
    }
    let none = Options {
        stabilise: Stabilise::None,
        ..Options::rattle(0.01)
    };
    let told = refused(DOUBLE, none);
    assert!(told.contains("Stabilise::Projection"), "{told}");
    let single = Generic::<f32>::with_defaults(read(DOUBLE)).expect("no params");
    let told = Simulation::new(&single, Options::rattle(0.01))
        .err()
        .expect("refused");
    assert!(
        told.to_string().contains("f32") && told.to_string().contains("f64"),
        "{told}"
    );
}

#[test]
fn steps_too_long_for_a_damper_or_a_spring_say_so() {
    let hung = |stiffness: f64, damping: f64| {
        format!(
        "model Hung {{ gravity: [0, 0, -9.81] m/s^2; point bob {{ mass: 1 kg, start at [0.1, 0, -1.2] m }}
         spring s from world to bob {{ free_length: 1 m, stiffness: {stiffness:e} N/m, damping: {damping:e} N*s/m }} }}"
    )
    };
    for (stiffness, damping) in [(100.0, 1e3), (1e6, 0.0), (1e6, 1e3), (1e5, 1.0)] {
        for watch in [true, false] {
            if !watch && damping < 1e3 {
                continue;
            }
            let model = interpreted(&hung(stiffness, damping));
            let options = Options {
                watch,
                ..Options::rattle(0.01)
            };
            let mut run = Simulation::new(&model, options).expect("options");
            let error = run.run(1.0).expect_err("too long");
            println!("{stiffness:e} {damping:e} {watch}: {error}");
            let StepError::UnstableStep { suggestion, .. } = error.cause else {
                panic!("{error}");
            };
            assert!(suggestion < 0.01, "{error}");
        }
    }
    // Prescribed motions are not judged by their energy: how forces change along the motion shows it.
    let driven = DRIVEN.replace(
        "joint q",
        "point bob { mass: 1 kg, start at [0, 0, -2] m }
         spring s from b.com to bob { free_length: 1 m, stiffness: 2e5 N/m } joint q",
    );
    let mut run = Simulation::new(&interpreted(&driven), Options::rattle(0.01)).expect("options");
    let told = run.run(1.0).expect_err("too long").to_string();
    assert!(told.contains("step times rate is"), "{told}");
    // Where they fit they are right.
    let model = interpreted(&hung(100.0, 10.0));
    let run = end(&model, Options::rattle(0.01), 1.0);
    let off = largest_difference(&run, &end(&model, Options::vern7(1e-12), 1.0));
    assert!(off < 1e-4, "{off:e}");
}
