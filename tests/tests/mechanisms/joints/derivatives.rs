//! Derivatives through the rows of joints against dual numbers through the whole elimination: on the joints and off them, with loops, with
//! rows that repeat others.

use std::collections::BTreeSet;

use mbd_compiler::{Interpreted, SceneEquations};
use mbd_runtime::{Generic, Linearisation, Matrix};
use mbd_scene::{Arguments, Coordinates, Differentiated, Layout, Model, Quantity, Scene, Variable};
use tests::instant::{partial_by_oracle, value};
use tests::looped::mechanism;
use tests::random::Random;

const MECHANISMS: u64 = 50;

fn somewhere(scene: &Scene, state: &[f64], random: &mut Random) -> Arguments<f64> {
    let layout = Layout::new(scene);
    let list = |n: usize, random: &mut Random| (0..n).map(|_| random.uniform(-3.0, 3.0)).collect();
    Arguments {
        state: state.to_vec(),
        inputs: list(layout.ni, random),
        hold: vec![0.0; layout.one_way()],
        ..Arguments::default()
    }
}

/// Takes out of the columns of every quaternion what changes its length: rotations do not depend on it.
fn along_unit_quaternions(layout: &Layout, state: &[f64], matrix: &mut [f64]) {
    let columns = layout.nx();
    for at in layout.quaternions() {
        for row in matrix.chunks_exact_mut(columns) {
            let radial: f64 = (at..at + 4).map(|k| row[k] * state[k]).sum();
            (at..at + 4).for_each(|k| row[k] -= radial * state[k]);
        }
    }
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(0.0, |most, x| x.abs().max(most))
}

/// The largest difference, over the largest number.
fn apart(got: &[f64], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len());
    let differences: Vec<f64> = got.iter().zip(want).map(|(a, b)| a - b).collect();
    largest(&differences) / largest(want).max(1e-9)
}

#[test]
fn accelerations_by_state_and_inputs_are_those_of_dual_numbers_through_the_elimination() {
    let (mut loops, mut redundant) = (0, 0);
    for seed in 0..MECHANISMS {
        let (scene, state) = mechanism(seed);
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("a mechanism");
        let layout = generic.layout();
        loops += usize::from(layout.redundancy.loops > 0);
        redundant += usize::from(layout.redundancy.lost() > 0);
        let mut random = Random::new(seed);
        let on = somewhere(&scene, &state, &mut random);
        // Off the joints, as the stages of a step are.
        let mut off = on.clone();
        off.state
            .iter_mut()
            .for_each(|x| *x += random.uniform(-1e-3, 1e-3));
        for at in layout.quaternions() {
            let length = off.state[at..at + 4]
                .iter()
                .map(|x| x * x)
                .sum::<f64>()
                .sqrt();
            off.state[at..at + 4].iter_mut().for_each(|x| *x /= length);
        }
        for (at, place) in [(on, "on"), (off, "off")] {
            let mut linear = Linearisation::new(layout);
            let found = linear.evaluate(&generic, &at.at(), &mut generic.work());
            found.unwrap_or_else(|error| panic!("mechanism {seed}: {error}"));
            for (by, got) in [
                (Variable::State, linear.state()),
                (Variable::Input, linear.input()),
            ] {
                let oracle = partial_by_oracle(&scene, &[], Differentiated::Derivative, by, &at);
                let (mut got, mut want) = (Matrix::values(got).to_vec(), oracle);
                if by == Variable::State {
                    along_unit_quaternions(layout, &at.state, &mut got);
                    along_unit_quaternions(layout, &at.state, &mut want);
                }
                let error = apart(&got, &want);
                assert!(
                    error < 1e-10,
                    "mechanism {seed} {place} {by:?}: {error:.1e}"
                );
            }
        }
    }
    assert!(
        loops >= 20 && redundant >= 8,
        "{loops} with loops, {redundant} redundant"
    );
}

#[test]
fn what_derivatives_are_made_of_is_the_same_interpreted_and_by_the_laws() {
    for seed in 0..MECHANISMS / 2 {
        let (scene, state) = mechanism(seed);
        let equations = SceneEquations::trace_with_derivatives(&scene);
        let interpreted = Interpreted::from_equations(equations, &[]).expect("a mechanism");
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("a mechanism");
        let layout = generic.layout();
        let mut random = Random::new(seed);
        let mut at = somewhere(&scene, &state, &mut random);
        let motion = layout.nv + layout.nc;
        for what in layout.derivatives() {
            let right: Vec<f64> = (0..motion).map(|_| random.uniform(-2.0, 2.0)).collect();
            at.rows.clone_from(&right);
            let [got, want] = [&interpreted as &dyn Model<f64>, &generic].map(|model| {
                let mut at = at.clone();
                if what == Quantity::Solve {
                    // Each by its own factor: where a number happens to be zero, laws skip more than symbols can.
                    at.rows = value(model, Quantity::Factor, &at);
                    at.rows.extend(&right);
                }
                value(model, what, &at)
            });
            if what == Quantity::Factor {
                continue;
            }
            let error = apart(&got, &want);
            assert!(error < 1e-12, "mechanism {seed} {what:?}: {error:.1e}");
        }
    }
}

/// Columns that the registers of every processor of 64 bits hold beside each other.
const BESIDE: usize = 2;

/// Operations of the whole Jacobian by the state, over those of as many state derivatives as it has columns; and of what is emitted for it. One on columns
/// beside each other in a register counts once.
fn cost(scene: &Scene) -> (f64, usize) {
    let equations = SceneEquations::trace_with_derivatives(scene);
    let count = |what: Quantity| {
        let program = equations.program(what);
        let Some(program) = program else { return 0 };
        let own = program.cost().total();
        let before = equations.values(what);
        match (&program.by_column, before) {
            (Some(matrix), Some(before)) => {
                let rounds = matrix.columns.len().div_ceil(BESIDE);
                before.cost().total() + rounds * own
            }
            _ => own,
        }
    };
    let layout = &equations.layout;
    let columns = layout.variables(Variable::State);
    let partial = |of| count(Quantity::Partial(of, Variable::State));
    let emitted = match layout.solves() {
        false => partial(Differentiated::Derivative),
        true => {
            partial(Differentiated::Residual) + count(Quantity::Factor) + count(Quantity::Solve)
        }
    };
    // A column in which nothing of the balances and rows changes is not solved for.
    let through = equations.program(Quantity::Partial(Differentiated::Residual, Variable::State));
    let places = through.map_or_else(Vec::new, |program| match &program.by_column {
        Some(matrix) => matrix.pattern.clone(),
        None => {
            let outputs = program.outputs.iter();
            outputs
                .map(|(place, _)| (place / columns, place % columns))
                .collect()
        }
    });
    let solved = places.iter();
    let solved = solved.filter(|(row, _)| !(0..layout.nq).contains(row));
    let solved: BTreeSet<usize> = solved.map(|&(_, column)| column).collect();
    let rounds = solved.len().div_ceil(BESIDE).saturating_sub(1);
    let each = rounds * count(Quantity::Solve);
    let whole = count(Quantity::Derivative) * columns;
    ((emitted + each) as f64 / whole as f64, emitted)
}

fn chain(count: usize) -> Scene {
    tests::declared::read(&format!(
        "model Chain {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body link[i in 0..{count}] {{ mass: 1.0 kg, inertia: diag(0.08, 0.08, 0.001) kg*m^2,
                frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }}
            joint first: hinge from world to link[0].top {{ axis: y }}
            joint next[i in 1..{count}]: hinge from link[i - 1].tip to link[i].top {{ axis: y }}
        }}"
    ))
}

/// A chain whose joints are no two parallel.
fn crossed(count: usize) -> Scene {
    tests::declared::read(&format!(
        "model Crossed {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body link[i in 0..{count}] {{ mass: 1.0 kg, inertia: diag(0.08, 0.05, 0.03) kg*m^2,
                frame top at [0.1, 0.03, 0.5] m, frame tip at [0.0, 0.2, -0.5] m }}
            joint first: hinge from world to link[0].top {{ axis: y }}
            joint next[i in 1..{count}]: hinge from link[i - 1].tip to link[i].top {{ axis: [0.3, 0.8, 0.4] }}
        }}"
    ))
}

#[test]
fn a_jacobian_costs_at_most_half_as_many_derivatives_as_it_has_columns() {
    let ready = |name: &'static str| {
        let found = models::scenes::READY
            .iter()
            .find(|ready| ready.name == name);
        (name, (found.expect("a ready scene").scene)())
    };
    let scenes = [
        ready("parachute"),
        ready("four_bar"),
        ("chain of 16", chain(16)),
    ];
    for (name, scene) in scenes {
        let (ratio, emitted) = cost(&scene);
        println!("{name}: {ratio:.3} of a derivative a column, {emitted} operations emitted");
        assert!(ratio <= 0.5, "{name}: {ratio}");
    }
    // In relative coordinates: axes that stay parallel, so that the scene is found to be planar, and axes that do not.
    for count in [4, 8, 12, 16, 32, 64] {
        for (scene, axes) in [(chain(count), "parallel"), (crossed(count), "crossed")] {
            let (ratio, emitted) = cost(&scene.in_coordinates(Coordinates::Relative));
            println!(
                "chain of {count}, {axes} axes, relative: {ratio:.3} of a derivative a column, {emitted} operations emitted"
            );
            assert!(ratio <= 0.5, "{count}, {axes}: {ratio}");
        }
    }
}

/// A boat that carries a long arm of all joints, a short one, and a mass beside it.
fn boat(count: usize, components: &str) -> Scene {
    let joints = [
        "hinge from $A to $B { axis: [0.3, 0.8, 0.4] }",
        "spherical from $A to $B",
        "prismatic from $A to $B { axis: [1.0, 0.2, 0.0] }",
        "universal from $A to $B { axes: [x, y] }",
        "cylindrical from $A to $B { axis: y }",
        "hinge from $B to $A { axis: z }",
        "screw from $A to $B { axis: x, pitch: 0.1 m }",
        "planar from $B to $A { axis: z }",
    ];
    let arm = (0..count).map(|index| {
        let from = match index {
            0 => "boat.bow".to_owned(),
            _ => format!("link[{}].tip", index - 1),
        };
        let joint = joints[index % joints.len()].replace("$A", &from);
        let joint = joint.replace("$B", &format!("link[{index}].top"));
        let end = if joint.ends_with('}') { "" } else { ";" };
        format!("joint j{index}: {joint}{end}\n")
    });
    let arm: String = arm.collect();
    tests::declared::read(&format!(
        "model Boat {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            coordinates: relative;
            angular_velocity: {components};
            body boat {{ mass: 5.0 kg, inertia: diag(0.8, 0.5, 0.7) kg*m^2, frame bow at [0.3, 0.1, 0.2] m }}
            body link[i in 0..{count}] {{ mass: 1.0 kg, inertia: diag(0.08, 0.05, 0.06) kg*m^2,
                frame top at [0.1, 0.03, 0.5] m, frame tip at [0.0, 0.2, -0.5] m }}
            body fin {{ mass: 0.5 kg, inertia: diag(0.01, 0.02, 0.03) kg*m^2, frame root at [0.1, 0.0, 0.0] m }}
            point buoy {{ mass: 0.25 kg, start at [3.0, 0.0, 0.0] m }}
            joint afloat: free from world to boat.com;
            joint rudder: hinge from boat.bow to fin.root {{ axis: z }}
            {arm}
        }}"
    ))
}

#[test]
fn the_factor_of_a_long_tree_is_that_of_its_mass_matrix() {
    for (count, components, long) in [(40, "body", true), (40, "world", true), (5, "body", false)] {
        let scene = boat(count, components);
        let generic = Generic::<f64>::with_defaults(scene.clone()).expect("a boat");
        let interpreted = {
            let equations = SceneEquations::trace_with_derivatives(&scene);
            Interpreted::from_equations(equations, &[]).expect("a boat")
        };
        let layout = generic.layout();
        assert_eq!(layout.elimination.order.articulated_factor, long);
        let mut random = Random::new(count as u64);
        let mut state: Vec<f64> = (0..layout.nx())
            .map(|_| random.uniform(-1.5, 1.5))
            .collect();
        for at in layout.quaternions() {
            let part = &mut state[at..at + 4];
            let length = part.iter().map(|x| x * x).sum::<f64>().sqrt();
            part.iter_mut().for_each(|x| *x /= length);
        }
        let (n, columns) = (layout.nv, 6);
        let right: Vec<f64> = (0..n * columns)
            .map(|_| random.uniform(-2.0, 2.0))
            .collect();
        let mut at = Arguments {
            state,
            ..Arguments::default()
        };
        let mass = value(&generic, Quantity::MassMatrix, &at);
        for model in [&generic as &dyn Model<f64>, &interpreted] {
            at.rows.clear();
            let factor = value(model, Quantity::Factor, &at);
            at.rows.clone_from(&factor);
            at.rows.extend(&right);
            let mut found = vec![0.0; n * columns];
            model.evaluate(Quantity::Solve, &at.at(), &mut model.work(), &mut found);
            let back: Vec<f64> = (0..n * columns)
                .map(|place| {
                    let (row, column) = (place / columns, place % columns);
                    (0..n)
                        .map(|k| mass[row * n + k] * found[k * columns + column])
                        .sum()
                })
                .collect();
            let error = apart(&back, &right);
            assert!(error < 1e-10, "{count}, {components}: {error:.1e}");
            // One by one they are the same to the bit.
            for column in 0..columns {
                at.rows.clone_from(&factor);
                at.rows.extend(right.iter().skip(column).step_by(columns));
                let alone = value(model, Quantity::Solve, &at);
                let beside = found.iter().skip(column).step_by(columns);
                assert!(beside.zip(&alone).all(|(a, b)| a.to_bits() == b.to_bits()));
            }
        }
        // Through it, accelerations have the derivatives that dual numbers have through articulated bodies.
        at.rows.clear();
        let mut linear = Linearisation::new(layout);
        let found = linear.evaluate(&generic, &at.at(), &mut generic.work());
        found.expect("derivatives");
        let mut got = linear.state().values().to_vec();
        let by = Variable::State;
        let mut want = partial_by_oracle(&scene, &[], Differentiated::Derivative, by, &at);
        along_unit_quaternions(layout, &at.state, &mut got);
        along_unit_quaternions(layout, &at.state, &mut want);
        let error = apart(&got, &want);
        assert!(error < 1e-10, "{count}, {components}: {error:.1e}");
    }
}

#[test]
fn what_is_emitted_for_derivatives_grows_linearly_in_an_open_chain() {
    let [four, eight, sixteen] = [4, 8, 16].map(|count| cost(&chain(count)).1);
    println!("{four} {eight} {sixteen}");
    assert_eq!(2 * (eight - four), sixteen - eight);
}
