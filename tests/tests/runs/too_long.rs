//! Fixed steps that are too long for what they have to follow are found before the damage, with a good state to go on from; and the energy that a
//! run reports to have made or lost is what it made or lost.

use mbd_runtime::{
    Content, Generic, Instability, Model, Options, Quantity, Sampling, Scalar, Simulation,
    StepError, Trajectory, model,
};
use tests::declared::read;

/// The energy that a run may lose before it is stopped, over the energy that moved; at a state that it calls good a tenth of it.
const ALLOWED: f64 = 0.02;

/// A scene of the extremes: what is declared, where it starts by joint coordinates or by its state, a step that is too long and one that is not [s].
struct Extreme {
    what: &'static str,
    text: &'static str,
    /// Changes of the declared start.
    speeds: &'static [(usize, f64)],
    long: f64,
    short: f64,
    until: f64,
}

const FREE_BODY: &str = "model Free { gravity: none; body b { mass: 1 kg, inertia: diag(1, 2, 3) kg*m^2 } joint loose: free from world to b.com; }";

const EXTREMES: &[Extreme] = &[
    Extreme {
        what: "a free body at 1e4 rad/s, near its middle axis",
        text: FREE_BODY,
        speeds: &[(7 + 3, 10.0), (7 + 4, 1e4), (7 + 5, 10.0)],
        long: 1e-4,
        short: 2e-6,
        until: 0.1,
    },
    Extreme {
        what: "a chain of two",
        text: "model Chain { gravity: [0, 0, -9.81] m/s^2;
            body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
            body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
            joint p: hinge from world to a.top { axis: y, start: 1.5 rad }
            joint q: hinge from a.end to b.top { axis: y, start: 0.5 rad } }",
        speeds: &[],
        long: 0.1,
        short: 0.005,
        until: 20.0,
    },
    Extreme {
        what: "a chain of four of masses 1 to 1000",
        text: "model Uneven { gravity: [0, 0, -9.81] m/s^2;
            const M = 1 kg; const J = 0.1 kg*m^2;
            body a { mass: M, inertia: diag(J, J, J), frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
            body b { mass: 10 * M, inertia: diag(10 * J, 10 * J, J), frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
            body c { mass: 100 * M, inertia: diag(100 * J, 100 * J, J), frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
            body d { mass: 1000 * M, inertia: diag(J, J, J), frame top at [0, 0, 0.5] m }
            joint p: hinge from world to a.top { axis: y, start: 1.5 rad }
            joint q: hinge from a.end to b.top { axis: y, start: 0.5 rad }
            joint r: hinge from b.end to c.top { axis: y, start: 0.5 rad }
            joint s: hinge from c.end to d.top { axis: y, start: 0.5 rad } }",
        speeds: &[],
        long: 0.02,
        short: 5e-4,
        until: 5.0,
    },
    Extreme {
        what: "a point through a centre of gravity",
        text: "model Fall { gravity: point_mass { mu: 3.986e14 m^3/s^2, center: [0, 0, 0] m }; point p { mass: 1 kg } }",
        speeds: &[(0, 7e6), (4, 10.0)],
        long: 1.0,
        short: 1.0,
        until: 2000.0,
    },
    Extreme {
        what: "bouncing on a stiff line",
        text: "model Bounce { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg }
            line rope from world to bob { free_length: 1 m, stiffness: 1e6 N/m, damping: 0 N*s/m } }",
        speeds: &[],
        long: 1e-3,
        short: 1e-5,
        until: 3.0,
    },
    Extreme {
        what: "a spring at hω = 1, which fades without a damper",
        text: "model Fades { gravity: none; point bob { mass: 1 kg }
            spring s from world to bob { free_length: 1 m, stiffness: 1e4 N/m, damping: 0 N*s/m } }",
        speeds: &[(0, 1.1)],
        long: 1e-2,
        short: 1e-3,
        until: 5.0,
    },
    Extreme {
        what: "a damper that is too stiff",
        text: "model Damped { gravity: [0, 0, -9.81] m/s^2; body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
            joint rail: prismatic from world to b.com { axis: z, damping: 400 N*s/m } }",
        speeds: &[],
        long: 1e-2,
        short: 1e-3,
        until: 2.0,
    },
    Extreme {
        what: "a line that is stiffer than the step can follow by far",
        text: "model Gross { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg }
            line rope from world to bob { free_length: 1 m, stiffness: 1e8 N/m, damping: 10 N*s/m } }",
        speeds: &[(2, -1.001)],
        long: 0.1,
        short: 1e-5,
        until: 1.0,
    },
];

fn begin(extreme: &Extreme, step: f64) -> Simulation<f64> {
    let model = Generic::<f64>::with_defaults(read(extreme.text)).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(step)).expect("options");
    if !extreme.speeds.is_empty() {
        let mut state = run.state().to_vec();
        for (slot, value) in extreme.speeds {
            state[*slot] = *value;
        }
        run.set_state(0.0, &state).expect("a state");
    }
    run
}

#[test]
fn a_step_that_is_too_long_is_found_before_the_damage_whatever_moves() {
    for extreme in EXTREMES {
        let mut run = begin(extreme, extreme.long);
        let found = run.run(extreme.until).map_err(|error| error.cause);
        let Err(StepError::UnstableStep {
            time,
            step_size,
            suggestion,
            what,
        }) = found
        else {
            panic!("{}: {found:?}, {:?}", extreme.what, run.imbalance());
        };
        println!(
            "{}: {what} at {time} s, back to {} s, try {suggestion:.2e}",
            extreme.what,
            run.time()
        );
        assert!(
            run.time() < time && suggestion < step_size,
            "{}",
            extreme.what
        );
        // Where it stands nothing has grown.
        let kept = run.imbalance().expect("a balance");
        assert!(
            kept.relative() <= 0.1 * ALLOWED,
            "{}: {kept:?}",
            extreme.what
        );
        assert!(
            run.state().iter().all(|x| x.abs() < 1e8),
            "{}",
            extreme.what
        );
    }
}

#[test]
fn a_step_that_is_short_enough_is_left_alone() {
    for extreme in EXTREMES
        .iter()
        .filter(|extreme| extreme.short < extreme.long)
    {
        let mut run = begin(extreme, extreme.short);
        let ran = run.run(extreme.until);
        println!("{}: {:?}", extreme.what, run.imbalance());
        ran.unwrap_or_else(|error| panic!("{}: {error}", extreme.what));
        let kept = run.imbalance().expect("a balance").relative();
        assert!(kept < ALLOWED, "{}: {kept:e}", extreme.what);
    }
}

#[test]
fn the_run_stands_where_the_same_run_stopped_there_would_and_its_history_ends_there() {
    for extreme in EXTREMES {
        let mut run = begin(extreme, extreme.long);
        let model = run.model().clone();
        let mut history = Trajectory::new(&*model, Sampling::Steps, Content::ALL);
        run.record(extreme.until, &mut history)
            .expect_err("too long a step");
        let last = *history.times().last().expect("the start is a row");
        assert!(last <= run.time(), "{}: {last}", extreme.what);
        assert!(history.events.iter().all(|(at, _)| *at <= run.time()));

        let mut same = begin(extreme, extreme.long);
        same.start().expect("a start");
        while same.time() < run.time() {
            same.step().expect("a step before the growth");
        }
        assert_eq!(run.snapshot(), same.snapshot(), "{}", extreme.what);

        if extreme.short == extreme.long {
            continue;
        }
        // And it goes on with a step that is short enough.
        let mut shorter = begin(extreme, extreme.short);
        shorter
            .set_state(run.time(), run.state())
            .expect("a good state");
        let more = 10.0 * extreme.short;
        shorter.run(run.time() + more).expect("a short step");
    }
}

model! {
    /// A pendulum with friction, a drag and a motor, on a cart with a spring.
    pub model Machine<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: force = 3 N;
        body cart { mass: 2.0 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        body arm {
            mass: 1.0 kg,
            inertia: diag(0.1, 0.1, 0.01) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint rail: prismatic from world to cart.com {
            axis: x,
            stiffness: 40 N/m,
            damping: 2 N*s/m,
            start: 0.2 m,
        }
        joint pin: hinge from cart.com to arm.top {
            axis: y,
            damping: 0.05 N*m*s,
            force: 0.5 N*m * sin(3 rad/s * time),
            start: 1 rad,
        }
        load drag on arm = -0.2 kg/m * norm(arm.velocity) * arm.velocity;
        load by_hand on cart = [push, 0.0, 0.0];
    }
}

/// E and the work of all that gives and takes, by the integrals of the run.
fn made<T: Scalar>(model: &impl Model<T>, step: f64) -> [f64; 2] {
    let options = Options {
        work: true,
        ..Options::rk4(step)
    };
    let mut run = Simulation::new(model, options).expect("options");
    let total = |run: &mut Simulation<T>| -> f64 {
        let mut energy = [T::zero(); 6];
        run.evaluate(Quantity::Energy, &mut energy)
            .expect("an energy");
        energy[..3].iter().map(|part| part.to_f64()).sum()
    };
    let before = total(&mut run);
    run.run(4.0).expect("a run");
    let work: f64 = run.work().expect("asked for").iter().sum();
    let made = total(&mut run) - before - work;
    let told = run.imbalance().expect("a balance");
    assert!(
        told.energy >= made.abs() && told.moved > 1.0,
        "{told:?} {made}"
    );
    // Without the integrals of the run the work is as good.
    let mut lean = Simulation::new(model, Options::rk4(step)).expect("options");
    lean.run(4.0).expect("a run");
    let lean = lean.imbalance().expect("a balance");
    println!("{step}: {made:e}, {told:?}, lean {lean:?}");
    [told.relative(), lean.relative()]
}

#[test]
fn the_imbalance_is_what_the_steps_got_wrong_and_falls_with_the_fourth_power_of_them() {
    let machine = Machine::<f64>::new(MachineParams::default()).expect("defaults");
    let [coarse, fine] = [0.04, 0.02].map(|step| made(&machine, step));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(
            coarse < 1e-3 && (coarse / fine).log2() > 3.5,
            "{coarse} {fine}"
        );
    }
    // In single precision rounding is all that is left.
    let machine = Machine::<f32>::new(MachineParams::default()).expect("defaults");
    let [told, lean] = made(&machine, 0.01);
    assert!(told < 1e-4 && lean < 1e-4, "{told} {lean}");
}

#[test]
fn what_the_user_changes_is_no_error_of_the_run() {
    let machine = Machine::<f64>::new(MachineParams::default()).expect("defaults");
    let mut run = Simulation::new(&machine, Options::rk4(0.01)).expect("options");
    for tenth in 0..40 {
        let push = if tenth % 2 == 0 { 40.0 } else { -40.0 };
        run.set_inputs(&MachineInputs { push }).expect("an input");
        run.run(f64::from(tenth + 1) / 10.0).expect("a run");
    }
    let kept = run.imbalance().expect("a balance").relative();
    assert!(kept < 1e-4, "{kept:e}");
}

model! {
    /// A spring alone; what it emits leaves its energy out.
    model Lean {
        gravity: none;
        emit: [derivative];
        point bob { mass: 1.0 kg }
        spring s from world to bob { free_length: 1 m, stiffness: 1e4 N/m, damping: 0 N*s/m }
    }
}

#[test]
fn energy_that_is_not_emitted_is_read_by_the_laws_now_and_then() {
    let lean = Lean::new(LeanParams::default()).expect("defaults");
    let mut run = Simulation::new(&lean, Options::rk4(3e-3)).expect("options");
    run.set_state(0.0, &[1.1, 0.0, 0.0, 0.0, 0.0, 0.0])
        .expect("a state");
    // (hω)⁶/72 of the energy a step at hω = 0.3: 2 % after 1975 steps.
    let found = run.run(100.0).expect_err("too long a step").cause;
    let StepError::UnstableStep {
        what: Instability::Energy(part),
        time,
        ..
    } = found
    else {
        panic!("{found:?}");
    };
    let steps = time / 3e-3;
    assert!((part / -ALLOWED - 1.0).abs() < 0.05, "{part}");
    assert!((1900.0..2100.0).contains(&steps), "{steps}");
    assert!(run.time() < 0.15 * time);
}

/// A lamp on three lines from a knot without mass, ω about 32 rad/s: at hω ≈ 10 the lamp is kilometres away after two steps.
#[test]
fn a_run_of_one_step_or_two_is_none_of_steps_far_too_long() {
    let text = |emit: &str| {
        format!(
            "model Lamp {{ gravity: [0, 0, -9.81] m/s^2; {emit}
                world {{ frame left at [-1, 0, 2] m, frame right at [1.5, 0, 2.2] m }}
                point lamp {{ mass: 2 kg, start at [0.4, 0.3, 0.8] m }}
                point knot;
                line a from world.left to knot {{ free_length: 1.2 m, stiffness: 2 kN/m }}
                line b from world.right to knot {{ free_length: 1.6 m, stiffness: 2 kN/m }}
                line cord from knot to lamp {{ free_length: 0.5 m, stiffness: 2 kN/m }} }}"
        )
    };
    for emit in ["", "emit: [derivative];"] {
        let lamp = Generic::<f64>::with_defaults(read(&text(emit))).expect("defaults");
        // The first step of 0.3 s tightens a slack line: by itself its stages tell nothing.
        for (step, ends) in [
            (0.3, &[1.7, 2.0][..]),
            (0.5, &[1.0, 1.7, 2.0]),
            (1.0, &[0.5, 1.0, 1.7, 2.0]),
            (2.0, &[0.25, 0.5, 1.0, 1.5]),
        ] {
            for until in ends.iter().map(|end| end * step) {
                let mut run = Simulation::new(&lamp, Options::rk4(step)).expect("it fits");
                run.start().expect("it starts");
                let start = run.state().to_vec();
                let error = run.run(until).expect_err("hω is far beyond 2.8");
                assert!(
                    matches!(error.cause, StepError::UnstableStep { .. }),
                    "{step} {until}: {error}"
                );
                assert_eq!((run.time(), run.state()), (0.0, &start[..]), "{step}");
            }
        }
        // A step that is short enough may be the only one.
        for steps in 1..=3 {
            let mut run = Simulation::new(&lamp, Options::rk4(0.01)).expect("it fits");
            let stop = run.run(0.01 * f64::from(steps));
            stop.expect("hω is about 0.3");
        }
    }
}

/// What stages show of a rate saturates where it is far above the step: a damper of a million times the step is told from the linear system.
#[test]
fn the_step_that_is_suggested_is_one_that_holds() {
    let scenes = [
        ("a damped spring", "point p { mass: 1 kg, start at [1.1, 0, 0] m velocity [0.1, 0.2, 0] m/s } spring s from world to p { free_length: 1 m, stiffness: 1 kN/m, damping: DAMPING }"),
        ("a damped hinge", "body b { mass: 1 kg, inertia: diag(0.5, 0.5, 0.5) kg*m^2, frame f at [0, 0, 1] m } joint h: hinge from world to b.f { axis: y, start: 0.3 rad, stiffness: 100 N*m/rad, damping: DAMPING*m^2 }"),
        ("a taut line on a rate node", "point p { mass: 1 kg, start at [0, 0, -2.01] m } point k { equilibrium: rate } world { frame a at [1, 0, 0] m, frame b at [-0.5, 0.8, 0] m, frame c at [-0.5, -0.8, 0] m }
            line u from world.a to k { free_length: 1 m, stiffness: 1 kN/m, damping: 10 N*s/m } line v from world.b to k { free_length: 1 m, stiffness: 1 kN/m, damping: 10 N*s/m }
            line w from world.c to k { free_length: 1 m, stiffness: 1 kN/m, damping: 10 N*s/m } line d from k to p { free_length: 1 m, stiffness: 1 kN/m, damping: 10 N*s/m }
            spring s from world to p { free_length: 2 m, stiffness: 1 kN/m, damping: DAMPING }"),
    ];
    for (what, text) in scenes {
        for family in ["absolute", "relative"] {
            for damping in [1e4, 1e6, 1e8] {
                let text = text.replace("DAMPING", &format!("{damping:e} N*s/m"));
                let text = text.replace("N*s/m*m^2", "N*m*s");
                let scene = read(&format!(
                    "model Damped {{ coordinates: {family}; gravity: [0, 0, -9.81] m/s^2; {text} }}"
                ));
                let model = Generic::<f64>::with_defaults(scene).expect("defaults");
                let what = format!("{what}, {family}, {damping:e}");
                let mut run =
                    Simulation::new(&model, Options::rk4(1e-2)).expect("options that fit");
                let error = run.run(1.0).expect_err("far too long");
                let StepError::UnstableStep { suggestion, .. } = error.cause else {
                    panic!("{what}: {error}")
                };
                let mut again =
                    Simulation::new(&model, Options::rk4(suggestion)).expect("options that fit");
                again
                    .run(500.0 * suggestion)
                    .unwrap_or_else(|error| panic!("{what}: {suggestion} {error}"));
            }
        }
    }
}

/// Numbers between 0 and 1, the same ones in every run.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Eight kinds of things that move at a rate ω, of any mass and size, under steps of 3/ω to 100/ω.
#[test]
fn random_scenes_under_steps_that_are_too_long_are_all_stopped_soon() {
    let mut next = random(1);
    let (mut stopped, mut late) = (0, 0_u64);
    for number in 0..1000 {
        let mut power = |from: f64, to: f64| 10f64.powf(from + (to - from) * next());
        let (m, l, w, too_long) = (
            power(-3.0, 3.0),
            power(-2.0, 2.0),
            power(-1.0, 3.0),
            power(0.5, 2.0),
        );
        let part = power(-1.0, 1.0);
        let (k, c, j) = (m * w * w, m * w, m * l * l);
        let g = w * w * l;
        let rail = "coordinates: absolute; gravity: none; body b { mass: M kg, inertia: diag(J, J, J) kg*m^2 } joint r: prismatic from world to b.com";
        let rail = rail
            .replace('M', &m.to_string())
            .replace('J', &j.to_string());
        let text = match number % 8 {
            0 => format!("gravity: none; point p {{ mass: {m} kg, start at [{}, 0, 0] m }}
                spring s from world to p {{ free_length: {l} m, stiffness: {k} N/m, damping: {} N*s/m }}", 1.1 * l, 0.1 * part * c),
            1 => format!("{rail} {{ axis: x, damping: {c} N*s/m, start_rate: {} m/s }}", l * w),
            2 => format!("{rail} {{ axis: x, stiffness: {k} N/m, damping: {} N*s/m, start: {l} m }}", 0.1 * part * c),
            3 => format!("gravity: none; body b {{ mass: {m} kg, inertia: diag({j}, {}, {}) kg*m^2, start at [0, 0, 0] m angular_velocity [{}, {w}, {}] rad/s }}
                joint f: free from world to b.com;", 2.0 * j, 2.5 * j, 0.3 * w, 0.2 * w),
            4 => format!("gravity: [0, 0, -{g}] m/s^2; body a {{ mass: {m} kg, inertia: diag({j}, {j}, {j}) kg*m^2, frame top at [0, 0, {l}] m, frame end at [0, 0, -{l}] m }}
                body b {{ mass: {} kg, inertia: diag({j}, {j}, {j}) kg*m^2, frame top at [0, 0, {l}] m }}
                joint p: hinge from world to a.top {{ axis: y, start: 1.5 rad }} joint q: hinge from a.end to b.top {{ axis: y, start: 0.5 rad }}", m * part),
            5 => format!("gravity: point_mass {{ mu: {} m^3/s^2, center: [0, 0, 0] m }}; point p {{ mass: {m} kg, start at [{l}, 0, 0] m velocity [0, {}, 0] m/s }}", w * w * l.powi(3), 0.3 * w * l),
            6 => format!("gravity: [0, 0, -{}] m/s^2; point p {{ mass: {m} kg, start at [0, 0, -{}] m }}
                line s from world to p {{ free_length: {l} m, stiffness: {k} N/m, damping: {} N*s/m }}", 0.01 * g, 1.05 * l, 0.1 * part * c),
            _ => format!("gravity: none; point p {{ mass: {m} kg, start at [0, 0, 0] m velocity [{}, 0, 0] m/s }} state s: length = {l} m {{ rate: (p.position.x - s) * {w} (1/s) }}", l * w),
        };
        let step = too_long / w;
        let model = Generic::<f64>::with_defaults(read(&format!("model Random {{ {text} }}")))
            .expect("defaults");
        let mut run = Simulation::new(&model, Options::rk4(step)).expect("options");
        let ended = run.run(200.0 * step).map_err(|error| error.cause);
        let Err(StepError::UnstableStep {
            time, suggestion, ..
        }) = ended
        else {
            panic!("{text}: h ω = {too_long}: {ended:?}, {:?}", run.imbalance());
        };
        assert!(
            time <= 50.5 * step && run.time() < time && suggestion < step,
            "{text}: {time} of {step}"
        );
        assert!(run.state().iter().all(|x| x.is_finite()));
        stopped += 1;
        late = late.max((time / step).round() as u64);
    }
    println!("{stopped} stopped, after {late} steps at most");
}
