//! What jumps where an event is jumps behind the step that ends there: every method keeps its order, and nothing is off by a part of the jump.

use mbd_compiler::Interpreted;

use mbd_runtime::{
    Batch, Case, Content, Generic, InLanes, Model, Options, Quantity, Sampling, Scalar, Simulation,
    Trajectory, model,
};
use tests::assert_close;
use tests::declared::read;

model! {
    /// A push forward and back; two masses, one of them on a spring.
    pub model Pushed<T> {
        gravity: none;
        param switch = 1 s in 0.1 s ..= 5 s;
        const k = 10 N/m;
        point free { mass: 1 kg }
        point tied { mass: 1 kg }
        let push = if(time < switch, 1 N, if(time < 2 * switch, -1 N, 0 N));
        load on_free on free = [push, 0 N, 0 N];
        load on_tied on tied = [push, 0 N, 0 N] - k * tied.position;
        event back = time rises switch;
        event over = time rises 2 * switch;
        output x = free.position.x;
        output y = tied.position.x;
        metric given = integral push;
        metric forth = integral max(push, 0 N);
    }
}

/// x and ẋ of both masses after the pushes, at a time.
fn exact(switch: f64, time: f64) -> [f64; 4] {
    let omega = 10.0_f64.sqrt();
    // A step of the force at a time: (1 − cos ωt)/k.
    let answer = |from: f64| {
        let after = (time - from).max(0.0);
        [
            (1.0 - (omega * after).cos()) / 10.0,
            omega * (omega * after).sin() / 10.0,
        ]
    };
    let [on, back, off] = [0.0, switch, 2.0 * switch].map(answer);
    let tied = [0, 1].map(|k| on[k] - 2.0 * back[k] + off[k]);
    [switch * switch, 0.0, tied[0], tied[1]]
}

fn flown<T: Scalar>(model: &dyn Model<T>, options: Options, until: f64) -> [f64; 4] {
    let mut run = Simulation::new(model, options).expect("a model that runs");
    run.run(until).expect("a run that ends");
    let state: Vec<f64> = run.state().iter().map(|x| x.to_f64()).collect();
    [state[0], state[6], state[3], state[9]]
}

#[test]
fn pushes_that_jump_with_the_time_leave_what_they_leave_in_closed_form() {
    // Steps that end on the jump, to the bit or but for rounding, and steps that do not.
    for switch in [1.0, 0.73] {
        let params = PushedParams { switch };
        let model = Pushed::new(params).expect("params in range");
        let interpreted =
            Interpreted::new(model.scene().clone(), &[switch]).expect("params in range");
        let exact = exact(switch, 4.0);
        // What is tied has the error of the method, 20 h⁴ of RK4; what is free has none.
        for (options, within) in [
            (Options::rk4(0.03), [1e-13, 2e-5]),
            (Options::rk4(0.01), [1e-13, 2e-7]),
            (Options::rk4(0.125), [1e-13, 5e-3]),
            (Options::rk4(0.1), [1e-13, 2e-3]),
            (Options::tsit5(1e-10), [1e-13, 1e-9]),
            (Options::vern7(1e-10), [1e-13, 1e-9]),
            (Options::rodas5p(1e-10), [1e-12, 1e-8]),
            (Options::rattle(0.01), [1e-12, 1e-7]),
        ] {
            let one = flown::<f64>(&model, options, 4.0);
            assert_eq!(one, flown::<f64>(&interpreted, options, 4.0), "{options:?}");
            for (k, within) in [within[0], within[0], within[1], within[1]]
                .iter()
                .enumerate()
            {
                let off = (one[k] - exact[k]).abs();
                println!("{switch} {} {k}: {off:.1e}", options.method.name());
                assert!(off < *within, "{switch} {options:?} {k}: {one:?} {exact:?}");
            }
        }
    }
}

#[test]
fn integrals_of_what_jumps_are_those_of_both_sides() {
    let model = Pushed::new(PushedParams { switch: 0.73 }).expect("params in range");
    for options in [
        Options::rk4(0.1),
        Options::rk4(0.03),
        Options::tsit5(1e-8),
        Options::rodas5p(1e-8),
    ] {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        let mut history = Trajectory::new(&model, Sampling::Every(0.5), Content::RESULTS);
        run.record(4.0, &mut history).expect("a run that ends");
        let metrics = history.metrics(model.scene());
        let found: Vec<f64> = metrics
            .iter()
            .filter_map(|metric| metric.value.ok())
            .collect();
        assert_eq!(found.len(), 2, "{metrics:?}");
        assert!(
            found[0].abs() < 1e-12 && (found[1] - 0.73).abs() < 1e-12,
            "{options:?} {found:?}"
        );
    }
}

#[test]
fn they_do_in_single_precision() {
    let model = Pushed::<f32>::new(PushedParams { switch: 0.73_f32 }).expect("params in range");
    for options in [Options::rk4(0.03), Options::tsit5(1e-5)] {
        let found = flown::<f32>(&model, options, 4.0);
        let exact = exact(0.73, 4.0);
        for (found, exact) in found.iter().zip(exact).take(2) {
            assert!((found - exact).abs() < 2e-6, "{options:?} {found} {exact}");
        }
    }
}

#[test]
fn the_order_of_a_method_is_kept_across_them() {
    let model = Pushed::new(PushedParams { switch: 0.73 }).expect("params in range");
    let exact = exact(0.73, 4.0);
    let off = |step: f64| {
        let found = flown::<f64>(&model, Options::rk4(step), 4.0);
        (found[2] - exact[2]).hypot(found[3] - exact[3])
    };
    let order = (off(0.04) / off(0.02)).log2();
    assert!(order > 3.8, "{order}");
}

#[test]
fn cases_beside_each_other_are_what_they_are_alone() {
    let model = Pushed::new(PushedParams::default())
        .expect("defaults")
        .in_lanes();
    let switches = [0.5, 0.73, 1.0, 1.25, 1.31];
    let cases = || switches.iter().map(|switch| Case::new().params([*switch]));
    let options = Options::rk4(0.05);
    let beside = Batch::new(&model, options, 4.0).lanes(4).cases(cases());
    let found = beside.run(|_, history| history.column("y").and_then(|y| y.last().copied()));
    for (found, switch) in found.iter().zip(switches) {
        let alone = Pushed::new(PushedParams { switch }).expect("params in range");
        let alone = flown::<f64>(&alone, options, 4.0);
        assert_eq!(
            found.result.as_ref().ok().copied().flatten(),
            Some(alone[2])
        );
        assert!((alone[2] - exact(switch, 4.0)[2]).abs() < 2e-4);
    }
}

model! {
    /// A mass between two forces that push it back to where they change: parabolas, on both sides of one place.
    pub model Between<T> {
        gravity: none;
        point mass { mass: 1 kg, start at [-1, 0, 0] m velocity [0.3, 0, 0] m/s }
        let x = mass.position.x;
        let force = if(x < 0 m, 2 N, -1 N);
        load push on mass = [force, 0 N, 0 N];
        event passed = x crosses 0 m;
        output energy_of_it = 0.5 kg * mass.velocity.x^2 + if(x < 0 m, -2 N * x, 1 N * x);
        metric right = time_above x { level: 0 m };
        metric pushed = integral max(force, 0 N);
    }
}

/// x and ẋ at a time: on each side a parabola from where it comes in.
fn between(time: f64) -> [f64; 2] {
    let (mut at, mut x, mut v) = (0.0, -1.0_f64, 0.3_f64);
    loop {
        let force = if x < 0.0 || x == 0.0 && v < 0.0 {
            2.0
        } else {
            -1.0
        };
        // x + v t + f t²/2 = 0, the later root.
        let leave = (-v - f64::copysign((v * v - 2.0 * force * x).sqrt(), -force)) / force;
        let left = time - at;
        if leave >= left {
            return [x + v * left + 0.5 * force * left * left, v + force * left];
        }
        (at, v, x) = (at + leave, v + force * leave, 0.0);
    }
}

#[test]
fn forces_that_jump_at_a_place_keep_the_energy_and_the_parabolas() {
    let model = Between::<f64>::new(BetweenParams::default()).expect("no params");
    let exact = between(30.0);
    for (options, within) in [
        (Options::rk4(0.0123), 1e-10),
        (Options::rk4(0.05), 1e-10),
        (Options::tsit5(1e-5), 1e-9),
        (Options::tsit5(1e-8), 1e-9),
        (Options::vern7(1e-8), 1e-9),
        (Options::rodas5p(1e-8), 1e-8),
        (Options::rattle(0.01), 1e-9),
    ] {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        let mut history = Trajectory::new(&model, Sampling::Every(0.1), Content::RESULTS);
        run.record(30.0, &mut history).expect("a run that ends");
        let state = run.state();
        let off = (state[0] - exact[0]).abs().max((state[3] - exact[1]).abs());
        println!("{} {off:.1e}", options.method.name());
        assert!(off < within, "{options:?} {state:?} {exact:?}");
        let energies = history.column("energy_of_it").expect("an output");
        assert!(
            energies
                .iter()
                .all(|energy| (energy - 2.045).abs() < within),
            "{options:?}"
        );
    }
}

model! {
    /// An oscillator whose force jumps at two places and with its speed.
    pub model Rubbing<T> {
        gravity: none;
        point mass { mass: 1 kg, start at [1, 0, 0] m }
        let v = mass.velocity.x;
        state heat = 0 J { rate: abs(0.02 N * v) }
        load elastic on mass = -1 N/m * mass.position;
        load rubbing on mass = [if(v < 0 m/s, 0.02 N, -0.02 N), 0 N, 0 N];
        load magnet on mass = [if(mass.position.x < 0.3 m, 0 N, 0.1 N), 0 N, 0 N];
        event turns = v crosses 0 m/s;
        event near = mass.position.x crosses 0.3 m;
    }
}

/// One of the stages behind the event would make it an order of one; what it is moved by is of the order of the stage.
#[test]
fn the_order_of_a_method_is_kept_where_states_decide() {
    let model = Rubbing::<f64>::new(RubbingParams::default()).expect("no params");
    let at_end = |options| {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        run.run(20.0).expect("a run that ends");
        [run.state()[0], run.state()[3]]
    };
    let exact = at_end(Options::vern7(1e-13));
    let off = |options| {
        let found = at_end(options);
        (found[0] - exact[0]).hypot(found[1] - exact[1])
    };
    // Means over steps that end differently beside the events.
    let mean = |steps: [f64; 4]| {
        steps
            .map(|step| off(Options::rk4(step)).ln())
            .iter()
            .sum::<f64>()
            / 4.0
    };
    let (coarse, fine) = (
        mean([0.1, 0.104, 0.096, 0.108]),
        mean([0.025, 0.026, 0.024, 0.027]),
    );
    let order = (coarse - fine) / 4.0_f64.ln();
    println!("order {order} {coarse} {fine}");
    assert!(order > 3.7, "{order}");
    for tolerance in [1e-6, 1e-8, 1e-10] {
        let error = off(Options::tsit5(tolerance));
        println!("{tolerance:e} {error:.1e}");
        assert!(error < 200.0 * tolerance, "{tolerance} {error}");
    }
}

#[test]
fn they_keep_them_in_single_precision() {
    let model = Between::<f32>::new(BetweenParams::default()).expect("no params");
    let exact = between(10.0);
    // One of these meets the place to the last digit, where no side is.
    for options in [
        Options::rk4(0.05),
        Options::rk4(0.0123),
        Options::tsit5(1e-3),
        Options::tsit5(1e-4),
        Options::tsit5(1e-5),
        Options::vern7(1e-5),
    ] {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        run.run(10.0).expect("a run that ends");
        let state = run.state();
        let off = [(state[0], exact[0]), (state[3], exact[1])];
        let off = off.map(|(found, exact)| (f64::from(found) - exact).abs());
        println!("{} {off:?}", options.method.name());
        assert!(
            off.iter().all(|off| *off < 1e-4),
            "{options:?} {state:?} {exact:?}"
        );
    }
}

/// A place 100 m from the origin, where numbers of single precision are 7.6e-6 m apart: a step that ends on it goes on from its far side, as does its energy.
#[test]
fn a_force_that_jumps_far_from_the_origin_keeps_the_energy_in_single_precision() {
    let model = Interpreted::<f32>::new(
        read(
            "model Far { gravity: none;
                point mass { mass: 1 kg, start at [99, 0, 0] m velocity [0.25, 0, 0] m/s }
                let x = mass.position.x;
                load push on mass = [if(x < 100 m, 2 N, -1 N), 0 N, 0 N];
                event passed = x crosses 100 m; }",
        ),
        &[],
    )
    .expect("no params");
    for step in [0.5, 0.25, 0.1, 0.05, 0.03, 0.0123, 0.01] {
        let mut run = Simulation::new(&model, Options::rk4(step)).expect("a model that runs");
        run.run(40.0).expect("a run that ends");
        let [x, v] = [0, 3].map(|at| f64::from(run.state()[at]));
        // E = v²/2 − 2 (x − 100), or v²/2 + (x − 100).
        let energy = 0.5 * v * v + (x - 100.0).max(-2.0 * (x - 100.0));
        let off = energy - (0.5 * 0.25 * 0.25 + 2.0);
        println!(
            "{step} {off:e} {}",
            run.imbalance().map_or(0.0, |it| it.relative())
        );
        assert!(off.abs() < 1e-3, "{step}: {off}");
    }
}

/// Halves of seconds and metres are met to the last digit: x = ½ − t²/2 = 0 at 1 s, then −t + t².
#[test]
fn a_place_that_is_met_to_the_last_digit_has_the_force_behind_it() {
    for from in [0.5, -0.25] {
        for options in [
            Options::rk4(0.25),
            Options::rk4(0.5),
            Options::tsit5(1e-6),
            Options::rattle(0.25),
        ] {
            let model = Between::<f64>::new(BetweenParams::default()).expect("no params");
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            run.set_state(0.0, &[from, 0.0, 0.0, 0.0, 0.0, 0.0])
                .expect("a state");
            let [met, after] = if from > 0.0 {
                [1.0, -0.1875]
            } else {
                // x = t² − ¼ = 0 at ½ s, then t − t²/2.
                [0.5, 0.46875]
            };
            run.run(met + 0.75).expect("a run that ends");
            let at = run.events().first().expect("it passes").time;
            assert!((at - met).abs() < 1e-12, "{options:?} {at}");
            let off = (run.state()[0] - after).abs();
            assert!(off < 1e-10, "{options:?} {off:e}");
        }
    }
}

/// A vane that hangs at rest until a gust of half a second: its angle and rate at 11 s.
fn gust(pulse: &str, options: Options) -> Vec<f64> {
    let scene = read(&format!(
        "model Vane {{
            gravity: [0, 0, -9.81] m/s^2;
            {pulse}
            body vane {{ mass: 2 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame root at [0, 0, 0.5] m, frame blade at [0, 0, -0.4] m }}
            joint pin: hinge from world to vane.root {{ axis: y, damping: 0.2 N*m*s }}
            load wind on vane at blade = gust * vane.blade.x;
            output angle = pin.angle;
            output rate = pin.angle_rate;
        }}"
    ));
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, options).expect("options");
    run.run(11.0)
        .unwrap_or_else(|error| panic!("{pulse}: {error}"));
    let mut out = vec![0.0; 2];
    run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
    out
}

#[test]
fn no_adaptive_step_leaps_over_a_pulse_whose_times_are_known() {
    let entries = "{ 0 s: 0 N, 10 s: 0 N, 10.1 s: 8 N, 10.4 s: 8 N, 10.5 s: 0 N }";
    for pulse in [
        format!("table blow = {entries}; let gust = blow(time);"),
        format!("smooth table blow = {entries}; let gust = blow(time);"),
        "table blow = { 0: 0 N, 0.25: 8 N, 0.5: 0 N }; let gust = blow((time - 10 s) / (1 s));"
            .to_owned(),
        "let gust = if(time > 10 s && time < 10.5 s, 8 N, 0 N);".to_owned(),
        "let gust = 8 N * smoothstep(10 s, 10.2 s, time) * smoothstep(-10.5 s, -10.3 s, -time);"
            .to_owned(),
        "let gust = max(0 N, 8 N - 40 N/s * abs(time - 10.25 s));".to_owned(),
    ] {
        // Steps of a quarter of a millisecond end on every time of the pulse, and are off by h⁴.
        let exact = gust(&pulse, Options::rk4(2.5e-4));
        assert!(exact[1].abs() > 0.1, "{pulse}: {exact:?}");
        for options in [
            Options::tsit5(1e-8),
            Options::vern7(1e-8),
            Options::rodas5p(1e-8),
            Options::auto(1e-8),
        ] {
            let found = gust(&pulse, options);
            assert_close(
                &found,
                &exact,
                1e-3,
                1e-3,
                &format!("{pulse} {:?}", options.method),
            );
        }
    }
}

/// A run that pauses right behind a jump makes a step as short as that is behind it: the powers at its ends say nothing of the steps that follow, and what jumped between
/// them, taken for a slope, was an energy that no step had made: the run was refused.
#[test]
fn a_pause_right_behind_a_jump_says_nothing_of_the_steps_that_follow() {
    let scene = read(
        "model Pushed { gravity: none;
           point mass { mass: 1 kg }
           load push on mass = [if(time < 0.50000005 s, 1 N, -3 N), 0 N, 0 N]; }",
    );
    let model = Generic::<f64>::with_defaults(scene).expect("defaults");
    for options in [Options::rk4(0.01), Options::rattle(0.01)] {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        for time in [0.5, 0.500_000_1, 1.0] {
            run.run(time).expect("no step is too long");
        }
        // x = 1/8 m + 1/4 m − 3/8 m, v = 1/2 m/s − 3/2 m/s, but for where the jump lies.
        let [x, v] = [0, 3].map(|at| run.state()[at]);
        assert!(x.abs() < 1e-6 && (v + 1.0).abs() < 1e-6, "{x} {v}");
    }
}
