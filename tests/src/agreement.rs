//! Generated code against the interpreter, to the bit, and against the laws on numbers, to rounding.

use mbd_compiler::Interpreted;
use mbd_runtime::Generic;
use mbd_scene::{Model, Quantity};

use crate::assert_close;
use crate::instant::{Instant, value};
use crate::random::Random;

/// Every quantity of a generated model at random instants: bits of the interpreter, 1e-12 of the generic solver.
///
/// # Panics
/// With the first number that differs, its quantity and the model.
pub fn agrees<M: Model<f64>>(model: &M) {
    let scene = model.scene().clone();
    let name = scene.name.clone();
    let interpreted = Interpreted::new(scene.clone(), model.params())
        .expect("the generated model accepted these parameters");
    let generic = Generic::new(scene.clone(), model.params())
        .expect("the generated model accepted these parameters");
    assert_eq!(
        model.layout(),
        generic.layout(),
        "{name}: the declaration and its layout survive code generation"
    );
    let mut random = Random::new(7);
    for _ in 0..20 {
        let instant = Instant::random(&scene, &mut random);
        for what in model.layout().quantities() {
            let (generated, interpreted) = (
                value(model, what, &instant),
                value(&interpreted, what, &instant),
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
                &value(&generic, what, &instant),
                relative,
                1e-12,
                &format!("{name}, {what:?}"),
            );
        }
    }
}
