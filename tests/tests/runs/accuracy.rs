//! How accurate runs are, measured: the error that a run tells is its error, a run is tightened until its error is what was asked for, and advice
//! meets what it promises.

use mbd_runtime::{
    Content, Generic, Options, Question, Sampling, Simulation, TradeError, Trajectory, Variant,
    trade,
};
use tests::declared::read;

/// Scenes of every kind of motion: what is declared, the column that counts, the end [s], a step of RK4 that suits it [s].
const SCENES: &[(&str, &str, f64, f64)] = &[
    ("model Rope { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg, start at [0.9, 0, -0.6] m }
      spring rope from world to bob { free_length: 1 m, stiffness: 200 N/m, damping: 1 N*s/m } }", "bob.z", 3.0, 0.01),
    ("model Bounce { gravity: [0, 0, -9.81] m/s^2; point bob { mass: 1 kg, start at [0, 0, -0.5] m }
      line rope from world to bob { free_length: 1 m, stiffness: 2 kN/m, damping: 4 N*s/m } }", "bob.z", 2.0, 0.004),
    ("model Tumble { gravity: none;
      body b { mass: 1 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame eye at [0.3, 0.2, 0.1] m, start at [1, 0.2, 0] m }
      joint loose: free from world to b.com;
      spring s from world to b.eye { free_length: 0.5 m, stiffness: 20 N/m, damping: 0 N*s/m } }",
        "b.y",
        4.0,
        0.02,
    ),
    ("model Chain { gravity: [0, 0, -9.81] m/s^2;
      body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
      body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
      joint p: hinge from world to a.top { axis: y, start: 1.0 rad }
      joint q: hinge from a.end to b.top { axis: y, start: 0.5 rad } }", "b.x", 3.0, 0.01),
    ("model Damped { gravity: [0, 0, -9.81] m/s^2;
      body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
      joint pin: hinge from world to arm.top { axis: y, damping: 0.2 N*m*s, stiffness: 2 N*m, start: 1.2 rad } }", "arm.x", 4.0, 0.02),
    ("model Drag { gravity: [0, 0, -9.81] m/s^2; point stone { mass: 1 kg, start at [0, 0, 0] m velocity [20, 0, 20] m/s }
      load drag on stone = -0.05 kg/m * norm(stone.velocity) * stone.velocity; }", "stone.x", 3.0, 0.05),
    ("model Servo { gravity: [0, 0, -9.81] m/s^2;
      body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
      body bob { mass: 0.5 kg, inertia: diag(0.02, 0.02, 0.02) kg*m^2, frame top at [0, 0, 0.3] m }
      joint pin: hinge from world to arm.top { axis: y, motor: 0.5 rad * sin(2 rad/s * time) }
      joint ball: spherical from arm.end to bob.top; }", "bob.z", 4.0, 0.01),
    ("model Stops { gravity: [0, 0, -9.81] m/s^2; body b { mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }
      joint rail: prismatic from world to b.com { axis: z, stops: [-0.3 m, 1 m], stop_stiffness: 3 kN/m, stop_damping: 20 N*s/m } }", "b.z", 1.0, 0.002),
];

fn methods(step: f64) -> [Options; 6] {
    [
        Options::rk4(step),
        Options::rk4(step / 4.0),
        Options::tsit5(1e-4),
        Options::tsit5(1e-7),
        Options::vern7(1e-6),
        Options::rodas5p(1e-5),
    ]
}

/// A scene as something to run, and its column at the times of the question.
struct Asked<'a> {
    model: &'a Generic<f64>,
    variant: Variant<'a>,
    question: Question,
    /// A step that suits it [s].
    step: f64,
}

impl Asked<'_> {
    fn column(&self, options: Options) -> Vec<f64> {
        let Question {
            column,
            window: [from, to],
            samples,
        } = &self.question;
        let last = samples - 1;
        let times = (0..=last).map(|k| from + (to - from) * k as f64 / last as f64);
        let mut run = Simulation::new(self.model, options).expect("a method");
        let times = Sampling::At(times.collect());
        let content = Content {
            energy: false,
            reactions: false,
            ..Content::ALL
        };
        let mut history = Trajectory::new(self.model, times, content);
        run.record(*to, &mut history).expect("a run");
        history.column(column).expect("a column").to_vec()
    }

    /// The truth, as far as numbers go: once a scene.
    fn reference(&self) -> Vec<f64> {
        self.column(Options::vern7(1e-13))
    }

    /// How far a run is from it, the root of the mean square.
    fn truth(&self, options: Options, reference: &[f64]) -> f64 {
        let found = self.column(options);
        assert_eq!(found.len(), reference.len());
        let squares = found.iter().zip(reference).map(|(a, b)| (a - b) * (a - b));
        (squares.sum::<f64>() / found.len() as f64).sqrt()
    }
}

/// Calls with a scene as something to run.
fn each(mut visit: impl FnMut(&Asked<'_>)) {
    for &(text, column, until, step) in SCENES {
        let model = Generic::<f64>::with_defaults(read(text)).expect("defaults");
        visit(&Asked {
            variant: Variant::new(column, &model, |_: &mut Simulation<f64>| Ok(())),
            model: &model,
            question: Question::new(column, [0.0, until]),
            step,
        });
    }
}

#[test]
fn the_error_that_is_told_is_within_a_factor_of_three_of_the_truth() {
    let (mut all, mut within) = (0, 0);
    each(|asked| {
        let (variant, question, reference) = (&asked.variant, &asked.question, asked.reference());
        for options in methods(asked.step) {
            let told = variant.error(question, options).expect("a run").rms;
            let truth = asked.truth(options, &reference);
            let ratio = told / truth;
            println!(
                "{}, {}: {told:.2e} for {truth:.2e}",
                variant.name(),
                options.method
            );
            all += 1;
            within += i32::from((1.0 / 3.0..=3.0).contains(&ratio));
        }
    });
    assert!(all == 48 && within * 100 >= all * 95, "{within} of {all}");
}

#[test]
fn a_run_is_tightened_until_its_error_is_what_was_asked_for() {
    each(|asked| {
        let (variant, reference) = (&asked.variant, asked.reference());
        for options in [Options::rk4(20.0 * asked.step), Options::tsit5(1e-2)] {
            let found = variant
                .accurate_to(&asked.question, 1e-6, options)
                .expect("it can be reached");
            let truth = asked.truth(found.options, &reference);
            println!("{}: {} {truth:.1e}", variant.name(), found.options.method);
            assert!(truth < 2e-6, "{}: {truth:e}", variant.name());
        }
    });
}

#[test]
fn advice_keeps_what_it_promises() {
    each(|asked| {
        let variants = std::slice::from_ref(&asked.variant);
        let race = trade(variants, &asked.question).expect("a race");
        let advice = race.advise(1e-4).expect("1e-4 is not hard");
        assert!(advice.choice.error.rms <= 1e-4 / 3.0);
        // Nothing that is as good is cheaper in the same race.
        let cheaper = race
            .entries
            .iter()
            .filter(|entry| entry.error.rms <= 1e-4 / 3.0);
        assert!(
            cheaper
                .into_iter()
                .all(|entry| entry.seconds >= advice.choice.seconds)
        );
        // Errors fall along the front while its costs rise.
        let front = race.front(None);
        assert!(front.windows(2).all(
            |pair| pair[1].error.rms < pair[0].error.rms && pair[1].seconds >= pair[0].seconds
        ));
    });
}

#[test]
fn references_that_disagree_are_told_as_unresolved() {
    // A double pendulum from high up, when it has multiplied rounding by the size of its motion.
    let text = "model Wild { gravity: [0, 0, -9.81] m/s^2;
      body a { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }
      body b { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
      joint p: hinge from world to a.top { axis: y, start: 3.0 rad }
      joint q: hinge from a.end to b.top { axis: y, start: 0.1 rad } }";
    let model = Generic::<f64>::with_defaults(read(text)).expect("defaults");
    let variant = Variant::new("wild", &model, |_: &mut Simulation<f64>| Ok(()));
    let error = trade(&[variant], &Question::new("b.x", [30.0, 40.0])).expect_err("chaos");
    assert!(matches!(error, TradeError::Unresolved { .. }), "{error}");
}

/// A pulse of a Gauss curve that is about as long as a fixed step: a run sees half of it, and so does one with half the step. The change of the velocity is
/// F w √π. Of the one 0.2 s long at 10.05 s a sixteenth of the error was told.
#[test]
fn the_error_of_fixed_steps_that_half_see_a_pulse_is_told() {
    let mut seen = 0;
    for width in [0.1, 0.15, 0.2, 0.25, 0.3] {
        for instant in [10.0, 10.05, 10.1, 10.2, 10.25, 10.3, 10.45] {
            let text = format!(
                "model Pushed {{ gravity: none; point p {{ mass: 1 kg, start at [0, 0, 0] m velocity [100, 0, 0] m/s }}
                load push on p = [0 N, 10 N * exp(-((time - {instant} s) / ({width} s))^2), 0 N]; }}"
            );
            let model = Generic::<f64>::with_defaults(read(&text)).expect("defaults");
            let variant = Variant::new("p.vy", &model, |_: &mut Simulation<f64>| Ok(()));
            let question = Question::new("p.vy", [19.0, 20.0]);
            let told = variant.error(&question, Options::rk4(1.0)).expect("a run");
            let mut run = Simulation::new(&model, Options::rk4(1.0)).expect("a method");
            run.run(20.0).expect("a run");
            let speed = 10.0 * width * std::f64::consts::PI.sqrt();
            let truth = (run.state()[4] - speed).abs() / speed;
            let told = told.rms / speed;
            if truth > 0.02 {
                let ratio = told / truth;
                assert!(
                    (0.3..3.0).contains(&ratio),
                    "{width} s at {instant} s: {told} for {truth}"
                );
                seen += 1;
            }
        }
    }
    assert!(seen > 20, "{seen}");
}

/// A mass that a force of 2 N pushes: 2 J a metre. An adaptive run does not know its balance of energy without that work, and says so; what it would be with a
/// work of zero is as large as the energy.
#[test]
fn the_balance_of_energy_under_a_load_is_told_with_its_work_only() {
    let text =
        "model Pushed { gravity: none; point p { mass: 1 kg } load push on p = [2 N, 0 N, 0 N]; }";
    let model = Generic::<f64>::with_defaults(read(text)).expect("defaults");
    let balance = |options: Options| {
        let mut run = Simulation::new(&model, options).expect("a method");
        run.run(1.0).expect("a run");
        run.imbalance()
    };
    assert_eq!(balance(Options::tsit5(1e-8)), None);
    let with_work = Options {
        work: true,
        ..Options::tsit5(1e-8)
    };
    for options in [with_work, Options::rk4(0.01)] {
        let told = balance(options).expect("a balance");
        assert!(
            (told.moved - 2.0).abs() < 1e-9 && told.energy < 1e-9,
            "{told:?}"
        );
    }
}

/// An oscillation of 1 rad/s over a hundred seconds of ticks that end every step, and then even motion for a long time in a few steps: x = cos T − sin T (t − T).
/// A tenth of the tolerance makes the same ticks again: of an error of 5.6e-4 one of 5e-6 was told, of 3.2e-6 one of 8e-15.
#[test]
fn the_error_of_steps_that_ticks_end_is_told_beside_a_long_flight() {
    for period in [0.2, 0.4, 0.5, 0.6, 0.8] {
        let text = format!(
            "model Ticks {{ gravity: none;
                const T = {period} s;
                state alive = 1 {{ rate: 0 }}
                state next = T {{ rate: 0 }}
                state x = 1 {{ rate: v / (1 s) }}
                state v = 0 {{ rate: -x * alive / (1 s) }}
                point idle {{ mass: 1 kg }}
                event tick = time rises next {{ set: next = next + T * if(alive > 0.5, 1, 1e9) }}
                event off = time rises 100.2 s {{ set: alive = 0 }}
                output place = x; }}"
        );
        let model = Generic::<f64>::with_defaults(read(&text)).expect("defaults");
        let variant = Variant::new("place", &model, |_: &mut Simulation<f64>| Ok(()));
        let question = Question::new("place", [1999.0, 2000.0]);
        for tolerance in [1e-3, 1e-4] {
            let options = Options::tsit5(tolerance);
            let told = variant.error(&question, options).expect("a run").largest;
            let mut run = Simulation::new(&model, options).expect("a method");
            run.run(2000.0).expect("a run");
            let off: f64 = 100.2;
            let place = off.cos() - off.sin() * (2000.0 - off);
            let truth = (run.output("place").expect("declared") - place).abs();
            let ratio = told / truth;
            assert!(
                (0.8..1.25).contains(&ratio),
                "{period} s, {tolerance}: {told} for {truth}"
            );
        }
    }
}
