//! Three executions of one declaration agree: laws on numbers, the interpreted program, and an independent derivative oracle.

use fuzz::random_scene::random_scene;
use mbd_compiler::Interpreted;
use mbd_runtime::Generic;
use mbd_scene::{Differentiated, Layout, Model, Quantity, Scene, Variable};
use tests::assert_close;
use tests::cores::on_all_cores;
use tests::instant::{partial_by_oracle, random_instant, value};
use tests::random::Random;

const SCENES: u64 = 50;

fn read(text: &str) -> Scene {
    let reading = mbd_compiler::read_text(text);
    let errors: Vec<String> = reading.errors.iter().map(ToString::to_string).collect();
    reading
        .scene
        .unwrap_or_else(|| panic!("{}\n{text}", errors.join("\n")))
}

#[test]
fn interpreted_and_generic_agree_on_every_quantity_of_random_scenes() {
    for seed in 0..SCENES {
        let scene = read(&random_scene(seed));
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("defaults are valid");
        let interpreted =
            Interpreted::new(scene.clone(), generic.params()).expect("defaults are valid");
        let mut random = Random::new(seed + 1000);
        for _ in 0..5 {
            let instant = random_instant(&scene, &mut random);
            for what in Layout::new(&scene).quantities() {
                // A symbolic derivative and dual numbers round differently; both are held to the same bound.
                let relative = if matches!(
                    what,
                    Quantity::NodeByAnchor(_) | Quantity::CondensedStiffness(_)
                ) {
                    1e-9
                } else {
                    1e-12
                };
                let name = format!("scene {seed}, {what:?}");
                assert_close(
                    &value(&interpreted, what, &instant),
                    &value(&generic, what, &instant),
                    relative,
                    1e-12,
                    &name,
                );
            }
        }
    }
}

#[test]
fn every_derivative_equals_the_one_of_an_independent_oracle() {
    let states = on_all_cores(SCENES, |seed| {
        let mut states = 0;
        let scene = read(&random_scene(seed));
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("defaults are valid");
        let interpreted =
            Interpreted::new(scene.clone(), generic.params()).expect("defaults are valid");
        let mut random = Random::new(seed + 2000);
        for _ in 0..20 {
            states += 1;
            let instant = random_instant(&scene, &mut random);
            for of in [
                Differentiated::Derivative,
                Differentiated::Balance,
                Differentiated::Outputs,
            ] {
                for by in Variable::ALL {
                    let oracle = partial_by_oracle(&scene, generic.params(), of, by, &instant);
                    let what = Quantity::Partial(of, by);
                    let name = format!("scene {seed}, {what:?}");
                    assert_close(
                        &value(&interpreted, what, &instant),
                        &oracle,
                        1e-12,
                        1e-12,
                        &format!("{name}, symbolic"),
                    );
                    assert_close(
                        &value(&generic, what, &instant),
                        &oracle,
                        1e-12,
                        1e-12,
                        &format!("{name}, dual"),
                    );
                }
            }
        }
        states
    });
    assert_eq!(states.iter().sum::<u64>(), 1000);
}
