//! Tables of one and two arguments, straight and smooth, as functions of a declaration.

use mbd_runtime::{Generic, Options, Quantity, Simulation, linearise, model};
use mbd_scene::{Model, Scene};
use tests::agreement::agrees;
use tests::declared::read;

model! {
    /// A wing whose lift is measured over angle and speed, and a ball in air that thins out.
    pub model Measured<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        verify;
        input flaps: angle;
        param reach = 1 m in 0.5 m ..= 2 m;
        table lift = {
            (-1 rad, -2 m/s): -3 N, (-1 rad, 0 m/s): 0 N, (-1 rad, 2 m/s): -8 N,
            (0 rad, -2 m/s): 1 N, (0 rad, 0 m/s): 0.5 N, (0 rad, 2 m/s): 2 N,
            (1 rad, -2 m/s): 6 N, (1 rad, 0 m/s): 0 N, (1 rad, 2 m/s): 9 N,
        };
        smooth table density = {
            -1 m: 1.2 kg/m^3, 0 m: 0.7 kg/m^3, 0.5 m: 0.4 kg/m^3, 1 m: 0.4 kg/m^3,
        };
        smooth table field = {
            (-1 m, -1 m): 0 N, (-1 m, 1 m): 2 N, (0 m, -1 m): 3 N, (0 m, 1 m): 1 N,
            (1 m, -1 m): 4 N, (1 m, 1 m): 7 N,
        };
        body wing { mass: 2 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2 }
        joint loose: free from world to wing.com;
        point ball { mass: 1 kg }
        load up on wing = lift(flaps + reach * wing.x.z / (1 m), wing.velocity.x) * wing.z;
        load drag on ball = -1 m^2 * density(ball.position.z) * norm(ball.velocity) * ball.velocity;
        load push on ball = [field(ball.position.x, ball.position.y), 0, 0];
        output pushed = field(ball.position.x / reach * (1 m), 0.3 m);
    }
}

#[test]
fn generated_interpreted_and_generic_tables_agree_with_all_their_derivatives() {
    agrees(&Measured::<f64>::new(Default::default()).expect("defaults"));
}

#[test]
fn tables_in_single_precision_are_those_in_double_to_its_rounding() {
    let double = Measured::<f64>::new(Default::default()).expect("defaults");
    let single = Measured::<f32>::new(Default::default()).expect("defaults");
    let mut state = vec![0.0; double.layout().nx()];
    state[3] = 1.0;
    state[7] = 0.3;
    state[8] = 0.4;
    state[9] = -0.7;
    let mut double = Simulation::new(&double, Options::rk4(1e-3)).expect("options");
    let mut single = Simulation::new(&single, Options::rk4(1e-3)).expect("options");
    double.set_state(0.0, &state).expect("a state");
    let narrow: Vec<f32> = state.iter().map(|&x| x as f32).collect();
    single.set_state(0.0, &narrow).expect("a state");
    let (mut wide, mut out) = ([0.0; 1], [0.0; 1]);
    double
        .evaluate(Quantity::Outputs, &mut wide)
        .expect("no node");
    single
        .evaluate(Quantity::Outputs, &mut out)
        .expect("no node");
    assert!(
        (f64::from(out[0]) - wide[0]).abs() < 1e-5,
        "{out:?} {wide:?}"
    );
}

/// A mass on a spring of measured force, which it crosses from entry to entry.
fn sprung(mark: &str) -> Scene {
    read(&format!(
        "model Sprung {{
            gravity: none;
            {mark} table pull = {{ -2 m: 5 N, -1 m: 1.5 N, -0.3 m: 1 N, 0.4 m: -1 N, 1 m: -2 N, 2 m: -6 N }};
            point mass {{ mass: 1 kg, start at [1.2, 0, 0] m }}
            load back on mass = [pull(mass.position.x), 0, 0];
            output stiffness = pull(mass.position.x);
        }}"
    ))
}

/// Where the mass is after 4 s.
fn place(scene: &Scene, step: f64) -> f64 {
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(step)).expect("options");
    run.run(4.0).expect("a run");
    run.state()[0]
}

/// The order that the errors at steps of 1/40 s to 1/640 s show.
fn order(scene: &Scene) -> f64 {
    let exact = place(scene, 1.0 / 32768.0);
    let steps = [40.0, 80.0, 160.0, 320.0, 640.0];
    // Where an entry falls within a step decides its error: several steps next to each other, the largest of their errors.
    let error = |steps: f64| {
        let near = (0..6).map(|k| 1.0 / (steps * (1.0 + 0.05 * f64::from(k))));
        let errors = near.map(|step| {
            let whole = (4.0 / step).round();
            (place(scene, 4.0 / whole) - exact).abs()
        });
        errors.fold(0.0, f64::max)
    };
    let first = error(steps[0]);
    let last = error(steps[4]);
    (first / last).log2() / 4.0
}

#[test]
fn rk4_loses_two_orders_at_the_kinks_of_a_straight_table_and_one_at_the_joints_of_a_smooth_one() {
    let (straight, smooth) = (order(&sprung("")), order(&sprung("smooth")));
    assert!((1.7..2.4).contains(&straight), "{straight}");
    assert!((2.7..3.4).contains(&smooth), "{smooth}");
}

#[test]
fn a_linear_system_has_the_slope_of_the_table_to_the_right_of_an_entry() {
    let scene = sprung("");
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut state = vec![0.0; 6];
    state[0] = 0.4;
    let space = linearise(&model, 0.0, &state, &[]).expect("a linear system");
    // Between 0.4 m and 1 m the force falls by 1 N.
    assert!((space.a[(3, 0)] + 1.0 / 0.6).abs() < 1e-12, "{}", space.a);
}

#[test]
fn a_mass_on_a_smooth_table_keeps_the_energy_of_its_integral() {
    let scene = sprung("smooth");
    let model = Generic::<f64>::with_defaults(scene.clone()).expect("no params");
    let mut run = Simulation::new(&model, Options::rk4(1e-4)).expect("options");
    run.run(6.0).expect("a run");
    let table = &scene.tables[0];
    // Simpson's rule is exact on cubics: between entries one interval each.
    let work = |from: f64, to: f64| {
        let mut edges: Vec<f64> = table
            .x
            .iter()
            .copied()
            .filter(|x| (from.min(to)..from.max(to)).contains(x))
            .collect();
        edges.extend([from, to]);
        edges.sort_by(f64::total_cmp);
        let pieces = edges.windows(2).map(|edge| {
            let [a, b] = [edge[0], edge[1]];
            let at = |x: f64| table.at(&[x]);
            (b - a) / 6.0 * (at(a) + 4.0 * at(0.5 * (a + b)) + at(b))
        });
        pieces.sum::<f64>() * (to - from).signum()
    };
    let state = run.state();
    let kinetic = 0.5 * state[3] * state[3];
    let missed = kinetic - work(1.2, state[0]);
    assert!(missed.abs() < 1e-9, "{missed:e} J");
}
