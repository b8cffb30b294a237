//! Derivatives of accelerations by parameters through the joints: masses, inertias, lengths, axes of frames, springs, dampers and gravity of
//! random mechanisms in both families, against dual numbers through the whole elimination and against differences.

use mbd_compiler::Interpreted;
use mbd_runtime::{At, Linearisation, LinearisationError};
use mbd_scene::{
    Arguments, Coordinates, Differentiated, Formula, Gravity, Layout, Model, Parameter, Quantity,
    Scene, Unit, Variable,
};
use tests::declared::read;
use tests::instant::{partial_by_oracle, value};
use tests::looped::mechanism;
use tests::minimal::in_family;
use tests::random::Random;

use super::generic;

const MECHANISMS: u64 = 20;

/// Makes a number a parameter; what is none already is left.
fn free(params: &mut Vec<Parameter>, formula: &mut Formula, kind: &str) {
    if let Formula::Number(default) = *formula {
        *formula = Formula::Param(params.len());
        params.push(Parameter {
            name: format!("{kind}{}", params.len()),
            doc: String::new(),
            default,
            range: None,
            unit: Unit::default(),
        });
    }
}

/// Every number of a mechanism as a parameter.
fn freed(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let params = &mut Vec::new();
    if let Gravity::Uniform { acceleration } = &mut scene.gravity {
        let all = acceleration.iter_mut();
        all.for_each(|x| free(params, x, "gravity"));
    }
    for body in &mut scene.bodies {
        free(params, &mut body.mass, "mass");
        let own = &mut body.inertia;
        for x in [&mut own.xx, &mut own.yy, &mut own.zz] {
            free(params, x, "moment");
        }
        for x in [&mut own.xy, &mut own.xz, &mut own.yz] {
            free(params, x, "product");
        }
        // The first frame is the centre of mass.
        for frame in &mut body.frames[1..] {
            let all = frame.position.iter_mut();
            all.for_each(|x| free(params, x, "length"));
        }
    }
    for joint in &mut scene.joints {
        for own in &mut joint.forces {
            for (formula, kind) in [
                (&mut own.stiffness, "stiffness"),
                (&mut own.damping, "damping"),
            ] {
                formula.iter_mut().for_each(|x| free(params, x, kind));
            }
        }
    }
    scene.params = std::mem::take(params);
    scene
}

fn largest(list: &[f64]) -> f64 {
    list.iter().fold(1.0, |most, x| x.abs().max(most))
}

#[test]
fn accelerations_by_parameters_are_those_of_dual_numbers_and_of_differences_through_the_joints() {
    let (mut loops, mut redundant) = (0, 0);
    let mut kinds = std::collections::BTreeSet::new();
    for case in 0..MECHANISMS {
        let seed = case / 2;
        let family = match case % 2 {
            0 => Coordinates::Absolute,
            _ => Coordinates::Relative,
        };
        let (scene, state) = mechanism(seed);
        let (scene, state) = in_family(&scene, &state, family);
        let scene = freed(&scene);
        let layout = Layout::new(&scene);
        loops += usize::from(layout.redundancy.loops > 0);
        redundant += usize::from(layout.redundancy.lost() > 0);
        let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
        let mut random = Random::new(seed);
        let at = Arguments {
            inputs: (0..layout.ni).map(|_| random.uniform(-3.0, 3.0)).collect(),
            hold: vec![0.0; layout.one_way()],
            state,
            ..Arguments::default()
        };
        let model = generic(scene.clone());
        let mut linear = Linearisation::new(&layout);
        let what = format!("{family:?}, mechanism {seed}");
        let found = linear.evaluate(&model, &at.at(), &mut model.work());
        found.unwrap_or_else(|error| panic!("{what}: {error}"));
        let got = linear.parameter().values();
        let by = (Differentiated::Derivative, Variable::Parameter);
        let want = partial_by_oracle(&scene, &defaults, by.0, by.1, &at);
        let size = largest(&want);
        let apart = got.iter().zip(&want).map(|(a, b)| (a - b).abs() / size);
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-10, "{what}: {apart:.1e}");

        let rates = |params: &[f64]| {
            // The layout is the scene's: it is found once.
            let moved = model
                .with_params(params)
                .expect("what was declared, nearly");
            value(&*moved, Quantity::Derivative, &at)
        };
        let count = defaults.len();
        for (column, param) in scene.params.iter().enumerate() {
            kinds.insert(param.name.trim_end_matches(char::is_numeric).to_owned());
            let by = |by: f64| {
                let mut params = defaults.clone();
                params[column] += by;
                rates(&params)
            };
            let h = 1e-5;
            for (row, (plus, minus)) in by(h).iter().zip(by(-h)).enumerate() {
                let (got, want) = (got[row * count + column], (plus - minus) / (2.0 * h));
                assert!(
                    (got - want).abs() < 1e-6 * size,
                    "{what}, {}, row {row}: {got} is not {want}",
                    param.name
                );
            }
        }
    }
    let all = [
        "damping",
        "gravity",
        "length",
        "mass",
        "moment",
        "product",
        "stiffness",
    ];
    assert!(kinds.iter().eq(&all), "{kinds:?}");
    assert!(
        loops >= 10 && redundant >= 4,
        "{loops} with loops, {redundant} redundant"
    );
}

#[test]
fn derivatives_are_those_of_the_params_of_their_model_whatever_the_room_was_used_for() {
    let scene = read(
        "model Swing { coordinates: relative; gravity: [0, 0, -9.81] m/s^2; param k = 3 N*m/rad;
            body rod { mass: 2 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.5] m }
            joint pin: hinge from world to rod.top { axis: y, force: -k * pin.angle } }",
    );
    let soft = generic(scene);
    let stiff = soft.with_params(&[30.0]).expect("params");
    let (mut linear, mut work) = (Linearisation::new(soft.layout()), soft.work());
    let at = Arguments {
        state: vec![0.0; 2],
        ..Arguments::default()
    };
    let mut slope = |model: &dyn Model<f64>| {
        let done = linear.evaluate(model, &at.at(), &mut work);
        done.expect("derivatives");
        linear.state().at(1, 0)
    };
    // −(m g l + k)/(I + m l²).
    for (model, stiffness) in [
        (&soft as &dyn Model<f64>, 3.0),
        (&*stiff, 30.0),
        (&soft, 3.0),
    ] {
        let expected = -(2.0 * 9.81 * 0.5 + stiffness) / (0.1 + 2.0 * 0.25);
        let found = slope(model);
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// −K/m along the line and its derivative by K; lists that are left out would make it a line that is slack, or a scene without rates.
#[test]
fn lists_that_the_scene_reads_are_not_left_out() {
    let scene = read(
        "model Hung { gravity: [0, 0, -9.81] m/s^2; param k = 100 N/m; input push = 2 N;
            point bob { mass: 2 kg }
            line cord from world to bob { free_length: 1 m, stiffness: k }
            load side on bob = [push, 0 N, 0 N]; }",
    );
    let model = Interpreted::<f64>::new(scene.clone(), &[100.0]).expect("params");
    let model: [&dyn Model<f64>; 2] = [&model, &generic(scene)];
    let state = [0.0, 0.0, -1.2, 0.0, 0.0, 0.0];
    for model in model {
        let mut linear = Linearisation::new(model.layout());
        let mut evaluate = |at: &At<'_, f64>| linear.evaluate(model, at, &mut model.work());
        let whole = At {
            hold: &[0.0],
            ..At::of_state(0.0, &state, &[2.0])
        };
        for (at, what) in [
            (At::of_state(0.0, &state, &[2.0]), "At::hold"),
            (
                At {
                    inputs: &[],
                    ..whole
                },
                "At::inputs",
            ),
            (
                At {
                    state: &state[..5],
                    ..whole
                },
                "At::state",
            ),
            (
                At {
                    nodes: &state[..3],
                    ..whole
                },
                "At::nodes",
            ),
        ] {
            let refused = evaluate(&at).expect_err(what);
            assert!(
                matches!(refused, LinearisationError::Length { what: found, .. } if found == what),
                "{refused}"
            );
        }
        evaluate(&whole).expect("derivatives");
        let found = [
            linear.state().at(5, 2),
            linear.parameter().at(5, 0),
            linear.input().at(3, 0),
        ];
        for (found, expected) in found.into_iter().zip([-100.0 / 2.0, 0.2 / 2.0, 1.0 / 2.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
