//! One declaration in single and in double precision: what `f32` costs in accuracy is measured, stated and bounded.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Options, Quantity, Scalar, Simulation};
use mbd_scene::Model;
use models::parachute::scene::{
    ParachuteMass, ParachuteMassParams, ParachuteStatic, ParachuteStepwise, SceneInstant as Start,
    TestCase,
};
use models::parachute::variant::state;

/// Start of case 2 in any precision, for a model whose layout `like` shares.
fn case_two<T: Scalar>(model: &dyn Model<T>, like: &impl Model<f64>, step: f64) -> Simulation<T> {
    let start = Start::start(TestCase::Two);
    let options = Options {
        watch: false,
        ..Options::rk4(step)
    };
    let cast = |list: &[f64]| list.iter().map(|&x| T::from_f64(x)).collect::<Vec<T>>();
    let mut simulation = Simulation::new(model, options).expect("options");
    let from = cast(&state(like, &start));
    simulation.set_state(0.0, &from).expect("state");
    if !model.layout().nodes.is_empty() {
        simulation.set_nodes(&cast(&start.point)).expect("guess");
    }
    simulation
}

/// Riser force [N] at every tenth of a second up to `until`.
fn riser<T: Scalar>(
    model: &dyn Model<T>,
    like: &impl Model<f64>,
    step: f64,
    tenths: u32,
) -> Vec<f64> {
    let mut simulation = case_two(model, like, step);
    let mut out = [T::zero()];
    (1..=tenths)
        .map(|tenth| {
            simulation
                .run(f64::from(tenth) * 0.1)
                .unwrap_or_else(|e| panic!("{}: {e}", model.scene().name));
            let found = simulation.evaluate(Quantity::Outputs, &mut out);
            found.expect("the nodes balance");
            out[0].to_f64()
        })
        .collect()
}

/// Mean and largest difference of two force histories [N].
fn error_between(a: &[f64], b: &[f64]) -> [f64; 2] {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    let largest = differences.iter().fold(0.0f64, |m, &x| m.max(x));
    [differences.iter().sum::<f64>() / a.len() as f64, largest]
}

/// Riser force in `f32` against `f64`, both generated: mean and largest error [N]. Generic and interpreted `f32` are run as well.
fn error_of_f32<D: Model<f64>, S: Model<f32>>(
    double: &D,
    single: &S,
    step: f64,
    tenths: u32,
) -> [f64; 2] {
    let (scene, params) = (single.scene().clone(), single.params());
    let generic = Generic::<f32>::new(scene.clone(), params).expect("accepted");
    let interpreted = Interpreted::<f32>::new(scene, params).expect("accepted");
    let exact = riser(double, double, step, tenths);
    let generated = riser(single, double, step, tenths);
    let interpreted = riser(&interpreted, double, step, tenths);
    assert_eq!(generated, interpreted, "the same bits also in f32");
    let error = error_between(&generated, &exact);
    let generic = error_between(&riser(&generic, double, step, tenths), &exact);
    let peak = exact.iter().fold(0.0f64, |m, &x| m.max(x));
    println!(
        "{}, {} s: peak {peak} N, f32 error mean {:e} N, largest {:e} N; generic mean {:e} N, largest {:e} N",
        double.scene().name,
        f64::from(tenths) * 0.1,
        error[0],
        error[1],
        generic[0],
        generic[1],
    );
    [error[0].max(generic[0]), error[1].max(generic[1])]
}

/// A position of 29 m has a rounding of 2e-6 m in `f32`, which is 0.1 N in the riser; a node adds what its solve cannot resolve.
#[test]
fn a_stepwise_node_flies_case_two_in_single_precision() {
    let double = ParachuteStepwise::<f64>::new(Default::default()).expect("defaults");
    let single = ParachuteStepwise::<f32>::new(Default::default()).expect("defaults");
    let [mean, largest] = error_of_f32(&double, &single, 0.01, 50);
    assert!(mean <= 1.0 && largest <= 5.0, "{mean} N, {largest} N");
}

#[test]
fn a_static_node_flies_case_two_in_single_precision() {
    let double = ParachuteStatic::<f64>::new(Default::default()).expect("defaults");
    let single = ParachuteStatic::<f32>::new(Default::default()).expect("defaults");
    // Undamped: what rounding excites stays.
    let [mean, largest] = error_of_f32(&double, &single, 0.01, 50);
    assert!(mean <= 4.0 && largest <= 25.0, "{mean} N, {largest} N");
}

#[test]
fn a_point_with_mass_flies_case_two_in_single_precision() {
    let params = |kg: f64| ParachuteMassParams::<f64> {
        m_point: kg,
        ..Default::default()
    };
    let single = ParachuteMassParams::<f32> {
        m_point: 1.0,
        ..Default::default()
    };
    let double = ParachuteMass::<f64>::new(params(1.0)).expect("in range");
    let single = ParachuteMass::<f32>::new(single).expect("in range");
    let [mean, largest] = error_of_f32(&double, &single, 0.001, 50);
    assert!(mean <= 0.3 && largest <= 1.5, "{mean} N, {largest} N");
}

/// After a minute the scene is kilometres from its origin, where a position rounds to 2e-4 m: 15 N in the riser. `f32` needs an origin that follows.
#[test]
fn the_error_of_single_precision_grows_with_the_distance_from_the_origin() {
    let double = ParachuteStepwise::<f64>::new(Default::default()).expect("defaults");
    let single = ParachuteStepwise::<f32>::new(Default::default()).expect("defaults");
    let near = error_of_f32(&double, &single, 0.01, 50);
    let far = error_of_f32(&double, &single, 0.01, 600);
    assert!(far[0] > near[0], "{far:?} {near:?}");
    assert!(far[1] <= 500.0, "{far:?}");
}
