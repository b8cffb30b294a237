//! Events whose action changes the motion of their own guard: what holds it at its value happens once, what turns it back happens at every bounce,
//! and without end where bounces become too short.

use mbd_runtime::{Generic, Options, Quantity, Simulation, StepError};
use mbd_scene::{Coordinates, Scene};
use tests::assert_close;
use tests::declared::read;

use super::{G, methods_in};

const BOTH: [Coordinates; 2] = [Coordinates::Absolute, Coordinates::Relative];

fn run(scene: Scene, options: Options) -> Simulation<f64> {
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    Simulation::new(&model, options).expect("options that fit")
}

/// A ball as two states, which bounces from z = 0 with the factor `e`; `set` is what the bounce sets besides.
fn ball(e: f64, set: &str) -> Scene {
    read(&format!(
        "model Ball {{ gravity: none;
           state z = 1 m {{ rate: v }}
           state v = 0 m/s {{ rate: -9.81 m/s^2 }}
           event hit = z falls 0 m {{ set: [v = -{e:?} * v{set}] }}
           output height = z; }}"
    ))
}

/// When a ball from 1 m hits the floor for the n-th time, and when it lies there [s].
fn hits(e: f64, n: i32) -> [f64; 2] {
    let first = (2.0 / G).sqrt();
    let after = |sum: f64| first * (1.0 + 2.0 * sum);
    let sum = e * (1.0 - e.powi(n - 1)) / (1.0 - e);
    [after(sum), after(e / (1.0 - e))]
}

/// Methods for scenes without joints.
fn some_methods() -> [Options; 4] {
    [
        Options::rk4(1e-3),
        Options::rk4(1e-2),
        Options::tsit5(1e-8),
        Options::rodas5p(1e-8),
    ]
}

#[test]
fn a_ball_bounces_by_its_closed_form_and_where_it_lies_the_run_ends_with_its_event() {
    for set in ["", ", z = 0 m"] {
        for options in some_methods() {
            let word = format!("{} {set}", options.method.name());
            let mut run = run(ball(0.8, set), options);
            run.run(4.05).expect("bounces");
            let found: Vec<f64> = run.events().iter().map(|event| event.time).collect();
            assert_eq!(found.len(), 25, "{word}");
            for (n, time) in (1..).zip(&found) {
                assert_close(&[*time], &[hits(0.8, n)[0]], 0.0, 1e-8, &word);
            }
            // However far the run is asked to go.
            for end in [4.2, 5.0, 60.0] {
                let told = run.run(end).expect_err("it lies there");
                let StepError::EventChatter { line, is_event, .. } = &told.cause else {
                    panic!("{word}: {told}");
                };
                assert_eq!((line.as_str(), *is_event), ("hit", true), "{word}");
                let words = told.to_string();
                assert!(words.contains("say what holds then"), "{words}");
                // There is no line in the scene that could be too stiff or slack.
                assert!(
                    !words.contains("stiff for") && !words.contains("slack"),
                    "{words}"
                );
                let [_, lies] = hits(0.8, 1);
                assert_close(&[run.time()], &[lies], 0.0, 1e-7, &word);
                assert!(run.state()[0].abs() < 1e-7, "{word}: {:?}", run.state());
            }
        }
    }
}

#[test]
fn a_ball_that_does_not_bounce_lies_at_once() {
    for options in some_methods() {
        let told = run(ball(0.0, ""), options).run(2.0);
        let told = told.expect_err("it lies there").cause;
        assert!(matches!(told, StepError::EventChatter { .. }), "{told}");
    }
}

#[test]
fn a_run_that_goes_on_between_two_bounces_keeps_its_bits() {
    let options = Options::tsit5(1e-8);
    let mut whole = run(ball(0.8, ""), options);
    whole.run(3.5).expect("bounces");
    let saved = whole.snapshot();
    let mut later = run(ball(0.8, ""), options);
    later.restore(&saved).expect("the same model");
    for run in [&mut whole, &mut later] {
        run.run(4.05).expect("bounces");
    }
    assert_eq!(whole.state(), later.state());
}

#[test]
fn a_latch_that_is_asked_for_by_a_distance_catches_once_and_again_after_it_was_opened() {
    // A slide runs in at 0.5 m/s, is caught at 1.5 m of the 2 m, let go, and pulled back at 1 m/s², so that it passes again.
    let scene = read(
        "model Latch { gravity: none;
           body sled { mass: 2 kg, inertia: diag(1, 1, 1) kg*m^2 }
           param pull = 0 N;
           joint rail: prismatic from world to sled.com { axis: x, start: 2 m, start_rate: -0.5 m/s, force: pull }
           state n = 0 { rate: 0 / (1 s) }
           event caught = norm(sled.position) falls 1.5 m { lock: rail, set: n = n + 1 }
           event opened = time rises 2 s { free: rail, set: pull = 2 N }
           event turned = time rises 3 s { set: pull = -2 N }
           output count = n; output x = rail.slide; }",
    );
    for coordinates in BOTH {
        for options in methods_in(coordinates) {
            let word = format!("{} {coordinates:?}", options.method.name());
            let mut run = run(scene.clone().in_coordinates(coordinates), options);
            let mut seen = |end: f64| {
                run.run(end).expect("a run");
                let mut outputs = [0.0; 2];
                run.evaluate(Quantity::Outputs, &mut outputs)
                    .expect("outputs");
                outputs
            };
            assert_close(&seen(1.9), &[1.0, 1.5], 0.0, 1e-9, &word);
            // Pushed out by 0.5 m in a second, it comes back after two more with 1 m/s inwards, and is caught for the second time.
            assert_close(&seen(3.0), &[1.0, 2.0], 0.0, 1e-9, &word);
            assert_close(&seen(6.0), &[2.0, 1.5], 0.0, 1e-9, &word);
        }
    }
}

#[test]
fn a_tether_comes_taut_once_and_takes_the_velocity_along_it() {
    let scene = read(
        "model Tether { gravity: [0, 0, -9.81] m/s^2; const L = 2 m;
           body w { mass: 30 kg, inertia: diag(2, 3, 4) kg*m^2, frame eye at [0.2, 0, 0.5] m,
             start at [0.3, 0, -0.6] m velocity [1, 0.4, 0] m/s angular_velocity [0.3, 1, 0] rad/s }
           joint f: free from world to w.com;
           joint rope: distance from world to w.eye { length: L, at_start: detached }
           event taut = norm(w.eye.position) rises L { attach: rope }
           output along = dot(w.eye.velocity, w.eye.position);
           output far = norm(w.eye.position); }",
    );
    for coordinates in BOTH {
        for options in [
            Options::tsit5(1e-8),
            Options::tsit5(1e-4),
            Options::rk4(1e-3),
        ] {
            let word = format!("{} {coordinates:?}", options.method.name());
            let mut run = run(scene.clone().in_coordinates(coordinates), options);
            run.run(1.2).expect("a run");
            assert_eq!(run.events().len(), 1, "{word}");
            let mut outputs = [0.0; 2];
            run.evaluate(Quantity::Outputs, &mut outputs)
                .expect("outputs");
            assert_close(&outputs, &[0.0, 2.0], 0.0, 1e-8, &word);
        }
    }
}

#[test]
fn a_guard_that_a_joint_holds_from_the_start_passes_nothing() {
    // A pendulum keeps its distance; the same event beside another part happens where that passes.
    let scene = read(
        "model Pendulum { gravity: [0, 0, -9.81] m/s^2;
           body bob { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 1] m }
           joint pin: hinge from world to bob.top { axis: y, start: 90 deg }
           event apart = norm(bob.position) rises 1 m;
           event deep = bob.position.z falls -0.5 m; }",
    );
    for coordinates in BOTH {
        for options in [Options::tsit5(1e-4), Options::rk4(1e-2)] {
            let mut run = run(scene.clone().in_coordinates(coordinates), options);
            run.run(1.0).expect("a run");
            assert_eq!(run.events().len(), 1, "{coordinates:?}");
        }
    }
}

#[test]
fn what_goes_on_beyond_has_passed_once_however_joints_are_closed_behind_its_action() {
    // Joints that are closed move an angle by rounding: behind its level, or back before it.
    for (angle, levels) in [
        ("p.angle", [-0.637, -0.604, -0.571, -0.538, -0.505]),
        ("q.angle", [0.254, 0.287, 0.32, 0.353, 0.386]),
    ] {
        for level in levels {
            let scene = read(&format!(
                "model Shaken {{ coordinates: absolute; gravity: [0, 0, -9.81] m/s^2;
                    world {{ frame w at [0.47 m + 0.05 m * sin(4.4 rad/s * time + 0.6), 1.17 m, -0.9 m + 0.07 m * sin(4.4 rad/s * time + 0.6)] }}
                    body a {{ mass: 1 kg, inertia: diag(0.3, 0.4, 0.2) kg*m^2,
                        frame r at [0.1, -0.5, 0.25] m rotated about([1, 2, 3], 50 deg), frame t at [0.2, -0.5, -0.4] m rotated about([1, 2, 0], 50 deg) }}
                    body b {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame r at [-0.5, 0.3, 0.2] m rotated about([1, 0, 1], 40 deg) }}
                    joint p: hinge from world.w to a.r {{ axis: x, start: -1 rad, start_rate: 1 rad/s }}
                    joint q: hinge from a.t to b.r
                    state passed = 0 {{ rate: 0 }}
                    event passes = {angle} crosses {level} rad {{ set: passed = passed + 1 }}
                    output count = passed; }}"
            ));
            let mut run = run(scene, Options::tsit5(1e-10));
            run.run(1.0).expect("a swing");
            let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
            let apart = times.windows(2).all(|pair| pair[1] - pair[0] > 1e-6);
            assert!(apart, "{angle} crosses {level} at {times:?}");
            let mut count = [f64::NAN];
            run.evaluate(Quantity::Outputs, &mut count)
                .expect("an output");
            assert_eq!(count, [times.len() as f64], "{angle} crosses {level}");
        }
    }
}

/// Of a ball whose bounces come to their end: on the ground, and on a floor 100 m up, where numbers of single precision are 7.6e-6 m apart. It fell through both in
/// single precision: the first bounce that was shorter than the guard is told from its value sent it down.
#[test]
fn a_ball_whose_bounces_end_falls_through_no_floor_in_single_precision() {
    let methods = [
        Options::rk4(1e-3),
        Options::rk4(1e-2),
        Options::tsit5(1e-5),
        Options::vern7(1e-5),
        Options::rodas5p(1e-5),
    ];
    for (floor, restitution) in [
        (0.0, 0.8),
        (0.0, 0.5),
        (100.0, 0.3),
        (100.0, 0.5),
        (100.0, 0.8),
    ] {
        let from = floor + 2.0;
        let scene = read(&format!(
            "model Ball {{ gravity: [0, 0, -9.81] m/s^2;
                point ball {{ mass: 1 kg, start at [0, 0, {from:?}] m velocity [0.5, 0, 0] m/s }}
                event hit = ball.position.z falls {floor:?} m {{ set: ball.velocity.z = -{restitution:?} * ball.velocity.z }} }}"
        ));
        let model = Generic::<f32>::with_defaults(scene).expect("defaults");
        // T (1 + 2 e + 2 e² + …).
        let end = (2.0 * 2.0 / 9.81_f64).sqrt() * (1.0 + restitution) / (1.0 - restitution);
        for options in methods {
            let mut run = Simulation::<f32>::new(&model, options).expect("options");
            let error = run.run(20.0).expect_err("bounces without end");
            let StepError::EventChatter { is_event: true, .. } = error.cause else {
                panic!("{floor} {restitution} {options:?}: {error}");
            };
            let off = run.time() / end - 1.0;
            println!("{floor} {restitution} {} {off:.1e}", options.method.name());
            assert!(off.abs() < 0.02, "{options:?}: {} {end}", run.time());
        }
    }
}

/// Between two looks the guard of a ball that has just bounced may not have left the number of the floor. Where it was at it exactly, 100 m up, it was taken to
/// have passed again: under Rodas5P, which looks closer, the run ended at the second bounce in pieces of 10 ms, and at one of the next in one piece.
#[test]
fn a_ball_that_is_still_at_the_number_of_its_floor_has_not_hit_it_again() {
    for (floor, drop) in [(100.0, 2.0), (1000.0, 2.0), (64.0, 1.3), (0.0, 2.0)] {
        let from = floor + drop;
        let scene = read(&format!(
            "model Ball {{ gravity: [0, 0, -9.81] m/s^2;
                point ball {{ mass: 1 kg, start at [0, 0, {from:?}] m velocity [0.5, 0, 0] m/s }}
                event hit = ball.position.z falls {floor:?} m {{ set: ball.velocity.z = -0.5 * ball.velocity.z }} }}"
        ));
        let model = Generic::<f32>::with_defaults(scene).expect("defaults");
        let end = 3.0 * (2.0 * drop / G).sqrt();
        for options in [
            Options::rodas5p(1e-3),
            Options::rodas5p(1e-5),
            Options::auto(1e-5),
            Options::vern7(1e-5),
            Options::rk4(1e-3),
        ] {
            for piece in [3.0, 0.01, 0.003] {
                let word = format!("{floor} {} {piece}", options.method.name());
                let mut run = Simulation::<f32>::new(&model, options).expect("options");
                let pieces = (1..).map(|n| f64::from(n) * piece);
                let error = pieces.take(3000).find_map(|until| run.run(until).err());
                let cause = error.expect("bounces without end").cause;
                assert!(
                    matches!(cause, StepError::EventChatter { is_event: true, .. }),
                    "{word}: {cause}"
                );
                // The rest of the bounces are lower than numbers are apart there.
                let lowest = 4.0 * f64::from(f32::EPSILON) * from;
                let rest = 12.0 * (2.0 * lowest / G).sqrt();
                let off = run.time() - end;
                assert!(off.abs() < rest, "{word}: {off:.1e} {rest:.1e}");
            }
        }
    }
}
