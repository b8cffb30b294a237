//! Derivatives through the nodes equal dual numbers at a thousand states along real flights, and are finite at every edge.

use std::ops::Range;

use mbd_compiler::Interpreted;
use mbd_runtime::{Generic, Linearisation};
use mbd_scene::laws::line;
use mbd_scene::{LineEnd, Model, Quantity, Real};
use models::parachute::scene::{
    ParachuteMass, ParachuteRate, ParachuteStatic, ParachuteStepwise, SceneInstant as Start,
    TestCase,
};
use models::parachute::variant::state;
use nalgebra::Vector3;
use tests::assert_close;
use tests::flights::Course;
use tests::implicit::Implicit;
use tests::instant::{Instant, value};
use tests::oracle::Oracle;
use tests::random::Random;

/// Bound of every comparison, relative to the largest number of the vector a row belongs to.
const RELATIVE: f64 = 1e-12;
/// States of each model: 3 × 334 > 1,000.
const STATES: usize = 334;
/// Step of the flights [s].
const STEP: f64 = 0.01;

/// Visits `count` taut states near a flight of case 3, with the nodes in balance there.
fn along_a_flight(
    model: &dyn Model<f64>,
    count: usize,
    seed: u64,
    mut visit: impl FnMut(&Instant<f64>),
) {
    let start = Start::start(TestCase::Three);
    let mut course =
        Course::new(model, &state(model, &start), &start.point).expect("the start is in balance");
    let mut random = Random::new(seed);
    let mut found = 0;
    while found < count {
        course.step(STEP).expect("case 3 flies");
        assert!(course.time < 20.0, "only {found} taut states");
        let nearby = course.nearby(&mut random);
        if course.solve(STEP, &nearby).is_err() {
            continue;
        }
        let at = course.instant(&nearby);
        if is_taut(model, &at) {
            found += 1;
            visit(&at);
        }
    }
}

/// Whether riser and legs span space, with at least 1 N each.
fn is_taut(model: &dyn Model<f64>, at: &Instant<f64>) -> bool {
    let lines = value(model, Quantity::Lines, at);
    let pulling = lines.chunks_exact(10).filter(|line| line[0] > 1.0).count();
    pulling == model.layout().lines.len()
}

/// Rows that form a vector: position, attitude, velocity and angular velocity of each body, position of each rate node.
fn vectors(model: &dyn Model<f64>) -> Vec<Range<usize>> {
    let layout = model.layout();
    let mut vectors = Vec::new();
    for (_, body) in layout.own_bodies() {
        let (q, v) = (body.q, layout.nq + body.v);
        vectors.extend([q..q + 3, q + 3..q + 7, v..v + 3, v + 3..v + 6]);
    }
    vectors.extend(
        (layout.nq + layout.nv..layout.nx())
            .step_by(3)
            .map(|z| z..z + 3),
    );
    vectors
}

/// Vector by vector, each against the largest number of its rows.
#[track_caller]
fn assert_vectors(got: &[f64], want: &[f64], rows: &[Range<usize>], columns: usize, what: &str) {
    assert_eq!(got.len(), want.len(), "{what}");
    for rows in rows {
        let range = rows.start * columns..rows.end * columns;
        let name = format!("{what}, rows {rows:?}");
        assert_close(&got[range.clone()], &want[range], RELATIVE, 1e-15, &name);
    }
}

fn linearised(model: &dyn Model<f64>, at: &Instant<f64>) -> Linearisation<f64> {
    let mut linear = Linearisation::new(model.layout());
    linear
        .evaluate(model, &at.at(), &mut model.work())
        .expect("derivatives without rows");
    linear
}

/// The three ways to run one declaration against the oracle.
fn total_jacobian_equals_the_oracle(model: &dyn Model<f64>, seed: u64) {
    let scene = model.scene().clone();
    let params = model.params();
    let generic = Generic::new(scene.clone(), params).expect("accepted");
    let interpreted = Interpreted::new(scene.clone(), params).expect("accepted");
    let mut oracle = Implicit::new(&scene, params);
    let columns = model.layout().nx();
    let (state, nodes) = (vectors(model), std::iter::once(0..3).collect::<Vec<_>>());
    along_a_flight(model, STATES, seed, |at| {
        let [by_state, node] = oracle.by_state(at);
        for (who, linear) in [
            ("generic", linearised(&generic, at)),
            ("interpreted", linearised(&interpreted, at)),
            ("generated", linearised(model, at)),
        ] {
            let what = format!("{}, {who}", scene.name);
            let (a, w) = (linear.state(), linear.node_by_state());
            assert_vectors(
                a.values(),
                &by_state,
                &state,
                columns,
                &format!("{what}, dẋ/dx"),
            );
            assert_vectors(
                w.values(),
                &node,
                &nodes,
                columns,
                &format!("{what}, dy/dx"),
            );
        }
    });
}

#[test]
fn the_state_jacobian_through_a_static_node_equals_dual_numbers() {
    let model = ParachuteStatic::new(Default::default()).expect("defaults");
    total_jacobian_equals_the_oracle(&model, 11);
}

#[test]
fn the_state_jacobian_through_a_stepwise_node_equals_dual_numbers() {
    let model = ParachuteStepwise::new(Default::default()).expect("defaults");
    total_jacobian_equals_the_oracle(&model, 12);
}

#[test]
fn the_state_jacobian_through_a_rate_node_equals_dual_numbers() {
    let model = ParachuteRate::new(Default::default()).expect("defaults");
    total_jacobian_equals_the_oracle(&model, 13);
}

/// Force of every line on its anchor [N] and the energy of all lines [J], on dual numbers.
fn forces_and_energy(model: &dyn Model<f64>, at: &Instant<Oracle>) -> (Vec<Oracle>, Oracle) {
    let layout = model.layout();
    let zero = Oracle::constant(0.0);
    let (mut forces, mut energy) = (Vec::new(), zero);
    for anchor in &layout.anchors {
        let slots = &layout.lines[anchor.line];
        let place = |end: LineEnd| match end {
            LineEnd::Anchor(i) => Vector3::from_column_slice(&at.ends[6 * i..6 * i + 3]),
            LineEnd::Node(i) => Vector3::from_column_slice(&at.nodes[3 * i..3 * i + 3]),
            LineEnd::Plain => Vector3::zeros(),
        };
        let [from, to] = slots.ends.map(place);
        let effective = slots.effective.expect("a line of a static node");
        let (k, l) = (at.effective[2 * effective], at.effective[2 * effective + 1]);
        let geometry = line::geometry(&(to - from), l);
        let tension = line::effective_tension(k, geometry.stretch);
        let toward = matches!(slots.ends[0], LineEnd::Anchor(_));
        let sign = Oracle::constant(if toward { 1.0 } else { -1.0 });
        forces.extend(geometry.direction.iter().map(|&u| sign * tension * u));
        let stretched = geometry.stretch.max(zero);
        energy += Oracle::constant(0.5) * k * stretched * stretched;
    }
    (forces, energy)
}

/// ∂p/∂anchors, the condensed stiffness and ∂E*/∂anchors by the oracle.
struct ByAnchors {
    node: Vec<f64>,
    stiffness: Vec<f64>,
    energy: Vec<f64>,
    forces: Vec<f64>,
}

fn by_anchors(model: &dyn Model<f64>, oracle: &mut Implicit<'_>, at: &Instant<f64>) -> ByAnchors {
    let anchors = model.layout().anchors.len();
    let columns = 3 * anchors;
    let mut found = ByAnchors {
        node: vec![0.0; at.nodes.len() * columns],
        stiffness: vec![0.0; columns * columns],
        energy: vec![0.0; columns],
        forces: Vec::new(),
    };
    for column in 0..columns {
        let mut seeded = at.map(Oracle::constant);
        let slot = &mut seeded.ends[6 * (column / 3) + column % 3];
        *slot = Oracle::variable(slot.0.re);
        oracle.follow(Quantity::Equilibrium(0), &mut seeded);
        for (row, node) in seeded.nodes.iter().enumerate() {
            found.node[row * columns + column] = node.0.eps;
        }
        let (forces, energy) = forces_and_energy(model, &seeded);
        for (row, force) in forces.iter().enumerate() {
            found.stiffness[row * columns + column] = -force.0.eps;
        }
        found.energy[column] = energy.0.eps;
        found.forces = forces.iter().map(|force| force.0.re).collect();
    }
    found
}

fn anchors_equal_the_oracle(model: &dyn Model<f64>, seed: u64) {
    let scene = model.scene().clone();
    let params = model.params();
    let generic = Generic::new(scene.clone(), params).expect("accepted");
    let interpreted = Interpreted::new(scene.clone(), params).expect("accepted");
    let mut oracle = Implicit::new(&scene, params);
    along_a_flight(model, STATES, seed, |at| {
        let want = by_anchors(model, &mut oracle, at);
        let (node, stiffness) = (Quantity::NodeByAnchor(0), Quantity::CondensedStiffness(0));
        for (who, node, stiffness) in [
            (
                "generic",
                value(&generic, node, at),
                value(&generic, stiffness, at),
            ),
            (
                "interpreted",
                value(&interpreted, node, at),
                value(&interpreted, stiffness, at),
            ),
            (
                "generated",
                value(model, node, at),
                value(model, stiffness, at),
            ),
        ] {
            let what = format!("{}, {who}", scene.name);
            assert_close(
                &node,
                &want.node,
                RELATIVE,
                0.0,
                &format!("{what}, ∂p/∂anchor"),
            );
            assert_close(
                &stiffness,
                &want.stiffness,
                RELATIVE,
                0.0,
                &format!("{what}, condensed stiffness"),
            );
        }
        // The envelope theorem: the node minimises E, so ∂E*/∂p_i is the pull of the line alone, the opposite of the force on its anchor.
        let pull: Vec<f64> = want.forces.iter().map(|force| -force).collect();
        assert_close(
            &want.energy,
            &pull,
            1e-9,
            0.0,
            &format!("{}, ∂E*/∂p_i = T u", scene.name),
        );
    });
}

#[test]
fn a_static_node_follows_its_anchors_as_dual_numbers_say() {
    let model = ParachuteStatic::new(Default::default()).expect("defaults");
    anchors_equal_the_oracle(&model, 21);
}

#[test]
fn a_stepwise_node_follows_its_anchors_as_dual_numbers_say() {
    let model = ParachuteStepwise::new(Default::default()).expect("defaults");
    anchors_equal_the_oracle(&model, 22);
}

/// Everything that is differentiated at an instant, by the three ways to run a declaration, is finite; hands back A = dẋ/dx of each.
fn finite(model: &dyn Model<f64>, at: &Instant<f64>, what: &str) -> [Vec<f64>; 3] {
    fn all(model: &dyn Model<f64>, at: &Instant<f64>, what: &str) -> Vec<f64> {
        let linear = linearised(model, at);
        for (name, matrix) in [
            ("dẋ/dx", linear.state()),
            ("dẋ/dθ", linear.parameter()),
            ("dy/dx", linear.node_by_state()),
            ("dy/dθ", linear.node_by_parameter()),
            ("do/dx", linear.outputs_by_state()),
            ("do/dθ", linear.outputs_by_parameter()),
        ] {
            let finite = matrix.values().iter().all(|x| x.is_finite());
            assert!(finite, "{what}: {name} of {}", model.scene().name);
        }
        for quantity in model.layout().quantities() {
            let value = value(model, quantity, at);
            let finite = value.iter().all(|x| x.is_finite());
            assert!(finite, "{what}: {quantity:?} of {}", model.scene().name);
        }
        linear.state().values().to_vec()
    }
    let (scene, params) = (model.scene().clone(), model.params());
    let generic = Generic::new(scene.clone(), params).expect("accepted");
    let interpreted = Interpreted::new(scene, params).expect("accepted");
    [
        all(&generic, at, what),
        all(&interpreted, at, what),
        all(model, at, what),
    ]
}

/// The start of case 2 with its nodes: everything at rest, every line slack.
fn at_rest(model: &dyn Model<f64>) -> Instant<f64> {
    let start = Start::start(TestCase::Two);
    let course =
        Course::new(model, &state(model, &start), &start.point).expect("the start is in balance");
    course.instant(&course.state)
}

/// Calls a test with every model of the confluence.
macro_rules! every_model {
    ($test:ident) => {
        $test(&ParachuteStatic::new(Default::default()).expect("defaults"));
        $test(&ParachuteStepwise::new(Default::default()).expect("defaults"));
        $test(&ParachuteRate::new(Default::default()).expect("defaults"));
        $test(&ParachuteMass::new(Default::default()).expect("defaults"));
    };
}

#[test]
fn drag_has_no_derivative_at_zero_velocity_and_everything_is_finite_with_every_line_slack() {
    fn test(model: &dyn Model<f64>) {
        let at = at_rest(model);
        let lines = value(model, Quantity::Lines, &at);
        assert!(lines.chunks_exact(10).all(|line| line[0] == 0.0), "slack");
        let (columns, layout) = (at.state.len(), model.layout());
        for jacobian in finite(model, &at, "at rest") {
            // The chute's acceleration by its velocity: −k (|v| 1 + v vᵀ/|v|) → 0.
            for row in layout.nq..layout.nq + 6 {
                for column in layout.nq..layout.nq + 3 {
                    assert_eq!(jacobian[row * columns + column], 0.0);
                }
            }
        }
    }
    every_model!(test);
}

#[test]
fn everything_is_finite_where_the_node_sits_on_an_anchor() {
    fn test(model: &dyn Model<f64>) {
        let start = Start::start(TestCase::Three);
        let rest = at_rest(model);
        let (chute, capsule) = (start.q[2] - 22.0, 1.23);
        let azimuth = 20f64.to_radians();
        for anchor in [
            [0.0, 0.0, chute],
            [0.6 * azimuth.cos(), 0.6 * azimuth.sin(), capsule],
        ] {
            // The position of the confluence is a coordinate, a node state or a node unknown; all lines carry.
            let mut at = rest.clone();
            let owned = Start {
                point: anchor,
                ..start.clone()
            };
            at.state = state(model, &owned);
            if model.layout().nz == 0 && !at.nodes.is_empty() {
                at.nodes = anchor.to_vec();
            }
            for (hold, free_length) in [(0.0, 1.5), (1.0, 1.5), (0.0, 0.0)] {
                at.hold.fill(hold);
                for effective in at.effective.chunks_exact_mut(2) {
                    effective.copy_from_slice(&[50e3, free_length]);
                }
                finite(model, &at, "node on an anchor");
            }
        }
    }
    every_model!(test);
}

#[test]
fn tension_is_continuous_and_everything_finite_one_ulp_on_either_side_of_the_slack_edge() {
    fn test(model: &dyn Model<f64>) {
        let rest = at_rest(model);
        let mut start = Start::start(TestCase::Two);
        // The riser ends at 28.5 − 22 = 6.5 m; around a confluence at 2.5 m its length is 4 m and one ulp more or less, exactly.
        start.q[2] = 28.5;
        let (below, above) = (2.5f64.next_up(), 2.5f64.next_down().next_down());
        for (height, length) in [
            (below, 4.0f64.next_down()),
            (2.5, 4.0),
            (above, 4.0f64.next_up()),
        ] {
            start.point = [0.0, 0.0, height];
            let mut at = rest.clone();
            at.state = state(model, &start);
            if model.layout().nz == 0 && !at.nodes.is_empty() {
                at.nodes = start.point.to_vec();
            }
            at.hold.fill(0.0);
            for (index, effective) in at.effective.chunks_exact_mut(2).enumerate() {
                let law = if index == 0 { [60e3, 4.0] } else { [47e3, 1.5] };
                effective.copy_from_slice(&law);
            }
            let riser = &value(model, Quantity::Lines, &at)[..10];
            assert_eq!(riser[1], length, "{}", model.scene().name);
            assert!((0.0..=60e3 * 1e-15).contains(&riser[0]), "{}", riser[0]);
            assert_eq!(riser[0] > 0.0, length > 4.0);
            finite(model, &at, "slack edge");
        }
    }
    every_model!(test);
}

#[test]
fn a_slack_node_follows_the_mean_of_its_anchors() {
    fn test(model: &dyn Model<f64>) {
        let at = at_rest(model);
        let anchors = model.layout().anchors.len();
        let interpreted =
            Interpreted::new(model.scene().clone(), model.params()).expect("accepted");
        for follow in [
            value(model, Quantity::NodeByAnchor(0), &at),
            value(&interpreted, Quantity::NodeByAnchor(0), &at),
        ] {
            for (index, slope) in follow.iter().enumerate() {
                let (row, column) = (index / (3 * anchors), index % (3 * anchors));
                let mean = if row == column % 3 {
                    1.0 / anchors as f64
                } else {
                    0.0
                };
                assert!((slope - mean).abs() < 1e-12, "{row} {column}: {slope}");
            }
        }
    }
    test(&ParachuteStatic::new(Default::default()).expect("defaults"));
    test(&ParachuteStepwise::new(Default::default()).expect("defaults"));
}
