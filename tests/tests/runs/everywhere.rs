//! Snapshots from everywhere: after every step, after a run is cancelled and after each kind of failure, written as text and read into another run, which
//! goes on to the same end to the bit.

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::{Happening, Model, Options, RunError, Simulation, Snapshot, StepError, Stop};

/// A scene, and the methods that run it.
struct Scene {
    text: &'static str,
    methods: fn() -> Vec<Options>,
    /// The failure that ends every run of it.
    fails: Option<&'static str>,
}

const EXPLICIT: fn() -> Vec<Options> = || {
    vec![
        Options::rk4(2e-3),
        Options::tsit5(1e-5),
        Options::vern7(1e-8),
    ]
};
const ALL: fn() -> Vec<Options> = || {
    let mut all = EXPLICIT();
    all.extend([
        Options::rodas5p(1e-4),
        Options::auto(1e-4),
        Options::rattle(2e-3),
    ]);
    all
};

/// A lamp on a cord from a knot between two lines: its name, the node, and what is said of the damping of the lines.
macro_rules! lamp {
    ($name:literal $node:literal $damping:literal) => {
        concat!(
            "model ", $name, " {
            gravity: [0, 0, -9.81] m/s^2;
            world { frame left at [-1 m, 0 m, 2 m], frame right at [1.5 m, 0.2 m, 2.2 m] }
            point lamp { mass: 1.5 kg, start at [0.4 m, 0.3 m, 0.8 m] velocity [0 m/s, 0 m/s, 3 m/s] }
            point knot { equilibrium: ", $node, " }
            line a from world.left to knot { free_length: 1.2 m, stiffness: 5 kN/m ", $damping, " }
            line b from world.right to knot { free_length: 1.6 m, stiffness: 5 kN/m ", $damping, " }
            line cord from knot to lamp { free_length: 0.5 m, stiffness: 5 kN/m ", $damping, " }
            load air on lamp = -0.05 kg/m * norm(lamp.velocity) * lamp.velocity;
        }"
        )
    };
}

const SCENES: [Scene; 12] = [
    // Lines that bounce, chains of events.
    Scene {
        text: "model Bounce {
            gravity: [0, 0, -9.81] m/s^2;
            param k = 800 N/m in 1 N/m ..= 1 MN/m;
            param pull = 0 N in -10 N ..= 10 N;
            state seen = 0 m { rate: (bob.position.z - seen) / (20 ms) }
            point bob { mass: 1 kg, start at [0.1 m, 0 m, -0.2 m] velocity [0.3 m/s, 0 m/s, 1 m/s] }
            point tail { mass: 0.5 kg, start at [0.2 m, 0 m, -0.6 m] }
            line rope from world to bob { free_length: 0.5 m, stiffness: k, damping: 3 N*s/m }
            line cord from bob to tail { free_length: 0.3 m, stiffness: 600 N/m }
            load wind on bob = [pull, 0 N, 0 N];
            event low = bob.position.z falls -0.5 m { set: k = 1.1 * k }
            event stiff = k rises 1 kN/m { set: pull = 2 N, acts: once }
            event pushed = pull rises 1 N { set: k = 700 N/m }
            event gone = time rises 0.9 s { detach: cord }
            event back = time rises 1.3 s { attach: cord }
        }",
        methods: || vec![Options::rk4(2e-3), Options::tsit5(1e-5), Options::vern7(1e-8), Options::rodas5p(1e-4), Options::auto(1e-4)],
        fails: None,
    },
    // A node that remembers steps.
    Scene {
        text: lamp!("Stepwise" "stepwise" ", damping: 50 N*s/m"),
        methods: || vec![Options::rk4(5e-3)],
        fails: None,
    },
    // A node with dampers.
    Scene {
        text: lamp!("Rate" "rate" ", damping: 50 N*s/m"),
        methods: || vec![Options::rk4(5e-4), Options::tsit5(1e-5), Options::vern7(1e-8)],
        fails: None,
    },
    // A node without.
    Scene {
        text: lamp!("Static" "static" ""),
        methods: ALL,
        fails: None,
    },
    // An origin that moves.
    Scene {
        text: "model Far {
            gravity: point_mass { mu: 400 m^3/s^2, center: [0, 0, -20] m };
            origin: follows a;
            point a { mass: 1 kg, start at [0 m, 0 m, 0 m] velocity [60 m/s, 0 m/s, 50 m/s] }
            point b { mass: 2 kg, start at [1.05 m, 0 m, 0 m] velocity [60 m/s, 1 m/s, 50 m/s] }
            line tie from a to b { free_length: 1 m, stiffness: 300 N/m, damping: 2 N*s/m }
            event high = a.position.z rises 20 m;
            event cut = time rises 1.1 s { detach: tie }
        }",
        methods: ALL,
        fails: None,
    },
    // Joints that lock, stops, friction.
    Scene {
        text: "model Rigid {
            gravity: [0, 0, -9.81] m/s^2;
            body one { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0, 0, 0.5] m, frame tip at [0, 0, -0.5] m }
            body two { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0, 0, 0.5] m }
            joint a: hinge from world to one.root { axis: y, start: 60 deg, damping: 0.2 N*m*s, stops: [-40, 80] deg, stop_stiffness: 200 N*m }
            joint b: hinge from one.tip to two.root { axis: y, friction: 0.1 N*m, friction_rate: 0.1 rad/s }
            event stuck = b.angle rises 0.3 rad { lock: b, acts: once }
            event loose = time rises 1.2 s { free: b }
        }",
        methods: || vec![Options::rk4(5e-3), Options::tsit5(1e-5), Options::vern7(1e-8), Options::rodas5p(1e-4), Options::auto(1e-4), Options::rattle(5e-3)],
        fails: None,
    },
    // A load that has no value.
    Scene {
        text: "model Root {
            gravity: none;
            point a { mass: 1 kg, start at [1 m, 0 m, 0 m] velocity [-1 m/s, 0 m/s, 0 m/s] }
            load f on a = [0 N, 1 N/m * sqrt((a.position.x - 0.5 m) * (1 m)), 0 N];
        }",
        methods: EXPLICIT,
        fails: Some("non_finite"),
    },
    // A rope that is used up.
    Scene {
        text: "model Winch {
            gravity: [0, 0, -9.81] m/s^2;
            state paid = 0.5 m { rate: -0.5 m/s }
            point a { mass: 1 kg, start at [0 m, 0 m, -0.5 m] }
            line rope from world to a { free_length: paid, stiffness: 1 kN/m, damping: 20 N*s/m }
        }",
        methods: EXPLICIT,
        fails: Some("negative_length"),
    },
    // A step that is too long.
    Scene {
        text: "model Stiff {
            gravity: [0, 0, -9.81] m/s^2;
            point a { mass: 1 kg, start at [0 m, 0 m, 1 m] }
            point b { mass: 1 kg, start at [0.3 m, 0 m, -0.5 m] }
            event far = a.position.z falls 0 m;
            line rope from world to a { free_length: 1.5 m, stiffness: 1 MN/m, damping: 10 N*s/m }
        }",
        methods: || vec![Options::rk4(1e-2)],
        fails: Some("unstable_step"),
    },
    // A motor that jumps.
    Scene {
        text: "model Jump {
            gravity: [0, 0, -9.81] m/s^2;
            body arm { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2, frame root at [0, 0, 0.5] m }
            joint pin: hinge from world to arm.root { axis: y, motor: if(time > 0.5 s, 1 rad, 0.2 rad) }
        }",
        methods: EXPLICIT,
        fails: Some("jump"),
    },
    // An action that cannot be.
    Scene {
        text: "model Act {
            gravity: [0, 0, -9.81] m/s^2;
            param m = 1 kg in 0.5 kg ..= 2 kg;
            param k = 10 N/m in 1 N/m ..= 20 N/m;
            point a { mass: m, start at [0 m, 0 m, 0.5 m] }
            spring s from world to a { free_length: 0.1 m, stiffness: k }
            event low = a.position.z falls 0.1 m { set: k = 3 * k }
        }",
        methods: ALL,
        fails: Some("action"),
    },
    // Events without end.
    Scene {
        text: "model Chatter {
            gravity: [0, 0, -9.81] m/s^2;
            param k = 10 N in -100 N ..= 100 N;
            point a { mass: 1 kg, start at [0 m, 0 m, 0.5 m] }
            load s on a = [k, 0 N, 0 N];
            event begin = time rises 0.3 s { set: k = -k }
            event up = k rises 0 N { set: k = -10 N }
            event down = k falls 0 N { set: k = 10 N }
        }",
        methods: EXPLICIT,
        fails: Some("event_limit"),
    },
];

const UNTIL: f64 = 1.5;

/// How a run ended: its kind of failure, its state, its time and everything it would go on with.
type End = (Result<Stop, &'static str>, Vec<u64>, Snapshot<f64>);

fn end(run: &mut Simulation<f64>) -> End {
    let stop = run.run(UNTIL).map_err(|error| error.cause.status());
    let bits = run.state().iter().map(|x| x.to_bits());
    (stop, bits.collect(), run.snapshot())
}

/// Whether two ends are the same. A step that is too long takes a run back to a state that it remembers now and then; one that goes on from a snapshot
/// remembers that. An event that could not act, or did so without end, is still due in both, at the same instant to 1e-12 s.
fn same(one: &End, other: &End) -> bool {
    let [at, other_at] = [one, other].map(|end| end.2.time());
    one == other
        || one.0 == other.0
            && match one.0 {
                Err("unstable_step") => true,
                Err("action" | "event_limit") => (at - other_at).abs() < 1e-12,
                _ => false,
            }
}

/// In what two ends differ.
fn difference((stop, bits, saved): &End, (other_stop, other_bits, other): &End) -> String {
    let value = |saved: &Snapshot<f64>| serde_json::to_value(saved).expect("numbers");
    let (one, other) = (value(saved), value(other));
    let keys = one.as_object().into_iter().flatten();
    let differing = keys.filter(|(key, value)| other.get(key.as_str()) != Some(value));
    let told: Vec<String> = differing
        .map(|(key, value)| format!("{key}: {value} and {}", other[key]))
        .collect();
    let states = if bits == other_bits {
        "the same"
    } else {
        "other"
    };
    format!(
        "{stop:?} and {other_stop:?}, {states} states; {}",
        told.join("; ")
    )
}

fn events(run: &Simulation<f64>, from: f64) -> Vec<(u64, Happening)> {
    let all = run.events().iter().filter(|event| event.time > from);
    all.map(|event| (event.time.to_bits(), event.what))
        .collect()
}

/// A run of its own that goes on from what was written of a snapshot.
fn read_again(
    model: &Interpreted<f64>,
    options: Options,
    of: &Simulation<f64>,
) -> Result<Simulation<f64>, RunError> {
    let saved = of.snapshot();
    let text = serde_json::to_string(&saved).expect("numbers");
    let read: Snapshot<f64> = serde_json::from_str(&text).expect("what was written");
    assert_eq!(read, saved);
    let mut run = Simulation::new(model, options)?;
    run.restore(&read)?;
    Ok(run)
}

#[test]
fn runs_of_lines_and_points_go_on_from_every_step_to_the_bit() {
    go_on_everywhere(&SCENES[..5]);
}

#[test]
fn runs_of_joints_go_on_from_every_step_to_the_bit() {
    go_on_everywhere(&SCENES[5..6]);
}

#[test]
fn runs_that_fail_go_on_from_every_step_before_to_the_bit_and_fail_again_after() {
    go_on_everywhere(&SCENES[6..]);
}

fn go_on_everywhere(scenes: &[Scene]) {
    let mut compared = 0;
    for Scene {
        text,
        methods,
        fails,
    } in scenes
    {
        let scene = read_text(text).scene.expect("a scene");
        let defaults: Vec<f64> = scene.params.iter().map(|param| param.default).collect();
        let model = Interpreted::<f64>::new(scene, &defaults).expect("defaults");
        for options in methods() {
            let name = format!("{} {options:?}", model.scene().name);
            let mut whole = Simulation::new(&model, options).expect("options that fit");
            let expected = end(&mut whole);
            let failure = expected.0.err();
            assert_eq!(failure, *fails, "{name}: {:?}", expected.0);
            // After steps, more of them where there are few.
            let mut walker = Simulation::new(&model, options).expect("options that fit");
            let every = 1 + whole.statistics().steps / 12;
            while walker.time() < expected.2.time() - 1e-9 && walker.step().is_ok() {
                if walker.time() < UNTIL && walker.statistics().steps.is_multiple_of(every) {
                    let mut other = read_again(&model, options, &walker).expect(&name);
                    let from = walker.time();
                    let found = end(&mut other);
                    assert!(
                        same(&found, &expected),
                        "{name} from {from} s: {}",
                        difference(&found, &expected)
                    );
                    assert_eq!(
                        events(&other, from),
                        events(&whole, from),
                        "{name} from {from} s"
                    );
                    compared += 1;
                }
            }
            // After a run was cancelled, which it may be between events of one instant.
            for calls in [0, 1, 2, 5, 13, 34, 89] {
                let mut cancelled = Simulation::new(&model, options).expect("options that fit");
                let mut left = calls;
                let stopped = cancelled.run_while(UNTIL, None, &mut |_| {
                    left -= 1;
                    left >= 0
                });
                if stopped.is_err_and(|error| error.cause == StepError::Cancelled) {
                    let mut other = read_again(&model, options, &cancelled).expect(&name);
                    let found = end(&mut other);
                    assert!(
                        same(&found, &expected),
                        "{name} cancelled at {calls}: {}",
                        difference(&found, &expected)
                    );
                    let found = end(&mut cancelled);
                    assert!(
                        same(&found, &expected),
                        "{name} cancelled at {calls}: {}",
                        difference(&found, &expected)
                    );
                    compared += 1;
                }
            }
            // After its failure it fails again, as one that goes on from its snapshot does.
            if fails.is_some() {
                let mut other = read_again(&model, options, &whole).expect(&name);
                let again = end(&mut whole);
                assert!(again.0.is_err(), "{name}: {:?}", again.0);
                let found = end(&mut other);
                assert!(
                    same(&found, &again),
                    "{name}: {}",
                    difference(&found, &again)
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 40, "{compared}");
}

/// A rope is wound in until nothing is left of it, then paid out again by 0.5 m/s: a refused step is none of the grid of fixed steps.
#[test]
fn after_a_failure_time_goes_on_with_the_state() {
    let text = "model Winch {
        gravity: [0, 0, -9.81] m/s^2;
        input speed: speed = -0.5 m/s;
        state paid = 0.5 m { rate: speed }
        point a { mass: 1 kg, start at [0 m, 0 m, -0.5 m] }
        line rope from world to a { free_length: paid, stiffness: 1 kN/m, damping: 20 N*s/m }
    }";
    let scene = read_text(text).scene.expect("a scene");
    let model = Interpreted::<f64>::new(scene, &[]).expect("no params");
    for options in [Options::rk4(2e-3), Options::tsit5(1e-5)] {
        let mut run = Simulation::new(&model, options).expect("options that fit");
        let error = run.run(1.5).expect_err("nothing is left");
        assert_eq!(error.cause.status(), "negative_length");
        let [from, left] = [run.time(), *run.state().last().expect("a state")];
        assert!(
            (left - (0.5 - 0.5 * from)).abs() < 1e-12,
            "{left} m at {from} s"
        );
        run.set_inputs(&[0.5]).expect("an input");
        run.run(1.5).expect("it is paid out");
        let paid = run.state().last().expect("a state");
        let exact = left + 0.5 * (1.5 - from);
        assert!(
            (paid - exact).abs() < 1e-12,
            "{paid} m instead of {exact} m, {options:?}"
        );
    }
}
