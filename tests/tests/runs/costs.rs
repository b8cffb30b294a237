//! What steps cost at equal error, counted in evaluations.

use mbd_runtime::{
    Generic, Method, Options, Question, RunError, Scales, Simulation, StepError, Variant,
};
use tests::declared::read;

/// A linkage that spins, and nods on a spring and a damper: λ = 5e3 1/s where it is damped so much that it creeps, and 1900 rad/s where it swings.
fn spinning(damping: f64) -> Generic<f64> {
    let text = format!(
        "model Spin {{ gravity: [0, 0, -9.81] m/s^2;
          body hub {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame tip at [0.5, 0, 0] m }}
          body arm {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [-0.5, 0, 0] m }}
          joint pin: hinge from world to hub.com {{ axis: z, start_rate: 10 rad/s }}
          joint elbow: hinge from hub.tip to arm.root {{ axis: y, stiffness: 1e6 N*m, damping: {damping} N*m*s }}
          output tip = arm.com.position.x; output nod = elbow.angle; }}"
    );
    Generic::with_defaults(read(&text)).expect("defaults")
}

/// Steps, rejected ones among them, and evaluations of a run over a fifth of a second; `None` where its step is too long.
fn cost(model: &Generic<f64>, options: Options) -> Option<[u64; 2]> {
    let mut run = Simulation::new(model, options).expect("a method");
    run.run(0.2).ok()?;
    let statistics = run.statistics();
    Some([statistics.steps + statistics.rejected, statistics.rhs])
}

/// Its error, of the angle of the spring [rad].
fn error(model: &Generic<f64>, options: Options) -> f64 {
    let variant = Variant::new("nod", model, |_: &mut Simulation<f64>| Ok(()));
    let question = Question::new("nod", [0.0, 0.2]);
    variant.error(&question, options).expect("a run").rms
}

/// Where stability alone bounds steps, on a mode that creeps and on one that swings, those of Tsit5 are two thirds as long as the longest of RK4, or longer; where
/// the swing is followed RK4 does no better with as many evaluations.
#[test]
fn adaptive_steps_on_stiff_modes_are_not_half_as_long_as_fixed_ones() {
    for damping in [2e3, 20.0] {
        let model = spinning(damping);
        let steps = (0..16).map(|k| 2e-3 * 0.9f64.powi(k));
        let longest = steps.filter_map(|step| cost(&model, Options::rk4(step)));
        let [longest, _] = longest.min().expect("a step that is short enough");
        for rtol in [1e-2, 1e-4] {
            let [adaptive, _] = cost(&model, Options::tsit5(rtol)).expect("a run");
            println!("{damping}: {rtol:e}: {adaptive} steps for {longest}");
            assert!(
                2 * adaptive <= 3 * longest,
                "{damping}: {rtol:e}: {adaptive}, {longest}"
            );
        }
    }
    let model = spinning(20.0);
    let adaptive = Options::tsit5(1e-7);
    let [_, evaluations] = cost(&model, adaptive).expect("a run");
    let fixed = Options::rk4(0.2 * 4.0 / evaluations as f64);
    let [adaptive, fixed] = [adaptive, fixed].map(|options| error(&model, options));
    println!("{evaluations} evaluations: {adaptive:.1e} rad, RK4 {fixed:.1e} rad");
    assert!(adaptive <= fixed, "{adaptive:e} {fixed:e}");
}

/// Kepler's ellipse with e = 0.3 over more than a turn, in even steps: every error passes, and the largest step is the step.
#[test]
fn tsit5_has_the_order_five() {
    let text = "model Orbit { gravity: point_mass { mu: 1 m^3/s^2, center: [0, 0, 0] m };
        point p { mass: 1 kg, start at [1.3, 0, 0] m velocity [0, sqrt(0.7 / 1.3) * 1 m/s, 0 m/s] } }";
    let model = Generic::<f64>::with_defaults(read(text)).expect("defaults");
    let end = |options: Options| {
        let mut run = Simulation::new(&model, options).expect("a method");
        run.run(8.0).expect("a run");
        run.state().to_vec()
    };
    let exact = end(Options::vern7(1e-13));
    let large = 1e6;
    let scales = Scales {
        length: large,
        angle: large,
        speed: large,
        rate: large,
        energy: large,
        state: large,
    };
    let errors = [0.025, 0.0125, 0.00625].map(|step| {
        let method = Method::Tsit5 {
            rtol: 0.01,
            max_step: step,
        };
        let found = end(Options {
            scales: Some(scales),
            ..Options::of(method)
        });
        let squares = found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>().sqrt()
    });
    let orders: Vec<f64> = errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect();
    println!("{errors:?} {orders:?}");
    assert!(
        orders.iter().all(|order| (order - 5.0).abs() < 0.15),
        "{orders:?}"
    );
}

/// 1e300 in every slot of the options: refused by name before a step, or a run that is right or ends with a cause.
#[test]
fn numbers_beyond_any_scene_in_steps_and_tolerances_give_no_wrong_numbers() {
    let model = spinning(20.0);
    let large = 1e300;
    let slot = |options: Options| match Simulation::new(&model, options).map(drop) {
        Err(RunError {
            cause: StepError::InvalidInput { slot, value },
            ..
        }) if value == large => slot,
        other => panic!("{other:?}"),
    };
    for word in Method::ADAPTIVE {
        let method = Method::adaptive(word, large).expect("a method");
        assert!(slot(Options::of(method)).starts_with("rtol"), "{word}");
    }
    assert!(
        slot(Options {
            max_angle: large,
            ..Options::tsit5(1e-6)
        })
        .starts_with("max_angle")
    );
    // A step that is longer than the run is one of the run, which is too long here.
    for options in [Options::rk4(large), Options::rattle(large)] {
        let mut run = Simulation::new(&model, options).expect("a positive step");
        let before = run.state().to_vec();
        let error = run.run(1.0).expect_err("too long").cause;
        assert!(
            matches!(
                error,
                StepError::UnstableStep { .. } | StepError::JointsApart { .. }
            ),
            "{error:?}"
        );
        assert_eq!(run.state(), before);
    }
    // A largest step that bounds nothing is none, and a guard tolerance that nothing passes locates nothing.
    let tip = |options: Options| {
        let mut run = Simulation::new(&model, options).expect("a method");
        run.run(0.1).expect("a run");
        run.output("tip").expect("declared")
    };
    let without = tip(Options::tsit5(1e-8));
    assert_eq!(
        tip(Options::of(Method::Tsit5 {
            rtol: 1e-8,
            max_step: large
        })),
        without
    );
    assert_eq!(
        tip(Options {
            guard_tolerance: Some(large),
            ..Options::tsit5(1e-8)
        }),
        without
    );
    // And what is as small ends at once, with a cause.
    for options in [
        Options::tsit5(1e-300),
        Options::of(Method::Tsit5 {
            rtol: 1e-8,
            max_step: 1e-300,
        }),
        Options::rk4(1e-300),
    ] {
        let mut run = Simulation::new(&model, options).expect("a positive number");
        let error = run.run(0.1).expect_err("no step is made").cause;
        assert!(matches!(error, StepError::StepCollapse { .. }), "{error:?}");
    }
}
