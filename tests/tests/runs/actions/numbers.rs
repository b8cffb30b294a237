//! Params and states that are set.

use mbd_runtime::{Options, Simulation, Stop, model};
use tests::agreement::{agrees, agrees_along};

use super::{G, methods};

model! {
    /// A capsule under a parachute that is reefed until four seconds.
    pub model Reefed<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param rho = 0.02 kg/m^3;
        param cd_s = 25 m^2 in 1 m^2 ..= 100 m^2;
        point capsule { mass: 80 kg, start at [0.0, 0.0, 3000.0] m velocity [60.0, 0.0, -80.0] m/s }
        load drag on capsule = -0.5 * rho * cd_s * norm(capsule.velocity) * capsule.velocity;
        event opened = time rises 4 s { set: cd_s = 82 m^2 }
        output area = cd_s;
    }
}

model! {
    /// A room that is heated until 21 and cools until 19: what the heater does follows from where the room has been.
    model Heated {
        units: si;
        gravity: none;
        param power = 1 in 0 ..= 2;
        point idle { mass: 1 }
        state warm = 15 { rate: 20 * power - 0.5 * (warm - 10) }
        state cycles = 0 { rate: 0 }
        event hot = warm rises 21 { set: [power = 0, cycles = cycles + 1] }
        event cold = warm falls 19 { set: power = 1 }
    }
}

model! {
    /// Two events at one instant, of which the later declared counts, a third that follows from what they do, and one that acts once.
    model Together {
        units: si;
        gravity: none;
        param a = 0;
        param b = 1;
        point idle { mass: 1 }
        state seen = 0 { rate: 0 }
        event first = 3 * (time - 1) rises 0 { set: [a = 5, b = a + 7] }
        event second = time rises 1 { set: a = b + 10 }
        event third = a rises 10.5 { set: seen = a }
        event once = sin(6.283185307179586 * time) rises 0.5 { set: seen = seen + 100, acts: once }
        event halt = time rises 2.5 { then: stop }
    }
}

/// A run of the parachute.
fn reefed(options: Options) -> Simulation<f64> {
    let model = Reefed::<f64>::new(ReefedParams::default()).expect("defaults");
    Simulation::new(&model, options).expect("options that fit")
}

#[test]
fn an_area_that_changes_in_a_run_is_two_runs_joined_by_hand() {
    let opened = ReefedParams {
        cd_s: 82.0,
        ..ReefedParams::default()
    };
    let opened = Reefed::<f64>::new(opened).expect("a value within the range");
    for options in methods() {
        let word = options.method.name();
        let mut whole = reefed(options);
        whole.run(9.0).expect("a smooth motion");
        let mut first = reefed(Options {
            stop_at_events: true,
            ..options
        });
        assert_eq!(first.run(9.0).expect("a smooth motion"), Stop::Event(0));
        assert!(
            (first.time() - 4.0).abs() < 1e-13,
            "{word}: {}",
            first.time()
        );
        let mut second = Simulation::new(&opened, options).expect("options that fit");
        second
            .set_state(first.time(), first.state())
            .expect("a state");
        second.run(9.0).expect("a smooth motion");
        let apart = tests::largest_difference(whole.state(), second.state());
        match options.method.fixed_step() {
            // A run from four seconds opens it at its start.
            Some(_) => assert!(apart < 2e-12, "{word}: {apart:e}"),
            None => assert!(apart < 1e-8, "{word}: {apart:e}"),
        }
        assert_eq!(whole.model().params(), [0.02, 82.0]);
        // No energy is stored in an area.
        assert_eq!(whole.actions()[0].work(), Some(0.0));
    }
}

#[test]
fn what_is_set_is_the_same_in_generated_interpreted_and_generic_models() {
    let model = Reefed::<f64>::new(ReefedParams::default()).expect("defaults");
    agrees(&model);
    let start = [0.0, 0.0, 3000.0, 60.0, 0.0, -80.0];
    agrees_along(&model, &start, (200, 0.04), 1e-12);
    let model = Heated::new(HeatedParams::default()).expect("defaults");
    agrees(&model);
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 15.0, 0.0];
    agrees_along(&model, &start, (300, 0.01), 1e-12);
}

#[test]
fn a_snapshot_after_an_action_goes_on_to_the_same_bits() {
    for options in methods() {
        let mut whole = reefed(options);
        whole.run(5.0).expect("a smooth motion");
        let snapshot = whole.snapshot();
        let mut resumed = reefed(options);
        resumed.restore(&snapshot).expect("of the same model");
        assert_eq!(resumed.model().params(), [0.02, 82.0]);
        for run in [&mut whole, &mut resumed] {
            run.run(8.0).expect("a smooth motion");
        }
        let word = options.method.name();
        assert_eq!(whole.state(), resumed.state(), "{word}");
        assert_eq!(whole.snapshot(), resumed.snapshot(), "{word}");
        // Back before the event it happens again.
        let mut early = reefed(options);
        early.run(3.0).expect("a smooth motion");
        whole.restore(&early.snapshot()).expect("of the same model");
        assert_eq!(whole.model().params(), [0.02, 25.0]);
        for run in [&mut whole, &mut early] {
            run.run(8.0).expect("a smooth motion");
        }
        assert_eq!(whole.state(), early.state(), "{word}");
    }
}

#[test]
fn params_that_are_given_after_an_event_hold_and_another_run_has_those_that_were_given() {
    let mut run = reefed(Options::rk4(0.01));
    run.run(5.0).expect("a smooth motion");
    run.set_params(&[0.03, 60.0])
        .expect("values within their ranges");
    run.run(6.0).expect("a smooth motion");
    assert_eq!(run.model().params(), [0.03, 60.0]);
    run.set_state(0.0, &[0.0, 0.0, 3000.0, 0.0, 0.0, 0.0])
        .expect("a state");
    assert_eq!(run.model().params(), [0.03, 60.0]);
    run.run(4.5).expect("a smooth motion");
    assert_eq!(run.model().params(), [0.03, 82.0]);
    run.set_state(0.0, &[0.0, 0.0, 3000.0, 0.0, 0.0, 0.0])
        .expect("a state");
    assert_eq!(run.model().params(), [0.03, 60.0]);
}

#[test]
fn a_relay_with_hysteresis_has_the_period_of_its_exponentials() {
    // Heating towards 50, cooling towards 10, with 1/2 s⁻¹.
    let up = 2.0 * (31.0_f64 / 29.0).ln();
    let down = 2.0 * (11.0_f64 / 9.0).ln();
    let first = 2.0 * (35.0_f64 / 29.0).ln();
    let model = Heated::new(HeatedParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(10.0).expect("a smooth motion");
        let hot: Vec<f64> = run
            .events()
            .iter()
            .step_by(2)
            .map(|event| event.time)
            .collect();
        assert!((hot[0] - first).abs() < 1e-9, "{word}: {hot:?}");
        assert!(hot.len() > 15, "{word}: {hot:?}");
        for pair in hot.windows(2) {
            assert!(
                (pair[1] - pair[0] - up - down).abs() < 1e-8,
                "{word}: {hot:?}"
            );
        }
        assert_eq!(
            run.state().last(),
            Some(&(hot.len() as f64)),
            "{word}: counted"
        );
    }
}

#[test]
fn what_happens_at_one_instant_acts_together_on_what_was_before() {
    let model = Together::new(TogetherParams::default()).expect("defaults");
    for options in methods() {
        let word = options.method.name();
        let mut run = Simulation::new(&model, options).expect("options that fit");
        assert_eq!(
            run.run(4.0).expect("a smooth motion"),
            Stop::Event(4),
            "{word}"
        );
        assert!((run.time() - 2.5).abs() < 1e-13, "{word}: {}", run.time());
        // Both see a = 0 and b = 1; the last value of a counts, and what it brings about acts at the same instant.
        assert_eq!(run.model().params(), [11.0, 7.0], "{word}");
        let acted: Vec<&[usize]> = run.actions().iter().map(|it| &it.events[..]).collect();
        assert_eq!(acted, [&[3][..], &[0, 1], &[2]], "{word}");
        assert_eq!(run.actions()[1].time, run.actions()[2].time, "{word}");
        assert!((run.actions()[1].time - 1.0).abs() < 1e-13, "{word}");
        assert_eq!(run.state().last(), Some(&11.0), "{word}");
        // Told each time, acted once.
        let told = run
            .events()
            .iter()
            .filter(|it| it.what == mbd_runtime::Happening::Declared(3));
        assert_eq!(told.count(), 3, "{word}");
        assert_eq!(
            run.run(4.0).expect("a smooth motion"),
            Stop::Reached,
            "{word}"
        );
    }
}

model! {
    /// A capsule that drops its heat shield: half of its mass goes at 20 m.
    model Lighter {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param mass = 100 kg;
        point capsule { mass: mass, start at [0.0, 0.0, 100.0] m velocity [3.0, 0.0, 0.0] m/s }
        event dropped = capsule.position.z falls 20 m { set: mass = 60 kg, acts: once }
    }
}

#[test]
fn mass_that_goes_takes_its_energy_and_changes_no_velocity() {
    let model = Lighter::new(LighterParams::default()).expect("defaults");
    for options in methods() {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        run.run(4.2).expect("a smooth motion");
        let [acted] = run.actions() else {
            panic!("one action")
        };
        let [kinetic, potential, _] = acted.energies.expect("uniform gravity");
        let speed2 = 9.0 + 2.0 * G * 80.0;
        assert!((kinetic + 0.5 * 40.0 * speed2).abs() < 1e-6);
        assert!((potential + 40.0 * G * 20.0).abs() < 1e-6);
        let z = 100.0 - 0.5 * G * 4.2 * 4.2;
        assert!((run.state()[2] - z).abs() < 1e-9);
        assert!(run.imbalance().is_none_or(|it| it.relative() < 1e-10));
    }
}
