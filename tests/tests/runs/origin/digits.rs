//! Closed forms far away: what a pair does at the origin it does there.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Model, Options, Quantity, Scalar, Simulation, StepError, model};
use tests::declared::read;

model! {
    /// Two points on a spring that fall freely, far from the world's origin.
    pub model Pair<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        origin: follows left;
        param away = 1000000000 m;
        param speed = 7600 m/s;
        point left { mass: 2 kg, start at [away, 0 m, away] velocity [speed, 0 m/s, 0 m/s] }
        point right {
            mass: 3 kg,
            start at [away + 1.25 m, 0 m, away] velocity [speed, 0 m/s, 0 m/s],
        }
        spring tie from left to right { free_length: 1 m, stiffness: 120 N/m }
        output stretch = tie.stretch;
        output gap = right.position - left.position;
        output place = right.position;
    }
}

model! {
    /// The same around a planet.
    pub model Orbit {
        gravity: point_mass { mu: 398600441800000 m^3/s^2, center: [0, 0, 0] m };
        origin: follows left;
        point left { mass: 2 kg, start at [1000000000, 0, 0] m velocity [0, 631.3481146, 0] m/s }
        point right {
            mass: 3 kg,
            start at [1000000001.25, 0, 0] m velocity [0, 631.3481146, 0] m/s,
        }
        spring tie from left to right { free_length: 1 m, stiffness: 120 N/m }
        output stretch = tie.stretch;
        output gap = right.position - left.position;
        output place = right.position;
    }
}

/// The stretch [m] of the spring of 120 N/m between 2 kg and 3 kg that was let go at 0.25 m: ω² = k (1/m₁ + 1/m₂) = 100/s².
fn stretch(time: f64) -> f64 {
    0.25 * (10.0 * time).cos()
}

/// The largest error of the stretch [m] at some times, of the output and of the gap that positions have.
fn error<T: Scalar>(model: &dyn Model<T>, options: Options, until: f64) -> f64 {
    let mut run = Simulation::new(model, options).expect("options");
    let mut outputs = vec![T::zero(); model.layout().len(Quantity::Outputs)];
    let mut worst: f64 = 0.0;
    for k in 1..=20 {
        let time = until * f64::from(k) / 20.0;
        run.run(time).unwrap_or_else(|error| panic!("{error}"));
        run.evaluate(Quantity::Outputs, &mut outputs)
            .expect("outputs");
        let found = outputs[0].to_f64();
        let gap = outputs[1]
            .to_f64()
            .hypot(outputs[2].to_f64())
            .hypot(outputs[3].to_f64())
            - 1.0;
        for found in [found, gap] {
            worst = worst.max((found - stretch(time)).abs());
        }
    }
    worst
}

#[test]
fn a_pair_far_away_swings_with_the_frequency_and_the_amplitude_it_has_at_the_origin() {
    let pair = Pair::new(PairParams::<f64>::default()).expect("defaults");
    let orbit = Orbit::new(OrbitParams::default()).expect("defaults");
    for generated in [&pair as &dyn Model<f64>, &orbit] {
        let scene = generated.scene().clone();
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("defaults");
        let interpreted = Interpreted::<f64>::new(scene, generated.params()).expect("defaults");
        for model in [generated, &generic, &interpreted] {
            for options in [
                Options::vern7(1e-13),
                Options::rodas5p(1e-11),
                Options::rk4(2e-4),
            ] {
                let error = error(model, options, 2.0);
                assert!(
                    error < 1e-10 * 0.25 * 10.0,
                    "{} {error:e}",
                    generated.scene().name
                );
            }
        }
    }
}

#[test]
fn without_an_origin_of_its_own_the_pair_loses_its_digits_there() {
    let mut scene = Pair::<f64>::scene();
    scene.runs.origin = None;
    let model = Generic::<f64>::with_defaults(scene).expect("defaults");
    let error = error(&model, Options::vern7(1e-10), 2.0);
    assert!(error > 1e-8, "{error:e}");
}

#[test]
fn where_a_run_is_refused_for_its_digits_the_remedy_is_an_origin_that_follows() {
    let mut scene = Pair::<f64>::scene();
    let far = [1e15, 7600.0];
    let following = Generic::new(scene.clone(), &far).expect("accepted");
    // Numbers are 1/8 m apart there: 1.25 m is one of them.
    assert!(error(&following, Options::vern7(1e-13), 2.0) < 1e-10 * 0.25 * 10.0);
    scene.runs.origin = None;
    let staying = Generic::new(scene, &far).expect("accepted");
    let mut run = Simulation::new(&staying, Options::vern7(1e-10)).expect("options");
    let cause = run.run(2.0).expect_err("no digits").cause;
    assert!(
        matches!(cause, StepError::FarFromOrigin { .. }),
        "{cause:?}"
    );
    let said = mbd_runtime::RunError {
        cause,
        progress: Box::default(),
    }
    .to_string();
    assert!(said.contains("`origin: follows NAME;`"), "{said}");
}

#[test]
fn in_single_precision_it_swings_as_numbers_of_that_precision_do() {
    let params = |away: f32| PairParams::<f32> { away, speed: 300.0 };
    let far = Pair::<f32>::new(params(131_072.0)).expect("accepted");
    let near = Pair::<f32>::new(params(0.0)).expect("accepted");
    let generic = Generic::<f32>::new(Pair::<f32>::scene(), far.params()).expect("accepted");
    let [far, near, generic] = [&far as &dyn Model<f32>, &near, &generic]
        .map(|model| error(model, Options::rk4(1e-3), 1.0));
    assert!(
        far < 4e-6 && generic < 4e-6 && near < 4e-6,
        "{far:e} {generic:e} {near:e}"
    );
}

#[test]
fn what_is_tied_to_the_world_far_away_is_refused_with_an_origin_that_follows_too() {
    let run = |far: f64| {
        let scene = read(&format!(
            "model Hanging {{ gravity: [0, 0, -9.81] m/s^2; origin: follows bob;
             world {{ frame hook at [{far:?}, 0, 0] m }}
             point bob {{ mass: 1 kg, start at [{far:?}, 0, -1] m }}
             spring rope from world.hook to bob {{ free_length: 1 m, stiffness: 1e6 N/m, damping: 10 N*s/m }} }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::tsit5(1e-5)).expect("options");
        let result = run.run(0.1).map_err(|error| error.cause);
        (result, run.rounding())
    };
    let (near, share) = run(1e6);
    assert!(near.is_ok());
    assert!(
        (share / (f64::EPSILON * 1e6 * 1e6 / 9.81) - 1.0).abs() < 0.01,
        "{share:e}"
    );
    let (far, _) = run(1e12);
    assert!(
        matches!(far, Err(StepError::FarFromOrigin { ref part, distance, .. }) if part == "bob" && distance > 0.9e12),
        "{far:?}"
    );
}

/// What is measured from an origin that moves depends on time, which a method that asks for derivatives must know: without them its order is two.
#[test]
fn a_stiff_method_keeps_its_order_with_an_origin_that_moves() {
    let steps = |origin: &str, tolerance: f64| {
        let scene = read(&format!(
            "model Orbit {{ {origin} gravity: none; const mu = 3.986004418e14 m^3/s^2;
                point a {{ mass: 1 kg, start at [7000, 0, 0] km velocity [0, 7.546, 0] km/s }}
                load pull on a = -mu * 1 kg * a.position / norm(a.position)^3; }}"
        ));
        let model = Generic::<f64>::with_defaults(scene).expect("defaults");
        let mut run = Simulation::new(&model, Options::rodas5p(tolerance)).expect("options");
        run.run(100.0).unwrap_or_else(|error| panic!("{error}"));
        run.statistics().steps
    };
    for tolerance in [1e-4, 1e-6] {
        let (still, moving) = (steps("", tolerance), steps("origin: follows a;", tolerance));
        assert!(moving <= still + still / 4, "{moving} {still}");
    }
}
