//! The scene of AAS 03-163 against independent reference histories, and the order of every method.

use mbd_runtime::Options;
use models::parachute::scene::{
    ParachuteRate, ParachuteRateParams, ParachuteStepwise, ParachuteStepwiseParams, SceneInstant,
    TestCase,
};
use models::parachute::stability::largest_taut_step;
use models::parachute::variant::{Confluence, Damping, Flight, FlightPlan, fly, fly_model};
use tests::cores::on_all_cores;
use tests::reference::{field, load};

/// A flight sampled at the times of a reference file, up to `until`.
fn flight(
    case: TestCase,
    confluence: Confluence,
    options: Options,
    name: &str,
    until: f64,
) -> (Flight, Vec<f64>, Vec<f64>, f64) {
    let reference = load(&format!("parachute/{name}.json"));
    let times: Vec<f64> = field(&reference, "t")
        .into_iter()
        .filter(|t| *t <= until)
        .collect();
    let force = field(&reference, "riser_force");
    let uncertainty = &reference["uncertainty"];
    let late = uncertainty["force_t_gt_2"].as_f64().unwrap_or(0.0);
    let bound = uncertainty["force_t_le_2"]
        .as_f64()
        .expect("the file states it")
        .max(late);
    let end = times.last().copied().expect("a history has rows");
    let flight = fly(&FlightPlan::new(case, confluence, options, end).sampled(&times))
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    (flight, times, force, bound)
}

/// The largest difference of the riser force between two times.
fn largest(flight: &Flight, force: &[f64], window: [f64; 2]) -> f64 {
    let rows = flight.times().iter().zip(flight.riser()).zip(force);
    rows.filter(|((t, _), _)| (window[0]..=window[1]).contains(*t))
        .fold(0.0, |m, ((_, a), b)| f64::max(m, (a - b).abs()))
}

#[test]
fn riser_force_of_a_point_with_mass_is_that_of_the_reference() {
    for (case, kg, name) in [
        (TestCase::Two, 1.0, "case2_mass_1kg"),
        (TestCase::Two, 0.1, "case2_mass_0p1kg"),
        (TestCase::Three, 0.1, "case3_mass_0p1kg"),
    ] {
        let confluence = Confluence::Mass(kg, Damping::On);
        let (flight, _, force, bound) = flight(case, confluence, Options::tsit5(1e-11), name, 70.0);
        let error = largest(&flight, &force, [0.0, 70.0]);
        println!("{name}: {error:e} N, {:?}", flight.statistics);
        assert!(
            error <= 10.0 * bound,
            "{name}: riser force off by {error:e} N, stated uncertainty {bound:e} N"
        );
    }
}

#[test]
fn undamped_point_with_mass_follows_the_reference_until_chaos_sets_in() {
    let confluence = Confluence::Mass(1.0, Damping::Off);
    let (flight, _, force, _) = flight(
        TestCase::Three,
        confluence,
        Options::tsit5(1e-11),
        "case3_mass_C0_1kg",
        1.0,
    );
    let error = largest(&flight, &force, [0.0, 1.0]);
    // The two tolerances of the reference itself part by 1e-5 N at 1.18 s.
    assert!(error <= 1e-4, "riser force off by {error:e} N before 1 s");
}

#[test]
fn riser_force_of_the_static_equilibrium_point_is_that_of_the_reference() {
    for (case, name) in [
        (TestCase::Two, "case2_eq_C0"),
        (TestCase::Three, "case3_eq_C0"),
    ] {
        let (flight, _, force, bound) =
            flight(case, Confluence::Static, Options::tsit5(2e-13), name, 70.0);
        let error = largest(&flight, &force, [0.0, 70.0]);
        println!("{name}: {error:e} N, {:?}", flight.statistics);
        assert!(
            error <= 10.0 * bound,
            "{name}: riser force off by {error:e} N, stated uncertainty {bound:e} N"
        );
    }
}

#[test]
fn riser_force_of_the_rate_equilibrium_point_is_that_of_the_reference() {
    let (flight, _, force, bound) = flight(
        TestCase::Two,
        Confluence::Rate,
        Options::tsit5(1e-11),
        "case2_damped",
        70.0,
    );
    let late = largest(&flight, &force, [1.0, 70.0]);
    println!(
        "rate: {late:e} N after 1 s, {:e} before, {:?}",
        largest(&flight, &force, [0.0, 1.0]),
        flight.statistics
    );
    assert!(
        late <= 10.0 * bound,
        "riser force off by {late:e} N after 1 s, stated uncertainty {bound:e} N"
    );
}

/// Case 3, all lines taut, from 5 s.
fn taut_swing() -> SceneInstant {
    fly(&FlightPlan::new(
        TestCase::Three,
        Confluence::Rate,
        Options::tsit5(1e-11),
        5.0,
    ))
    .expect("case 3 flies")
    .end
}

/// Observed orders of the riser force and the capsule's position over a taut swing of 2 s, from three steps.
fn orders(confluence: Confluence, steps: [f64; 3]) -> [f64; 2] {
    let from = taut_swing();
    let times: Vec<f64> = (1..=10).map(|i| 5.0 + 0.2 * f64::from(i)).collect();
    let end = |confluence: Confluence, options: Options| {
        let plan = FlightPlan {
            from: from.clone(),
            ..FlightPlan::new(TestCase::Three, confluence, options, 7.0)
        };
        fly(&plan.sampled(&times)).unwrap_or_else(|error| panic!("{confluence}: {error}"))
    };
    let exact = end(confluence.exact(), Options::tsit5(1e-12));
    let errors = steps.map(|step| {
        let flight = end(
            confluence,
            Options {
                locate: false,
                ..Options::rk4(step)
            },
        );
        let position = (0..3)
            .map(|i| (flight.end.q[7 + i] - exact.end.q[7 + i]).abs())
            .fold(0.0, f64::max);
        [
            flight
                .riser()
                .iter()
                .zip(exact.riser())
                .skip(1)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max),
            position,
        ]
    });
    println!("{confluence}: force and position errors {errors:?} at steps {steps:?}");
    [0, 1].map(|i| ((errors[0][i] / errors[2][i]).ln()) / (steps[0] / steps[2]).ln())
}

#[test]
fn a_rate_node_keeps_the_order_of_runge_kutta() {
    let [force, position] = orders(Confluence::Rate, [0.01, 0.005, 0.0025]);
    assert!(
        force >= 3.8 && position >= 3.8,
        "order {force} in the force, {position} in the position"
    );
}

#[test]
fn a_static_node_keeps_the_order_of_runge_kutta() {
    let [force, _] = orders(Confluence::Static, [0.01, 0.005, 0.0025]);
    assert!(force >= 3.8, "order {force} in the force");
}

#[test]
fn the_first_order_difference_has_order_one_and_bdf2_order_two() {
    let [force, _] = orders(Confluence::Euler, [0.0025, 0.00125, 0.000_625]);
    assert!((0.9..1.3).contains(&force), "Euler: order {force}");
    let [force, _] = orders(Confluence::Stepwise, [0.005, 0.0025, 0.00125]);
    assert!(force >= 1.8, "BDF2: order {force}");
}

#[test]
fn steady_riser_force_is_the_weight_of_the_capsule() {
    let flight = fly(&FlightPlan::new(
        TestCase::Two,
        Confluence::Stepwise,
        Options::rk4(0.01),
        100.0,
    ))
    .expect("case 2 flies");
    let distance = 3_404_590.0 + flight.end.q[9];
    let weight = 761.0 * 4.2828e13 / (distance * distance);
    let force = flight.riser().last().copied().expect("one row");
    assert!(
        (force / weight - 1.0).abs() <= 1e-3,
        "riser force {force} N, weight {weight} N"
    );
}

/// At the corners of `models/examples/flights/dispersions.toml`: three standard deviations of mass and drag, the ends of the ranges of the lines.
#[test]
fn flights_of_the_campaign_are_within_a_thousandth_of_the_steady_force_after_two_seconds() {
    let times: Vec<f64> = (20..=700).map(|k| 0.1 * f64::from(k)).collect();
    let of = |options| {
        FlightPlan::new(TestCase::Two, Confluence::Stepwise, options, 70.0).sampled(&times)
    };
    for ([drag, mass], [riser_k, leg_k, riser_c]) in [
        ([1.0, 1.0], [60e3, 47e3, 600.0]),
        ([0.88, 1.045], [72e3, 56e3, 300.0]),
        ([1.12, 0.955], [72e3, 56e3, 300.0]),
        ([1.12, 1.045], [48e3, 38e3, 300.0]),
        ([1.12, 1.045], [72e3, 38e3, 900.0]),
        ([0.88, 0.955], [48e3, 56e3, 900.0]),
    ] {
        let (cd, m_capsule) = (0.46 * drag, 761.0 * mass);
        let stepwise = ParachuteStepwise::new(ParachuteStepwiseParams {
            cd,
            m_capsule,
            riser_k,
            leg_k,
            riser_c,
            ..Default::default()
        });
        let exact = ParachuteRate::new(ParachuteRateParams {
            cd,
            m_capsule,
            riser_k,
            leg_k,
            riser_c,
            ..Default::default()
        });
        let (stepwise, exact) = (stepwise.expect("in range"), exact.expect("in range"));
        let flown = fly_model(&of(Options::rk4(0.02)), &stepwise).expect("it flies");
        let exact = fly_model(&of(Options::tsit5(1e-10)), &exact).expect("it flies");
        let steady = exact.riser().last().copied().expect("rows");
        let error = largest(&flown, exact.riser(), [2.0, 70.0]);
        println!("{drag} {mass} {riser_k} {leg_k} {riser_c}: {error:e} N of {steady} N");
        assert!(error <= 1e-3 * steady, "off by {error:e} N of {steady} N");
    }
}

#[test]
fn largest_stable_steps_are_those_of_the_eigenvalues() {
    // RK4 is stable to h λ = 2.785 on the real axis and h ω = 2.83 on the imaginary one. A point of 0.1 kg: dampers of 1784 N s/m together.
    // Undamped lines: the axial mode of the bodies at 50.4 rad/s; a rate node: C/K = 0.01 s. The stepwise limit is a measured one, the same mode.
    let cases = [
        (Confluence::Mass(0.1, Damping::On), 2.785 * 0.1 / 1784.0),
        (Confluence::Static, 2.83 / 50.4),
        (Confluence::Rate, 2.785 * 0.01),
        (Confluence::Euler, 0.048),
    ];
    on_all_cores(cases.len() as u64, |number| {
        let (confluence, predicted) = cases[number as usize];
        let found =
            largest_taut_step(confluence).unwrap_or_else(|error| panic!("{confluence}: {error}"));
        println!("{confluence}: largest stable step {found} s, predicted {predicted} s");
        assert!(
            (found / predicted - 1.0).abs() <= 0.1,
            "{confluence}: found {found} s, predicted {predicted} s"
        );
    });
}
