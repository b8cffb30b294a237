//! Rate nodes whose taut lines fall into one line or plane.

use mbd_compiler::Interpreted;
use mbd_runtime::{Model, Options, Quantity, RunError, Simulation};
use tests::declared::read;
use tests::largest_difference;

/// Case 2 of AAS 03-163 on bridles of unequal length.
fn unequal(confluence: &str, lengths: [f64; 3]) -> mbd_scene::Scene {
    let legs: String = (0..3)
        .map(|i| {
            format!(
                "line leg_{i} from capsule.bridle_{i} to confluence {{ free_length: {} m, stiffness: 47 kN/m, damping: 470 N*s/m }}\n",
                lengths[i]
            )
        })
        .collect();
    read(&format!(
        "model Drop {{
            gravity: point_mass {{ mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m }};
            body chute {{
                mass: 16.0 kg,
                inertia: diag(700.0, 700.0, 220.0) kg*m^2,
                frame riser_end at [0.0, 0.0, -22.0] m,
                frame cp at [0.0, 0.0, 1.57] m,
            }}
            body capsule {{
                mass: 761.0 kg,
                inertia: diag(235.0, 225.0, 290.0) kg*m^2,
                frame bridle_0 at polar(0.6 m, 20 deg, 1.23 m),
                frame bridle_1 at polar(0.6 m, 140 deg, 1.23 m),
                frame bridle_2 at polar(0.6 m, 260 deg, 1.23 m),
            }}
            joint chute_free: free from world to chute.com;
            joint capsule_free: free from world to capsule.com;
            point confluence {{ {confluence} }}
            line riser from chute.riser_end to confluence {{ free_length: 4.0 m, stiffness: 60 kN/m, damping: 600 N*s/m }}
            {legs}
            load drag on chute at cp = -0.5 * 0.014 kg/m^3 * 0.46 * 178.8 m^2 * norm(chute.velocity) * chute.velocity;
        }}"
    ))
}

/// A drop from rest, the riser 1 cm short of taut if the bridles were equal.
fn drop(model: &dyn Model<f64>, options: Options) -> Simulation<f64> {
    let mut simulation = Simulation::new(model, options).expect("options that fit");
    let mut state = vec![0.0; model.layout().nx()];
    (state[2], state[3], state[10]) = (28.59, 1.0, 1.0);
    simulation.set_state(0.0, &state).expect("a state");
    simulation
}

/// Riser force every tenth of a second up to `end` [N].
fn riser(model: &dyn Model<f64>, options: Options, end: usize) -> Vec<f64> {
    let mut simulation = drop(model, options);
    let mut lines = [0.0; 40];
    let forces = (1..=end).map(|tenth| {
        simulation
            .run(tenth as f64 * 0.1)
            .unwrap_or_else(|error| panic!("{error}"));
        let found = simulation.evaluate(Quantity::Lines, &mut lines);
        found.expect("a balance");
        lines[0]
    });
    forces.collect()
}

fn interpreted(confluence: &str, lengths: [f64; 3]) -> Interpreted<f64> {
    Interpreted::new(unequal(confluence, lengths), &[]).expect("no params")
}

#[test]
fn a_drop_on_unequal_bridles_runs_through() {
    // With three lines carrying in one plane a fourth comes taut: it spans the direction that was missing.
    for lengths in [
        [1.5, 1.45, 1.55],
        [1.5, 1.4, 1.6],
        [1.5, 1.3, 1.7],
        [1.5, 1.5, 1.52],
    ] {
        let model = interpreted("equilibrium: rate", lengths);
        let exact = riser(&model, Options::tsit5(1e-9), 100);
        let found = riser(&model, Options::tsit5(1e-6), 100);
        let error = largest_difference(&found[20..], &exact[20..]);
        println!(
            "{lengths:?}: {error:.2e} N after 2 s, {} N at the end",
            exact[99]
        );
        assert!(error < 0.2, "{lengths:?}: {error} N");
        let coarse = riser(&model, Options::rk4(0.005), 100);
        assert!(
            coarse
                .iter()
                .all(|force| *force >= 0.0 && force.is_finite())
        );
    }
}

#[test]
fn a_line_that_leaves_the_plane_of_the_carrying_ones_pulls_as_on_a_vanishing_mass() {
    // Three lines hold the knot in the plane y = 0; from 20 ms on a tug draws it out of that plane by a fourth.
    let tensions = |knot: &str| {
        let scene = read(&format!(
            "model Tug {{
                gravity: none;
                world {{ frame top at [0.0, 0.0, 4.0] m, frame left at [-0.9, 0.0, -1.2] m, frame right at [0.9, 0.0, -1.2] m, }}
                point tug {{ mass: 1e9 kg }}
                point knot {{ {knot} }}
                line riser from world.top to knot {{ free_length: 3.99 m, stiffness: 60 kN/m, damping: 600 N*s/m }}
                line port from world.left to knot {{ free_length: 1.49 m, stiffness: 47 kN/m, damping: 470 N*s/m }}
                line starboard from world.right to knot {{ free_length: 1.49 m, stiffness: 47 kN/m, damping: 470 N*s/m }}
                line tow from tug to knot {{ free_length: 1.0 m, stiffness: 47 kN/m, damping: 470 N*s/m }}
            }}"
        ));
        let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
        let mut simulation = Simulation::new(&model, Options::tsit5(1e-8)).expect("options");
        let layout = model.layout();
        let mut state = vec![0.0; layout.nx()];
        state[1] = 0.99;
        state[layout.nq + 1] = 0.5;
        simulation.set_state(0.0, &state).expect("a state");
        if !layout.nodes.is_empty() {
            simulation.set_nodes(&[0.0; 3]).expect("a guess");
        }
        let mut lines = [0.0; 40];
        let mut seen = Vec::new();
        for step in 1..=10 {
            simulation
                .run(0.02 * f64::from(step))
                .unwrap_or_else(|error| panic!("{knot}: {error}"));
            simulation
                .evaluate(Quantity::Lines, &mut lines)
                .expect("a balance");
            seen.extend(lines.chunks_exact(10).map(|line| line[0]));
        }
        seen
    };
    let limit = tensions("equilibrium: rate");
    // Out of the plane T₄ balances what the other three turned by.
    assert!(limit[39] > 50.0, "{limit:?}");
    let errors = [0.1, 0.01, 0.001].map(|mass| {
        let found = tensions(&format!("mass: {mass} kg"));
        largest_difference(&found[8..], &limit[8..])
    });
    println!("{errors:?} N of {limit:?}");
    assert!(errors[2] < 0.02 && errors[1] < 0.2 * errors[0] && errors[2] < 0.2 * errors[1]);
}

#[test]
fn a_misaligned_pair_jumps_to_its_tension_when_it_is_straight() {
    // y → 0 after t* = C/K ln((d₀ − L0)/(a − L0)), with a velocity that grows without bound; then K (a − L0) at once.
    let scene = read(
        "model Pair {
            gravity: none;
            world { frame left at [-1.5, 0.0, 0.0] m, frame right at [1.5, 0.0, 0.0] m, }
            point knot { equilibrium: rate }
            line port from world.left to knot { free_length: 1.499 m, stiffness: 47 kN/m, damping: 470 N*s/m }
            line starboard from world.right to knot { free_length: 1.499 m, stiffness: 47 kN/m, damping: 470 N*s/m }
        }",
    );
    let jump = 0.01 * (((2.25f64 + 0.01).sqrt() - 1.499) / 0.001).ln();
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    for (options, within) in [(Options::tsit5(1e-9), 2e-4), (Options::rk4(1e-4), 2e-4)] {
        let mut simulation = Simulation::new(&model, options).expect("options");
        simulation
            .set_state(0.0, &[0.0, 0.1, 0.0])
            .expect("a state");
        let mut tension = |time: f64| {
            simulation
                .run(time)
                .unwrap_or_else(|error| panic!("{error}"));
            let mut lines = [0.0; 20];
            let found = simulation.evaluate(Quantity::Lines, &mut lines);
            found.expect("a balance");
            lines[0]
        };
        let (before, after) = (tension(jump - within), tension(jump + within));
        println!("{:?}: {before:e} N, then {after} N", options.method);
        assert!(before.abs() < 1e-6, "{before} N before {jump} s");
        assert!((after - 47.0).abs() < 1e-6, "{after} N after {jump} s");
    }
}

/// A bob on a knot that two lines hold to the world: from 0.1 s to 0.3 s it rises freely, and draws two of the three lines straight without force.
fn hung(knot: &str, start: [f64; 3]) -> mbd_scene::Scene {
    read(&format!(
        "model Hung {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{ frame left at [-1.0, 0.0, 2.0] m, frame right at [1.0, 0.0, 2.0] m }}
            point bob {{ mass: 1 kg, start at {start:?} m }}
            point knot {{ {knot} }}
            line la from world.left to knot {{ free_length: 1.1 m, stiffness: 2 kN/m, damping: 20 N*s/m }}
            line lb from world.right to knot {{ free_length: 1.2 m, stiffness: 2 kN/m, damping: 20 N*s/m }}
            line lc from knot to bob {{ free_length: 0.5 m, stiffness: 2 kN/m, damping: 20 N*s/m }}
        }}"
    ))
}

/// Where the bob is at a time [m].
fn bob_at(knot: &str, options: Options, time: f64) -> [f64; 3] {
    bob_from([0.2, 0.1, 0.6], knot, options, time)
}

/// The same from another start [m].
fn bob_from(start: [f64; 3], knot: &str, options: Options, time: f64) -> [f64; 3] {
    let found = try_bob(start, knot, options, time);
    found.unwrap_or_else(|error| panic!("{:?}: {error}", options.method))
}

fn try_bob(start: [f64; 3], knot: &str, options: Options, time: f64) -> Result<[f64; 3], RunError> {
    let model = Interpreted::<f64>::new(hung(knot, start), &[]).expect("no params");
    let mut run = Simulation::new(&model, options).expect("a method");
    run.run(time)?;
    Ok([0, 1, 2].map(|axis| run.state()[axis]))
}

#[test]
fn lines_that_are_drawn_straight_without_force_stop_no_method_at_any_tolerance() {
    // At 0.300277 s and 0.9337 s the velocity of the knot grows without bound: the lines have no force, and the bob does not feel it. At 0.05165 s three
    // lines in one plane stop pulling at once: two of them relax from there, and none pushes.
    let exact = bob_at("equilibrium: rate", Options::vern7(1e-12), 1.2);
    for rtol in [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11] {
        let methods = [
            Options::tsit5(rtol),
            Options::vern7(rtol),
            Options::rodas5p(rtol),
        ];
        for options in methods {
            let method = options.method;
            let found = bob_at("equilibrium: rate", options, 1.2);
            let error = largest_difference(&found, &exact);
            println!("{method:?}: {error:e} m");
            assert!(error < 1e-9 + 100.0 * rtol, "{method:?}: {error:e} m");
        }
    }
    // A light point between the same lines tends to it with its mass.
    let start = "start at [-0.019776514773157294, 0.05580995488523501, 1.21866063160671] m";
    let limit = bob_at("equilibrium: rate", Options::vern7(1e-10), 0.36);
    let errors = [1e-3, 1e-4].map(|mass| {
        let knot = format!("mass: {mass} kg, {start}");
        let found = bob_at(&knot, Options::rodas5p(1e-8), 0.36);
        largest_difference(&found, &limit)
    });
    println!("{errors:?} m");
    assert!(errors[1] < 2e-4 && errors[1] < 0.3 * errors[0]);
}

/// At 0.300277 s and 0.9337 s the lines are drawn straight from one long step to the next, and the knot runs beyond bounds there: a step that passed that held the
/// lines beside where they are straight, by as much as 2.7e-2 m after 2 s at 1e-5.
#[test]
fn no_long_step_passes_over_lines_that_are_drawn_straight() {
    let rate = "equilibrium: rate";
    let mut wrong = Vec::new();
    let mut check = |start: [f64; 3], time: f64, all: &[(Options, f64)]| {
        let exact = bob_from(start, rate, Options::vern7(1e-11), time);
        for &(options, allowed) in all {
            let method = options.method;
            let told = match try_bob(start, rate, options, time) {
                Ok(found) => {
                    let error = largest_difference(&found, &exact);
                    (error >= allowed).then(|| format!("{error:e} m"))
                }
                Err(error) => Some(error.to_string()),
            };
            wrong.extend(told.map(|told| format!("{start:?}, {method:?}: {told}")));
        }
    };
    for rtol in [1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6] {
        let methods = [
            Options::tsit5(rtol),
            Options::vern7(rtol),
            Options::rodas5p(rtol),
        ];
        check(
            [0.2, 0.1, 0.6],
            2.0,
            &methods.map(|options| (options, 10.0 * rtol)),
        );
    }
    let fixed = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5].map(|step| {
        // Longer ones meet a second straightening from too far: 2.8e-4 m at 0.5 ms, 1.2e-4 m at 0.2 ms.
        let allowed = if step > 1e-4 { 1e-3 } else { 1e-6 };
        (Options::rk4(step), allowed)
    });
    check([0.2, 0.1, 0.6], 2.0, &fixed);
    // Three lines that carry once they are straight are not put there from afar: 6 mm.
    for start in [[0.3, 0.2, 0.5], [0.5, 0.1, 0.8], [0.2, -0.4, 0.3]] {
        let all = [
            (Options::tsit5(1e-4), 5e-4),
            (Options::tsit5(1e-5), 1e-4),
            (Options::rodas5p(1e-4), 5e-4),
            (Options::rodas5p(1e-5), 1e-4),
            (Options::rk4(2e-4), 2e-4),
        ];
        check(start, 1.0, &all);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A lamp on a knot of three damped lines: thrown up, it slackens them all, and draws them straight when it falls. In single precision the pulls of nearly straight
/// lines are rounded by more than what a line goes slack at, and lines switched without end at 0.6848 s.
#[test]
fn lines_go_slack_and_taut_again_in_single_precision() {
    let scene = || {
        read(
            "model Thrown {
                gravity: [0, 0, -9.81] m/s^2;
                world { frame l at [-1, 0, 2] m, frame r at [1.2, 0, 2] m }
                body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame r at [0, 0, 0.5] m, frame t at [0, 0, -0.5] m }
                body two { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame r at [0, 0, 0.5] m }
                point lamp { mass: 0.6 kg, start at [0.4, 0.3, 0.3] m velocity [0.3, 0.2, 0] m/s }
                point knot { equilibrium: rate }
                line la from world.l to knot { free_length: 1.2 m, stiffness: 500 N/m, damping: 20 N*s/m }
                line lb from world.r to knot { free_length: 1.3 m, stiffness: 500 N/m, damping: 20 N*s/m }
                line lc from knot to lamp { free_length: 0.9 m, stiffness: 800 N/m, damping: 15 N*s/m }
                line sling from arm.t to lamp { free_length: 0.8 m, stiffness: 100 N/m, damping: 2 N*s/m }
                joint pin: hinge from world to arm.r { axis: y, start: 850 deg, start_rate: 40 rad/s }
                joint pin2: hinge from arm.t to two.r { axis: y, start: 20 deg, stiffness: 3 N*m, rest: 10 deg }
                event cut = time rises 0.37 s { detach: sling }
                output lamp_at = lamp.position;
            }",
        )
    };
    let double = Interpreted::<f64>::new(scene(), &[]).expect("no params");
    let mut run = Simulation::new(&double, Options::vern7(1e-10)).expect("a method");
    run.run(1.0).expect("it runs");
    let mut exact = [0.0; 3];
    run.evaluate(Quantity::Outputs, &mut exact)
        .expect("a state");
    let single = Interpreted::<f32>::new(scene(), &[]).expect("no params");
    for options in [
        Options::tsit5(1e-5),
        Options::tsit5(1e-6),
        Options::vern7(1e-5),
        Options::vern7(1e-6),
        Options::rodas5p(1e-5),
        Options::rk4(1e-4),
    ] {
        let method = options.method;
        let mut run = Simulation::new(&single, options).expect("a method");
        run.run(1.0)
            .unwrap_or_else(|error| panic!("{method:?}: {error}"));
        let mut found = [0.0_f32; 3];
        run.evaluate(Quantity::Outputs, &mut found)
            .expect("a state");
        let error = largest_difference(&found.map(f64::from), &exact);
        println!("{method:?}: {error:e} m");
        assert!(error < 5e-5, "{method:?}: {error:e} m");
    }
}

/// A knot of four damped lines to the world; the anchor of the fourth rises through the plane of the others at 0.5 s.
fn passing(knot: &str) -> mbd_scene::Scene {
    read(&format!(
        "model Passing {{
            gravity: none;
            world {{
                frame a at [1.0, 0.0, 0.0] m, frame b at [-0.5, 0.9, 0.0] m, frame c at [-0.6, -0.8, 0.0] m,
                frame d at [0.1, 0.2, -0.3 + 0.6 * time / 1 s] m
            }}
            point knot {{ {knot} }}
            line la from world.a to knot {{ free_length: 0.7 m, stiffness: 200 N/m, damping: 5 N*s/m }}
            line lb from world.b to knot {{ free_length: 0.7 m, stiffness: 150 N/m, damping: 4 N*s/m }}
            line lc from world.c to knot {{ free_length: 0.6 m, stiffness: 180 N/m, damping: 3 N*s/m }}
            line ld from world.d to knot {{ free_length: 0.05 m, stiffness: 100 N/m, damping: 3 N*s/m }}
        }}"
    ))
}

#[test]
fn a_node_that_passes_through_the_plane_of_its_anchors_stays_in_balance() {
    let node = Interpreted::<f64>::new(passing("equilibrium: rate"), &[]).expect("no params");
    let start = "mass: 1e-5 kg, start at [0.0028, 0.0059, -0.0936] m";
    let mass = Interpreted::<f64>::new(passing(start), &[]).expect("no params");
    let mut run = Simulation::new(&node, Options::tsit5(1e-8)).expect("a method");
    let mut heavy = Simulation::new(&mass, Options::rodas5p(1e-8)).expect("a method");
    for tenth in [1, 4, 6, 7, 8, 9, 10] {
        let time = f64::from(tenth) * 0.1;
        run.run(time).expect("it passes");
        heavy.run(time).expect("a point with mass");
        let mut lines = [0.0; 40];
        run.evaluate(Quantity::Lines, &mut lines)
            .expect("a balance");
        let place = &run.state()[..3];
        let anchors = [
            [1.0, 0.0, 0.0],
            [-0.5, 0.9, 0.0],
            [-0.6, -0.8, 0.0],
            [0.1, 0.2, -0.3 + 0.6 * time],
        ];
        let mut sum = [0.0; 3];
        for (anchor, line) in anchors.iter().zip(lines.chunks(10)) {
            let arm = [0, 1, 2].map(|k| anchor[k] - place[k]);
            let length = arm.iter().map(|x| x * x).sum::<f64>().sqrt();
            for (sum, x) in sum.iter_mut().zip(arm) {
                *sum += line[0] * x / length;
            }
        }
        // Held in the plane that fits the anchors best, 6 N of 75 N were left open at the end, and the node was 22 mm off.
        assert!(sum.iter().all(|x| x.abs() < 1e-8), "{time} s: {sum:?} N");
        let apart = largest_difference(place, &heavy.state()[..3]);
        assert!(apart < 1e-5, "{time} s: {apart} m");
    }
}

/// Two damped lines without force, whose anchors swing into one line with their node at 0.1896 s, where its velocity grows beyond bounds. The pull of
/// one of them is rounding there, and was taken for one that carries: the node was put 98 mm beside the line, in relative coordinates.
#[test]
fn a_node_that_two_idle_lines_swing_into_one_line_stays_between_their_anchors() {
    let places = ["absolute", "relative"].map(|family| {
        let scene = read(&format!(
            "model Swing {{
                coordinates: {family}; planar: xz;
                gravity: [-1.173, 0.0, 7.239] m/s^2;
                world {{ frame f0 at [-0.310, 0.0, 0.041] m, frame f2 at [-0.326, 0.0, -0.497] m }}
                body b0 {{ mass: 3.522 kg, inertia: diag(0.1845, 0.0531, 0.1663) kg*m^2, frame f0 at [-0.247, 0.0, 0.244] m,
                    frame f1 at [-0.421, 0.0, 0.330] m, frame f2 at [-0.056, 0.0, -0.218] m rotated rpy(0, -90 deg, 0) }}
                body b1 {{ mass: 1.714 kg, inertia: diag(0.1213, 0.1126, 0.1544) kg*m^2, frame f0 at [-0.202, 0.0, 0.085] m,
                    frame f1 at [0.032, 0.0, 0.222] m rotated rpy(0, 17.0 deg, 0), frame f2 at [-0.225, 0.0, -0.013] m rotated rpy(0, -90 deg, 0),
                    frame f3 at [-0.053, 0.0, -0.105] m rotated rpy(0, 90 deg, 0), frame f4 at [0.011, 0.0, 0.126] m }}
                body b2 {{ mass: 3.808 kg, inertia: diag(0.1392, 0.1807, 0.0683) kg*m^2, frame f0 at [0.065, 0.0, 0.454] m, frame f1 at [0.260, 0.0, 0.414] m }}
                joint j0: free from world.f0 to b0.f0;
                joint j1: rigid from world to b1.com;
                joint j2: rigid from b0.com to b2.f0;
                line l0 from b0.f1 to b1.f0 {{ free_length: 0.90 m, stiffness: 66.3 N/m }}
                spring l2 from world.f2 to b1.f1 {{ free_length: 0.29 m, stiffness: 64.6 N/m, damping: 0.94 N*s/m }}
                load w0 on b0 at f2 = [0, 0, 2.46] N * sin(3 rad/s * time);
                load w1 on b1 at f2 = -0.88 N*s/m * b1.f2.velocity;
                point knot {{ equilibrium: rate }}
                line kn0 from b2.f1 to knot {{ free_length: 0.15 m, stiffness: 43.3 N/m, damping: 9.4 N*s/m }}
                line kn1 from b1.f3 to knot {{ free_length: 0.15 m, stiffness: 148.3 N/m, damping: 5.4 N*s/m }}
                line kn2 from b1.f4 to knot {{ free_length: 0.19 m, stiffness: 97.2 N/m, damping: 2.0 N*s/m }}
                output place = b2.position;
                output knot_at = knot.position;
            }}"
        ));
        let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).expect("a method");
        run.run(0.4).unwrap_or_else(|error| panic!("{family}: {error}"));
        let mut outputs = [0.0; 6];
        run.evaluate(Quantity::Outputs, &mut outputs).expect("a state");
        outputs
    });
    let apart = largest_difference(&places[0], &places[1]);
    assert!(apart < 1e-5, "{apart} m: {places:?}");
}

/// A node on three damped lines of a plane under a load in that plane comes to rest where the elastic lines and the load balance, as the static node does at
/// once; a load across the plane has nothing to balance it.
#[test]
fn a_load_in_the_plane_of_the_lines_is_balanced_and_one_across_it_is_refused() {
    let scene = |plane: &str, knot: &str, load: &str| {
        read(&format!(
            "model Net {{ {plane} gravity: none;
                world {{ frame l at [-1, 0, 2] m, frame r at [1.5, 0, 2.2] m, frame q at [0.3, 0, 0] m }}
                point k {{ equilibrium: {knot} }}
                line a from world.l to k {{ free_length: 1 m, stiffness: 500 N/m, damping: 40 N*s/m }}
                line b from world.r to k {{ free_length: 1 m, stiffness: 300 N/m, damping: 40 N*s/m }}
                line c from world.q to k {{ free_length: 0.5 m, stiffness: 200 N/m, damping: 40 N*s/m }}
                load w on k = {load};
                output place = k.position;
            }}"
        ))
    };
    let rest = |plane: &str, knot: &str, load: &str| -> Result<Vec<f64>, String> {
        let model = Interpreted::<f64>::new(scene(plane, knot, load), &[]).expect("no params");
        let told = |error: &dyn std::fmt::Display| error.to_string();
        let mut run = Simulation::new(&model, Options::tsit5(1e-10)).map_err(|e| told(&e))?;
        run.set_nodes(&[0.2, 0.0, 1.2]).map_err(|e| told(&e))?;
        run.run(20.0).map_err(|e| told(&e))?;
        let mut place = vec![0.0; 3];
        run.evaluate(Quantity::Outputs, &mut place)
            .map_err(|e| told(&e))?;
        Ok(place)
    };
    for plane in ["planar: xz;", ""] {
        for load in [
            "[0 N, 0 N, -0.5 N]",
            "[-20, 0, 30] N",
            "[4 N * sin(0 rad/s * time), 0, 0]",
        ] {
            let [damped, at_once] = ["rate", "static"].map(|knot| {
                rest(plane, knot, load).unwrap_or_else(|error| panic!("{plane} {load}: {error}"))
            });
            let apart = largest_difference(&damped, &at_once);
            assert!(apart < 1e-7, "{plane} {load}: {apart} m");
        }
    }
    let across = rest("", "rate", "[0, 1, 0] N").expect_err("nothing pulls across the plane");
    assert!(across.contains("no taut line spans"), "{across}");
    // No step is short enough for it.
    assert!(across.contains("give the point a mass"), "{across}");
}

/// A node under a load on three bodies that hang from springs. One of its three lines goes slack twice; the other two carry the load as a pendulum, at any
/// tolerance: a node of 2 g, whose lines and load do the same by another law, is where it is. It was refused at 1e-4 and 1e-5, as the line that went slack had
/// pulled by its tolerance at most until then and had held the node a little beside the plane of the other two.
#[test]
fn two_lines_carry_a_load_when_the_third_goes_slack_at_any_tolerance() {
    let run = |knot: &str, load: f64, options: Options| {
        let scene = read(&format!(
            "model Net {{ gravity: [0, 0, -9.81] m/s^2;
                world {{ frame f0 at [1.354, 0.522, 3.546] m, frame f1 at [-0.714, 0.796, 4.178] m, frame f2 at [-0.077, -1.177, 4.263] m }}
                body b0 {{ mass: 1.51 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [1.042, 0.402, 2.546] m, frame e at [0, 0, 0.2] m }}
                body b1 {{ mass: 2.67 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [-0.549, 0.612, 3.178] m, frame e at [0, 0, 0.2] m }}
                body b2 {{ mass: 4.55 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, start at [-0.059, -0.905, 3.263] m, frame e at [0, 0, 0.2] m }}
                joint j0: free from world to b0.com;
                joint j1: free from world to b1.com;
                joint j2: free from world to b2.com;
                spring s0 from world.f0 to b0.e {{ free_length: 0.8 m, stiffness: 439 N/m, damping: 1.2 N*s/m }}
                spring s1 from world.f1 to b1.e {{ free_length: 0.8 m, stiffness: 318 N/m, damping: 2.3 N*s/m }}
                spring s2 from world.f2 to b2.e {{ free_length: 0.8 m, stiffness: 69 N/m, damping: 2.9 N*s/m }}
                point k {{ {knot} }}
                line l0 from b0.com to k {{ free_length: 1.18 m, stiffness: 19102 N/m, damping: 916.58 N*s/m }}
                line l1 from b1.com to k {{ free_length: 1.559 m, stiffness: 487 N/m, damping: 3.82 N*s/m }}
                line l2 from b2.com to k {{ free_length: 1.71 m, stiffness: 7455 N/m, damping: 531.03 N*s/m }}
                load w on k = [0, 0, -{load}] N;
                output places = [b0.position.x, b0.position.z, b1.position.x, b1.position.z, b2.position.x, b2.position.z];
            }}"
        ));
        let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
        let mut run = Simulation::new(&model, options).expect("a method");
        let reached = run.run(2.0);
        reached.unwrap_or_else(|error| panic!("{:?}: {error}", options.method));
        let mut places = vec![0.0; 6];
        run.evaluate(Quantity::Outputs, &mut places)
            .expect("a state");
        places
    };
    let mass = "mass: 0.002 kg, start at [0.143377, 0.057812, 1.862165] m";
    let truth = run(mass, 28.0 - 0.002 * 9.81, Options::rodas5p(1e-7));
    for (options, allowed) in [
        (Options::tsit5(1e-4), 5e-3),
        (Options::tsit5(3e-5), 5e-4),
        (Options::tsit5(1e-5), 2e-4),
        (Options::vern7(1e-8), 2e-4),
        (Options::rk4(0.005), 1e-3),
    ] {
        let apart = largest_difference(&truth, &run("equilibrium: rate", 28.0, options));
        assert!(apart < allowed, "{:?}: {apart} m", options.method);
    }
}
