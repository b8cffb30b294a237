//! Networks of many nodes: what a model spells out grows with their number, not with its square.

use mbd_compiler::{SceneEquations, emit, read_text};

/// A crate below a chain of knots, each with a stay to the world.
fn chain(knots: usize) -> String {
    format!(
        "model Chain {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{
                frame start at [0.0, 0.0, 0.0] m,
                frame post[i in 0..{knots}] at [i * 1 m, 0.5 m, 0.5 m],
            }}
            body cargo {{ mass: 5 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2, frame eye at [0.0, 0.0, 0.2] m }}
            joint loose: free from world to cargo.com;
            point knot[i in 0..{knots}] {{ equilibrium: static }}
            line first from world.start to knot[0] {{ free_length: 0.8 m, stiffness: 1 kN/m }}
            line link[i in 1..{knots}] from knot[i - 1] to knot[i] {{ free_length: 0.8 m, stiffness: 1 kN/m }}
            line stay[i in 0..{knots}] from world.post[i] to knot[i] {{ free_length: 0.5 m, stiffness: 400 N/m }}
            line last from knot[{knots} - 1] to cargo.eye {{ free_length: 0.8 m, stiffness: 1 kN/m }}
        }}"
    )
}

/// Operations of all quantities, as counted for the limit of a model.
fn operations(knots: usize) -> usize {
    let scene = read_text(&chain(knots)).scene.expect("a chain");
    let cost = SceneEquations::trace(&scene).cost();
    let total = cost.total();
    println!("{knots} knots: {total} operations");
    total
}

#[test]
fn operations_are_linear_in_the_knots_of_a_chain() {
    let [twenty, forty, two_hundred] = [20, 40, 200].map(operations);
    let knot = (forty - twenty) as f64 / 20.0;
    let later = (two_hundred - forty) as f64 / 160.0;
    assert!(
        (later / knot - 1.0).abs() < 0.01,
        "{knot} operations a knot up to 40, {later} up to 200"
    );
}

#[test]
fn chains_of_forty_and_of_two_hundred_knots_are_emitted_as_declared() {
    for knots in [40, 200] {
        let emitted = emit(&read_text(&chain(knots))).to_string();
        assert!(!emitted.contains("compile_error"), "{knots} knots");
    }
}
