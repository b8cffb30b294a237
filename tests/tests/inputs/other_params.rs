//! Other params for a living run: it is the run that was made with them, in what it measures by as in its equations, and starts where they say.

use mbd_runtime::{Model, Options, Simulation, Stop, model};
use tests::assert_close;

model! {
    /// A mass on a cord that stays taut, drawn out by half its length, and what decays beside it. As declared it is a kilometre long.
    pub model Cord {
        gravity: none;
        param size = 1000 m;
        param k = 100 N/m;
        state seen = size { rate: -seen / (0.3 s) }
        point bob { mass: 1 kg, start at [1.5 * size, 0, 0] m }
        line cord from world to bob { free_length: size, stiffness: k }
        output x = bob.position.x;
        output left = seen;
    }
}

/// Runs a cord of a millimetre in one that was made with a kilometre, and one that was made with a millimetre.
fn millimetre(options: Options) -> [Simulation<f64>; 2] {
    let small = CordParams {
        size: 1e-3,
        ..CordParams::default()
    };
    let as_declared = Cord::new(CordParams::default()).expect("defaults");
    let mut changed = Simulation::new(&as_declared, options).expect("options");
    changed.set_params(&small).expect("params that can be run");
    let made = Cord::new(small).expect("params that can be run");
    let made = Simulation::new(&made, options).expect("options");
    [changed, made].map(|mut run| {
        assert_eq!(run.run(0.15).expect("it swings"), Stop::Reached);
        run
    })
}

#[test]
fn errors_are_measured_by_the_lengths_of_the_params_that_a_run_has() {
    for options in [
        Options::rk4(1e-3),
        Options::tsit5(1e-6),
        Options::vern7(1e-6),
        Options::rodas5p(1e-6),
        Options::auto(1e-6),
    ] {
        let [mut changed, made] = millimetre(options);
        let name = options.method.name();
        assert_eq!(changed.state(), made.state(), "{name}");
        assert_eq!(changed.statistics(), made.statistics(), "{name}");
        // x = L (1 + ½ cos ωt), ω = 10 rad/s; the other falls by e^(−t/0.3 s). By the scale of a kilometre a single step would do.
        let exact = [1e-3 * (1.0 + 0.5 * 1.5f64.cos()), 1e-3 * (-0.5f64).exp()];
        let found = ["x", "left"].map(|it| changed.output(it).expect("an output"));
        assert_close(&found, &exact, 0.0, 1e-8, name);
    }
}

model! {
    /// A mass on a spring a thousand kilometres from the origin of the world, where numbers are 1e-10 m apart.
    pub model Remote {
        gravity: none;
        param k = 100 N/m;
        world { frame post at [1000000, 0, 0] m }
        point bob { mass: 1 kg, start at [1000002, 0, 0] m }
        spring coil from world.post to bob { free_length: 1 m, stiffness: k }
        event harder = time rises 1 ms { set: k = 1000000 N/m }
    }
}

#[test]
fn rounding_is_measured_by_the_stiffness_that_params_and_events_give() {
    let stiff = RemoteParams { k: 1e13 };
    let soft = Remote::new(RemoteParams::default()).expect("defaults");
    let of = |model: &Remote, options| Simulation::new(model, options).expect("options");
    // ε d K/m against what accelerates it, K/m times its stretch of 1 m.
    let told = |mut run: Simulation<f64>, until: f64| {
        run.run(until).expect("it has its digits");
        run.rounding()
    };
    let made = told(
        of(
            &Remote::new(stiff.clone()).expect("in range"),
            Options::rk4(1e-8),
        ),
        1e-6,
    );
    let mut changed = of(&soft, Options::rk4(1e-8));
    changed.set_params(&stiff).expect("in range");
    let changed = told(changed, 1e-6);
    assert!(made > 1e-10, "{made}");
    assert_eq!(changed.to_bits(), made.to_bits());
    // What an event sets is measured by what it sets.
    let [before, after] = [0.9e-3, 1.1e-3].map(|until| told(of(&soft, Options::rk4(1e-5)), until));
    assert!(after > before && before > 0.0, "{before} {after}");
    // One that was made stiff and is soft is not refused where it has its digits.
    let stiffest = Remote::new(RemoteParams { k: 1e20 }).expect("in range");
    let mut softened = of(&stiffest, Options::rk4(1e-4));
    softened
        .set_params(&RemoteParams::default())
        .expect("in range");
    let made = told(of(&soft, Options::rk4(1e-4)), 0.9e-3);
    assert_eq!(told(softened, 0.9e-3).to_bits(), made.to_bits());
}

macro_rules! hanging {
    ($name:ident, $family:ident) => {
        model! {
            /// A rod on a pin, and a ball that starts by itself.
            pub model $name {
                coordinates: $family;
                gravity: [0.0, 0.0, -9.81] m/s^2;
                param length = 1 m;
                param aside = 0.3 m;
                body rod {
                    mass: 1 kg,
                    inertia: diag(0.1, 0.1, 0.01) kg*m^2,
                    frame top at [0, 0, length / 2] m,
                }
                point ball { mass: 1 kg, start at [aside, 0, 0] m }
                joint pin: hinge from world to rod.top { axis: y }
                output bend = pin.angle;
                output depth = rod.position.z;
                output place = ball.position.x;
            }
        }
    };
}
hanging!(Hanging, absolute);
hanging!(HangingTree, relative);

#[test]
fn what_is_set_by_joints_hangs_by_its_new_length_and_the_rest_starts_where_new_params_say() {
    let params = [2.0, 0.7];
    let models: [&dyn Model<f64>; 2] = [
        &Hanging::new(HangingParams::default()).expect("defaults"),
        &HangingTree::new(HangingTreeParams::default()).expect("defaults"),
    ];
    for model in models {
        let mut run = Simulation::new(model, Options::rk4(1e-3)).expect("options");
        run.set_joints(&[("pin.angle", 0.5)]).expect("a coordinate");
        run.set_params(&params).expect("in range");
        let found = ["bend", "depth", "place"].map(|it| run.output(it).expect("an output"));
        let wanted = [0.5, -0.5f64.cos(), 0.7];
        assert_close(&found, &wanted, 1e-14, 0.0, &model.scene().name);
        assert!(run.start_moved().is_empty(), "nothing has to give way");
        // A state that is given stays what it is.
        let state = run.state().to_vec();
        run.set_state(0.0, &state).expect("its state");
        run.set_params(&[2.0, 0.1]).expect("in range");
        assert_eq!(run.state(), state);
    }
}

model! {
    /// A crank, and a slider on a rod that reaches it only where it is long enough.
    pub model SliderCrank {
        gravity: none;
        coordinates: relative;
        planar: xz;
        param reach = 2 m;
        body crank { mass: 1 kg, inertia: 0.1 kg*m^2, frame eye at [1, 0, 0] m }
        body rod {
            mass: 1 kg,
            inertia: 0.1 kg*m^2,
            frame near at [-reach / 2, 0, 0] m,
            frame far at [reach / 2, 0, 0] m,
        }
        body slider { mass: 1 kg, inertia: 0.1 kg*m^2 }
        joint turn: hinge from world to crank.com { axis: y }
        joint big: hinge from crank.eye to rod.near { axis: y }
        joint guide: prismatic from world to slider.com { axis: x, start: about 3 m }
        joint small: hinge from rod.far to slider.com { axis: y }
        output place = guide.slide;
    }
}

#[test]
fn params_with_which_a_set_coordinate_cannot_be_are_refused_and_change_nothing() {
    let model = SliderCrank::new(SliderCrankParams::default()).expect("defaults");
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options");
    let quarter = 90f64.to_radians();
    run.set_joints(&[("turn.angle", quarter)])
        .expect("it closes");
    let before = run.state().to_vec();
    // A crank of 1 m across the guide is out of reach of a rod of half a metre.
    let refused = run.set_params(&[0.5]).expect_err("it does not reach");
    assert!(refused.to_string().contains("stays open"), "{refused}");
    assert_eq!(run.state(), before);
    assert_eq!(run.model().params(), [2.0]);
    run.set_params(&[1.25]).expect("it reaches");
    let place = run.output("place").expect("an output");
    assert!(
        (place.abs() - 0.75).abs() < 1e-9,
        "a 3-4-5 triangle: {place}"
    );
}
