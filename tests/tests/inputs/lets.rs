//! Named expressions: what a `let` says once is what is said in its place, in every execution, at no cost.

use mbd_runtime::model;
use mbd_scene::{Model, Quantity};
use tests::agreement::agrees;
use tests::assert_close;
use tests::declared::read;
use tests::instant::{random_instant, value};
use tests::random::Random;

macro_rules! kite {
    ($name:ident { $($named:tt)* } { $($drag:tt)* } { $($mass:tt)* } { $($sum:tt)* }) => {
        model! {
            /// A kite on two tethers.
            pub model $name<T> {
                gravity: [0.0, 0.0, -9.81] m/s^2;
                param area = 3 m^2 in 1 m^2 ..= 9 m^2;
                $($named)*
                world { frame post at [0.0, 0.0, -5.0] m }
                body kite {
                    mass: $($mass)*,
                    inertia: diag(1.0, 1.0, 1.0) kg*m^2,
                    frame tip[i in 0..2] at [0.0, 1.0, 0.0] m * (2 * i - 1),
                }
                joint fly: free from world to kite.com;
                line tether[i in 0..2] from kite.tip[i] to world.post { free_length: 5 m, stiffness: 1 kN/m, damping: 2 N*s/m }
                load air on kite = $($drag)*;
                event slow = norm(kite.velocity) falls 0.5 m/s;
                output force = $($drag)*;
                output both = $($sum)*;
            }
        }
    };
}

kite! { Named {
    const wind = [8.0, 1.0, 0.0] m/s;
    let drag = -0.5 * 1.2 kg/m^3 * area * speed * flow;
    let flow = kite.velocity - wind;
    let speed = norm(flow);
    let kite_mass = area * 0.4 kg/m^2;
    let pull[i in 0..2] = tether[i].tension;
} { drag } { kite_mass } { pull[0] + pull[1] } }

kite! { Written {
} { -0.5 * 1.2 kg/m^3 * area * norm(kite.velocity - [8.0, 1.0, 0.0] m/s) * (kite.velocity - [8.0, 1.0, 0.0] m/s) }
  { area * 0.4 kg/m^2 } { tether[0].tension + tether[1].tension } }

#[test]
fn a_kite_with_named_forces_flies_as_one_that_spells_them_out_at_the_same_cost() {
    let (named, written) = (
        Named::<f64>::new(NamedParams::default()).expect("declared params"),
        Written::<f64>::new(WrittenParams::default()).expect("declared params"),
    );
    agrees(&named);
    let mut random = Random::new(3);
    for _ in 0..20 {
        let instant = random_instant(named.scene(), &mut random);
        for what in named.layout().quantities() {
            let (a, b) = (
                value(&named, what, &instant),
                value(&written, what, &instant),
            );
            assert_close(&a, &b, 1e-14, 1e-14, &format!("{what:?}"));
        }
    }
    assert_eq!(Named::<f64>::COST, Written::<f64>::COST);
    let single = Named::<f32>::new(NamedParams::default()).expect("declared params");
    assert_eq!(single.layout(), named.layout());
}

/// Each let doubles the one before: with every name written out the last has 2^40 terms.
#[test]
fn forty_lets_each_naming_the_one_before_twice_are_evaluated_once_each() {
    let row = "model Row {
        gravity: none;
        point p { mass: 1 kg }
        let x[i in 0..1] = p.position.x / (1 m);
        let x[i in 1..41] = 0.5 * x[i - 1] + 0.5 * x[i - 1];
        output last = x[40];
    }";
    let row = row.replace("let x[i in 0..1] =", "let x[0] =");
    let scene = read(&row);
    let model = mbd_runtime::Generic::new(scene.clone(), &[]).expect("a scene");
    let mut random = Random::new(5);
    let instant = random_instant(&scene, &mut random);
    let found = value(&model, Quantity::Outputs, &instant);
    assert_close(&found, &instant.at().state[..1], 1e-15, 0.0, "x");
}

/// The deepest row of lets that is accepted runs in the stack of a test.
#[test]
fn the_longest_row_of_lets_is_run_and_a_longer_one_refused() {
    let row = |count: usize| {
        format!(
            "model Row {{
                gravity: none;
                point p {{ mass: 1 kg }}
                let x[0] = p.position.x;
                let x[i in 1..{count}] = x[i - 1] + 1 m;
                output last = x[{}];
            }}",
            count - 1
        )
    };
    let scene = read(&row(100));
    let model = mbd_runtime::Generic::new(scene.clone(), &[]).expect("a scene");
    let mut random = Random::new(5);
    let instant = random_instant(&scene, &mut random);
    let found = value(&model, Quantity::Outputs, &instant);
    assert_close(&found, &[instant.at().state[0] + 99.0], 1e-14, 0.0, "x");
    let long = mbd_compiler::read_text(&row(400));
    assert!(long.scene.is_none());
    assert!(long.errors[0].text.contains("rests on too many others"));
}
