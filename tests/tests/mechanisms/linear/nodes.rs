//! Linear systems and rests of scenes with equilibrium points, against closed forms.

use mbd_runtime::node::{Nodes, Stage};
use mbd_runtime::{
    Linearisation, LinearisationError, Model, NodeMemory, Options, Simulation, linearise, trim,
};
use nalgebra::DMatrix;
use tests::declared::read;

use super::generic;

/// Stiffness [N/m], damping [N s/m] and free length [m] of the three lines, and stiffness, damping and free length of the hook.
const LINES: [f64; 3] = [5000.0, 200.0, 1.1];
const HOOK: [f64; 3] = [3000.0, 100.0, 0.3];
/// The mass [kg] and gravity [m/s²].
const MASS: f64 = 2.0;
const GRAVITY: f64 = 9.81;

/// A lamp on a hook that hangs on a knot of three lines, whose ends are 1 m beside the vertical through it, 2 m high.
fn lamp(equilibrium: &str) -> String {
    let [[k, c, l], [hk, hc, hl]] = [LINES, HOOK];
    format!(
        "model Lamp {{ gravity: [0, 0, -{GRAVITY}] m/s^2;
            world {{ frame end[i in 0..3] at [cos(i * 120 deg), sin(i * 120 deg), 2] m }}
            point knot {{ equilibrium: {equilibrium} }}
            point lamp {{ mass: {MASS} kg, start at [0, 0, 1.2] m }}
            line wire[i in 0..3] from world.end[i] to knot {{ free_length: {l} m, stiffness: {k} N/m, damping: {c} N*s/m }}
            line hook from knot to lamp {{ free_length: {hl} m, stiffness: {hk} N/m, damping: {hc} N*s/m }}
            output height = knot.position.z; }}"
    )
}

/// A rate node on the straight line between its two anchors moves across it as a point of that line: with v d/(d + e), d from the anchor at rest, e from the one that
/// moves. Both pull alike, so that their parts are 1/d and 1/e; these change with the lengths.
#[test]
fn a_rate_node_between_two_anchors_moves_as_a_point_of_the_line_through_them() {
    const FAR: f64 = 3.0;
    const PLACE: f64 = 1.25;
    const SPEED: f64 = 0.8;
    let scene = read(
        "model Between { gravity: none;
            param near = 0 m;
            param l = 1 m;
            param k = 200 N/m;
            world { frame wall at [near, 0, 0] m }
            point knot { equilibrium: rate }
            point bob { mass: 2 kg }
            line one from world.wall to knot { free_length: l, stiffness: k, damping: 30 N*s/m }
            line other from knot to bob { free_length: 1.2 m, stiffness: 300 N/m, damping: 20 N*s/m }
            output across = knot.velocity.y; }",
    );
    let model = generic(scene);
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
    let state = [FAR, 0.0, 0.0, 0.3, SPEED, 0.0, PLACE, 0.0, 0.0];
    run.set_state(0.0, &state).expect("a state");
    run.start().expect("a start");
    let across = SPEED * PLACE / FAR;
    assert!((run.rates()[7] - across).abs() < 1e-12);
    let space = run.linearise(&[]).expect("a linear system");
    let [knot, x, bob, vy] =
        ["knot.y", "knot.x", "bob.x", "bob.vy"].map(|name| space.state(name).expect("it is there"));
    let output = space.output("across").expect("it is there");
    let by_place = SPEED / FAR;
    for (row, what) in [(space.a.row(knot), "rate"), (space.c.row(output), "output")] {
        for (column, expected) in [(x, by_place), (bob, -across / FAR), (vy, PLACE / FAR)] {
            let found = row[column];
            let by = &space.states[column].name;
            assert!(
                (found - expected).abs() < 1e-12,
                "{what} by {by}: {found} {expected}"
            );
        }
    }

    let (mut nodes, mut memory) = (Nodes::new(model.layout()), NodeMemory::new(model.layout()));
    let mut work = model.work();
    let stage = Stage {
        model: &model,
        time: 0.0,
        state: &state,
        inputs: &[],
    };
    let started = nodes.start_stage(stage, Some(&state[6..]), &mut memory, &mut work);
    started.expect("a balance");
    let mut linear = Linearisation::new(model.layout());
    let at = nodes.at(0.0, &state, &[]);
    let done = linear.evaluate(&model, &at, &mut work);
    done.expect("derivatives");
    for (param, expected) in [
        (0, -SPEED * (FAR - PLACE) / (FAR * FAR)),
        (1, 0.0),
        (2, 0.0),
    ] {
        for found in [
            linear.parameter().at(7, param),
            linear.outputs_by_parameter().at(0, param),
        ] {
            let name = &model.scene().params[param].name;
            assert!(
                (found - expected).abs() < 1e-12,
                "by {name}: {found} {expected}"
            );
        }
    }
}

/// How far the knot hangs below the ends [m], and the tension of a line [N]: 3 T cos θ = m g.
fn hanging() -> (f64, f64) {
    let [stiffness, _, free_length] = LINES;
    let tension = |drop: f64| stiffness * (f64::hypot(1.0, drop) - free_length);
    let (mut low, mut high) = (0.0, 2.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match 3.0 * tension(middle) * middle / f64::hypot(1.0, middle) < MASS * GRAVITY {
            true => low = middle,
            false => high = middle,
        }
    }
    (low, tension(low))
}

#[test]
fn a_rate_node_rests_where_its_lines_balance_and_moves_as_two_dampers_in_series() {
    let (drop, tension) = hanging();
    let length = f64::hypot(1.0, drop);
    let (cosine, sine) = (drop / length, 1.0 / length);
    let knot = 2.0 - drop;
    let height = knot - HOOK[2] - MASS * GRAVITY / HOOK[0];
    let model = generic(read(&lamp("rate")));
    // From a run that stands at its start, and from nothing.
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
    run.start().expect("a start");
    for asked in [
        trim(&model).begin_at(&run),
        trim(&model).guess("lamp.z", 1.2),
    ] {
        let rest = asked.solve().expect("it hangs");
        let found = ["lamp.z", "knot.z"].map(|name| rest.value(name).expect("a coordinate"));
        assert!(
            (found[0] - height).abs() < 1e-9 && (found[1] - knot).abs() < 1e-9,
            "{found:?}"
        );
        // What it gives back starts a run that stays there.
        run.set_state(0.0, &rest.state).expect("a state");
        run.set_nodes(&rest.nodes).expect("places of the nodes");
        run.run(0.5).expect("a run");
        assert!((run.state()[2] - height).abs() < 1e-9, "{:?}", run.state());
        // Along the vertical: m z̈ = −F, F = K_h (z − y) + C_h (ż − ẏ) = k y + c ẏ, of three lines at θ to the vertical.
        let k = 3.0 * (LINES[0] * cosine * cosine + tension / length * sine * sine);
        let c = 3.0 * LINES[1] * cosine * cosine;
        let [hook_k, hook_c, _] = HOOK;
        // ẏ = (K_h (z − y) + C_h ż − k y)/(c + C_h)
        let flow = [hook_k, hook_c, -(k + hook_k)].map(|x| x / (c + hook_c));
        let pull = [k * 0.0 + c * flow[0], c * flow[1], k + c * flow[2]];
        let vertical = DMatrix::from_row_slice(
            3,
            3,
            &[
                0.0,
                1.0,
                0.0, //
                -pull[0] / MASS,
                -pull[1] / MASS,
                -pull[2] / MASS, //
                flow[0],
                flow[1],
                flow[2],
            ],
        );
        let at = run.linearise(&[]).expect("a linear system");
        for space in [&rest.space, &at] {
            assert!(space.accelerations.amax() < 1e-6 && space.undamped.is_empty());
            let all = space.vibrations();
            for want in vertical.clone().complex_eigenvalues().iter() {
                let near = |real: f64, imaginary: f64| {
                    f64::hypot(real - want.re, imaginary - want.im.abs()) < 1e-6 * want.norm()
                };
                assert!(
                    all.iter().any(|one| near(one.real, one.imaginary)),
                    "{want} {all:?}"
                );
            }
        }
    }
}

#[test]
fn a_rate_node_off_balance_is_linearised_where_it_is() {
    let model = generic(read(&lamp("rate")));
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options");
    run.run(0.05).expect("a run");
    let state = run.state().to_vec();
    let rates = run.rates().to_vec();
    let before = run.linearise(&[]).expect("a linear system");
    assert_eq!(run.state(), state);
    let alone = linearise(&model, 0.05, &state, &[]).expect("a linear system");
    for space in [before, alone] {
        for (at, name) in ["lamp.vz", "knot.z"].into_iter().zip(["lamp.vz", "knot.z"]) {
            let told = space.state(at).expect("a name");
            let own = space.accelerations[told - (space.states.len() - space.accelerations.len())];
            let want = rates[[5, 8][usize::from(name == "knot.z")]];
            assert!(
                (own - want).abs() < 1e-6 * want.abs().max(1.0),
                "{name}: {own} {want}"
            );
        }
    }
}

#[test]
fn damping_by_differences_from_step_to_step_has_no_linear_system_and_moves_no_rest() {
    let (drop, _) = hanging();
    let model = generic(read(&lamp("stepwise")));
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    run.start().expect("a start");
    let refused = run.linearise(&[]).expect_err("no linear system");
    assert!(matches!(&refused, LinearisationError::Stepwise { node } if node == "knot"));
    let rest = trim(&model).begin_at(&run).solve().expect("it hangs");
    assert!(
        (rest.nodes[2] - (2.0 - drop)).abs() < 1e-9,
        "{:?}",
        rest.nodes
    );
    assert_eq!(rest.space.undamped, ["knot"]);
}
