//! Lines whose force is a table over stretch: webbing, bungee cords. Against the linear line, closed forms, and the laws of conservation.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Happening, Options, Quantity, RunError, Simulation, StepError, model};
use mbd_scene::{LineKind, Model, PointKind, Scene};
use tests::agreement::agrees;
use tests::assert_close;
use tests::declared::read;

model! {
    /// A chest on two straps below a hook, with a ball on a cord.
    pub model Sling<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        verify;
        param slack = 0.8 m in 0.1 m ..= 2 m;
        table webbing = { 0 m: 0 N, 50 mm: 400 N, 0.2 m: 3.1 kN };
        table cord = { 0 m: 0 N, 0.1 m: 60 N, 0.5 m: 110 N, 1.5 m: 900 N };
        world { frame hook at [0.1, 0.2, 3.0] m }
        body chest {
            mass: 20 kg,
            inertia: diag(1.0, 1.5, 2.0) kg*m^2,
            frame left at [-0.4, 0.0, 0.3] m,
            frame right at [0.4, 0.1, 0.3] m,
        }
        point ball { mass: 2 kg }
        joint loose: free from world to chest.com;
        line strap_left from world.hook to chest.left {
            free_length: slack,
            force: webbing,
            damping: 30 N*s/m,
        }
        line strap_right from world.hook to chest.right { free_length: 0.9 m, force: webbing }
        line tether from chest.com to ball { free_length: 0.5 m, force: cord, damping: 2 N*s/m }
        line band from world.hook to ball { free_length: 0 m, force: cord }
        output pulls = [strap_left.tension, strap_right.tension, tether.tension];
    }
}

/// A mass on a vertical line from a hook at the origin, given by its fields.
fn bungee(fields: &str) -> Scene {
    read(&format!(
        "model Bungee {{
            gravity: [0.0, 0.0, -10.0] m/s^2;
            table cord = {{ 0 m: 0 N, 0.2 m: 50 N, 0.6 m: 90 N, 1.0 m: 290 N }};
            table straight = {{ 0 m: 0 N, 2 m: 500 N }};
            point jumper {{ mass: 7 kg }}
            line tether from world to jumper {{ free_length: 1 m, {fields} }}
            output pull = tether.tension;
            output same = cord(0 m) + straight(0 m);
        }}"
    ))
}

fn energy(run: &mut Simulation<f64>) -> [f64; 6] {
    let mut out = [0.0; 6];
    run.evaluate(Quantity::Energy, &mut out)
        .expect("no node to place");
    out
}

#[test]
fn generated_interpreted_and_generic_tables_agree_with_all_their_derivatives() {
    agrees(&Sling::<f64>::new(Default::default()).expect("defaults"));
}

/// Tension, elastic energy and slope at a stretch, with the jumper below the hook.
fn at_stretch(model: &dyn Model<f64>, stretch: f64) -> [f64; 3] {
    let mut run = Simulation::<f64>::new(model, Options::rk4(0.01)).expect("options");
    let state = [0.0, 0.0, -1.0 - stretch, 0.0, 0.0, 0.0];
    run.set_state(0.0, &state).expect("a state");
    let mut lines = [0.0; 10];
    run.evaluate(Quantity::Lines, &mut lines)
        .expect("no node to place");
    [lines[0], energy(&mut run)[2], lines[9]]
}

#[test]
fn force_energy_and_slope_are_those_of_the_table_piece_by_piece_and_the_last_slope_goes_on() {
    let model = Generic::<f64>::with_defaults(bungee("force: cord")).expect("no params");
    // At a knot the slope is that of the piece to the right.
    for (stretch, want) in [
        (-0.1, [0.0, 0.0, 0.0]),
        (0.1, [25.0, 1.25, 250.0]),
        (0.5, [80.0, 5.0 + 15.0 + 4.5, 100.0]),
        (
            0.75,
            [165.0, 5.0 + 28.0 + 0.5 * (90.0 + 165.0) * 0.15, 500.0],
        ),
        (1.5, [540.0, 5.0 + 28.0 + 0.5 * (90.0 + 540.0) * 0.9, 500.0]),
    ] {
        let found = at_stretch(&model, stretch);
        assert_close(&found, &want, 1e-13, 1e-13, &format!("stretch {stretch} m"));
    }
    assert_eq!(at_stretch(&model, 0.0), [0.0, 0.0, 250.0]);
}

#[test]
fn a_table_with_one_slope_is_the_linear_line() {
    let fly = |fields: &str| {
        let model = Interpreted::new(bungee(fields), &[]).expect("no params");
        let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-9)).expect("options");
        run.set_state(0.0, &[0.3, 0.0, -0.5, 0.0, 0.4, 0.0])
            .expect("a state");
        run.run(3.0).expect("a bouncing mass");
        let events: Vec<_> = run.events().to_vec();
        (run.state().to_vec(), energy(&mut run), events)
    };
    let (table, linear) = (
        fly("force: straight, damping: 4 N*s/m"),
        fly("stiffness: 250 N/m, damping: 4 N*s/m"),
    );
    assert!(linear.2.len() > 2, "{:?}", linear.2);
    assert_eq!(table, linear);
}

/// K s = m g on the piece that carries 70 N: 50 N + 100 N/m (s − 0.2 m) = 70 N, s = 0.4 m.
#[test]
fn a_damped_bungee_comes_to_rest_where_its_table_carries_the_weight() {
    let scene = bungee("force: cord, damping: 40 N*s/m");
    let model = Interpreted::new(scene, &[]).expect("no params");
    let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-10)).expect("options");
    run.set_state(0.0, &[0.0, 0.0, -1.0, 0.0, 0.0, 0.0])
        .expect("a state");
    run.run(30.0).expect("a motion that dies out");
    assert!((run.state()[2] + 1.4).abs() < 1e-8, "{:?}", run.state());
}

/// Dropped 1 m above the slack edge, energy gives the lowest point: m g (1 m + s) = E(s) = 33 J + 90 N (s − 0.6 m) + 250 N/m (s − 0.6 m)².
#[test]
fn an_undamped_bungee_keeps_its_energy_and_reaches_the_depth_that_energy_gives() {
    let model = Interpreted::new(bungee("force: cord"), &[]).expect("no params");
    let mut run = Simulation::<f64>::new(&model, Options::tsit5(1e-11)).expect("options");
    run.set_state(0.0, &[0.0; 6]).expect("a state");
    let total = |run: &mut Simulation<f64>| energy(run)[..3].iter().sum::<f64>();
    let before = total(&mut run);
    let (mut lowest, mut worst) = (0.0f64, 0.0f64);
    for step in 1..=4000 {
        run.run(f64::from(step) * 1e-3).expect("a bouncing mass");
        lowest = lowest.min(run.state()[2]);
        worst = worst.max((total(&mut run) - before).abs());
    }
    // Measured: 1.1e-7 J of 100 J that go to and fro.
    assert!(worst < 1e-6, "{worst:e} J");
    let over = (-20.0 + f64::sqrt(400.0 + 1000.0 * (112.0 - 33.0))) / 500.0;
    assert!((lowest + 1.6 + over).abs() < 1e-4, "{lowest} {over}");
    let taut = run.events().iter().map(|event| event.what);
    let taut: Vec<Happening> = taut.collect();
    assert!(taut.len() >= 2, "{taut:?}");
    // Free fall over 1 m reaches the slack edge.
    let first = run.events()[0].time;
    assert!((first - f64::sqrt(0.2)).abs() < 1e-9, "{first}");
}

#[test]
fn a_table_at_a_point_without_mass_is_refused_by_name() {
    let mut scene = read(
        "model Knot {
            gravity: none;
            table cord = { 0 m: 0 N, 1 m: 100 N };
            point ball { mass: 1 kg }
            point knot { equilibrium: static }
            world { frame a at [1.0, 0.0, 0.0] m, frame b at [0.0, 1.0, 0.0] m }
            line left from world.a to knot { free_length: 0.5 m, stiffness: 1 kN/m }
            line right from world.b to knot { free_length: 0.5 m, stiffness: 1 kN/m }
            line tether from knot to ball { free_length: 0.5 m, stiffness: 1 kN/m }
            line spare from world to ball { free_length: 0.5 m, force: cord }
        }",
    );
    assert!(matches!(scene.points[1].kind, PointKind::Node(_)));
    scene.lines[2].kind = LineKind::Table(0);
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::<f64>::new(&model, Options::rk4(0.01)).expect("options");
    let refused = run.run(0.1);
    let Err(RunError { cause, .. }) = &refused else {
        panic!("{refused:?}");
    };
    assert!(
        matches!(cause, StepError::Unsupported { what, .. } if what.contains("`tether`")),
        "{cause}"
    );
}
