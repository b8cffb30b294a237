//! Lines that are wound: free lengths of inputs, states and time, against pendulums of varying length and the work of a winch.

use mbd_runtime::{
    Content, Generic, Options, Quantity, Sampling, Simulation, StepError, Trajectory, model,
};
use tests::agreement::{agrees, agrees_along};
use tests::declared::read;

model! {
    /// A load on a rope from a trolley at rest: the length is a state, wound at the speed of an input.
    pub model Crane<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input speed: speed = 0 m/s;
        state paid = 5 m { rate: speed }
        point bob { mass: 2.0 kg }
        spring rope from world to bob { free_length: paid, stiffness: 1e7 N/m, damping: 2 kN*s/m }
        output pull = rope.tension;
        output stretching = rope.stretch_rate;
    }
}

model! {
    /// The same with a length of time, on a body that turns about nothing.
    model Timed {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body bob { mass: 2.0 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        joint loose: free from world to bob.com;
        line rope from world to bob.com {
            free_length: 5 m + 1 m * sin(0.4 rad/s * time),
            stiffness: 2e5 N/m,
            damping: 200 N*s/m,
        }
    }
}

model! {
    /// A winch above a mass: the rope is drawn in with a rate that is said beside it.
    model Hoist {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input paid: length = 4 m;
        input paying: speed;
        point bob { mass: 3.0 kg }
        line rope from world to bob {
            free_length: [paid, paying],
            stiffness: 5 kN/m,
            damping: 300 N*s/m,
        }
    }
}

const G: f64 = 9.81;

/// θ and θ̇ of a pendulum of length l(t) by small Runge–Kutta steps: θ̈ = −(2 l̇ θ̇ + g sin θ)/l.
fn pendulum(mut x: [f64; 2], end: f64, length: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let steps = 20_000;
    let h = end / f64::from(steps);
    let rates = |t: f64, [angle, rate]: [f64; 2]| {
        let [l, winding] = length(t);
        [rate, -(2.0 * winding * rate + G * angle.sin()) / l]
    };
    let add = |x: [f64; 2], k: [f64; 2], by: f64| [x[0] + by * k[0], x[1] + by * k[1]];
    for step in 0..steps {
        let t = f64::from(step) * h;
        let a = rates(t, x);
        let b = rates(t + 0.5 * h, add(x, a, 0.5 * h));
        let c = rates(t + 0.5 * h, add(x, b, 0.5 * h));
        let d = rates(t + h, add(x, c, h));
        for k in 0..2 {
            x[k] += h / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]);
        }
    }
    x
}

/// Sum of energies.
fn energy(run: &mut Simulation<f64>) -> f64 {
    let mut out = [0.0; 6];
    run.evaluate(Quantity::Energy, &mut out).expect("energies");
    out[..3].iter().sum()
}

#[test]
fn a_crane_swings_as_a_pendulum_of_varying_length() {
    let model = Crane::<f64>::new(CraneParams::default()).expect("defaults");
    let speed = -0.8;
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    run.set_inputs(&CraneInputs { speed }).expect("numbers");
    let (start, l0) = (0.3_f64, 5.0);
    // The rope carries the weight along itself, and its end moves with the drum.
    let stretch = 2.0 * G * start.cos() / 1e7;
    let along = [start.sin(), 0.0, -start.cos()];
    let mut state = CraneState::at_origin();
    state.set_bob(mbd_runtime::PointState {
        position: along.map(|x| x * (l0 + stretch)),
        velocity: along.map(|x| x * speed),
    });
    run.set_state(0.0, &state.to_vec()).expect("a state");
    run.start().expect("a start");
    let before = energy(&mut run);
    run.run(4.0).expect("a smooth motion");
    let x = run.state();
    let angle = x[0].atan2(-x[2]);
    let [want, rate] = pendulum([start, 0.0], 4.0, |t| [l0 + speed * t, speed]);
    assert!((angle - want).abs() < 2e-5, "{angle} against {want}");
    let length = x[0].hypot(x[2]);
    let turning = (x[0] * x[5] - x[2] * x[3]) / (length * length);
    assert!(
        (turning.abs() - rate.abs()).abs() < 1e-4,
        "{turning} against {rate}"
    );
    let gained = energy(&mut run) - before;
    let works = run.work().expect("asked for");
    let error = gained - works.iter().sum::<f64>();
    assert!(error.abs() < 1e-6 * gained.abs(), "{error:e} of {gained} J");
}

#[test]
fn a_length_that_is_a_function_of_time_swings_alike_and_closes_the_balance() {
    let model = Timed::new(TimedParams::default()).expect("defaults");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    let (start, l0) = (-0.4_f64, 5.0);
    let stretch = 2.0 * G * start.cos() / 2e5;
    let along = [start.sin(), 0.0, -start.cos()];
    let mut x = vec![0.0; 13];
    for k in 0..3 {
        x[k] = along[k] * (l0 + stretch);
        x[7 + k] = along[k] * 0.4;
    }
    x[3] = 1.0;
    run.set_state(0.0, &x).expect("a state");
    run.start().expect("a start");
    let before = energy(&mut run);
    run.run(5.0).expect("a smooth motion");
    let x = run.state();
    let length = |t: f64| [l0 + (0.4 * t).sin(), 0.4 * (0.4 * t).cos()];
    let [want, _] = pendulum([start, 0.0], 5.0, length);
    let angle = x[0].atan2(-x[2]);
    assert!((angle - want).abs() < 1e-3, "{angle} against {want}");
    let gained = energy(&mut run) - before;
    let works = run.work().expect("asked for");
    let error = gained - works.iter().sum::<f64>();
    assert!(
        error.abs() < 1e-6 * gained.abs().max(1.0),
        "{error:e} of {gained} J"
    );
}

#[test]
fn a_winch_that_lifts_a_mass_does_the_work_of_its_weight() {
    let model = Hoist::new(HoistParams::default()).expect("defaults");
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    // From rest to rest in 2 s, 1.5 m up: h(τ) = 3 τ² − 2 τ³.
    let lift = |t: f64| {
        let s = (t / 2.0).clamp(0.0, 1.0);
        [
            1.5 * (3.0 - 2.0 * s) * s * s,
            1.5 * 6.0 * s * (1.0 - s) / 2.0,
        ]
    };
    run.control(move |now, inputs: &mut HoistInputs| {
        let [height, rate] = lift(now.time);
        (inputs.paid, inputs.paying) = (4.0 - height, -rate);
    })
    .expect("inputs of this model");
    let hanging = 4.0 + 3.0 * G / 5000.0;
    let mut x = vec![0.0; 6];
    x[2] = -hanging;
    run.set_state(0.0, &x).expect("a state");
    run.run(6.0).expect("a smooth motion");
    let height = run.state()[2] + hanging;
    assert!((height - 1.5).abs() < 1e-7, "{height}");
    let [loads, lost, drives] = run.work().expect("asked for");
    assert_eq!(loads, 0.0);
    let want = 3.0 * G * 1.5;
    assert!(
        (drives + lost - want).abs() < 1e-5 * want,
        "{drives} and {lost} against {want}"
    );
    assert!(lost < 0.0 && lost > -0.05 * want, "{lost}");
}

#[test]
fn a_drum_as_the_language_describes_it_makes_no_energy_and_falls_as_its_load() {
    // I θ̈ = T r, m z̈ = T − m g: with I = m r² the load falls at g/2.
    let language = include_str!("../../../mbd-macros/LANGUAGE.md");
    let between = |from: &str, to: &str| {
        let rest = language.split_once(from).map(|(_, rest)| rest);
        let found = rest.and_then(|rest| rest.split_once(to));
        found.map_or_else(|| panic!("`{from}`"), |(found, _)| found.to_owned())
    };
    let rate = between("of a drum `", "`");
    let force = between("its joint feels the rope by `", "`");
    let scene = read(&format!(
        "model Hoist {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            const radius = 0.2 m;
            body barrel {{ mass: 20 kg, inertia: diag(0.2, 0.12, 0.2) kg*m^2 }}
            point hook {{ mass: 3 kg, start at [0, 0, -5] m }}
            joint drum: hinge from world to barrel.com {{ axis: y, {force} }}
            state paid_out = 5 m {rate}
            line rope from world to hook {{ free_length: paid_out, stiffness: 20 kN/m }}
            output energy = energy.total;
            output height = hook.position.z;
        }}"
    ));
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
    let start = run.output("energy").expect("an output");
    run.run(1.0).expect("a fall");
    let change = run.output("energy").expect("an output") - start;
    assert!(change.abs() < 1e-6, "{change} J");
    let fallen = -5.0 - run.output("height").expect("an output");
    let want = 0.25 * G;
    // The rope stretches by 1 mm and swings about that.
    assert!((fallen - want).abs() < 5e-3, "{fallen} m against {want} m");
}

#[test]
fn a_commanded_length_behind_the_two_states_of_the_language_follows_as_behind_a_filter() {
    let language = include_str!("../../../mbd-macros/LANGUAGE.md");
    let mut examples = language.split("```text\n").skip(1);
    let example = examples.find(|example| example.starts_with("model Hoist"));
    let example = example.and_then(|example| example.split("```").next());
    let scene = read(example.expect("the example"));
    let model = Generic::<f64>::with_defaults(scene).expect("no params");
    let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("options that fit");
    run.set_inputs(&vec![4.0]).expect("one input");
    for time in [0.02, 0.05, 0.1, 0.3] {
        run.run(time).expect("a command that jumps");
        // A step of 1 m is followed by 1 − (1 + t/τ) exp(−t/τ).
        let passed: f64 = time / 0.05;
        let want = 4.0 + (1.0 + passed) * (-passed).exp();
        let found = run.state().last().copied().expect("the last state");
        assert!((found - want).abs() < 1e-8, "{found} against {want}");
    }
}

#[test]
fn a_wound_line_is_the_same_in_every_execution() {
    let crane = Crane::<f64>::new(CraneParams::default()).expect("defaults");
    agrees(&crane);
    agrees(&Timed::new(TimedParams::default()).expect("defaults"));
    agrees(&Hoist::new(HoistParams::default()).expect("defaults"));
    let mut state = CraneState::at_origin();
    state.set_bob(mbd_runtime::PointState {
        position: [1.0, 0.0, -4.8],
        velocity: [0.0; 3],
    });
    agrees_along(&crane, &state.to_vec(), (20, 1e-4), 1e-12);
}

/// A bob that is drawn in on a rope that a step of single precision resolves.
fn winch(setting: &str) -> mbd_runtime::scene::Scene {
    tests::declared::read(&format!(
        "model Winch {{
            gravity: [0.0, 0.0, -9.81] m/s^2; {setting}
            state paid = 5 m {{ rate: -0.8 m/s }}
            point bob {{ mass: 2.0 kg, start at [1.5, 0, -4.8] m }}
            line rope from world to bob {{ free_length: paid, stiffness: 2 kN/m, damping: 50 N*s/m }}
            output place = bob.position;
            output pull = rope.tension;
        }}"
    ))
}

/// Place and pull after two seconds.
fn drawn_in<T: mbd_runtime::Scalar>(setting: &str) -> [f64; 4] {
    let model = mbd_runtime::Generic::<T>::with_defaults(winch(setting)).expect("no params");
    let mut run = Simulation::<T>::new(&model, Options::rk4(1e-3)).expect("options that fit");
    run.run(2.0).expect("a swing");
    let mut out = [T::zero(); 4];
    run.evaluate(Quantity::Outputs, &mut out).expect("no node");
    out.map(|x| x.to_f64())
}

#[test]
fn a_winch_in_single_precision_swings_to_single_precision() {
    for (single, double) in drawn_in::<f32>("").iter().zip(drawn_in::<f64>("")) {
        assert!(
            (single - double).abs() < 1e-3 * (1.0 + double.abs()),
            "{single} {double}"
        );
    }
}

#[test]
fn a_winch_in_a_plane_is_the_winch_in_space() {
    let [flat, deep] = ["planar: xz;", ""].map(drawn_in::<f64>);
    for (flat, deep) in flat.iter().zip(deep) {
        assert!((flat - deep).abs() < 1e-11, "{flat} {deep}");
    }
}

#[test]
fn a_length_that_does_not_follow_its_own_rate_is_refused_by_name() {
    let model = Hoist::new(HoistParams::default()).expect("defaults");
    for wrong in [0.0, -0.5, 2.0] {
        let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
        run.control(move |now, inputs: &mut HoistInputs| {
            inputs.paid = 4.0 - 0.3 * now.time;
            inputs.paying = -0.3 + wrong * now.time.min(1.0);
        })
        .expect("inputs of this model");
        let result = run.run(1.0);
        if wrong == 0.0 {
            result.expect("a length that follows its rate");
            continue;
        }
        let refused = result.expect_err("a rate of another motion").cause;
        let StepError::Command { motor, .. } = &refused else {
            panic!("{refused}");
        };
        assert_eq!(motor, "rope.free_length");
    }
    // A jump of the length between two steps is no winding.
    let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    run.run(0.1).expect("hanging");
    let jump = HoistInputs {
        paid: 3.0,
        paying: 0.0,
    };
    run.set_inputs(&jump).expect("numbers");
    let refused = run.run(0.2).expect_err("a jump of a metre").cause;
    assert!(
        refused.to_string().contains("rope.free_length"),
        "{refused}"
    );
}

/// A platform on cables between the corners of a frame of 4 m by 3 m and its own of 1 m by 0.4 m, each cable with its length and rate as inputs.
fn cable_robot(components: &str) -> mbd_runtime::scene::Scene {
    tests::declared::read(&format!(
        "model CableRobot {{
            gravity: [0.0, 0.0, -9.81] m/s^2; {components}
            input length[i in 0..4]: length = 1.98 m;
            input rate[i in 0..4]: speed = 0 m/s;
            const W = 2 m; const H = 1.5 m; const w = 0.5 m; const h = 0.2 m;
            world {{
                frame post[i in 0..2] at [(2 * i - 1) * W, 0, H],
                frame foot[i in 0..2] at [(2 * i - 1) * W, 0, -H],
            }}
            body platform {{
                mass: 6 kg,
                inertia: diag(0.3, 0.6, 0.8) kg*m^2,
                frame up[i in 0..2] at [(2 * i - 1) * w, 0, h],
                frame down[i in 0..2] at [(2 * i - 1) * w, 0, -h],
            }}
            joint loose: free from world to platform.com;
            line high[i in 0..2] from world.post[i] to platform.up[i] {{
                free_length: [length[i], rate[i]], stiffness: 20 kN/m, damping: 40 N*s/m
            }}
            line low[i in 0..2] from world.foot[i] to platform.down[i] {{
                free_length: [length[i + 2], rate[i + 2]], stiffness: 20 kN/m, damping: 40 N*s/m
            }}
            output pull_high[i in 0..2] = high[i].tension;
            output pull_low[i in 0..2] = low[i].tension;
        }}"
    ))
}

/// Length of a cable of the platform at rest in the middle, and the sine of its slope.
fn middle() -> [f64; 2] {
    let length = 1.5_f64.hypot(1.3);
    [length, 1.3 / length]
}

#[test]
fn a_cable_robot_stands_where_its_tensions_carry_its_weight() {
    for components in ["", "planar: xz;"] {
        let model = mbd_runtime::Generic::<f64>::with_defaults(cable_robot(components));
        let model = model.expect("no params");
        // 2 (T_high − T_low) sin α = m g in the middle: the free lengths that give these tensions.
        let ([length, slope], low) = (middle(), 120.0);
        let high = low + 6.0 * G / (2.0 * slope);
        let mut asked = mbd_runtime::trim(&model);
        for (cable, tension) in [high, high, low, low].into_iter().enumerate() {
            asked = asked.input(&format!("length[{cable}]"), length - tension / 20e3);
        }
        let found = asked.solve().expect("a balance");
        let place = &found.state[..3];
        assert!(place.iter().all(|x| x.abs() < 1e-9), "{place:?}");
        let mut run = Simulation::new(&model, Options::tsit5(1e-9)).expect("options that fit");
        run.set_inputs(&found.inputs).expect("numbers");
        run.set_state(0.0, &found.state).expect("a state");
        let mut pulls = [0.0; 4];
        run.evaluate(Quantity::Outputs, &mut pulls)
            .expect("no node");
        let apart = pulls.iter().zip([high, high, low, low]);
        let apart = apart
            .map(|(got, want)| (got - want).abs())
            .fold(0.0, f64::max);
        assert!(apart < 1e-6, "{pulls:?}");
    }
}

#[test]
fn a_cable_robot_that_is_driven_by_all_its_cables_closes_its_balance() {
    let model = mbd_runtime::Generic::<f64>::with_defaults(cable_robot(""));
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let model = model.expect("no params");
    let mut run = Simulation::new(&model, options).expect("options that fit");
    // The middle goes along an ellipse; each cable is as long as its corners are apart, less a pretension.
    let goal = |t: f64| [0.6 * t.sin(), 0.3 * (1.0 - t.cos())];
    let speed = |t: f64| [0.6 * t.cos(), 0.3 * t.sin()];
    let arm = |cable: usize, [x, z]: [f64; 2]| {
        let side = if cable.is_multiple_of(2) { -1.0 } else { 1.0 };
        let up = if cable < 2 { 1.0 } else { -1.0 };
        [1.5 * side - x, 1.3 * up - z]
    };
    run.control(move |now, inputs: &mut Vec<f64>| {
        for cable in 0..4 {
            let ([dx, dz], [vx, vz]) = (arm(cable, goal(now.time)), speed(now.time));
            let length = dx.hypot(dz);
            inputs[cable] = length - 0.01;
            inputs[4 + cable] = -(dx * vx + dz * vz) / length;
        }
    })
    .expect("plain numbers");
    let mut x = vec![0.0; 13];
    (x[3], x[7]) = (1.0, 0.6);
    run.set_state(0.0, &x).expect("a state");
    run.start().expect("taut");
    let before = energy(&mut run);
    for half in 1..=6 {
        let t = 0.5 * f64::from(half);
        run.run(t).expect("a smooth motion");
        let ([gx, gz], place) = (goal(t), [run.state()[0], run.state()[2]]);
        assert!(
            (place[0] - gx).abs() < 0.02 && (place[1] - gz).abs() < 0.02,
            "{place:?} at {t} s"
        );
    }
    let gained = energy(&mut run) - before;
    let [loads, lost, drives] = run.work().expect("asked for");
    assert_eq!(loads, 0.0);
    // It lifts the platform by 0.6 m.
    assert!(drives > 30.0 && lost < -0.01, "{drives} J, {lost} J");
    let error = gained - drives - lost;
    assert!(error.abs() < 1e-6 * drives, "{error:e} of {drives} J");
}

model! {
    /// A winch that draws its rope in, one that is told to stop, and a rope that is let go of before.
    model Reel {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input speed: speed = -1 m/s;
        state paid = 2 m { rate: speed }
        state other = 2 m { rate: speed }
        point load { mass: 2.0 kg, start at [0.0, 0.0, -2.1] m }
        line rope from world to load { free_length: paid, stiffness: 5 kN/m, damping: 300 N*s/m }
        line loose from world to load { free_length: other, stiffness: 5 N/m }
        event let_go = other falls 1 m { detach: loose, acts: once }
        event near = paid falls 0 m { set: paid = 0.5 m }
    }
}

model! {
    /// A winch that nothing stops.
    model Spent {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        state paid = 2 m { rate: -1 m/s }
        point load { mass: 2.0 kg, start at [0.0, 0.0, -2.1] m }
        line rope from world to load { free_length: paid, stiffness: 5 kN/m, damping: 300 N*s/m }
    }
}

#[test]
fn a_rope_that_is_wound_in_beyond_its_end_is_told_by_its_name() {
    let reel = Reel::new(ReelParams::default()).expect("no params");
    let spent = Spent::new(SpentParams::default()).expect("no params");
    for options in [Options::tsit5(1e-6), Options::rk4(1e-3)] {
        let mut run = Simulation::new(&reel, options).expect("options that fit");
        // An event that winds out again where nothing is left is in time, and what is detached may go on.
        run.run(4.0).expect("it is wound out again");
        let mut onward = Simulation::new(&spent, options).expect("options that fit");
        let mut history = Trajectory::new(&spent, Sampling::Every(1e-4), Content::RESULTS);
        let error = onward
            .record(4.0, &mut history)
            .expect_err("nothing is left");
        let last = history.times().last().expect("rows");
        assert!(*last <= onward.time(), "a row at {last} of a refused step");
        let StepError::NegativeLength { line, time, length } = &error.cause else {
            panic!("{error}");
        };
        assert_eq!(
            (line.as_str(), error.cause.status()),
            ("rope", "negative_length")
        );
        assert!(*time > 2.0 && *time < 3.0 && *length < 0.0, "{error}");
        assert!(onward.time() <= 2.0 + 1e-6, "{}", onward.time());
        let text = error.to_string();
        assert!(
            text.contains("`free_length` of `rope` is -")
                && text.contains("rope.length falls 0.1 m"),
            "{text}"
        );
    }
}

#[test]
fn an_input_that_is_no_length_is_told_where_it_is_given() {
    let hoist = Hoist::new(HoistParams::default()).expect("no params");
    let mut run = Simulation::new(&hoist, Options::rk4(1e-3)).expect("options that fit");
    run.set_inputs(&HoistInputs {
        paid: -1.0,
        paying: 0.0,
    })
    .expect("a number");
    let error = run.run(0.1).expect_err("no length");
    assert!(
        matches!(&error.cause, StepError::NegativeLength { line, .. } if line == "rope"),
        "{error}"
    );
}

model! {
    /// A load between two ropes, each let out or drawn in by what the length or the stretch of the other, or its own, is.
    model Eased {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        planar: xz;
        state left_paid = 2.4 m { rate: 2 / s * (3 m - left.length) + 0 / s * right.stretch }
        state right_paid = 2.4 m {
            rate: if(left.length < 4 m, 2 / s * (3 m - right.length), 0 m/s),
        }
        world { frame a at [-2.0, 0.0, 0.0] m, frame b at [2.0, 0.0, 0.0] m }
        point load { mass: 2.0 kg, start at [0.1, 0.0, -1.5] m }
        line left from world.a to load {
            free_length: left_paid,
            stiffness: 500 N/m,
            damping: 60 N*s/m,
        }
        line right from world.b to load {
            free_length: right_paid,
            stiffness: 500 N/m,
            damping: 60 N*s/m,
        }
        load air on load = -4 N*s/m * load.velocity;
    }
}

#[test]
fn damped_ropes_may_be_wound_by_what_their_lengths_are() {
    let model = Eased::new(EasedParams::default()).expect("no params");
    agrees(&model);
    let options = Options {
        work: true,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::new(&model, options).expect("options that fit");
    run.run(30.0).expect("it comes to rest");
    let missed = run.imbalance().expect("a balance").relative();
    assert!(missed < 1e-6, "{missed}");
    // Both ropes are as long as they are wound to be, under half the weight each.
    let state = EasedState::from_slice(run.state()).expect("its state");
    let depth = 5.0_f64.sqrt();
    let [x, z] = state.load().position;
    assert!(x.abs() < 1e-6 && (z + depth).abs() < 1e-6, "{x} {z}");
    let free = 3.0 - 2.0 * 9.81 / 2.0 * 3.0 / depth / 500.0;
    for paid in [state.left_paid(), state.right_paid()] {
        assert!((paid - free).abs() < 1e-6, "{paid} {free}");
    }
}
