//! The interface that `model!` generates: every item of it, used as a user would.

use mbd_runtime::nalgebra::{SMatrix, SVector};
use mbd_runtime::scene::{Dual, Formula};
use mbd_runtime::{
    Content, Cost, Generic, Model, Options, ParamError, Quantity, Sampling, Simulation, Trajectory,
    Wrench,
};

mbd_runtime::model! {
    /// A kite on one line, pushed by the wind.
    pub model Kite<T> {
        gravity: field;
        verify;
        /// Mass of the kite.
        param mass = 2.0 kg in 1.0 kg ..= 4.0 kg;
        /// Stiffness of its line.
        param stiffness = 0.2 kN/m in 0.1 kN/m ..= 0.5 kN/m;
        /// Wind, world axes.
        input wind: [speed; 3];
        /// How much of its area the kite shows.
        input trim: number;
        body kite {
            mass: mass,
            inertia: diag(0.2, 0.3, 0.4) kg*m^2,
            frame bridle at [0.0, 0.0, -0.5] m,
        }
        joint free: free from world to kite.com;
        point tail { mass: 0.1 kg }
        line tether from world to kite.bridle {
            free_length: 10.0 m,
            stiffness: stiffness,
            damping: 5.0 N*s/m,
        }
        line ribbon from kite.bridle to tail {
            free_length: 1.0 m,
            stiffness: 50 N/m,
            damping: 0.5 N*s/m,
        }
        load drag on kite at com =
            0.3 kg/m * trim * norm(wind - kite.velocity) * (wind - kite.velocity);
        load rudder on kite at com: external;
        load flutter on tail: external;
        /// Force in the tether.
        output tether_force = tether.tension;
        output place = kite.position;
        event touch_down = kite.position.z falls 0 m;
    }
}

mbd_runtime::model! {
    /// Two tumbling bodies in the field of a planet, tied by damped lines, dragged by the air: no node, so `verify;` also balances energy.
    pub model Pair<T> {
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        angular_velocity: world;
        verify;
        body first {
            mass: 3.0 kg,
            inertia: full {
                xx: 1.0,
                yy: 1.2,
                zz: 0.9,
                xy: 0.1,
                xz: -0.05,
                yz: 0.02,
            } kg*m^2 (matrix elements),
            frame hook at [0.2, 0.0, 0.1] m,
        }
        body second {
            mass: 2.0 kg,
            inertia: diag(0.5, 0.6, 0.4) kg*m^2,
            frame hook at [0.0, 0.3, 0.0] m,
        }
        joint first_free: free from world to first.com;
        joint second_free: free from world to second.com;
        line tie from first.hook to second.hook {
            free_length: 0.2 m,
            stiffness: 200 N/m,
            damping: 3 N*s/m,
        }
        line back_up from first.com to second.com {
            free_length: 0.1 m,
            stiffness: 100 N/m,
            damping: 2 N*s/m,
        }
        spring rod from world to first.hook {
            free_length: 0.7 m,
            stiffness: 50 N/m,
            damping: 1 N*s/m,
        }
        load drag on first at hook = -0.3 kg/m * norm(first.hook.velocity) * first.hook.velocity;
        load swirl on second at com = [0.1, 0.0, -0.2] N*m;
    }
}

mbd_runtime::model! {
    /// A weight on a spring line, for `f64` only.
    model Weight {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [outputs];
        point weight { mass: 1.0 kg }
        line string from world to weight { free_length: 1.0 m, stiffness: 100 N/m }
        output stretch = string.stretch;
    }
}

/// A wind that grows, a rudder that follows the motion, gravity that depends on the height.
fn breeze<T: mbd_runtime::Real>(time: T, state: &KiteState<T>) -> KiteInputs<T> {
    let mut inputs = KiteInputs {
        wind: [T::from_f64(8.0) + time, T::zero(), T::zero()],
        rudder: Wrench {
            force: [T::zero(), state.v.data.0[0][1], T::zero()],
            couple: [T::zero(); 3],
        },
        flutter: [T::zero(), T::one(), T::zero()],
        ..KiteInputs::default()
    };
    inputs.set_gravity(state, |position| {
        let fall = T::from_f64(-9.81) + T::from_f64(3e-6) * position[2];
        [T::zero(), T::zero(), fall]
    });
    inputs
}

fn kite() -> (Kite, KiteState) {
    let kite = Kite::new(KiteParams::default()).expect("defaults are valid");
    let mut state = KiteState::at_origin();
    (state.q[0], state.q[2]) = (8.0, 7.0);
    (state.q[7], state.q[9]) = (8.5, 5.7);
    state.v[1] = 0.4;
    (kite, state)
}

const HOLD: [f64; 2] = [0.0; 2];

#[test]
fn typed_methods_give_the_numbers_of_the_trait() {
    let (kite, state) = kite();
    let x = state.to_vec();
    assert_eq!(KiteState::from_slice(&x).expect("its own length"), state);
    assert!(KiteState::<f64>::from_slice(&x[1..]).is_none());
    let given = breeze(0.5, &state);
    let inputs = given.to_array();
    assert_eq!(KiteInputs::from_array(inputs), given);
    let at = mbd_runtime::At {
        hold: &HOLD,
        ..mbd_runtime::At::of_state(0.5, &x, &inputs)
    };
    let value = |what: Quantity| {
        let mut out = vec![0.0; kite.layout().len(what)];
        kite.evaluate(what, &at, &mut kite.work(), &mut out);
        out
    };
    let rates = kite.derivative(&state, &HOLD, &given);
    assert_eq!(rates.to_vec(), value(Quantity::Derivative));
    assert_eq!(
        kite.kinematics(&state).as_slice(),
        &value(Quantity::Derivative)[..Kite::<f64>::NQ]
    );
    assert_eq!(
        kite.forces(&state, &HOLD, &given).as_slice(),
        value(Quantity::Forces)
    );
    assert_eq!(
        kite.bias_force(&state, &given).as_slice(),
        value(Quantity::BiasForce)
    );
    let outputs = kite.outputs(&state, &HOLD);
    assert_eq!(outputs.tether_force, value(Quantity::Outputs)[0]);
    assert_eq!(outputs.place, [8.0, 0.0, 7.0]);
    assert_eq!(kite.lines(&state, &HOLD)[0].tension, outputs.tether_force);
    assert!(outputs.tether_force > 0.0, "the tether is taut");
    let energy = kite.energy(&state, &HOLD, &given);
    assert_eq!(
        [energy.kinetic, energy.elastic],
        [value(Quantity::Energy)[0], value(Quantity::Energy)[2]]
    );
    assert_eq!(kite.momentum(&state).linear, value(Quantity::Momentum)[..3]);
    let mut m: SMatrix<f64, 9, 9> = SMatrix::zeros();
    kite.mass_matrix(&mut m);
    assert_eq!(
        m.diagonal(),
        SVector::from([2.0, 2.0, 2.0, 0.2, 0.3, 0.4, 0.1, 0.1, 0.1])
    );
}

#[test]
fn forces_and_bias_give_the_accelerations() {
    let (kite, state) = kite();
    let mut m: SMatrix<f64, 9, 9> = SMatrix::zeros();
    kite.mass_matrix(&mut m);
    let inputs = breeze(0.5, &state);
    let f = kite.forces(&state, &HOLD, &inputs);
    let h = kite.bias_force(&state, &inputs);
    let v = kite.derivative(&state, &HOLD, &inputs).v;
    let residual = m * v + h - f;
    assert!(
        residual.amax() < 1e-12 * f.amax(),
        "M v̇ + h = f: {residual}"
    );
}

#[test]
fn a_simulation_asks_the_callers_function() {
    let (kite, state) = kite();
    let mut simulation =
        Simulation::new(&kite, Options::rk4(1e-3)).expect("fixed steps suit every model");
    simulation
        .control(|sample, inputs: &mut KiteInputs| *inputs = breeze(sample.time, &sample.state()))
        .expect("its own inputs");
    simulation
        .set_state(0.0, &state.to_vec())
        .expect("a state of the scene");
    simulation.start().expect("nothing to solve");
    for _ in 0..10 {
        simulation.step().expect("a stable step");
    }
    assert!((simulation.time() - 0.01).abs() < 1e-12);
}

#[test]
fn parameters_are_checked_and_named() {
    let refused = Kite::new(KiteParams {
        mass: 5.0,
        ..KiteParams::default()
    });
    assert!(matches!(refused, Err(ParamError::OutOfRange { ref param, .. }) if param == "mass"));
    let refused = Kite::new(KiteParams {
        stiffness: f64::NAN,
        ..KiteParams::default()
    });
    assert!(
        matches!(refused, Err(ParamError::NotFinite { ref param, .. }) if param == "stiffness")
    );
}

#[test]
fn constants_tell_what_the_model_is() {
    assert_eq!(
        (
            Kite::<f64>::NQ,
            Kite::<f64>::NV,
            Kite::<f64>::NC,
            Kite::<f64>::NP
        ),
        (10, 9, 0, 2)
    );
    assert_eq!(Kite::<f64>::COORDS[3].name, "kite.qw");
    assert_eq!(Kite::<f64>::SPEEDS[3].unit, "rad/s");
    let stiffness = &Kite::<f64>::PARAMS[1];
    assert_eq!(
        (stiffness.name, stiffness.unit, stiffness.default),
        ("stiffness", "kN/m", 200.0)
    );
    assert_eq!(stiffness.range, Some([100.0, 500.0]));
    assert_eq!(
        KiteOutputs::<f64>::COLUMNS,
        [
            ("tether_force", "N"),
            ("place_x", "m"),
            ("place_y", "m"),
            ("place_z", "m")
        ]
    );
    assert_ne!(Kite::<f64>::DECL_HASH, Weight::DECL_HASH);
    const DERIVATIVE: Cost = Kite::<f64>::COST.of("derivative").unwrap();
    const { assert!(DERIVATIVE.total() < 400) };
    assert_eq!(Kite::<f64>::COST.of("derivation"), None);
    let explained = Kite::<f64>::explain();
    for word in [
        "tether",
        "K = stiffness N/m",
        "mass kg",
        "flutter",
        "Left out",
        "from the caller",
    ] {
        assert!(
            explained.contains(word),
            "{word} is missing in:\n{explained}"
        );
    }
}

#[test]
fn parameters_are_read_and_written_by_serde() {
    let text = serde_json::to_string(&KiteParams::<f64>::default()).expect("plain numbers");
    assert_eq!(text, r#"{"mass":2.0,"stiffness":200.0}"#);
    let back: KiteParams = serde_json::from_str(&text).expect("its own text");
    assert_eq!(back, KiteParams::default());
    assert!(serde_json::from_str::<KiteParams>(r#"{"mass":2.0,"stifness":200.0}"#).is_err());
}

#[test]
fn the_scene_is_the_declaration() {
    let scene = Kite::<f64>::scene();
    assert_eq!(scene.bodies[0].mass, Formula::Param(0));
    assert_eq!(scene.lines[1].name, "ribbon");
    assert_eq!(scene.events[0].name, "touch_down");
}

#[test]
fn equations_run_on_duals_and_on_single_precision() {
    type Slope = Dual<f64, 1>;
    let (kite, state) = kite();
    let duals = Kite::unchecked(KiteParams::<Slope>::default());
    let mut moved = KiteState::<Slope>::at_origin();
    for i in 0..10 {
        moved.q[i] = Dual::constant(state.q[i]);
    }
    for i in 0..9 {
        moved.v[i] = Dual::constant(state.v[i]);
    }
    moved.q[0] = Dual::variable(state.q[0], 0);
    let hold = [Dual::constant(0.0); 2];
    let slope = duals.outputs(&moved, &hold).tether_force.slopes[0];
    let line = &kite.lines(&state, &HOLD)[0];
    let step = 1e-6;
    let mut ahead = state.clone();
    ahead.q[0] += step;
    let difference = (kite.lines(&ahead, &HOLD)[0].tension - line.tension) / step;
    assert!(
        (slope - difference).abs() < 1e-3 * slope.abs(),
        "{slope} is not {difference}"
    );

    let single = Kite::<f32>::new(KiteParams::default()).expect("defaults are valid");
    let mut near = KiteState::<f32>::at_origin();
    near.q = state.q.map(|x| x as f32);
    near.v = state.v.map(|x| x as f32);
    let tension = single.outputs(&near, &[0.0; 2]).tether_force;
    assert!((f64::from(tension) - line.tension).abs() < 1e-4 * line.tension);
}

#[test]
fn a_model_for_f64_alone_needs_no_annotation() {
    let weight = Weight::new(WeightParams::default()).expect("no parameters");
    let mut state = WeightState::at_origin();
    state.q[2] = -1.2;
    assert!((weight.outputs(&state).stretch - 0.2).abs() < 1e-15);
    assert_eq!(Weight::NQ, 3);
}

#[test]
fn a_quantity_that_is_not_emitted_says_so_loudly() {
    let weight = Weight::new(WeightParams::default()).expect("no parameters");
    let x = [0.0; 6];
    let at = mbd_runtime::At {
        hold: &[0.0],
        ..mbd_runtime::At::of_state(0.0, &x, &[])
    };
    let mut energy = [0.0; 6];
    weight.evaluate(Quantity::Energy, &at, &mut weight.work(), &mut energy);
    assert!(energy.iter().all(|x| x.is_nan()));
}

#[test]
fn slices_of_a_wrong_length_leave_the_result_untouched() {
    let (kite, state) = kite();
    let x = state.to_vec();
    let inputs = breeze(0.0, &state).to_array();
    let at = mbd_runtime::At {
        hold: &HOLD,
        ..mbd_runtime::At::of_state(0.0, &x[1..], &inputs)
    };
    let mut out = vec![7.0; 19];
    kite.evaluate(Quantity::Derivative, &at, &mut kite.work(), &mut out);
    assert_eq!(out, vec![7.0; 19]);
    let at = mbd_runtime::At { state: &x, ..at };
    kite.evaluate(Quantity::Derivative, &at, &mut kite.work(), &mut out[1..]);
    assert_eq!(out, vec![7.0; 19]);
}

mbd_runtime::model! {
    /// A stone with an output that nobody asked to be compiled.
    model Mute {
        gravity: none;
        emit: [derivative];
        point stone { mass: 1 kg, start at [0, 0, 2] m }
        output height = stone.position.z;
    }
}

#[test]
fn an_output_that_is_not_emitted_is_an_error_and_no_number() {
    let mute = Mute::new(MuteParams::default()).expect("no params");
    let mut simulation = Simulation::new(&mute, Options::rk4(0.1)).expect("options");
    for (name, said) in [
        ("height", "outputs of a model that does not emit them"),
        ("heigth", "did you mean `height`?"),
    ] {
        let error = simulation.output(name).expect_err("no number").to_string();
        assert!(error.contains(said), "{error}");
    }
    // Nor is a list of them, nor a history.
    let mut out = [0.0; 1];
    let error = simulation.evaluate(Quantity::Outputs, &mut out);
    let error = error.expect_err("no outputs").to_string();
    assert!(
        error.contains("add them to the `emit` of its declaration"),
        "{error}"
    );
    let mut history = Trajectory::new(&mute, Sampling::Every(0.1), Content::RESULTS);
    let error = simulation.record(1.0, &mut history);
    let error = error.expect_err("no outputs").to_string();
    assert!(
        error.contains("add them to the `emit` of its declaration"),
        "{error}"
    );
    // What is emitted is there.
    let model = simulation.model();
    assert!(model.emits(Quantity::Derivative) && !model.emits(Quantity::MassMatrix));
    let mut plain = Trajectory::new(&mute, Sampling::Every(0.1), Content::TIME);
    simulation
        .record(1.0, &mut plain)
        .expect("a run without outputs");
}

#[test]
fn work_needs_the_energy_that_a_model_emits() {
    let mute = Mute::new(MuteParams::default()).expect("no params");
    for method in [Options::rk4(0.1), Options::tsit5(1e-6)] {
        let works = Options {
            work: true,
            ..method
        };
        let error = Simulation::new(&mute, works).err();
        let error = error.expect("no energy to integrate the work of");
        let told = error.to_string();
        for said in [
            "a run with `work`, of a model that does not emit the `energy`",
            "add `energy` to the `emit` of its declaration",
        ] {
            assert!(told.contains(said), "{told}");
        }
        // Momentum is that of the laws, and so is the energy that fixed steps are watched by.
        let follows = Options {
            momentum: true,
            ..method
        };
        let mut run = Simulation::new(&mute, follows).expect("options");
        run.run(1.0).expect("a stone that rests");
        assert!(run.momentum_imbalance().is_some());
        assert_eq!(run.imbalance().map(|found| found.relative()), Some(0.0));
    }
}

mbd_runtime::model! {
    /// A rod on a pin whose inverse dynamics are compiled.
    model Swinging {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        coordinates: relative;
        emit: [derivative, inverse_dynamics, partial];
        body rod {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.01) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint pin: hinge from world to rod.top { axis: y, start: 30 deg }
    }
}

#[test]
fn a_run_is_not_asked_for_what_it_has_no_numbers_for() {
    use mbd_scene::{Differentiated, Variable};
    let model = Swinging::new(SwingingParams::default()).expect("no params");
    let generic = Generic::<f64>::with_defaults(Swinging::scene()).expect("no params");
    // What acts along the pin at which acceleration? At the right-hand sides of nobody nothing is solved, either.
    let asked = [
        Quantity::InverseDynamics,
        Quantity::Residual,
        Quantity::Solve,
        Quantity::Partial(Differentiated::Residual, Variable::State),
    ];
    for model in [&model as &dyn Model<f64>, &generic] {
        let mut run = Simulation::new(model, Options::rk4(0.1)).expect("options");
        for what in asked {
            let mut out = vec![0.0; model.layout().len(what)];
            let refused = run
                .evaluate(what, &mut out)
                .expect_err("asked with nothing");
            assert!(refused.to_string().contains("is asked with"), "{refused}");
        }
    }
    // What a compiled model has no equations for is said before, and no number that is none is handed out.
    let mut run = Simulation::new(&model, Options::rk4(0.1)).expect("options");
    let by_state = Quantity::Partial(Differentiated::Derivative, Variable::State);
    for (what, instead) in [
        (by_state, "take a `Linearisation`"),
        (Quantity::Coordinates, "declare an output of them"),
        (Quantity::MassMatrix, "leave `emit` out"),
        (Quantity::CentreOfMass, "ask `Generic` of its scene"),
        (Quantity::FrameJacobian(0, 0), "ask `Generic` of its scene"),
    ] {
        assert!(!model.emits(what) && generic.emits(what), "{what}");
        let mut out = vec![0.0; model.layout().len(what)];
        let refused = run.evaluate(what, &mut out).expect_err("not emitted");
        assert!(refused.to_string().contains(instead), "{refused}");
        let mut own = Simulation::new(&generic, Options::rk4(0.1)).expect("options");
        own.evaluate(what, &mut out).expect("by the laws");
        assert!(out.iter().all(|x| x.is_finite()), "{what}");
    }
    // Of what a model has nothing there is an empty list.
    assert!(model.emits(Quantity::Lines) && model.emits(Quantity::Derivative));
}
