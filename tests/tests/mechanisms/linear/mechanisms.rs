//! A, B, C, D of fifty random mechanisms against the mechanism as a function of its minimal coordinates: dual numbers through the whole
//! elimination, central differences along the joints, and short runs.

use mbd_runtime::{Generic, Options, Simulation, StateSpace, linearise};
use mbd_scene::joints::JointForces;
use mbd_scene::{
    Coordinates, EnergyKind, Formula, Function, Input, Layout, Load, LoadKind, Model, Output,
    Place, Quantity, Scene, State, Unit,
};
use nalgebra::DVector;
use tests::looped::mechanism;
use tests::mechanism::evaluate;
use tests::minimal::{Minimal, in_family};
use tests::random::Random;

use super::{Held, generic};

const MECHANISMS: u64 = 50;

/// A mechanism that is driven and watched, at a motion that it can have.
struct Driven {
    scene: Scene,
    state: Vec<f64>,
    inputs: Vec<f64>,
    motor: bool,
}

fn apply<const N: usize>(function: Function, arguments: [Formula; N]) -> Formula {
    Formula::Apply(function, arguments.to_vec())
}

fn add_input(scene: &mut Scene, name: &str, default: f64) -> Formula {
    scene.inputs.push(Input {
        default: [default, 0.0, 0.0],
        name: name.to_owned(),
        doc: String::new(),
        components: 1,
        unit: Unit::default(),
    });
    Formula::Input(scene.inputs.len() - 1)
}

/// A motor whose coordinate, rate and acceleration are inputs, on the first joint of one freedom that nothing else holds.
fn add_motor(scene: &mut Scene, state: &[f64]) -> bool {
    let free = Layout::new(scene).freedoms();
    let measured = evaluate(scene, Quantity::JointCoordinates, state, &[], &[]);
    let mut number = 0;
    for joint in 0..scene.joints.len() {
        let law = &scene.joints[joint].law;
        let (own, count) = (number, law.measured().count());
        number += count;
        if law.freedoms() != 1 || count != 1 {
            continue;
        }
        let mut with = scene.clone();
        let course = ["course", "course_rate", "course_gain"];
        let values = [measured[3 * own], measured[3 * own + 1], 0.7];
        let course = [0, 1, 2].map(|k| add_input(&mut with, course[k], values[k]));
        with.joints[joint].forces = vec![JointForces {
            motor: Some(Formula::Vector(course.to_vec())),
            ..JointForces::default()
        }];
        let layout = Layout::new(&with);
        if layout.redundancy.held.is_empty() && layout.freedoms() + 1 == free && free > 2 {
            *scene = with;
            return true;
        }
    }
    false
}

/// A filter that the scene declares, of an input and of a velocity; it pushes the last body.
fn add_filter(scene: &mut Scene) {
    let last = Place::Body(scene.bodies.len() - 1, 0);
    let wish = add_input(scene, "wish", 0.4);
    let seen = Formula::Component(vec![Formula::Velocity(last)], 1);
    let lag = Formula::State(scene.states.len());
    let asked = apply(Function::Add, [wish, seen]);
    let missing = apply(Function::Sub, [asked, lag.clone()]);
    scene.states.push(State {
        name: "lag".to_owned(),
        doc: String::new(),
        start: 0.3.into(),
        unit: Unit::default(),
        rate: apply(Function::Div, [missing, 0.2.into()]),
    });
    let push = apply(Function::Mul, [lag.clone(), lag]);
    scene.loads.push(Load {
        name: "filtered".to_owned(),
        doc: String::new(),
        at: last,
        kind: LoadKind::Force(Formula::Vector(vec![push, 0.2.into(), 0.0.into()])),
    });
}

fn watch(scene: &mut Scene, name: &str, value: Formula, components: usize) {
    scene.outputs.push(Output {
        name: name.to_owned(),
        doc: String::new(),
        value,
        components,
        unit: Unit {
            factor: 1.0,
            ..Unit::default()
        },
    });
}

/// Which bodies are pushed from outside.
#[derive(Clone, Copy, PartialEq)]
enum Pushed {
    Last,
    Every,
}

fn driven(seed: u64, pushed: Pushed) -> Driven {
    let (mut scene, mut state) = mechanism(seed);
    if pushed == Pushed::Last {
        scene.loads.drain(..scene.bodies.len() - 1);
    }
    let motor = !seed.is_multiple_of(3) && add_motor(&mut scene, &state);
    if seed.is_multiple_of(2) {
        add_filter(&mut scene);
        state.push(0.3);
    }
    let last = scene.bodies.len() - 1;
    let place = Place::Body(last, 0);
    watch(&mut scene, "place", Formula::Position(place), 3);
    watch(&mut scene, "felt", Formula::Acceleration(place), 3);
    watch(&mut scene, "spin", Formula::AngularVelocityWorld(last), 3);
    watch(
        &mut scene,
        "kinetic",
        Formula::Energy(EnergyKind::Kinetic),
        1,
    );
    let layout = Layout::new(&scene);
    if layout.redundancy.lost() == 0 {
        watch(&mut scene, "held", Formula::ReactionForce(0), 3);
    }
    let mut random = Random::new(seed + 300);
    let mut inputs = layout.default_inputs(&scene);
    for slots in &layout.inputs {
        if let mbd_scene::InputSource::Load(_) = slots.source {
            inputs[slots.at..slots.at + slots.len].fill_with(|| random.uniform(-2.0, 2.0));
        }
    }
    Driven {
        scene,
        state,
        inputs,
        motor,
    }
}

fn names(space: &StateSpace, rest: usize) -> Vec<&str> {
    let count = (space.states.len() - rest) / 2;
    let all = space.states[..count].iter();
    all.map(|state| state.name.as_str()).collect()
}

/// A number of s, or of u behind them, as the linear system has it: ξ̇, η̇, ż, o.
fn column(space: &StateSpace, number: usize) -> Vec<f64> {
    let n = space.states.len();
    let (of_states, of_outputs, at) = match number.checked_sub(n) {
        None => (&space.a, &space.c, number),
        Some(input) => (&space.b, &space.d, input),
    };
    let (above, below) = (of_states.column(at), of_outputs.column(at));
    above.iter().chain(below.iter()).copied().collect()
}

/// Every driven mechanism in its family, its linear system and the mechanism in the same coordinates.
fn each(family: impl Fn(u64) -> Coordinates, mut check: impl FnMut(&str, &StateSpace, &Minimal)) {
    let (mut loops, mut redundant, mut motors, mut filters) = (0, 0, 0, 0);
    for seed in 0..MECHANISMS {
        let Driven {
            scene,
            state,
            inputs,
            motor,
        } = driven(seed, Pushed::Last);
        let family = family(seed);
        let what = format!("{family:?}, mechanism {seed}");
        let (scene, state) = in_family(&scene, &state, family);
        let layout = Layout::new(&scene);
        loops += usize::from(layout.redundancy.loops > 0);
        redundant += usize::from(layout.redundancy.lost() > 0);
        motors += usize::from(motor);
        filters += usize::from(layout.ns > 0);
        let space = linearise(&generic(scene.clone()), 0.0, &state, &inputs);
        let space = space.unwrap_or_else(|error| panic!("{what}: {error}"));
        let names = names(&space, layout.nx() - layout.nq - layout.nv);
        let minimal = Minimal::new(&scene, &names, &state, &inputs);
        check(&what, &space, &minimal);
    }
    assert!(
        loops >= 20 && redundant >= 8 && motors >= 8 && filters >= 25,
        "{loops} with loops, {redundant} redundant, {motors} with motors, {filters} with states"
    );
}

/// Ten mechanisms in one family, ten in the other.
fn alternately(seed: u64) -> Coordinates {
    match (seed / 10).is_multiple_of(2) {
        true => Coordinates::Absolute,
        false => Coordinates::Relative,
    }
}

fn assert_columns(space: &StateSpace, want: impl Fn(usize) -> Vec<f64>, most: f64, what: &str) {
    let count = space.states.len() + space.inputs.len();
    let pairs: Vec<[Vec<f64>; 2]> = (0..count)
        .map(|number| [column(space, number), want(number)])
        .collect();
    let all = pairs.iter().flat_map(|[_, want]| want);
    let size = all.fold(1.0_f64, |most, x| most.max(x.abs()));
    for (number, [got, want]) in pairs.iter().enumerate() {
        for (row, (got, want)) in got.iter().zip(want).enumerate() {
            let apart = (got - want).abs() / size;
            assert!(
                apart < most,
                "{what}, row {row}, column {number} of {}: {got} is not {want} ({apart:.1e})",
                space.states.len()
            );
        }
    }
}

#[test]
fn linear_systems_are_those_of_dual_numbers_through_the_elimination_in_both_families() {
    for family in [Coordinates::Absolute, Coordinates::Relative] {
        each(
            |_| family,
            |what, space, minimal| {
                let want = |number| {
                    let along = minimal.direction(number);
                    [minimal.swept(&along), minimal.slope(&along)].concat()
                };
                assert_columns(space, want, 1e-10, what);
            },
        );
    }
}

#[test]
fn linear_systems_are_central_differences_of_mechanisms_in_their_minimal_coordinates() {
    each(alternately, |what, space, minimal| {
        // The sixth order leaves h⁶ of the seventh derivative, and rounding over h.
        let h = 3e-5;
        let want = |number| {
            let along = minimal.direction(number);
            let at = |by: f64| DVector::from_vec(minimal.value(&along, by));
            let [near, mid, far] = [1.0, 2.0, 3.0].map(|k| at(k * h) - at(-k * h));
            let slope = (near * 45.0 - mid * 9.0 + far) / (60.0 * h);
            [minimal.swept(&along), slope.as_slice().to_vec()].concat()
        };
        assert_columns(space, want, 1e-6, what);
    });
}

/// How long mechanisms run about a balance [s].
const SPAN: f64 = 0.2;

/// The outputs of a run of [`SPAN`] from a state, at inputs that are held.
fn outputs_after(model: &Generic<f64>, state: &[f64], inputs: &[f64]) -> DVector<f64> {
    let held = Held(inputs.to_vec());
    let mut run = Simulation::with_loads(model, Options::tsit5(1e-12), held).expect("options");
    run.set_state(0.0, state).expect("a state");
    run.run(SPAN).expect("a smooth motion");
    let mut out = DVector::zeros(model.layout().len(Quantity::Outputs));
    run.evaluate(Quantity::Outputs, out.as_mut_slice())
        .expect("no node");
    out
}

#[test]
fn outputs_of_runs_about_a_balance_are_those_of_the_sampled_linear_system() {
    for seed in 0..MECHANISMS {
        let Driven {
            scene,
            mut state,
            mut inputs,
            motor,
        } = driven(seed, Pushed::Every);
        let layout = Layout::new(&scene);
        state[layout.nq..layout.nq + layout.nv].fill(0.0);
        if layout.ns > 0 {
            // The filter is where its input is.
            state[layout.nq + layout.nv] = 0.4;
        }
        // Motors stand still; what they follow does not jump, because their joints would open.
        let course = if motor { 3 } else { 0 };
        inputs[..course]
            .iter_mut()
            .skip(1)
            .for_each(|rate| *rate = 0.0);
        let (scene, state) = in_family(&scene, &state, alternately(seed));
        let model = generic(scene.clone());
        // Accelerations are linear in the loads: those that leave none.
        let there = linearise(&model, 0.0, &state, &inputs).expect("linear");
        let n = there.accelerations.len() - layout.ns;
        let by_loads = there.b.rows(n, n);
        let by_loads = by_loads.columns_range(inputs.len() - 6 * scene.bodies.len()..);
        let inverse = by_loads.into_owned().pseudo_inverse(1e-9).expect("a bound");
        let loads = inverse * there.accelerations.rows(0, n);
        let first = inputs.len() - loads.len();
        (0..loads.len()).for_each(|k| inputs[first + k] -= loads[k]);

        let space = linearise(&model, 0.0, &state, &inputs).expect("linear");
        let what = format!("mechanism {seed}");
        assert!(
            space.accelerations.amax() < 1e-9,
            "{what}: {}",
            space.accelerations
        );
        let [advance, push] = space.sampled(SPAN).expect("a period");
        let step = DVector::from_fn(inputs.len(), |k, _| match k < course {
            true => 0.0,
            false => (2.4 * (k as f64 + 1.0)).sin(),
        });
        let (balance, small) = (DVector::from_vec(inputs), 3e-4);
        let after = |side: f64| {
            let given = &balance + &step * (side * small);
            outputs_after(&model, &state, given.as_slice())
        };
        let got = (after(1.0) - after(-1.0)) / (2.0 * small);
        let want = &space.c * (push * &step) + &space.d * &step;
        let apart = (&got - &want).amax() / want.amax().max(1.0);
        assert!(apart < 1e-7, "{what}: {apart:.1e}");
        // From beside the balance: a coordinate, a rate, and all of them at once.
        let count = space.a.nrows();
        let unit = |at: usize| DVector::from_fn(count, |k, _| f64::from(u8::from(k == at)));
        let all = DVector::from_fn(count, |k, _| (1.7 * (k as f64 + 1.0)).cos());
        let seed = seed as usize;
        for (which, small) in [unit(seed % n), unit(n + seed % n), all]
            .iter()
            .zip([3e-5, 3e-5, 1e-5])
        {
            let moved = &space.tangent * which;
            let after = |side: f64| {
                let state = state.iter().zip(moved.iter());
                let state: Vec<f64> = state.map(|(x, by)| x + side * small * by).collect();
                outputs_after(&model, &state, balance.as_slice())
            };
            let got = (after(1.0) - after(-1.0)) / (2.0 * small);
            let want = &space.c * (&advance * which);
            let apart = (&got - &want).amax() / want.amax().max(1.0);
            assert!(apart < 1e-6, "{what}: {apart:.1e}");
        }
    }
}
