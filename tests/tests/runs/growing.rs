//! Numbers that grow without end, angles that count turns and phases, in single and in double precision: what steps add is not lost, and what is read of them
//! is told before it is wrong.

use mbd_compiler::Interpreted;
use mbd_runtime::{CoarseState, Method, Options, Quantity, Scalar, Simulation, StepError};
use tests::declared::read;

/// A run of a declaration, what became of it, and what is told.
struct Flown<T: Scalar> {
    run: Simulation<T>,
    end: Result<(), StepError>,
}

impl<T: Scalar> Flown<T> {
    fn new(text: &str, options: Options, until: f64) -> Self {
        let model = Interpreted::<T>::new(read(text), &[]).expect("no params");
        let mut run = Simulation::new(&model, options).expect("options");
        let end = run.run(until).map(|_| ()).map_err(|error| error.cause);
        Flown { run, end }
    }

    fn outputs<const N: usize>(&mut self) -> [f64; N] {
        let mut out = [T::zero(); N];
        let found = self.run.evaluate(Quantity::Outputs, &mut out);
        found.expect("outputs");
        out.map(|x| x.to_f64())
    }

    fn told(&self) -> Option<CoarseState> {
        self.run.coarse_state()
    }
}

/// A wheel that turns at 3,000 rad/s, with a mark on its rim; a phase that grows as fast, and its sine.
const WHEEL: &str = "model Wheel { gravity: none; coordinates: relative;
    body wheel { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
    joint axle: hinge from world to wheel.com { axis: z, start_rate: 3000 rad/s }
    state phase = 0 rad { rate: 3000 rad/s }
    output turned = axle.angle;
    output phase_now = phase;
    output height = sin(axle.angle);
    output wave = sin(phase); }";

/// Each step was rounded to the same side: at steps of 1e-4 s the angle was 1,087 rad off after 12.5 s, and both sines were any number.
#[test]
fn what_grows_in_single_precision_is_off_by_a_rounding_and_not_by_one_a_step() {
    for options in [
        Options::rk4(1e-3),
        Options::rk4(1e-4),
        Options::tsit5(1e-5),
        Options::vern7(1e-5),
    ] {
        for until in [1.0_f64, 12.5, 17.0] {
            let exact = 3000.0 * until;
            let apart = f64::from(f32::EPSILON) * exact;
            let mut flown = Flown::<f32>::new(WHEEL, options, until);
            assert_eq!(flown.end, Ok(()));
            let [turned, phase, height, wave] = flown.outputs();
            for grown in [turned, phase] {
                let off = (grown - exact).abs();
                assert!(off < 3.0 * apart, "{options:?}, {until} s: {grown} {exact}");
            }
            // What is told is as large as what is wrong.
            let told = flown.run.rounding();
            for sine in [height, wave] {
                let off = (sine - exact.sin()).abs();
                assert!(off < 3.0 * told, "{options:?}, {until} s: {off} {told}");
            }
            let names = flown.told().map(|told| told.state);
            assert_eq!(
                names.is_some(),
                apart > 1e-3,
                "{options:?}, {until} s: {names:?}"
            );
            // Double precision has nothing to tell.
            let double = Flown::<f64>::new(WHEEL, options, until);
            assert_eq!((double.end, double.run.coarse_state()), (Ok(()), None));
        }
    }
}

/// In absolute coordinates turns are counted beside the state; nothing told that the angle had as few digits as in relative ones.
#[test]
fn an_angle_whose_turns_are_counted_beside_the_state_is_told_as_one_in_it() {
    for coordinates in ["absolute", "relative"] {
        let text = WHEEL.replace("relative", coordinates).replace(
            "state phase = 0 rad { rate: 3000 rad/s }",
            "state phase = 0 rad { rate: 0 rad/s }",
        );
        let mut single = Flown::<f32>::new(&text, Options::rk4(1e-4), 12.5);
        assert_eq!(single.end, Ok(()), "{coordinates}");
        let [turned, ..] = single.outputs::<4>();
        // RK4 lags by (h ω/2)⁴/120 of an attitude in absolute coordinates.
        assert!((turned - 37500.0).abs() < 0.2, "{coordinates}: {turned}");
        let told = single.told().expect("a coarse angle");
        assert_eq!(
            (told.state.as_str(), told.unit.as_str()),
            ("axle.angle", "rad")
        );
        // Two numbers are looked at in turn, every tenth step one, and a step is 0.3 rad.
        assert!((told.value - turned).abs() < 6.1, "{coordinates}: {told:?}");
        let apart = f64::from(f32::EPSILON) * turned;
        assert!((told.apart - apart).abs() < 1e-5, "{coordinates}: {told:?}");
        assert!(single.run.rounding() >= 0.9 * apart, "{coordinates}");
        let double = Flown::<f64>::new(&text, Options::rk4(1e-4), 12.5);
        assert_eq!(
            (&double.end, double.told()),
            (&Ok(()), None),
            "{coordinates}"
        );
    }
}

/// Only an event reads this phase, by its sine: 37,500 rad are known to 0.004, and when it happens to as much of the time of a radian.
#[test]
fn a_phase_that_only_an_event_reads_is_told_with_the_event() {
    let text = |guard: &str| {
        format!(
            "model Ticks {{ gravity: none;
                state phase = 0 rad {{ rate: 3000 rad/s }}
                event tick = {guard}; }}"
        )
    };
    let waves = text("sin(phase) rises 0.5");
    let single = Flown::<f32>::new(&waves, Options::rk4(1e-4), 12.5);
    let told = single.told().expect("a coarse phase");
    assert_eq!((told.state.as_str(), single.end), ("phase", Ok(())));
    assert!(told.affected.contains("`tick`"), "{told:?}");
    assert!((1e-3..1e-2).contains(&told.share), "{told:?}");
    // What waits for the phase itself is as exact as the phase; double precision has the digits of both.
    let waits = text("phase rises 37000 rad");
    let single = Flown::<f32>::new(&waits, Options::rk4(1e-4), 12.5);
    let (time, exact) = (single.run.events()[0].time, 37000.0 / 3000.0);
    assert!((time - exact).abs() < 3e-6, "{time}");
    assert_eq!(single.told(), None);
    let double = Flown::<f64>::new(&waves, Options::rk4(1e-4), 12.5);
    assert_eq!((&double.end, double.told()), (&Ok(()), None));
}

/// A bob that is shaken by the sine of a phase, and a whirling arm with its weight.
fn shaken(rate: f64) -> String {
    format!(
        "model Shaken {{ gravity: none;
            state phase = 0 rad {{ rate: {rate:?} rad/s }}
            point bob {{ mass: 1 kg }}
            load push on bob = [1 N * sin(phase), 0 N, 0 N]; }}"
    )
}

const WHIRLING: &str = "model Whirling { gravity: [0, 0, -9.81] m/s^2; coordinates: relative;
    body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame top at [0, 0, 0.5] m }
    joint pin: hinge from world to arm.top { axis: y, start_rate: 3000 rad/s } }";

#[test]
fn a_sine_that_moves_something_is_refused_where_its_phase_has_no_digits_left() {
    let refused = |end: Result<(), StepError>, name: &str, unit_turns: f64| {
        let Err(error @ StepError::LargeState { .. }) = end else {
            panic!("{name}: {end:?}");
        };
        let text = error.to_string();
        assert!(text.contains(&format!("`{name}`")), "{text}");
        let StepError::LargeState {
            value,
            apart,
            share,
            ..
        } = error
        else {
            unreachable!()
        };
        // One digit is left of a radian.
        assert!((0.05..0.5).contains(&apart), "{text}");
        assert!((0.1..0.3).contains(&share), "{text}");
        assert!(
            value * unit_turns > 0.05 && value * unit_turns < 0.5,
            "{text}"
        );
    };
    let single = f64::from(f32::EPSILON);
    let long = Flown::<f32>::new(&shaken(3000.0), Options::rk4(1e-4), 400.0);
    refused(long.end, "phase", single);
    let long = Flown::<f32>::new(WHIRLING, Options::rk4(1e-4), 400.0);
    refused(long.end, "pin.angle", single);
    for text in [shaken(3000.0).as_str(), WHIRLING] {
        let same = Flown::<f64>::new(text, Options::rk4(1e-4), 100.0);
        assert_eq!((same.end, same.run.coarse_state()), (Ok(()), None));
    }
    let turns = Flown::<f64>::new(&shaken(1e16), Options::rk4(1e-4), 1.0);
    refused(turns.end, "phase", f64::EPSILON);
}

/// It ended as a step that is too long, with the advice of a shorter one, which has as few digits.
#[test]
fn a_sine_whose_phase_begins_without_digits_is_refused_for_that_and_not_for_its_step() {
    let begins =
        |phase: f64| shaken(3000.0).replace("phase = 0 rad", &format!("phase = {phase:?} rad"));
    for options in [Options::rk4(1e-4), Options::rk4(1e-5)] {
        let flown = Flown::<f32>::new(&begins(7e5), options, 1.0);
        let Err(StepError::LargeState {
            state,
            value,
            apart,
            ..
        }) = flown.end
        else {
            panic!("{options:?}: {:?}", flown.end);
        };
        assert_eq!(state, "phase");
        assert!((value - 7e5).abs() < 3e3, "{value}");
        assert!(
            (apart - 7e5 * f64::from(f32::EPSILON)).abs() < 1e-3,
            "{apart}"
        );
        let double = Flown::<f64>::new(&begins(7e5), options, 1.0);
        assert_eq!((double.end, double.run.coarse_state()), (Ok(()), None));
    }
    // Adaptive steps of a coarse tolerance pass; then it is told, and how much of the force is rounding.
    let single = Flown::<f32>::new(&begins(7e5), Options::tsit5(1e-5), 1.0);
    let told = single.told().expect("a coarse phase");
    assert_eq!((told.state.as_str(), single.end), ("phase", Ok(())));
    assert!((0.03..0.1).contains(&told.share), "{told:?}");
    // Steps of which nothing is left: the phase stayed where it began, and the force was that of its start, without a word.
    for options in [
        Options::tsit5(1e-8),
        Options::vern7(1e-10),
        Options::rodas5p(1e-8),
    ] {
        let stays = Flown::<f64>::new(&begins(1e15), options, 0.1);
        assert!(
            matches!(&stays.end, Err(StepError::LargeState { state, .. }) if state == "phase"),
            "{options:?} {:?}",
            stays.end
        );
    }
    // What moves by few of its roundings has what its start had.
    let warm = "model Warm { gravity: none;
        state heat = 3e5 J { rate: (3.00001e5 J - heat) / (1 s) }
        point bob { mass: 1 kg }
        load push on bob = [1 N/J * (heat - 3e5 J), 0 N, 0 N]; }";
    let single = Flown::<f32>::new(warm, Options::tsit5(1e-4), 0.5);
    assert_eq!(single.told(), None);
    // Steps that are too long stay what they are, whatever begins far from zero beside them.
    let stiff = "model Stiff { gravity: none;
        state phase = 7e5 rad { rate: 3000 rad/s }
        point bob { mass: 1 kg, start at [1.1, 0, 0] m }
        spring rope from world to bob { free_length: 1 m, stiffness: 1e4 N/m } }";
    let flown = Flown::<f32>::new(stiff, Options::rk4(0.04), 1.0);
    assert!(
        matches!(flown.end, Err(StepError::UnstableStep { .. })),
        "{:?}",
        flown.end
    );
}

/// What the refusal says to do: the phase is set back by a turn at each.
#[test]
fn a_phase_that_is_set_back_keeps_its_digits() {
    let text = "model Shaken { gravity: none;
        state phase = 0 rad { rate: 300 rad/s }
        event turn = phase rises 360 deg { set: phase = phase - 360 deg }
        point bob { mass: 1 kg }
        load push on bob = [1 N * sin(phase), 0 N, 0 N];
        output wave = sin(phase); }";
    let until = 40.0;
    let mut flown = Flown::<f32>::new(text, Options::rk4(2e-4), until);
    assert_eq!((&flown.end, flown.told()), (&Ok(()), None));
    let [wave] = flown.outputs();
    let exact = (300.0 * until).sin();
    assert!((wave - exact).abs() < 2e-3, "{wave} {exact}");
}

/// What nobody reads a sine of may turn on, and what a stiff spring brings back feels its rounding and loses nothing by it.
#[test]
fn what_loses_nothing_by_its_rounding_is_not_refused() {
    // 2e6 rad.
    let long = Flown::<f32>::new(WHEEL, Options::rk4(1e-3), 600.0);
    assert_eq!(long.end, Ok(()));
    assert!(long.told().is_some_and(|told| told.share > 0.1));
    // A drum that turns against a torsion spring of 1e6 rad/s², 60 rad from where it began; a heat that settles at 1e5 within milliseconds.
    let drum = "model Drum { gravity: none; coordinates: relative;
        state aim = 0 rad { rate: (60 rad - aim) / (0.2 s) }
        state heat = 0 J { rate: (1e5 J - heat) / (2 ms) }
        body drum { mass: 1 kg, inertia: diag(0.01, 0.01, 0.01) kg*m^2 }
        joint axle: hinge from world to drum.com { axis: z, force: 1e4 N*m * (aim - axle.angle), damping: 10 N*m*s }
        output turned = axle.angle;
        output warm = heat; }";
    let mut held = Flown::<f32>::new(drum, Options::rk4(2e-4), 5.0);
    assert_eq!((&held.end, held.told()), (&Ok(()), None));
    let [turned, warm] = held.outputs();
    assert!((turned - 60.0).abs() < 1e-4, "{turned}");
    assert!((warm - 1e5).abs() < 0.1, "{warm}");
}

/// A point far away that moves at 1 m/s by steps of 1e-5 s: 1e10 m away positions are 1.9e-6 m apart, and of the four sums of a step, a sixth, a third, a third
/// and a sixth of it, each is rounded to one or two of them: 14 % too far. 2e10 m away it is three quarters of the way.
#[test]
fn steps_that_rounding_takes_in_double_precision_are_told_and_refused() {
    for (distance, share) in [(1e4_f64, 0.0), (3e9, 0.0463), (1e10, 0.144), (2e10, 0.237)] {
        let text = format!(
            "model Slow {{ gravity: none; point probe {{ mass: 1 kg, start at [{distance:?}, 0, 0] m velocity [1, 0, 0] m/s }} }}"
        );
        let flown = Flown::<f64>::new(&text, Options::rk4(1e-5), 1.0);
        let off = (flown.run.state()[0] - distance - flown.run.time()).abs();
        match flown.end {
            Ok(()) => {
                assert!((off - share).abs() < 2e-3, "{distance}: {off}");
                assert!(share < 0.1, "{distance}");
                let told = flown.told().map_or(0.0, |told| told.share);
                assert!((told - share).abs() < 5e-3, "{distance}: {told} {share}");
            }
            Err(StepError::LargeState { state, .. }) => {
                assert!(share > 0.1, "{distance}");
                assert_eq!(state, "probe.x");
            }
            Err(other) => panic!("{other}"),
        }
    }
    // Single precision keeps what rounding takes, whatever the step.
    let text = "model Slow { gravity: none; point probe { mass: 1 kg, start at [100, 0, 0] m velocity [1, 0, 0] m/s } }";
    for step in [1e-5, 1.7e-5, 1e-4] {
        let flown = Flown::<f32>::new(text, Options::rk4(step), 1.0);
        let off = f64::from(flown.run.state()[0]) - 101.0;
        assert!(off.abs() < 2e-5, "{step}: {off}");
        assert_eq!((flown.end, flown.run.coarse_state()), (Ok(()), None));
    }
    // The stiff method does not.
    let method = Method::Rodas5P {
        rtol: 1e-4,
        max_step: 1e-5,
    };
    let options = Options {
        method,
        ..Options::rk4(1.0)
    };
    let flown = Flown::<f32>::new(text, options, 1.0);
    let is_refused =
        matches!(flown.end, Err(StepError::LargeState { ref state, .. }) if state == "probe.x");
    assert!(is_refused, "{:?}", flown.end);
}

/// Rounding to either side takes nothing, and what a body loses while it is slower than its steps are told apart is no more than its digits: a point that began to
/// fall 100 m up, and a chain of seven after ten steps of 0.1 ms, were refused under Rodas5P.
#[test]
fn what_falls_from_rest_and_what_hangs_at_rest_is_not_refused_by_short_steps() {
    let short = |max_step| Options {
        method: Method::Rodas5P {
            rtol: 1e-4,
            max_step,
        },
        ..Options::rk4(1.0)
    };
    let falls = "model Falls { gravity: [0, 0, -9.81] m/s^2; point stone { mass: 1 kg, start at [3, 2, 100] m } }";
    let flown = Flown::<f32>::new(falls, short(1e-4), 1.0);
    assert_eq!((&flown.end, flown.told()), (&Ok(()), None));
    let off = f64::from(flown.run.state()[2]) - (100.0 - 0.5 * 9.81);
    assert!(off.abs() < 5e-4, "{off}");
    let hangs = "model Hangs { gravity: [0, 0, -9.81] m/s^2;
        point bob { mass: 1 kg, start at [0.1, 0.2, -2.00981] m }
        spring rope from world to bob { free_length: 2 m, stiffness: 1000 N/m, damping: 30 N*s/m } }";
    let held = Flown::<f32>::new(hangs, short(1e-3), 20.0);
    assert_eq!((&held.end, held.told()), (&Ok(()), None));
}
