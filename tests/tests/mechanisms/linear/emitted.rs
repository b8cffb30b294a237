//! Derivatives of emitted code, of the interpreter and of the laws; joints and nodes together.

use mbd_compiler::{Interpreted, SceneEquations};
use mbd_runtime::{Generic, Linearisation};
use mbd_scene::{Differentiated, Model, Quantity, Variable};
use tests::assert_close;
use tests::declared::read;
use tests::flights::Course;
use tests::implicit::Implicit;

use super::{generic, placed};

mbd_runtime::model! {
    /// A crank that moves a block through a rod: one loop.
    model Crank {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [partial];
        param rod_mass = 0.7 kg in 0.1 kg ..= 2.0 kg;
        input torque: torque;
        body crank {
            mass: 0.5 kg,
            inertia: diag(0.001, 0.01, 0.01) kg*m^2,
            frame axle at [-0.1, 0.0, 0.0] m,
            frame pin at [0.1, 0.0, 0.0] m,
        }
        body rod {
            mass: rod_mass,
            inertia: diag(0.001, 0.05, 0.05) kg*m^2,
            frame big at [-0.3, 0.0, 0.0] m,
            frame small at [0.3, 0.0, 0.0] m,
        }
        body block { mass: 1.2 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }
        joint main: hinge from world to crank.axle {
            axis: y,
            damping: 0.05 N*m*s,
            force: torque + 0.5 * lag,
        }
        state lag = 0 N*m { rate: (torque - lag) / (50 ms) }
        joint big_end: hinge from crank.pin to rod.big { axis: y }
        joint small_end: spherical from rod.small to block.com;
        joint guide: prismatic from world to block.com { axis: x, stiffness: 40 N/m, rest: 0.7 m }
        output pull = block.velocity * 2.0 kg / 1.0 s;
    }
}

/// ẋ by state, inputs and parameters, and outputs by state; nothing of what a scene has not.
fn derivatives(model: &dyn Model<f64>, at: &mbd_scene::Arguments<f64>) -> [Vec<f64>; 4] {
    let mut linear = Linearisation::new(model.layout());
    let found = linear.evaluate(model, &at.at(), &mut model.work());
    found.expect("a regular position");
    [
        linear.state().values().to_vec(),
        linear.input().values().to_vec(),
        linear.parameter().values().to_vec(),
        linear.outputs_by_state().values().to_vec(),
    ]
}

#[test]
fn derivatives_of_emitted_code_are_those_of_the_interpreter_to_the_bit_and_of_the_laws() {
    let crank = Crank::new(CrankParams::default()).expect("defaults");
    let scene = Crank::scene();
    let params = [0.7];
    let equations = SceneEquations::trace_with_derivatives(&scene);
    let interpreted = Interpreted::from_equations(equations, &params).expect("defaults");
    let laws = Generic::new(scene, &params).expect("defaults");
    let place = [("main.angle", 0.4), ("main.angle_rate", 2.0)];
    let state = placed(&laws, &[1.5], &place);
    let at = mbd_scene::Arguments {
        state,
        inputs: vec![1.5],
        ..mbd_scene::Arguments::default()
    };
    let models = [&crank as &dyn Model<f64>, &interpreted, &laws];
    let found = models.map(|model| derivatives(model, &at));
    let [emitted, interpreted, by_laws] = &found;
    for ((emitted, interpreted), by_laws) in emitted.iter().zip(interpreted).zip(by_laws) {
        let size = by_laws.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert_eq!(emitted, interpreted, "generated and interpreted");
        let what = "generated and by the laws";
        assert_close(emitted, by_laws, 0.0, 1e-12 * size, what);
        assert!(size > 0.0);
    }
}

/// A trunk of many links in relative coordinates: so long that its derivatives are emitted in one direction at a time.
macro_rules! trunk {
    ($($name:tt)*) => {
        mbd_runtime::model! {
            /// A trunk that bends in all directions.
            model $($name)* {
                gravity: [0.0, 0.0, -9.81] m/s^2;
                coordinates: relative;
                emit: [outputs, partial];
                param tip_mass = 0.3 kg in 0.1 kg ..= 2.0 kg;
                input torque: torque;
                input wind: [speed; 3];
                body link[i in 0..12] {
                    mass: 1.0 kg,
                    inertia: diag(0.08, 0.05, 0.03) kg*m^2,
                    frame top at [0.1, 0.03, 0.25] m,
                    frame tip at [0.0, 0.2, -0.25] m,
                }
                body tip { mass: tip_mass, inertia: diag(0.01, 0.02, 0.03) kg*m^2 }
                joint root: hinge from world to link[0].top { axis: y, force: torque + 0.5 * lag }
                joint bend[i in 1..10]: hinge from link[i - 1].tip to link[i].top {
                    axis: x,
                    stiffness: 4 N*m/rad,
                    damping: 0.2 N*m*s,
                }
                joint slide: prismatic from link[9].tip to link[10].top { axis: x, stiffness: 300 N/m, damping: 2 N*s/m }
                joint ball: spherical from link[10].tip to link[11].top;
                joint end: hinge from link[11].tip to tip.com { axis: z, stiffness: 2 N*m/rad }
                state lag = 0 N*m { rate: (torque - lag) / (50 ms) }
                load drag on tip at com = if(norm(wind - tip.velocity) > 1.0 m/s, 0.3, 0.2) * (wind - tip.velocity) * 1.0 N*s/m;
                output reach = norm(tip.position);
                output pace = tip.velocity;
                output swing = abs(slide.slide) + max(tip.position.x, tip.position.z) + atan2(tip.position.y, tip.position.x) * 1.0 m;
            }
        }
    };
}
trunk!(Trunk);
trunk!(TrunkOver<T>);

#[test]
fn derivatives_in_one_direction_at_a_time_are_those_of_the_laws_four_beside_each_other_and_alone() {
    let trunk = Trunk::new(TrunkParams::default()).expect("defaults");
    let alone = TrunkOver::<f64>::new(TrunkOverParams::default()).expect("defaults");
    let scene = Trunk::scene();
    let params = [0.3];
    let equations = SceneEquations::trace_with_derivatives(&scene);
    let what = Quantity::Partial(Differentiated::Residual, Variable::State);
    let program = equations.program(what).expect("traced");
    assert!(
        program.by_column.is_some(),
        "a scene that is too short for this test"
    );
    let interpreted = Interpreted::from_equations(equations, &params).expect("defaults");
    let laws = Generic::new(scene, &params).expect("defaults");
    let inputs = [1.5, 3.0, -1.0, 0.5];
    let place = [
        ("root.angle", 0.4),
        ("bend[3].angle", -0.7),
        ("root.angle_rate", 2.0),
        ("slide.slide", 0.1),
    ];
    let at = mbd_scene::Arguments {
        state: placed(&laws, &inputs, &place),
        inputs: inputs.to_vec(),
        ..mbd_scene::Arguments::default()
    };
    let models = [&trunk as &dyn Model<f64>, &alone, &interpreted, &laws];
    let found = models.map(|model| derivatives(model, &at));
    let [beside, alone, interpreted, by_laws] = &found;
    for kind in 0..by_laws.len() {
        let size = by_laws[kind]
            .iter()
            .fold(0.0_f64, |most, x| most.max(x.abs()));
        assert!(size > 0.0);
        for (found, how) in [
            (beside, "four beside each other"),
            (alone, "alone"),
            (interpreted, "interpreted"),
        ] {
            assert_close(&found[kind], &by_laws[kind], 0.0, 1e-12 * size, how);
        }
    }
}

#[test]
fn derivatives_in_one_direction_at_a_time_have_the_digits_of_single_precision() {
    let double = TrunkOver::<f64>::new(TrunkOverParams::default()).expect("defaults");
    let single = TrunkOver::<f32>::new(TrunkOverParams::default()).expect("defaults");
    let laws = Generic::with_defaults(TrunkOver::<f64>::scene()).expect("defaults");
    let state = placed(
        &laws,
        &[0.0; 4],
        &[("root.angle", 0.4), ("bend[3].angle", -0.7)],
    );
    let inputs = vec![0.5; 4];
    let rounded = |numbers: &[f64]| numbers.iter().map(|&x| x as f32).collect::<Vec<f32>>();
    let in_single = mbd_scene::Arguments {
        state: rounded(&state),
        inputs: rounded(&inputs),
        ..mbd_scene::Arguments::default()
    };
    let at = mbd_scene::Arguments {
        state,
        inputs,
        ..mbd_scene::Arguments::default()
    };
    let mut linear = Linearisation::new(double.layout());
    linear
        .evaluate(&double, &at.at(), &mut double.work())
        .expect("a regular position");
    let mut rough = Linearisation::new(single.layout());
    rough
        .evaluate(&single, &in_single.at(), &mut single.work())
        .expect("a regular position");
    let want = linear.state().values();
    let got: Vec<f64> = rough
        .state()
        .values()
        .iter()
        .map(|&x| f64::from(x))
        .collect();
    let size = want.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert_close(&got, want, 0.0, 1e-4 * size, "single precision");
}

#[test]
fn derivatives_go_through_joints_and_nodes_together() {
    for (equilibrium, damping) in [("static", 0.0), ("rate", 8.0)] {
        let scene = read(&format!(
            "model Guyed {{
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world {{ frame east at [2.0, 0.1, 0.0] m, frame low at [1.8, -0.6, -1.2] m }}
                body bar {{ mass: 2.0 kg, inertia: diag(0.17, 0.17, 0.01) kg*m^2,
                    frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }}
                joint pin: hinge from world to bar.top {{ axis: y }}
                point knot {{ equilibrium: {equilibrium} }}
                line a from world.east to knot {{ free_length: 0.6 m, stiffness: 900 N/m, damping: {damping} N*s/m }}
                line b from world.low to knot {{ free_length: 0.5 m, stiffness: 700 N/m, damping: {damping} N*s/m }}
                line c from bar.tip to knot {{ free_length: 0.4 m, stiffness: 800 N/m, damping: {damping} N*s/m }}
                output pull = c.tension;
            }}"
        ));
        let model = generic(scene.clone());
        let layout = model.layout();
        let at = placed(&model, &[], &[("pin.angle", -0.3), ("pin.angle_rate", 0.8)]);
        let course = Course::new(&model, &at, &[1.2, -0.2, -0.5]).expect("a balance");
        let state = course.state.clone();
        let mut course = course;
        course.solve(0.0, &state).expect("a balance");
        let instant = course.instant(&state);
        let mut linear = Linearisation::new(layout);
        let found = linear.evaluate(&model, &instant.at(), &mut model.work());
        found.expect("a regular position");
        let [mut want, _] = Implicit::new(&scene, &[]).by_state(&instant);
        let mut got = linear.state().values().to_vec();
        let columns = layout.nx();
        for q in layout.quaternions() {
            for rows in [&mut got, &mut want] {
                for row in rows.chunks_exact_mut(columns) {
                    let radial: f64 = (q..q + 4).map(|k| row[k] * state[k]).sum();
                    (q..q + 4).for_each(|k| row[k] -= radial * state[k]);
                }
            }
        }
        let size = want.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        assert_close(&got, &want, 0.0, 1e-10 * size, equilibrium);
    }
}
