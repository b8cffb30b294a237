//! What nature keeps is kept: energy without damping and drag, momentum without a world to push against, and the balance of both with it.

use mbd_compiler::Interpreted;
use mbd_runtime::{Options, Quantity, Simulation};
use mbd_scene::{Model, Scene};
use models::parachute::scene::{
    ParachuteMass, ParachuteMassParams, ParachuteRate, ParachuteStatic, SceneInstant as Start,
    TestCase,
};
use models::parachute::variant::state;
use tests::declared::read;

/// The scene of AAS 03-163 without drag and without damping.
fn undamped(confluence: &str) -> Scene {
    read(&format!(
        "model Undamped {{
            gravity: point_mass {{ mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m }};
            body chute {{
                mass: 16.0 kg,
                inertia: diag(700.0, 700.0, 220.0) kg*m^2,
                frame riser_end at [0.0, 0.0, -22.0] m,
            }}
            body capsule {{
                mass: 761.0 kg,
                inertia: diag(235.0, 225.0, 290.0) kg*m^2,
                frame bridle[i in 0..3] at polar(0.6 m, 20 deg + i * 120 deg, 1.23 m),
            }}
            joint chute_free: free from world to chute.com;
            joint capsule_free: free from world to capsule.com;
            point confluence {{ {confluence} }}
            line riser from chute.riser_end to confluence {{ free_length: 4.0 m, stiffness: 60 kN/m }}
            line leg[i in 0..3] from capsule.bridle[i] to confluence {{ free_length: 1.5 m, stiffness: 47 kN/m }}
        }}"
    ))
}

/// A simulation of case 3 of any model of the scene.
fn case_three(model: &dyn Model<f64>, options: Options) -> Simulation<f64> {
    let start = Start::start(TestCase::Three);
    let mut simulation = Simulation::new(model, options).expect("options");
    simulation
        .set_state(0.0, &state(model, &start))
        .expect("state");
    let layout = model.layout();
    if layout.nz == 0 && !layout.nodes.is_empty() {
        simulation.set_nodes(&start.point).expect("guess");
    }
    simulation
}

/// Kinetic, gravitational and elastic energy together [J].
fn energy(simulation: &mut Simulation<f64>) -> f64 {
    let mut out = [0.0; 6];
    simulation
        .evaluate(Quantity::Energy, &mut out)
        .expect("the nodes balance");
    out[..3].iter().sum()
}

/// Largest change of energy over ten seconds of case 3 [J], looked at ten times a second.
fn drift(scene: Scene, rtol: f64) -> f64 {
    let model = Interpreted::new(scene, &[]).expect("no params");
    let mut simulation = case_three(&model, Options::tsit5(rtol));
    let before = energy(&mut simulation);
    let mut worst = 0.0f64;
    for tenth in 1..=100 {
        simulation
            .run(f64::from(tenth) * 0.1)
            .expect("case 3 flies");
        worst = worst.max((energy(&mut simulation) - before).abs());
    }
    println!("{worst:e} J of {before:e} J, {:?}", simulation.statistics());
    worst
}

#[test]
fn a_static_node_without_drag_keeps_the_energy_of_case_three_to_1e_5_joule() {
    let drift = drift(undamped("equilibrium: static"), 1e-12);
    assert!(drift <= 1e-5, "{drift:e} J");
}

#[test]
fn a_point_with_mass_without_drag_and_damping_keeps_the_energy_of_case_three_to_1e_5_joule() {
    let drift = drift(undamped("mass: 0.1 kg"), 1e-13);
    assert!(drift <= 1e-5, "{drift:e} J");
}

/// Two bodies and three damped lines, nothing else.
fn pair(angular_velocity: &str) -> Scene {
    read(&format!(
        "model Pair {{
            angular_velocity: {angular_velocity};
            gravity: none;
            body ship {{
                mass: 7.0 kg,
                inertia: full {{ xx: 2.0, yy: 2.5, zz: 3.0, xy: 0.1, xz: -0.2, yz: 0.15 }} kg*m^2 (matrix elements),
                frame bow at [1.0, 0.1, -0.2] m, frame stern at [-0.9, 0.2, 0.1] m, frame mast at [0.1, -0.1, 1.1] m,
            }}
            body buoy {{
                mass: 3.0 kg,
                inertia: diag(1.0, 1.2, 0.9) kg*m^2,
                frame top at [0.0, 0.1, 0.5] m, frame side at [0.4, 0.0, -0.1] m, frame keel at [0.0, -0.3, -0.4] m,
            }}
            joint ship_free: free from world to ship.com;
            joint buoy_free: free from world to buoy.com;
            line one from ship.bow to buoy.top {{ free_length: 1.0 m, stiffness: 300 N/m, damping: 5 N*s/m }}
            line two from ship.stern to buoy.side {{ free_length: 1.5 m, stiffness: 500 N/m, damping: 3 N*s/m }}
            line three from ship.mast to buoy.keel {{ free_length: 1.2 m, stiffness: 400 N/m }}
        }}"
    ))
}

#[test]
fn two_bodies_joined_by_three_lines_keep_their_momentum_to_1e_12() {
    for setting in ["body", "world"] {
        let model = Interpreted::new(pair(setting), &[]).expect("no params");
        let mut simulation = Simulation::new(&model, Options::tsit5(1e-13)).expect("options");
        let (ship, buoy) = ([0.0, 0.0, 0.0], [2.0, 0.4, -0.3]);
        let mut start: Vec<f64> = Vec::new();
        start.extend(ship.iter().chain(&[1.0, 0.0, 0.0, 0.0]));
        start.extend(buoy.iter().chain(&[0.8, 0.0, 0.6, 0.0]));
        start.extend([
            0.4, -0.3, 0.2, 0.5, 0.7, -0.6, -1.1, 0.9, 0.3, -0.4, 0.8, 1.3,
        ]);
        simulation.set_state(0.0, &start).expect("state");
        let momentum = |simulation: &mut Simulation<f64>| {
            let mut out = [0.0; 6];
            let found = simulation.evaluate(Quantity::Momentum, &mut out);
            found.expect("no nodes");
            out
        };
        let before = momentum(&mut simulation);
        let (mut linear, mut angular) = (0.0f64, 0.0f64);
        for tenth in 1..=100 {
            simulation.run(f64::from(tenth) * 0.1).expect("flies");
            let (now, state) = (momentum(&mut simulation), simulation.state());
            // Scales: Σ |m v|, and Σ |r| |m v| + |I ω|, at the same instant.
            let size = |at: usize| state[at..at + 3].iter().map(|x| x * x).sum::<f64>().sqrt();
            let (p, q) = (7.0 * size(14), 3.0 * size(20));
            let turning = size(0) * p + size(7) * q + 3.0 * size(17) + 1.2 * size(23);
            let change = |range: std::ops::Range<usize>| {
                range.fold(0.0f64, |m, i| m.max((now[i] - before[i]).abs()))
            };
            linear = linear.max(change(0..3) / (p + q));
            angular = angular.max(change(3..6) / turning);
        }
        println!(
            "{setting}: linear {linear:e}, angular {angular:e}, {:?}",
            simulation.statistics()
        );
        assert!(linear <= 1e-12, "{setting}: linear momentum {linear:e}");
        // Angular momentum is quadratic in the state: kept to the tolerance of the run.
        assert!(angular <= 1e-12, "{setting}: angular momentum {angular:e}");
    }
}

/// Energy gained minus work of loads and dampers over a run, and the work itself [J].
fn balance(model: &dyn Model<f64>, until: f64, rtol: f64) -> [f64; 3] {
    let options = Options {
        work: true,
        ..Options::tsit5(rtol)
    };
    let mut simulation = case_three(model, options);
    let before = energy(&mut simulation);
    simulation.run(until).expect("case 3 flies");
    let [loads, dampers, _] = simulation.work().expect("asked for");
    let gained = energy(&mut simulation) - before;
    println!(
        "{}: gained {gained} J, loads {loads} J, dampers {dampers} J, open {:e} J",
        model.scene().name,
        gained - loads - dampers
    );
    [gained - loads - dampers, loads, dampers]
}

#[test]
fn energy_gained_is_the_work_of_drag_and_dampers_for_a_point_with_mass() {
    let params = ParachuteMassParams {
        m_point: 1.0,
        ..ParachuteMassParams::default()
    };
    let model = ParachuteMass::new(params).expect("in range");
    let [open, loads, dampers] = balance(&model, 5.0, 1e-11);
    assert!(loads < 0.0 && dampers < 0.0, "both take energy");
    assert!(
        open.abs() <= 1e-8 * (loads.abs() + dampers.abs()),
        "{open:e} J"
    );
}

#[test]
fn energy_gained_is_the_work_of_drag_for_a_static_node() {
    let model = ParachuteStatic::new(Default::default()).expect("defaults");
    let [open, loads, dampers] = balance(&model, 5.0, 1e-11);
    assert_eq!(dampers, 0.0);
    assert!(open.abs() <= 1e-8 * loads.abs(), "{open:e} J");
}

#[test]
fn energy_gained_is_the_work_of_drag_and_dampers_for_a_rate_node() {
    let model = ParachuteRate::new(Default::default()).expect("defaults");
    let [open, loads, dampers] = balance(&model, 5.0, 1e-11);
    assert!(loads < 0.0 && dampers < 0.0, "both take energy");
    assert!(
        open.abs() <= 1e-8 * (loads.abs() + dampers.abs()),
        "{open:e} J"
    );
}

/// The momentum that a run over two seconds made or lost, relative.
fn momentum_lost(text: &str, options: Options) -> f64 {
    let model = Interpreted::<f64>::new(read(text), &[]).expect("no params");
    let options = Options {
        momentum: true,
        ..options
    };
    let mut simulation = Simulation::new(&model, options).expect("options");
    simulation
        .run(2.0)
        .unwrap_or_else(|error| panic!("{error}"));
    let found = simulation.momentum_imbalance().expect("nothing is held");
    println!("{}: {found:?}", model.scene().name);
    found.relative()
}

/// Two bodies on a joint and a point on a damped spring that fall, are pushed, and tumble.
const FALLING: &str = "model Falling {
    gravity: point_mass { mu: 1.6e4 m^3/s^2, center: [0.0, 0.0, -40.0] m };
    body a { mass: 2 kg, inertia: diag(0.3, 0.2, 0.25) kg*m^2, frame end at [0.3, 0.1, 0] m,
        start at [0, 0, 0] m velocity [1, 0.5, 3] m/s angular_velocity [0.5, 1, -2] rad/s }
    body b { mass: 1 kg, inertia: full { xx: 0.1, yy: 0.12, zz: 0.15, xy: 0.01, xz: 0.02, yz: -0.01 } kg*m^2 (matrix elements),
        frame root at [-0.2, 0, 0.1] m }
    point bob { mass: 0.5 kg, start at [0.4, 0.5, 0.3] m }
    joint a_free: free from world to a.com;
    joint pin: hinge from a.end to b.root { axis: z, stiffness: 3 N*m, damping: 0.1 N*m*s }
    spring s from b.com to bob { free_length: 0.2 m, stiffness: 30 N/m, damping: 0.3 N*s/m }
    load push on b at root = [2 N * sin(3 rad/s * time), 1 N, 0 N] - (0.2 kg/s) * b.root.velocity;
    load twist on a at com = [0.1, 0, 0.2] N*m;
    load drag on bob = -(0.1 kg/s) * bob.velocity; }";

#[test]
fn gravity_and_loads_account_for_all_momentum_of_what_the_ground_does_not_hold() {
    for (options, bound) in [
        (Options::rk4(1e-3), 1e-8),
        (Options::rattle(1e-3), 1e-8),
        (Options::tsit5(1e-9), 1e-7),
        (Options::vern7(1e-11), 1e-9),
        (Options::rodas5p(1e-8), 1e-6),
    ] {
        let lost = momentum_lost(FALLING, options);
        assert!(lost < bound, "{:?}: {lost:e}", options.method);
    }
    // A step that is too long for what it has to follow loses some, and it shows.
    let coarse = Options {
        watch: false,
        ..Options::rk4(0.05)
    };
    let lost = momentum_lost(FALLING, coarse);
    assert!(lost > 1e-7, "{lost:e}");
    // In space without anything the sum is constant.
    let alone = FALLING.replace(
        "point_mass { mu: 1.6e4 m^3/s^2, center: [0.0, 0.0, -40.0] m }",
        "none",
    );
    let alone = alone
        .lines()
        .filter(|line| !line.contains("load "))
        .collect::<Vec<_>>()
        .join("\n")
        + "}";
    let lost = momentum_lost(&alone, Options::rattle(1e-3));
    assert!(lost < 1e-13, "{lost:e}");
}

/// Six masses on springs that breathe about the origin: no part of them has a moment about it, nor any momentum is left over.
const BREATHING: &str = "model Breathing {
    gravity: none;
    const N = 6;
    point mass[i in 0..N] { mass: 0.5 kg, start at 1.1 * polar(1 m, i * 360 deg / N, 0 m) }
    spring rim[i in 0..N] from mass[i] to mass[(i + 1) % N] { free_length: 1 m, stiffness: 200 N/m } }";

#[test]
fn nothing_is_lost_where_all_moments_vanish_by_symmetry() {
    for options in [Options::tsit5(1e-10), Options::rk4(1e-3)] {
        let lost = momentum_lost(BREATHING, options);
        assert!(lost < 1e-12, "{:?}: {lost:e}", options.method);
    }
}

#[test]
fn momentum_is_not_told_of_what_the_ground_holds_and_the_holder_has_a_name() {
    let held = |more: &str| {
        let scene = read(&format!(
            "model Held {{ gravity: none; body a {{ mass: 1 kg, inertia: diag(1, 1, 1) kg*m^2 }} point bob {{ mass: 1 kg }} {more} }}"
        ));
        let model = Interpreted::<f64>::new(scene.clone(), &[]).expect("no params");
        let options = Options {
            momentum: true,
            ..Options::rk4(0.01)
        };
        let mut simulation = Simulation::new(&model, options).expect("options");
        simulation.run(0.1).expect("nothing moves");
        let by = scene.held_by_ground().map(|names| names.map(str::to_owned));
        assert_eq!(simulation.momentum_imbalance().is_none(), by.is_some());
        by
    };
    assert_eq!(held("joint loose: free from world to a.com;"), None);
    let by = |more: &str| held(more).expect("held");
    assert_eq!(
        by("joint pin: hinge from world to a.com { axis: z }"),
        ["pin", "a"]
    );
    assert_eq!(
        by(
            "joint loose: free from world to a.com; spring s from bob to world { free_length: 0 m, stiffness: 1 N/m }"
        ),
        ["s", "bob"]
    );
}

/// An orbit whose centre of gravity is `off` metres from the origin: energy at the start [J], its relative imbalance after coarse steps.
fn orbit(off: f64) -> (f64, f64) {
    let scene = read(&format!(
        "model Orbit {{ gravity: point_mass {{ mu: 398600 km^3/s^2, center: [{off}, 0, 0] m }};
            point p {{ mass: 20 kg, start at [7000, 0, 0] km velocity [0, 7, 1.5] km/s }} }}"
    ));
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(300.0)).expect("options");
    run.start().expect("a start");
    let before = energy(&mut run);
    run.run(40_000.0).expect("an orbit");
    let lost = run.imbalance().expect("energies");
    (before, lost.relative())
}

#[test]
fn the_energy_of_an_orbit_does_not_depend_on_where_its_centre_nearly_is() {
    let (mu, distance) = (398_600e9, 7e6);
    let exact = 20.0 * (0.5 * (7000_f64.powi(2) + 1500_f64.powi(2)) - mu / distance);
    let (_, at_centre) = orbit(0.0);
    assert!(at_centre > 0.01, "{at_centre}");
    for off in [0.0, 1e-9, 1.0, 1000.0] {
        let (energy, lost) = orbit(off);
        assert!(
            (energy / exact - 1.0).abs() < 1e-3,
            "{off} m: {energy} J, {exact} J"
        );
        assert!((lost / at_centre - 1.0).abs() < 0.1, "{off} m: {lost}");
    }
}
