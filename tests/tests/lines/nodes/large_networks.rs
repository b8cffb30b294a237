//! A network of forty nodes compiles as it is declared and runs; what is not spelt out is solved on numbers.

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Model, Options, Quantity, Simulation, model};
use tests::assert_close;
use tests::instant::{random_instant, value};
use tests::random::Random;

model! {
    /// A crate on a net of forty knots, each with a stay to the world.
    pub model Net {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        world {
            frame start at [0.0, 0.0, 0.0] m,
            frame post[i in 0..40] at [i * 1 m, 0.5 m, 0.5 m],
        }
        body crate {
            mass: 5 kg,
            inertia: diag(1.0, 1.0, 1.0) kg*m^2,
            frame eye at [0.0, 0.0, 0.2] m,
        }
        joint loose: free from world to crate.com;
        point knot[i in 0..40] { equilibrium: static }
        line first from world.start to knot[0] { free_length: 0.8 m, stiffness: 1 kN/m }
        line link[i in 1..40] from knot[i - 1] to knot[i] { free_length: 0.8 m, stiffness: 1 kN/m }
        line stay[i in 0..40] from world.post[i] to knot[i] {
            free_length: 0.5 m,
            stiffness: 400 N/m,
        }
        line last from knot[39] to crate.eye { free_length: 0.8 m, stiffness: 1 kN/m }
    }
}

#[test]
fn forty_knots_agree_in_all_three_executions() {
    let net = Net::new(Default::default()).expect("no params");
    let scene = net.scene().clone();
    let generic = Generic::<f64>::with_defaults(scene.clone()).expect("no params");
    let interpreted = Interpreted::new(scene.clone(), &[]).expect("no params");
    let instant = random_instant(&scene, &mut Random::new(40));
    for what in net.layout().quantities() {
        let name = format!("{what:?}");
        let (got, same) = (
            value(&net, what, &instant),
            value(&interpreted, what, &instant),
        );
        assert!(got == same, "{name}");
        assert_close(&got, &value(&generic, what, &instant), 1e-9, 1e-9, &name);
        assert!(
            got.iter().any(|x| *x != 0.0)
                || matches!(what, Quantity::Partial(..) | Quantity::Outputs),
            "{name}"
        );
    }
}

#[test]
fn a_net_of_forty_knots_keeps_its_energy() {
    let net = Net::new(Default::default()).expect("no params");
    let mut run = Simulation::<f64>::new(&net, Options::tsit5(1e-9)).expect("options");
    let mut start = [0.0; 13];
    (start[0], start[2], start[3]) = (40.5, -0.5, 1.0);
    run.set_state(0.0, &start).expect("a state");
    let mut energy = [0.0; 6];
    let mut total = |run: &mut Simulation<f64>| {
        run.evaluate(Quantity::Energy, &mut energy)
            .expect("a balance");
        energy[..3].iter().sum::<f64>()
    };
    let before = total(&mut run);
    run.run(0.5).expect("a swinging crate");
    let after = total(&mut run);
    assert!(
        (after - before).abs() < 1e-5 * before.abs().max(1.0),
        "{before} {after}"
    );
}
