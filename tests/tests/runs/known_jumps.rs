//! Fixed steps end on what jumps at a time known beforehand, wherever the steps before it ended: what is behind a located switch is no multiple of the step.

use mbd_compiler::Interpreted;
use mbd_runtime::{
    Batch, Case, Content, Generic, InLanes, Options, Sampling, Scalar, Simulation, Trajectory,
    model,
};
use tests::declared::read;

model! {
    /// A mass that is pushed against a rope and flies back slack; the push ends at a time, and twice as much pushes it back for a tenth of a second.
    pub model Caught<T> {
        gravity: none;
        param off = 0.9 s in 0 s ..= 100 s;
        point mass { mass: 1 kg, start at [0.5, 0, 0] m velocity [1, 0, 0] m/s }
        line rope from world to mass { free_length: 1 m, stiffness: 100 N/m }
        let push = if(time < off, 1 N, if(time <= off + 0.1 s, -2 N, 0 N));
        load pushing on mass = [push, 0 N, 0 N];
        output pushed = push;
        output x = mass.position.x;
        output v = mass.velocity.x;
        metric impulse = integral push;
    }
}

/// Where it is taut: 1/2 + t + t²/2 = 1.
fn caught() -> [f64; 2] {
    [2.0_f64.sqrt() - 1.0, 2.0_f64.sqrt()]
}

/// x and ẋ at a time, where the push ends while the rope is slack again, or while it is taut.
fn exact(off: f64, time: f64) -> [f64; 2] {
    let (omega, [taut, fast]) = (10.0_f64, caught());
    // x − 1 m from the end of a phase on, under a force, on the rope and without it.
    let swing = |[x, v]: [f64; 2], force: f64, after: f64| {
        let (s, c) = (omega * after).sin_cos();
        let middle = force / (omega * omega);
        [
            middle + (x - middle) * c + v / omega * s,
            v * c - (x - middle) * omega * s,
        ]
    };
    let fly = |[x, v]: [f64; 2], force: f64, after: f64| {
        [x + (v + 0.5 * force * after) * after, v + force * after]
    };
    // With the push it comes back as fast as it came.
    let half = 2.0 * (std::f64::consts::PI - (fast * omega).atan()) / omega;
    let slack = taut + half;
    let at_off = match off < slack {
        true => swing([0.0, fast], 1.0, off - taut),
        false => fly([0.0, -fast], 1.0, off - slack),
    };
    let move_on = |from: [f64; 2], force: f64, after: f64| match off < slack {
        true => swing(from, force, after),
        false => fly(from, force, after),
    };
    let at_end = move_on(at_off, -2.0, (time - off).min(0.1));
    let [x, v] = move_on(at_end, 0.0, (time - off - 0.1).max(0.0));
    [1.0 + x, v]
}

fn flown<T: Scalar>(off: f64, options: Options, until: f64) -> (Simulation<T>, [f64; 2]) {
    let model = Caught::<T>::new(CaughtParams {
        off: T::from_f64(off),
    })
    .expect("params in range");
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.run(until).expect("a run that ends");
    let state = [0, 3].map(|at| run.state()[at].to_f64());
    (run, state)
}

#[test]
fn a_push_that_ends_behind_a_located_switch_leaves_what_it_leaves_in_closed_form() {
    for off in [0.9, 0.9137, 0.95001, 0.999_999_7] {
        for (options, within) in [
            (Options::rk4(1e-3), 1e-10),
            (Options::rk4(3.1e-3), 1e-8),
            (Options::rattle(1e-3), 1e-10),
        ] {
            let (run, found) = flown::<f64>(off, options, 1.2);
            assert_eq!(run.events().len(), 2, "taut, slack");
            let exact = exact(off, 1.2);
            let errors = [0, 1].map(|k| (found[k] - exact[k]).abs());
            println!("{off} {:?} {errors:?}", options.method);
            assert!(
                errors.iter().all(|off| *off < within),
                "{off} {options:?} {errors:?}"
            );
        }
        // Numbers of single precision are 6e-8 apart at one.
        let (_, found) = flown::<f32>(off, Options::rk4(1e-3), 1.2);
        let exact = exact(off, 1.2);
        let errors = [0, 1].map(|k| (found[k] - exact[k]).abs());
        println!("{off} f32 {errors:?}");
        assert!(errors.iter().all(|off| *off < 3e-6), "{off} {errors:?}");
    }
}

#[test]
fn the_order_of_a_fixed_step_is_kept_across_what_jumps() {
    // While the rope is taut.
    let (off, until) = (0.5731, 0.7);
    let exact = exact(off, until);
    for method in [Options::rk4 as fn(f64) -> Options, Options::rattle] {
        let mean = |steps: [f64; 4]| {
            let logs = steps.map(|step| {
                let (_, [x, v]) = flown::<f64>(off, method(step), until);
                (10.0 * (x - exact[0])).hypot(v - exact[1]).ln()
            });
            logs.iter().sum::<f64>() / 4.0
        };
        let coarse = mean([0.02, 0.0205, 0.019, 0.0215]);
        let fine = mean([0.005, 0.005_125, 0.004_75, 0.005_375]);
        let order = (coarse - fine) / 4.0_f64.ln();
        println!("order {order} {coarse} {fine}");
        assert!(order > 3.8, "{order}");
    }
}

/// A mass alone, pushed until a time: v = F t/m, where no stage is on the wrong side. The steps meet the time to the last digit, or but for rounding, or not; late in
/// a run, too, where it is no difference of small numbers.
#[test]
fn no_stage_of_a_step_is_on_the_wrong_side_of_a_jump() {
    for (begin, holds, lasts) in [
        (0.0, "time < 1 s", 1.0),
        (0.0, "time <= 1 s", 1.0),
        (0.0, "time < 0.73 s", 0.73),
        (0.0, "2 * time <= 1.46 s", 0.73),
        (0.0, "time < 0.7301234 s", 0.730_123_4),
        (0.0, "time / (1 s) + 1 < 1.73", 0.73),
        (1000.0, "time < 1000.1 s", 0.1),
        (1000.0, "3 * time < 3000.37 s", 0.37 / 3.0),
        (12345.0, "time <= 12345.7 s", 0.7),
    ] {
        let scene = read(&format!(
            "model Pushed {{ gravity: none;
                point mass {{ mass: 1 kg }}
                load push on mass = [if({holds}, 1 N, 0 N), 0 N, 0 N]; }}"
        ));
        let double = Generic::<f64>::with_defaults(scene.clone()).expect("no params");
        let single = Generic::<f32>::with_defaults(scene).expect("no params");
        for options in [
            Options::rk4(0.01),
            Options::rk4(0.03),
            Options::rattle(0.01),
            Options::rk4(0.125),
        ] {
            let mut run = Simulation::new(&double, options).expect("a model that runs");
            run.set_state(begin, &[0.0; 6]).expect("a state");
            run.run(begin + 2.0).expect("a run that ends");
            let off = run.state()[3] - lasts;
            println!("{holds} {:?} {off:e}", options.method);
            // Times are rounded.
            let within = 1e-13 + 4.0 * f64::EPSILON * begin;
            assert!(off.abs() < within, "{holds} {options:?} {off:e}");
            if begin == 0.0 && options.method.name() == "RK4" {
                let mut run = Simulation::new(&single, options).expect("a model that runs");
                run.run(2.0).expect("a run that ends");
                let off = f64::from(run.state()[3]) - lasts;
                assert!(off.abs() < 3e-7, "{holds} {options:?} {off:e} in f32");
            }
        }
    }
}

/// Two entries of a table closer to each other than times of a run are told apart are one jump: the step behind it began on the old side.
#[test]
fn a_jump_that_is_written_as_two_entries_of_a_table_is_one() {
    let table = |times: &str, argument: &str| {
        read(&format!(
            "model Stepped {{ gravity: none;
                table push = {{ {times} }};
                point mass {{ mass: 1 kg }}
                load pushing on mass = [push({argument}), 0 N, 0 N]; }}"
        ))
    };
    let late = "0 s: 1 N, 100 ms: 1 N, 100.00000000000001 ms: 3 N, 2 s: 3 N";
    for (begin, times, argument) in [
        (
            0.0,
            "0 s: 1 N, 1 s: 1 N, 1.0000000000000003 s: 3 N, 2 s: 3 N",
            "time",
        ),
        (
            0.0,
            "0 s: 1 N, 1 s: 1 N, 1.000000000000003 s: 3 N, 2 s: 3 N",
            "time",
        ),
        (
            0.0,
            "0 s: 1 N, 1 s: 1 N, 1.000000000000004 s: 3 N, 2 s: 3 N",
            "time",
        ),
        (
            0.0,
            "0 s: 1 N, 1 s: 1 N, 1.000000000000009 s: 3 N, 2 s: 3 N",
            "time",
        ),
        (
            0.0,
            "0 s: 1 N, 1 s: 1 N, 1.000000000000001 s: 2 N, 1.000000000000002 s: 3 N, 2 s: 3 N",
            "time",
        ),
        (
            0.0,
            "0 s: 1 N, 300 ms: 1 N, 300.0000000000001 ms: 3 N, 2 s: 3 N",
            "0.3 * time",
        ),
        // The next number behind the time of the first is behind the second.
        (999.9, late, "time - 999.9 s"),
    ] {
        let scene = table(times, argument);
        let jump = match argument {
            "time" => 1.0,
            "0.3 * time" => 1.0,
            _ => 0.1,
        };
        let double = Generic::<f64>::with_defaults(scene.clone()).expect("no params");
        let single = Generic::<f32>::with_defaults(scene).expect("no params");
        for options in [
            Options::tsit5(1e-8),
            Options::vern7(1e-10),
            Options::rodas5p(1e-8),
            Options::rk4(0.03),
            Options::rattle(0.01),
        ] {
            let mut run = Simulation::new(&double, options).expect("a model that runs");
            run.set_state(begin, &[0.0; 6]).expect("a state");
            run.run(begin + 2.0).expect("a run that ends");
            let off = run.state()[3] - (jump + 3.0 * (2.0 - jump));
            println!("{times} {:?} {off:e}", options.method);
            let within = 1e-13 + 4.0 * f64::EPSILON * begin;
            assert!(off.abs() < within, "{times} {options:?} {off:e}");
            if begin == 0.0 && options.method.name() == "RK4" {
                let mut run = Simulation::new(&single, options).expect("a model that runs");
                run.run(2.0).expect("a run that ends");
                let off = f64::from(run.state()[3]) - 4.0;
                assert!(off.abs() < 2e-6, "{times} {options:?} {off:e} in f32");
            }
        }
    }
}

/// The grid of steps goes on where it meets a jump, and begins anew where it does not.
#[test]
fn steps_go_on_from_where_they_were_cut() {
    let ends = |off: f64, step: f64| {
        let model = Caught::<f64>::new(CaughtParams { off }).expect("params in range");
        let mut run = Simulation::new(&model, Options::rk4(step)).expect("a model that runs");
        let mut history = Trajectory::new(&model, Sampling::Steps, Content::RESULTS);
        run.record(0.3, &mut history).expect("a run that ends");
        history.times().to_vec()
    };
    let near = |found: Vec<f64>, exact: &[f64]| {
        let close = found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-15);
        assert!(found.len() == exact.len() && close, "{found:?} {exact:?}");
    };
    near(ends(0.1, 0.05), &[0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]);
    near(
        ends(0.12, 0.05),
        &[0.0, 0.05, 0.1, 0.12, 0.17, 0.22, 0.27, 0.3],
    );
}

#[test]
fn cases_beside_each_other_and_runs_from_snapshots_are_what_they_are_alone() {
    let model = Caught::new(CaughtParams::default())
        .expect("defaults")
        .in_lanes();
    let times = [0.2, 0.55, 0.9, 0.9137, 1.0, 1.05, 1.07];
    let options = Options::rk4(5e-3);
    let alone = times.map(|off| flown::<f64>(off, options, 1.5).1);
    for lanes in [1, 4, 8] {
        let cases = times.iter().map(|off| Case::new().params([*off]));
        // Of two threads one may take all cases but one, which is alone then.
        let batch = Batch::new(&model, options, 1.5).threads(1).lanes(lanes);
        let batch = batch.cases(cases);
        let found = batch.run(|_, history| {
            ["x", "v"].map(|name| history.column(name).and_then(|list| list.last().copied()))
        });
        for ((finished, alone), off) in found.iter().zip(alone).zip(times) {
            let ends = finished.result.as_ref().expect("a run that ends");
            assert_eq!(*ends, alone.map(Some), "{off}");
            assert_eq!(finished.beside > 0, lanes > 1, "{off} {lanes}");
        }
    }
    for (off, alone) in times.into_iter().zip(alone) {
        for pause in [off, off + 0.1, 0.7] {
            let whole = flown::<f64>(off, options, pause);
            let (mut other, _) = flown::<f64>(off, options, 0.1);
            let (mut whole, _) = whole;
            other.restore(&whole.snapshot()).expect("of the same model");
            whole.run(1.5).expect("it runs");
            other.run(1.5).expect("it runs");
            let bits = |run: &Simulation<f64>| run.state().iter().map(|x| x.to_bits()).collect();
            let [a, b]: [Vec<u64>; 2] = [&whole, &other].map(bits);
            assert_eq!(a, b, "{off} {pause}");
            assert!((whole.state()[3] - alone[1]).abs() < 1e-5, "{off} {pause}");
        }
    }
}

/// What jumps is on its side in rows and metrics, whatever the steps.
#[test]
fn what_is_measured_of_a_jump_is_that_of_both_sides() {
    for options in [
        Options::rk4(0.03),
        Options::rk4(0.01),
        Options::rattle(0.01),
        Options::tsit5(1e-8),
        Options::rodas5p(1e-8),
    ] {
        for off in [0.9, 0.9137] {
            let model = Caught::<f64>::new(CaughtParams { off }).expect("params in range");
            let mut run = Simulation::new(&model, options).expect("a model that runs");
            let mut history = Trajectory::new(&model, Sampling::Every(0.1), Content::ALL);
            run.record(1.5, &mut history).expect("a run that ends");
            let pushed = history.column("pushed").expect("an output");
            assert_eq!([pushed[8], pushed[9 + usize::from(off > 0.9)]], [1.0, -2.0]);
            let impulse = history.metric("impulse").expect("a metric");
            let wrong = impulse - (off - 0.2);
            let within = options.method.tolerance().map_or(1e-12, |_| 1e-10);
            assert!(wrong.abs() < within, "{options:?} {off} {wrong:e}");
            let imbalance = run.imbalance().map_or(0.0, |it| it.relative());
            // (h ω)⁴/80 of RK4 while the rope is taut.
            assert!(imbalance < 2e-4, "{options:?} {off} {imbalance:e}");
        }
    }
}

/// A pulse shorter than a step is hidden from none that ends on both its sides.
#[test]
fn a_pulse_whose_ends_are_known_is_hidden_from_no_step() {
    let model = Interpreted::<f64>::new(
        read(
            "model Struck { gravity: none;
                point mass { mass: 1 kg }
                load push on mass = [if(time > 0.5003 s && time < 0.5004 s, 100 N, 0 N), 0 N, 0 N]; }",
        ),
        &[],
    )
    .expect("no params");
    for options in [Options::rk4(0.01), Options::rattle(0.01)] {
        let mut run = Simulation::new(&model, options).expect("a model that runs");
        run.run(1.0).expect("a run that ends");
        assert_eq!(run.hidden_from_steps(), None);
        let off = run.state()[3] - 0.01;
        assert!(off.abs() < 1e-13, "{options:?} {off:e}");
    }
}

/// Three damped lines and a knot: the load on the mass below ends behind slack and taut switches. The place of the mass at the end.
fn hung(knot: &str, options: Options) -> Vec<f64> {
    let scene = read(&format!(
        "model Hung {{ gravity: [0, 0, -9.81] m/s^2;
            world {{ frame left at [-1, 0, 1] m, frame right at [1, 0, 1] m }}
            point knot {{ {knot} }}
            point bob {{ mass: 0.5 kg, start at [0.1, 0, -0.85] m velocity [0.4, 0, 1] m/s }}
            line a from world.left to knot {{ free_length: 1.3 m, stiffness: 400 N/m, damping: 3 N*s/m }}
            line b from world.right to knot {{ free_length: 1.3 m, stiffness: 400 N/m, damping: 3 N*s/m }}
            line c from knot to bob {{ free_length: 0.9 m, stiffness: 500 N/m, damping: 3 N*s/m }}
            load push on bob = [if(time < 1.5 s, 5 N, 0 N), 0 N, 0 N];
            output at_x = bob.position.x;
            output at_z = bob.position.z; }}"
    ));
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    let mut run = Simulation::new(&model, options).expect("a model that runs");
    run.run(2.0).expect("a run that ends");
    let switches = run.events().iter().filter(|it| it.time < 1.5).count();
    assert!(switches > 1 || knot.contains("stepwise"), "{switches}");
    ["at_x", "at_z"]
        .map(|name| run.output(name).expect("an output"))
        .to_vec()
}

#[test]
fn a_load_that_ends_while_lines_at_a_knot_switch_is_that_of_adaptive_steps() {
    let off = |[found, exact]: [Vec<f64>; 2]| {
        let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max)
    };
    let heavy = "mass: 0.2 kg, start at [0, 0, 0.1] m";
    let heavy = off([Options::rk4(1e-3), Options::vern7(1e-11)].map(|it| hung(heavy, it)));
    // Of damping by differences from step to step the error is of order two.
    let massless = "equilibrium: stepwise";
    let massless = off([1e-3, 2.5e-4].map(|step| hung(massless, Options::rk4(step))));
    println!("{heavy:e} {massless:e}");
    assert!(heavy < 1e-7, "{heavy:e}");
    assert!(massless < 1e-3, "{massless:e}");
}

model! {
    /// A mass in air, pushed until a time: nothing is looked for in its steps.
    model Blown<T> {
        gravity: none;
        param off = 0.5 s in 0 s ..= 100 s;
        point mass { mass: 1 kg }
        load push on mass = [if(time < off, 1 N, 0 N), 0 N, 0 N] - 2 kg/s * mass.velocity;
        output v = mass.velocity.x;
        metric fastest = max v;
        metric remaining = final v;
    }
}

#[test]
fn cases_whose_steps_nobody_reads_end_them_on_their_own_jumps() {
    let model = Blown::new(BlownParams::default())
        .expect("defaults")
        .in_lanes();
    let times = [0.311, 0.5, 0.5001, 0.77, 0.790_000_1, 5.0];
    let found = [1, 4, 8].map(|lanes| {
        let cases = times.iter().map(|off| Case::new().params([*off]));
        let batch = Batch::new(&model, Options::rk4(0.01), 1.0).lanes(lanes);
        let all = batch.cases(cases).run(|_, history| {
            ["fastest", "remaining"].map(|name| history.metric(name).expect("a metric"))
        });
        let numbers = all.iter().map(|it| *it.result.as_ref().expect("it ends"));
        numbers.collect::<Vec<_>>()
    });
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0], found[2]);
    for (off, [fastest, end]) in times.iter().zip(&found[0]) {
        let lasts = off.min(1.0);
        let most = 0.5 * (1.0 - (-2.0 * lasts).exp());
        let left = most * (-2.0 * (1.0 - lasts)).exp();
        // h⁴ of RK4.
        assert!((fastest - most).abs() < 1e-9, "{off} {fastest} {most}");
        assert!((end - left).abs() < 1e-9, "{off} {end} {left}");
    }
}
