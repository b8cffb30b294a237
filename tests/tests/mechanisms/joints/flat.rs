//! Parallelograms through both of their flat positions in every scalar: on their branch, with their energy, never without a word.

use std::f64::consts::PI;

use mbd_compiler::Interpreted;
use mbd_runtime::{Collapse, External, Method, Options, Scalar, Simulation, StepError, model};
use mbd_scene::{AngularVelocity, Load, LoadKind, Place};
use tests::turning::{Kept, PLAIN, Parallelogram};

/// The same mechanism as each family of coordinates has it.
fn families(of: Parallelogram) -> [Parallelogram; 3] {
    [
        Parallelogram { planar: true, ..of },
        of,
        Parallelogram {
            components: AngularVelocity::World,
            ..of
        },
    ]
}

/// Its interpreted model, for any rate and start of it that no motor drives.
fn interpreted<T: Scalar>(of: Parallelogram) -> Interpreted<T> {
    let (scene, _) = of.build();
    Interpreted::new(scene, &[]).expect("a valid scene")
}

/// Runs its interpreted model.
fn turn<T: Scalar>(
    model: &Interpreted<T>,
    of: Parallelogram,
    options: Options,
    until: f64,
) -> Kept {
    let kept = of.turn(model, options, until);
    let kept = kept.unwrap_or_else(|error| panic!("{of:?}, {:?}: {error}", options.method));
    println!("{of:?}, {:?}: {kept:?}", options.method);
    kept
}

/// The integrators of single precision.
fn single() -> [Options; 3] {
    [Options::rk4(5e-3), Options::rk4(1e-3), Options::tsit5(1e-5)]
}

#[test]
fn in_single_precision_a_parallelogram_turns_through_its_flat_positions_on_its_branch() {
    for cranks in [2, 3] {
        for of in families(Parallelogram { cranks, ..PLAIN }) {
            let model = interpreted::<f32>(of);
            for options in single() {
                let kept = turn(&model, of, options, 4.5);
                // Rounding ε of the state leaves ε over the distance of the branches, at least √margin = 0.07: a few 1e-6 of the speeds,
                // ten times that of an angle on the way; energy has its square, and the rounding of thousands of steps.
                assert!(kept.energy < 5e-5, "{kept:?}");
                assert!(kept.angle < 5e-4 && kept.tilt < 5e-4, "{kept:?}");
            }
        }
    }
}

#[test]
fn in_single_precision_neither_size_nor_speed_nor_uneven_masses_take_it_off_its_branch() {
    for link in [0.1_f64, 2.0, 50.0] {
        for cranks in [2, 3] {
            // Fast enough to turn over under gravity, in steps of the same angle.
            let rate = 2.0 + 2.0 * (2.0 * 9.81 / link).sqrt();
            let of = Parallelogram {
                cranks,
                link,
                rate,
                gravity: 9.81,
                uneven: 0.5,
                ..PLAIN
            };
            for of in families(of) {
                let options = [Options::rk4(1e-2 / rate), Options::tsit5(1e-5)];
                let model = interpreted::<f32>(of);
                for options in options {
                    let kept = turn(&model, of, options, 9.0 / rate);
                    assert!(kept.energy < 1e-3 && kept.tilt < 5e-3, "{kept:?}");
                }
            }
        }
    }
}

#[test]
fn in_single_precision_a_motor_turns_the_crank_through_the_flat_positions() {
    for cranks in [2, 3] {
        let of = Parallelogram {
            cranks,
            motor: true,
            ..PLAIN
        };
        for of in families(of) {
            let model = interpreted::<f32>(of);
            for options in single() {
                let kept = turn(&model, of, options, 4.5);
                // What rounding leaves of the speeds on the other branch has a share in the energy: nothing else gives way to a motor.
                assert!(kept.energy < 1e-2 && kept.angle < 1e-5, "{kept:?}");
                assert!(kept.tilt < 5e-4, "{kept:?}");
            }
        }
    }
}

#[test]
fn adaptive_steps_of_any_tolerance_pass_sixty_flat_positions_in_double_precision() {
    for cranks in [2, 3] {
        for (planar, until) in [(true, 100.0), (false, 20.0)] {
            let of = Parallelogram {
                cranks,
                planar,
                ..PLAIN
            };
            let model = interpreted::<f64>(of);
            for (rtol, energy) in [(1e-6, 1e-3), (1e-9, 1e-6), (1e-12, 1e-9)] {
                let kept = turn(&model, of, Options::tsit5(rtol), until);
                assert!(kept.energy < energy && kept.tilt < 1e-6, "{kept:?}");
            }
        }
    }
}

/// In its plane.
const PLANAR: Parallelogram = Parallelogram {
    planar: true,
    ..PLAIN
};

/// Twenty that come to a flat position in steps of their own, and when they have passed it \[s\].
fn approaches(of: Parallelogram) -> impl Iterator<Item = (Parallelogram, f64)> {
    (0..20_u32).map(move |k| {
        let (rate, before) = (2.0 + 0.012 * f64::from(k), 0.02 + 0.0037 * f64::from(k));
        let start = PI - before;
        (Parallelogram { rate, start, ..of }, (before + 0.02) / rate)
    })
}

/// Steps that are short enough to end close to a flat position.
fn short(rtol: f64) -> Options {
    Options::of(Method::Tsit5 {
        rtol,
        max_step: 1e-3,
    })
}

#[test]
fn whatever_steps_come_to_a_flat_position_tight_tolerances_pass_it() {
    let three = Parallelogram {
        cranks: 3,
        ..PLANAR
    };
    let seventh = Options::of(Method::Vern7 {
        rtol: 1e-12,
        max_step: 1e-3,
    });
    for (of, options) in [
        (PLANAR, short(1e-12)),
        (PLANAR, short(1e-13)),
        (PLANAR, seventh),
        (three, short(1e-12)),
        (PLAIN, short(1e-12)),
    ] {
        let model = interpreted::<f64>(of);
        for (of, until) in approaches(of) {
            let kept = turn(&model, of, options, until);
            // Rounding ε of a state leaves ε over the angle of rows of it on the way between branches: 1e-13 where limits begin, some of it
            // in each of ten steps from there on, and its square in energy. Accelerations by rows that are closer than that leave
            // a hundred times as much of all three, or no step that passes.
            assert!(kept.energy < 1e-12, "{kept:?}");
            assert!(kept.angle < 1e-11 && kept.tilt < 1e-11, "{kept:?}");
        }
    }
}

#[test]
fn a_run_goes_on_from_a_snapshot_in_the_middle_of_a_flat_position_to_the_bit() {
    let mut snapshots = 0;
    let model = interpreted::<f64>(PLANAR);
    for (of, until) in approaches(PLANAR) {
        let (_, state) = of.build();
        let mut run = Simulation::new(&model, short(1e-12)).expect("options that fit");
        run.set_state(0.0, &state).expect("a valid state");
        run.start().expect("a start");
        let (mut middle, mut chosen) = (None, 0);
        while run.time() < until {
            run.step().expect("a step");
            let now = run.statistics().rows_chosen;
            if now > chosen {
                middle = Some(run.snapshot());
                snapshots += 1;
            }
            chosen = now;
        }
        if let Some(middle) = middle {
            let mut other = Simulation::new(&model, short(1e-12)).expect("options that fit");
            other.restore(&middle).expect("a snapshot of this model");
            while other.time() < until {
                other.step().expect("a step");
            }
            assert_eq!(run.state(), other.state());
        }
    }
    assert!(snapshots > 20, "limits are taken at {snapshots} steps");
}

#[test]
fn a_load_that_jumps_at_a_flat_position_still_collapses_the_step() {
    /// A torque on the first crank that throws it back from the flat position: no step resolves when it begins.
    struct Jumps;
    impl External<f64> for Jumps {
        fn evaluate(&self, _: f64, state: &[f64], out: &mut [f64]) {
            out.fill(0.0);
            if let (Some(angle), Some(torque)) = (state.get(2), out.last_mut()) {
                *torque = if *angle < PI { 0.0 } else { -1e9 };
            }
        }
    }
    let of = Parallelogram {
        start: PI - 0.15,
        ..PLANAR
    };
    let (mut scene, state) = of.build();
    scene.loads.push(Load {
        name: "shaft".into(),
        doc: String::new(),
        at: Place::Body(0, 0),
        kind: LoadKind::External,
    });
    let model = Interpreted::<f64>::new(scene, &[]).expect("a valid scene");
    let options = Options {
        locate: false,
        ..Options::tsit5(1e-9)
    };
    let mut run = Simulation::with_loads(&model, options, Jumps).expect("options that fit");
    run.set_state(0.0, &state).expect("a valid state");
    let error = run.run(0.15).expect_err("a jump");
    assert!(
        matches!(
            error.cause,
            StepError::StepCollapse {
                cause: Collapse::ErrorTest,
                ..
            }
        ),
        "{error}"
    );
    // Limits on the way there look as far ahead as a crossing of the mechanism times ε^(1/7).
    assert!((run.time() - 0.075).abs() < 6e-3, "{error}");
}

model! {
    /// Two cranks and a beam of 2 m.
    pub model Turning<T> {
        planar: xy;
        gravity: [0.0, -0.0, 0.0] m/s^2;
        world { frame p0 at [0, 0, 0] m, frame p1 at [2, 0, 0] m }
        body crank0 {
            mass: 1 kg,
            inertia: diag(0.3333333333333333, 0.3333333333333333, 0.3333333333333333) kg*m^2,
            frame root at [-1, 0, 0] m,
            frame tip at [1, 0, 0] m,
        }
        body crank1 {
            mass: 1 kg,
            inertia: diag(0.3333333333333333, 0.3333333333333333, 0.3333333333333333) kg*m^2,
            frame root at [-1, 0, 0] m,
            frame tip at [1, 0, 0] m,
        }
        body beam {
            mass: 1 kg,
            inertia: diag(0.3333333333333333, 0.3333333333333333, 0.3333333333333333) kg*m^2,
            frame p0 at [-1, 0, 0] m,
            frame p1 at [1, 0, 0] m,
        }
        joint root0: hinge from world.p0 to crank0.root { axis: z }
        joint tip0: hinge from crank0.tip to beam.p0 { axis: z }
        joint root1: hinge from world.p1 to crank1.root { axis: z }
        joint tip1: hinge from crank1.tip to beam.p1 { axis: z }
    }
}

#[test]
fn generated_code_turns_as_the_interpreter_does_in_single_precision() {
    let of = Parallelogram {
        planar: true,
        ..PLAIN
    };
    let model = Turning::<f32>::new(Default::default()).expect("no params");
    let by_terms = interpreted::<f32>(of);
    for options in single() {
        let kept = of.turn(&model, options, 2.0).expect("a run");
        let again = turn(&by_terms, of, options, 2.0);
        assert_eq!(
            [kept.energy, kept.angle, kept.tilt],
            [again.energy, again.angle, again.tilt]
        );
    }
}
