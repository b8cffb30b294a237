//! Interpreted programs against the laws run on numbers, and derivatives against dual numbers.

#[path = "../../../mbd-macros/compiler/tests/scenes/mod.rs"]
mod scenes;

use mbd_compiler::{Interpreted, SceneEquations, Slot};
use mbd_scene::Scratch;
use mbd_scene::laws::Numbers;
use mbd_scene::{Arguments, Dual, Layout, Model, Quantity, Scene, Variable};
use scenes::{Random, somewhere};

fn params(scene: &Scene) -> Vec<f64> {
    scene.params.iter().map(|param| param.default).collect()
}

/// Asserts relative agreement, against the largest number of the list.
fn assert_close(what: &str, got: &[f64], want: &[f64], tolerance: f64) {
    assert_eq!(got.len(), want.len());
    let scale = want.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
    for (index, (a, b)) in got.iter().zip(want).enumerate() {
        let near = (a - b).abs() <= tolerance * (scale.min(b.abs() + scale * 1e-3) + f64::EPSILON);
        assert!(
            near || a == b,
            "{what}[{index}]: {a} is not {b} (scale {scale})"
        );
    }
}

fn by_law(scene: &Scene, what: Quantity, place: &Arguments<f64>) -> Vec<f64> {
    let layout = Layout::new(scene);
    let mut out = vec![0.0; layout.len(what)];
    let numbers = Numbers::new(scene, &params(scene));
    let mut scratch = Scratch::new(&layout);
    mbd_scene::evaluate(
        what,
        scene,
        &layout,
        &numbers,
        &place.at(),
        &mut scratch,
        &mut out,
    );
    out
}

type One = Dual<f64, 1>;

fn by_duals(scene: &Scene, of: Quantity, by: Variable, place: &Arguments<f64>) -> Vec<f64> {
    let layout = Layout::new(scene);
    let (rows, columns) = (layout.len(of), layout.variables(by));
    let mut jacobian = vec![0.0; rows * columns];
    for column in 0..columns {
        let mut seeded = place.map(One::constant);
        let mut values: Vec<One> = params(scene).into_iter().map(One::constant).collect();
        match by {
            Variable::State => seeded.state[column].slopes = [1.0],
            Variable::Node => seeded.nodes[column].slopes = [1.0],
            Variable::Parameter => values[column].slopes = [1.0],
            Variable::Input => seeded.inputs[column].slopes = [1.0],
        }
        let mut out = vec![One::constant(0.0); rows];
        let numbers = Numbers::new(scene, &values);
        let mut scratch = Scratch::new(&layout);
        let at = seeded.at();
        mbd_scene::evaluate(of, scene, &layout, &numbers, &at, &mut scratch, &mut out);
        for (row, value) in out.iter().enumerate() {
            jacobian[row * columns + column] = value.slopes[0];
        }
    }
    jacobian
}

#[test]
fn the_interpreter_computes_what_the_laws_compute() {
    for scene in scenes::all() {
        let model = Interpreted::new(scene.clone(), &params(&scene)).expect("defaults are valid");
        let mut work = model.work();
        let mut random = Random(1);
        for _ in 0..20 {
            let place = somewhere(&scene, &mut random);
            for what in model.layout().quantities() {
                let want = match what {
                    Quantity::Partial(of, by) => by_duals(&scene, of.quantity(), by, &place),
                    _ => by_law(&scene, what, &place),
                };
                let mut got = vec![0.0; want.len()];
                model.evaluate(what, &place.at(), &mut work, &mut got);
                assert_close(&format!("{} {what:?}", scene.name), &got, &want, 1e-12);
            }
        }
    }
}

#[test]
fn a_trace_is_the_same_every_time() {
    for scene in scenes::all() {
        let (first, second) = (SceneEquations::trace(&scene), SceneEquations::trace(&scene));
        assert_eq!(first.derived, second.derived);
        assert_eq!(first.programs, second.programs);
    }
}

#[test]
fn terms_of_the_parameters_alone_are_computed_once() {
    let scene = &scenes::all()[1];
    let equations = SceneEquations::trace(scene);
    assert!(equations.derived.cost().divs > 0, "1/mass of the capsule");
    let derivative = equations.program(Quantity::Derivative).expect("traced");
    let mass_is_read = derivative.slots.contains(&Slot::Param(1));
    assert!(!mass_is_read, "the derivative reads 1/mass, not the mass");
}

#[test]
fn a_scene_of_points_and_lines_carries_no_rotation() {
    let equations = SceneEquations::trace(&scenes::knot());
    for (what, program) in &equations.programs {
        assert_eq!(program.cost().trigs, 0, "{what:?}");
    }
    assert_eq!(
        equations.derived.cost().total(),
        0,
        "everything is constant"
    );
}

#[test]
fn a_damping_declared_zero_costs_nothing() {
    let mut scene = scenes::all()[5].clone();
    let cost = |scene: &Scene| {
        let equations = SceneEquations::trace(scene);
        equations
            .program(Quantity::Derivative)
            .expect("traced")
            .cost()
            .total()
    };
    let damped = cost(&scene);
    scene
        .lines
        .iter_mut()
        .for_each(|line| line.damping = 0.0.into());
    assert!(cost(&scene) < damped);
}
