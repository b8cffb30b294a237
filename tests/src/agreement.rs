//! Generated code against the interpreter, to the bit, and against the laws on numbers, to rounding: at instants and along runs.

use mbd_compiler::Interpreted;
use mbd_runtime::{External, Generic, Options, Scalar, Simulation};
use mbd_scene::{Float, Model, Quantity};

use crate::assert_close;
use crate::instant::{Instant, random_instant, value};
use crate::random::Random;

/// Every quantity of a generated model at random instants: bits of the interpreter, 1e-12 of the generic solver.
///
/// # Panics
/// With the first number that differs, its quantity and the model.
pub fn agrees(model: &dyn Model<f64>) {
    let mut random = Random::new(7);
    let instants: Vec<_> = (0..20)
        .map(|_| random_instant(model.scene(), &mut random))
        .collect();
    agrees_at(model, &instants);
}

/// The same at given instants.
///
/// # Panics
/// As [`agrees`].
pub fn agrees_at(model: &dyn Model<f64>, instants: &[Instant<f64>]) {
    let scene = model.scene().clone();
    let name = scene.name.clone();
    let interpreted = Interpreted::new(scene.clone(), model.params())
        .expect("the generated model accepted these parameters");
    let generic =
        Generic::new(scene, model.params()).expect("the generated model accepted these parameters");
    assert_eq!(
        model.layout(),
        generic.layout(),
        "{name}: the declaration and its layout survive code generation"
    );
    for instant in instants {
        for what in model.layout().quantities() {
            let (generated, interpreted) = (
                value(model, what, instant),
                value(&interpreted, what, instant),
            );
            for (i, (a, b)) in generated.iter().zip(&interpreted).enumerate() {
                assert!(
                    a.to_bits() == b.to_bits(),
                    "{name}, {what:?}[{i}]: generated {a:e}, interpreted {b:e}"
                );
            }
            let relative = if matches!(
                what,
                Quantity::NodeByAnchor(_) | Quantity::CondensedStiffness(_)
            ) {
                1e-9
            } else {
                1e-12
            };
            assert_close(
                &generated,
                &value(&generic, what, instant),
                relative,
                1e-12,
                &format!("{name}, {what:?}"),
            );
        }
    }
}

/// A run of Rk4 with projection from a consistent start: the generated model gives the bits of the interpreter at every step, and after the
/// last one the state of the generic solver to `relative` of its largest number.
///
/// # Panics
/// With the first step that differs, or a run that fails.
pub fn agrees_along<T: Scalar>(
    model: &dyn Model<T>,
    start: &[f64],
    (steps, step): (u32, f64),
    relative: f64,
) {
    let scene = model.scene().clone();
    let name = scene.name.clone();
    let interpreted = Interpreted::new(scene.clone(), model.params()).expect("valid parameters");
    let generic = Generic::new(scene, model.params()).expect("valid parameters");
    let (mut ours, mut theirs, mut laws) = (
        begun(model, start, step),
        begun(&interpreted, start, step),
        begun(&generic, start, step),
    );
    let bits = |state: &[T]| -> Vec<u64> { state.iter().map(|x| x.to_f64().to_bits()).collect() };
    assert_eq!(bits(ours.state()), bits(theirs.state()), "{name}: start");
    for count in 0..steps {
        advance(&mut ours, &name);
        advance(&mut theirs, &name);
        advance(&mut laws, &name);
        assert_eq!(
            bits(ours.state()),
            bits(theirs.state()),
            "{name}: step {count}"
        );
    }
    let wide = |state: &[T]| -> Vec<f64> { state.iter().map(|x| x.to_f64()).collect() };
    assert_close(
        &wide(ours.state()),
        &wide(laws.state()),
        relative,
        0.0,
        &name,
    );
}

/// Inputs that turn with time.
struct Swell;

impl<T: Float> External<T> for Swell {
    fn evaluate(&self, time: T, _: &[T], out: &mut [T]) {
        for (index, number) in out.iter_mut().enumerate() {
            *number = (time + T::from_f64(index as f64)).sin_cos().0;
        }
    }
}

fn begun<T: Scalar>(model: &dyn Model<T>, start: &[f64], step: f64) -> Simulation<T> {
    let mut run = Simulation::with_loads(model, Options::rk4(step), Swell).expect("options");
    let state: Vec<T> = start.iter().map(|&x| T::from_f64(x)).collect();
    run.set_state(0.0, &state).expect("a state");
    run.start().expect("a consistent start");
    run
}

fn advance<T: Scalar>(run: &mut Simulation<T>, name: &str) {
    run.step().unwrap_or_else(|error| panic!("{name}: {error}"));
}
