//! Full turns of angles in absolute coordinates: springs wind up, stops hold, controllers and events see what relative coordinates have in their state.

use std::f64::consts::{PI, TAU};

use mbd_runtime::{Generic, Instability, Options, Scalar, Simulation, StepError, linearise, trim};
use mbd_scene::{Coordinates, Quantity, Scene};
use tests::assert_close;
use tests::declared::read;

/// A wheel of 0.1 kg m² on a hinge about z with what is `said` of it, in either family.
fn wheel(said: &str, coordinates: Coordinates) -> Scene {
    read(&format!(
        "model Wheel {{ gravity: none;
           body rim {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
           joint pin: hinge from world to rim.com {{ axis: z {said} }} }}"
    ))
    .in_coordinates(coordinates)
}

fn simulation<T: Scalar>(scene: Scene) -> Simulation<T> {
    let model = Generic::<T>::with_defaults(scene).expect("a valid scene");
    Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit")
}

/// The rate of the wheel about z [rad/s].
fn rate<T: Scalar>(run: &Simulation<T>) -> f64 {
    run.state().last().expect("a state").to_f64()
}

const BOTH: [Coordinates; 2] = [Coordinates::Absolute, Coordinates::Relative];

#[test]
fn a_spring_winds_up_over_turns() {
    // θ = 10 sin t: three half turns and back.
    let said = ", stiffness: 0.1 N*m/rad, start_rate: 10 rad/s";
    for coordinates in BOTH {
        let mut run = simulation::<f64>(wheel(said, coordinates));
        for k in 1..=40 {
            let t = 0.1 * f64::from(k);
            run.run(t).expect("a run");
            assert_close(&[rate(&run)], &[10.0 * t.cos()], 0.0, 1e-10, "rate");
        }
    }
    let mut run = simulation::<f32>(wheel(said, Coordinates::Absolute));
    run.run(4.0).expect("a run");
    assert_close(&[rate(&run)], &[10.0 * 4f64.cos()], 0.0, 2e-3, "f32");
}

#[test]
fn a_stop_beyond_half_a_turn_is_no_passage() {
    // Without a damper the wheel comes back as fast as it went, after half a period of 0.01 s.
    let said = ", stops: [-9, 9] rad, stop_stiffness: 1000 N*m/rad, start_rate: 5 rad/s";
    for coordinates in BOTH {
        let mut run = simulation::<f64>(wheel(said, coordinates));
        run.run(1.7).expect("a run");
        assert_close(&[rate(&run)], &[5.0], 0.0, 1e-12, "on its way");
        run.run(2.0).expect("a run");
        assert_close(&[rate(&run)], &[-5.0], 0.0, 5e-6, "on its way back");
    }
}

#[test]
fn a_controller_goes_on_over_turns() {
    // Critically damped towards two turns: θ = 4π (1 − (1 + 5 t) e^(−5 t)), from rest.
    let said = ", force: 2.5 N*m * (720 deg - pin.angle) - 1 N*m*s * pin.angle_rate";
    for coordinates in BOTH {
        let mut run = simulation::<f64>(wheel(said, coordinates));
        for t in [0.3, 0.9, 2.0] {
            run.run(t).expect("a run");
            let want = 2.0 * TAU * 25.0 * t * (-5.0 * t).exp();
            assert_close(&[rate(&run)], &[want], 0.0, 1e-8, "rate");
        }
    }
}

#[test]
fn an_event_at_an_angle_happens_at_that_turn_alone() {
    let events = "event back = pin.angle rises 90 deg; event onward = pin.angle falls -270 deg;";
    for coordinates in BOTH {
        let scene = read(&format!(
            "model Wheel {{ gravity: none;
               body rim {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
               joint pin: hinge from world to rim.com {{ axis: z, start_rate: -1 rad/s }} {events} }}"
        ));
        let mut run = simulation::<f64>(scene.in_coordinates(coordinates));
        run.run(12.0).expect("a run");
        let times: Vec<f64> = run.events().iter().map(|it| it.time).collect();
        assert_close(&times, &[1.5 * PI], 0.0, 1e-9, "events");
    }
}

#[test]
fn turns_are_kept_by_starts_snapshots_and_what_goes_on() {
    let said = ", stiffness: 0.1 N*m/rad";
    let want = |t: f64| -3.0 * PI * t.sin();
    let scene = wheel(said, Coordinates::Absolute);
    let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
    let new = || Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
    let mut run = new();
    // Three half turns, which the attitude alone does not tell from one.
    run.set_joints(&[("pin.angle", 3.0 * PI)]).expect("a start");
    run.run(0.5).expect("a run");
    assert_close(&[rate(&run)], &[want(0.5)], 0.0, 1e-10, "a start");
    let mut restored = new();
    restored.restore(&run.snapshot()).expect("of this model");
    let mut next = new();
    next.take_over(&mut run, &[]).expect("of this model");
    for (mut run, how) in [(run, "on"), (restored, "restored"), (next, "taken over")] {
        run.run(1.5).expect("a run");
        assert_close(&[rate(&run)], &[want(1.5)], 0.0, 1e-10, how);
        // A state that is set tells no turns.
        let mut state = vec![0.0; 13];
        state[3] = 1.0;
        run.set_state(0.0, &state).expect("a valid state");
        run.run(0.5).expect("a run");
        assert_close(&[rate(&run)], &[0.0], 0.0, 1e-12, how);
    }
    // Declared, the same in both families: and the coordinate is what was declared.
    for coordinates in BOTH {
        for turns in [0.75, -1.75, 3.0] {
            let said = format!(", stiffness: 0.1 N*m/rad, start: {} deg", 360.0 * turns);
            let mut run = simulation::<f64>(wheel(&said, coordinates));
            run.run(0.5).expect("a run");
            let want = -turns * TAU * 0.5f64.sin();
            assert_close(&[rate(&run)], &[want], 0.0, 1e-10, "declared");
        }
    }
}

#[test]
fn both_angles_of_a_universal_joint_start_beyond_half_a_turn() {
    // A spring on one axle turns the cross, one on the other the wheel: each is its own pendulum where the other is at a whole turn.
    for (first, second, want) in [(720.0, 200.0, 200.0), (200.0, 360.0, 200.0)] {
        for coordinates in BOTH {
            let scene = read(&format!(
                "model Cross {{ gravity: none;
                   body rim {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
                   joint pin: universal from world to rim.com {{ axes: [x, y],
                     angle1: {{ start: {first} deg }}, angle2: {{ start: {second} deg }} }}
                   output sum = pin.angle1 + pin.angle2; }}"
            ));
            let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates));
            let model = model.expect("a valid scene");
            let mut out = [0.0];
            let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
            run.start().expect("a start");
            run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
            let whole = if first == want { second } else { first };
            let sum: f64 = (want + whole) / 360.0 * TAU;
            assert_close(&out, &[sum], 0.0, 1e-9, "the sum of both");
        }
    }
}

#[test]
fn what_a_motor_drives_begins_with_the_turns_of_its_course() {
    // The spring is wound by what the motor says, and so is what the motor pushes with.
    for course in [
        "300 deg",
        "1000 deg + 1 rad/s * time",
        "[wish, 0 rad/s, 0 rad/s^2]",
        "wish, filter: 20 ms",
    ] {
        for coordinates in BOTH {
            let scene = read(&format!(
                "model Wheel {{ gravity: none;
                   input wish: angle = 400 deg;
                   body rim {{ mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }}
                   joint pin: hinge from world to rim.com {{ axis: z, stiffness: 0.3 N*m/rad, motor: {course} }}
                   output wound = pin.angle in deg; }}"
            ));
            let model = Generic::<f64>::with_defaults(scene.in_coordinates(coordinates));
            let model = model.expect("a valid scene");
            let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
            run.run(1.0)
                .unwrap_or_else(|error| panic!("{course}, {coordinates:?}: {error}"));
            let mut out = [0.0];
            run.evaluate(Quantity::Outputs, &mut out).expect("outputs");
            let want = match course {
                "300 deg" => 300.0,
                it if it.contains("wish") => 400.0,
                _ => 1000.0 + 1f64.to_degrees(),
            };
            assert_close(&out, &[want], 0.0, 1e-9, course);
        }
    }
}

#[test]
fn turns_go_on_from_either_family_to_either() {
    for from in BOTH {
        for to in BOTH {
            let said = ", stiffness: 0.1 N*m/rad, start: 1000 deg";
            let mut run = simulation::<f64>(wheel(said, from));
            run.run(0.25).expect("a run");
            let model = Generic::<f64>::with_defaults(wheel(said, to)).expect("a valid scene");
            let mut next = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
            next.take_over(&mut run, &[]).expect("the same wheel");
            next.run(1.5).expect("a run");
            let want = -1000f64.to_radians() * 1.5f64.sin();
            assert_close(&[rate(&next)], &[want], 0.0, 1e-9, "rate");
        }
    }
}

#[test]
fn a_fixed_step_in_which_an_angle_turns_more_than_half_a_turn_is_refused() {
    let said = ", stiffness: 1e-9 N*m/rad, start_rate: 100 rad/s";
    for options in [Options::rk4(0.04), Options::rattle(0.04)] {
        let scene = wheel(said, Coordinates::Absolute);
        let model = Generic::<f64>::with_defaults(scene).expect("a valid scene");
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let error = run.run(1.0).expect_err("four radians a step");
        let StepError::UnstableStep {
            what: Instability::Turn(swept),
            ..
        } = error.cause
        else {
            panic!("{error}");
        };
        assert_close(&[swept, run.time()], &[4.0, 0.0], 0.0, 1e-9, "swept");
    }
}

#[test]
fn a_wound_spring_pushes_in_linear_systems_and_rests_where_it_holds_the_weight() {
    // A rod of 1 kg, half a metre below its pin: (0.1 + 0.25) θ̈ = −k θ − m g l sin θ, at rest at 4.1499 rad for 1 N m/rad.
    let scene = read(
        "model Wound { gravity: [0, 0, -9.81] m/s^2;
           body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.01) kg*m^2, frame top at [0, 0, 0.5] m }
           joint pin: hinge from world to rod.top { axis: y, stiffness: 1 N*m/rad, start: 220 deg } }",
    );
    for coordinates in BOTH {
        let model = Generic::<f64>::with_defaults(scene.clone().in_coordinates(coordinates));
        let model = model.expect("a valid scene");
        let angle = 220f64.to_radians();
        let acceleration = |angle: f64| -(angle + 4.905 * angle.sin()) / 0.35;
        let mut run = Simulation::new(&model, Options::rk4(1e-3)).expect("options that fit");
        run.start().expect("a start");
        let about_start = linearise(&model, 0.0, run.state(), &[]).expect("a linear system");
        let about_run = run.linearise(&[]).expect("a linear system");
        for space in [about_start, about_run] {
            assert_close(
                space.accelerations.as_slice(),
                &[acceleration(angle)],
                1e-12,
                1e-12,
                "start",
            );
        }
        // Where a run stands, a turn further than it was declared.
        run.set_joints(&[("pin.angle", angle + TAU)])
            .expect("a start");
        run.start().expect("a start");
        let space = run.linearise(&["pin.angle"]).expect("a linear system");
        assert_close(
            space.accelerations.as_slice(),
            &[acceleration(angle + TAU)],
            1e-12,
            1e-12,
            "run",
        );
        for rest in [trim(&model), trim(&model).guess("pin.angle", 4.0)] {
            let rest = rest
                .solve()
                .expect("a rest")
                .value("pin.angle")
                .expect("a coordinate");
            assert_close(&[acceleration(rest)], &[0.0], 0.0, 1e-9, "rest");
            assert!(rest > 4.0, "{rest}");
        }
    }
}
