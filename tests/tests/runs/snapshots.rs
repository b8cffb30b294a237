//! Snapshots: written and read again, into other steps and controllers, changed by somebody, and of runs in which a closure of the caller panicked.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mbd_runtime::{
    Generic, Method, Model, Options, RunError, Scalar, Simulation, Snapshot, StepError, model,
};
use serde_json::{Value, json};
use tests::declared::read;

model! {
    /// A cart on a spring that carries a wheel; a knot between two lines, of which one lets go; latches.
    model Cart {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        input push: force = 0 N;
        param k = 5 N/m in 1 N/m ..= 100 N/m;
        state seen = 0 m { rate: (cart.position.x - seen) / (20 ms) }
        body cart {
            mass: 1 kg,
            inertia: diag(0.1, 0.1, 0.1) kg*m^2,
            frame eye at [0.1, 0.0, 0.0] m,
        }
        body wheel { mass: 1 kg, inertia: diag(0.1, 0.1, 0.1) kg*m^2 }
        point bob { mass: 0.3 kg, start at [0.4, 0.0, -0.5] m }
        point knot;
        line a from cart.eye to knot { free_length: 0.2 m, stiffness: 900 N/m }
        line b from knot to bob { free_length: 0.2 m, stiffness: 900 N/m }
        joint rail: prismatic from world to cart.com { axis: x, stiffness: k, start: 0.3 m }
        joint turn: hinge from cart.eye to wheel.com { axis: z, start_rate: 3 rad/s }
        load drive on cart = [push, 0.0, 0.0];
        event far = rail.slide falls 0.1 m { set: k = 1.5 * k, acts: once }
        event stuck = turn.angle rises 5 rad { lock: turn, acts: once }
        event gone = time rises 2 s { detach: b }
        event loose = time rises 3 s { free: turn }
    }
}

/// A run with a controller at samples and a function of time.
fn cart(options: Options, period: f64) -> Simulation<f64> {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, options).expect("options that fit");
    run.control_every(period, |sample, inputs: &mut CartInputs| {
        inputs.push = (7.0 * sample.time).sin();
    })
    .expect("a period");
    run.control(|now, inputs: &mut CartInputs| inputs.push += now.time.cos())
        .expect("inputs of this model");
    run
}

fn bits(run: &Simulation<f64>) -> Vec<u64> {
    run.state().iter().map(|x| x.to_bits()).collect()
}

fn refused(result: Result<(), RunError>) -> String {
    result.expect_err("it is refused").cause.to_string()
}

const METHODS: [fn() -> Options; 2] = [|| Options::rk4(2e-3), || Options::tsit5(1e-7)];

#[test]
fn a_snapshot_that_was_written_as_text_goes_on_to_the_bit() {
    for options in METHODS {
        // Before and after a parameter is set, an angle locked, a line detached, the angle freed; at samples and between them.
        for time in [0.0, 0.37, 1.02, 1.9, 2.0, 2.51, 3.2] {
            let mut whole = cart(options(), 0.05);
            whole.run(time).expect("it runs");
            let saved = whole.snapshot();
            let text = serde_json::to_string(&saved).expect("numbers");
            let read: Snapshot<f64> = serde_json::from_str(&text).expect("what was written");
            assert_eq!(read, saved, "{time}");
            let mut other = cart(options(), 0.05);
            other.run(2.7).expect("it runs");
            other.restore(&read).expect("of the same run");
            whole.run(4.0).expect("it runs");
            other.run(4.0).expect("it runs");
            assert_eq!(bits(&whole), bits(&other), "{time}");
        }
    }
}

#[test]
fn a_run_that_has_not_begun_goes_on_to_the_bit_by_every_method_compiled_and_not() {
    let compiled = Cart::new(CartParams::default()).expect("defaults");
    let generic = Generic::with_defaults(compiled.scene().clone()).expect("defaults");
    let models: [Arc<dyn Model<f64>>; 2] = [compiled.share(), generic.share()];
    let methods: [fn() -> Options; 5] = [
        || Options::rk4(2e-3),
        || Options::tsit5(1e-7),
        || Options::vern7(1e-8),
        || Options::rodas5p(1e-6),
        || Options::auto(1e-6),
    ];
    for model in &models {
        for options in methods {
            let new = || Simulation::new(&**model, options()).expect("options that fit");
            let mut whole = new();
            for [time, end] in [[0.7, 1.3], [1.6, 2.2], [2.6, 3.3]] {
                whole.run(time).expect("it runs");
                let mut other = new();
                other.restore(&whole.snapshot()).expect("of the same model");
                whole.run(end).expect("it runs");
                other.run(end).expect("it runs");
                assert_eq!(bits(&whole), bits(&other), "{:?} {time}", options().method);
            }
        }
    }
}

#[test]
fn what_happened_after_a_snapshot_has_not_happened_where_it_is_restored() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, Options::tsit5(1e-7)).expect("options that fit");
    run.run(1.0).expect("it runs");
    let (saved, before) = (run.snapshot(), [run.events().len(), run.actions().len()]);
    run.run(3.5).expect("it runs");
    let all = (run.events().to_vec(), run.actions().to_vec());
    assert!(all.0.len() > before[0] && all.1.len() > before[1]);
    run.restore(&saved).expect("of the same model");
    assert_eq!([run.events().len(), run.actions().len()], before);
    run.run(3.5).expect("it runs");
    assert_eq!((run.events().to_vec(), run.actions().to_vec()), all);
}

#[test]
fn a_run_that_begins_anew_has_its_own_events_and_actions() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, Options::tsit5(1e-7)).expect("options that fit");
    let start = run.state().to_vec();
    run.run(3.5).expect("it runs");
    let all = (run.events().to_vec(), run.actions().to_vec());
    assert!(!all.0.is_empty() && !all.1.is_empty());
    run.set_state(0.0, &start).expect("a state");
    assert!(run.events().is_empty() && run.actions().is_empty());
    run.run(3.5).expect("it runs");
    assert_eq!((run.events().to_vec(), run.actions().to_vec()), all);
    run.set_joints(&[("rail.slide", 0.3)])
        .expect("a coordinate");
    assert!(run.events().is_empty() && run.actions().is_empty());
}

#[test]
fn options_of_the_run_that_goes_on_are_its_own() {
    // Steps of another size follow the time of the snapshot, not its count.
    let mut coarse = cart(Options::rk4(2e-3), 0.05);
    for _ in 0..5 {
        coarse.step().expect("a step");
    }
    let mut fine = cart(Options::rk4(1e-3), 0.05);
    fine.restore(&coarse.snapshot()).expect("of the same model");
    fine.step().expect("a step");
    assert!((fine.time() - 0.011).abs() < 1e-15, "{}", fine.time());
    // The largest step is that of the options, too.
    let mut free = cart(Options::tsit5(1e-4), 0.5);
    free.run(0.3).expect("it runs");
    let short = Options {
        method: Method::Tsit5 {
            rtol: 1e-4,
            max_step: 1e-3,
        },
        ..Options::tsit5(1e-4)
    };
    let mut bound = cart(short, 0.5);
    bound.restore(&free.snapshot()).expect("of the same model");
    bound.step().expect("a step");
    assert!(bound.time() <= 0.301 + 1e-12, "{}", bound.time());
}

#[test]
fn params_of_the_run_that_goes_on_are_its_own_but_for_those_that_an_event_set() {
    let with = |k: f64| {
        let cart = Cart::new(CartParams { k }).expect("in range");
        Simulation::new(&cart, Options::tsit5(1e-8)).expect("options")
    };
    let mut first = with(5.0);
    first.start().expect("a start");
    let (early, passes) = (first.snapshot(), 1.5);
    first.run(passes).expect("it rolls back");
    assert_eq!(first.model().params(), [7.5], "the event has set it");
    let late = first.snapshot();
    // The spring that nothing has changed yet is that of the run that goes on; the event makes it half as stiff again.
    let mut harder = with(6.0);
    harder.restore(&early).expect("of the same model");
    assert_eq!(harder.model().params(), [6.0]);
    harder.run(passes).expect("it rolls back");
    assert_eq!(harder.model().params(), [9.0]);
    let mut after = with(6.0);
    after.restore(&late).expect("of the same model");
    assert_eq!(after.model().params(), [7.5]);
    // Back before the event it is its own again.
    after.restore(&early).expect("of the same model");
    assert_eq!(after.model().params(), [6.0]);
}

#[test]
fn a_snapshot_of_other_controllers_or_of_no_run_is_refused() {
    let mut whole = cart(Options::rk4(2e-3), 0.05);
    let fresh = whole.snapshot();
    whole.run(1.0).expect("it runs");
    let mut other = cart(Options::rk4(2e-3), 0.1);
    let text = refused(other.restore(&whole.snapshot()));
    assert!(text.contains("controllers with other periods"), "{text}");
    let text = refused(whole.restore(&fresh));
    assert!(text.contains("a run that had not started"), "{text}");
    // Both are as they were.
    other.run(1.0).expect("it runs");
    whole.run(1.1).expect("it runs");
}

#[test]
fn numbers_that_no_run_had_are_refused_or_harmless() {
    for options in METHODS {
        let mut whole = cart(options(), 0.05);
        whole.run(1.02).expect("it runs");
        let saved = serde_json::to_value(whole.snapshot()).expect("numbers");
        let is_fixed = saved["control"].is_null();
        let changed = |at: &str, to: Value| -> Snapshot<f64> {
            let mut changed = saved.clone();
            *changed.pointer_mut(at).expect(at) = to;
            serde_json::from_value(changed).expect("still a snapshot")
        };
        let mut cases = vec![
            ("/state/0", json!(1e300), "`cart.x` cannot be 1e300"),
            ("/time", json!(1e300), "`time"),
            ("/samples/0/1", json!(u64::MAX), "has been changed"),
            ("/samples/0/0", json!(1e300), "has been changed"),
            (
                "/rearmed",
                json!([{"time": null, "rounding": 0.0, "value": 0.0}]),
                "another model",
            ),
            ("/watch_weights", json!([1.0]), "has been changed"),
        ];
        if !is_fixed {
            cases.push(("/control/step", json!(-1.0), "has been changed"));
            cases.push(("/control/previous", json!(0.0), "has been changed"));
        }
        for (at, to, words) in cases {
            let mut run = cart(options(), 0.05);
            let text = refused(run.restore(&changed(at, to)));
            assert!(text.contains(words), "{at}: {text}");
            run.run(0.1).expect("it is as it was");
        }
        // Counters.
        let mut counters = vec!["/watch/over", "/watch/seen", "/count"];
        if !is_fixed {
            counters = vec![
                "/stiffness/easy",
                "/control/failures",
                "/control/rejections",
            ];
        }
        for at in counters {
            let most = if is_fixed {
                json!(u64::MAX)
            } else {
                json!(u32::MAX)
            };
            let mut run = cart(options(), 0.05);
            run.restore(&changed(at, most)).expect("numbers");
            run.run(1.5).expect(at);
        }
    }
}

/// The run of [`cart`] with closures of which one panics at a call from 0.45 s on.
fn fragile(options: Options, panics: &'static str, after: usize) -> Simulation<f64> {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, options).expect("options that fit");
    let mut left = after;
    run.control_every(0.05, move |sample, inputs: &mut CartInputs| {
        inputs.push = (7.0 * sample.time).sin();
        if panics == "controller" && sample.time > 0.45 {
            assert!(left > 0, "a controller that gives up");
            left -= 1;
        }
    })
    .expect("a period");
    let left = AtomicUsize::new(after);
    run.control(move |now, inputs: &mut CartInputs| {
        inputs.push += now.time.cos();
        if panics == "function" && now.time > 0.45 {
            let left = left.fetch_sub(1, Ordering::Relaxed);
            assert!(left > 0, "a function that gives up");
        }
    })
    .expect("inputs of this model");
    run
}

#[test]
fn a_run_in_which_a_closure_panicked_does_not_go_on_but_its_snapshots_do() {
    for options in METHODS {
        let mut whole = cart(options(), 0.05);
        whole.run(1.5).expect("it runs");
        for panics in ["controller", "function", "watch"] {
            for after in [0, 1, 3, 8] {
                let mut run = fragile(options(), panics, after);
                run.run(0.4).expect("it runs");
                let before = run.snapshot();
                let panicked = catch_unwind(AssertUnwindSafe(|| {
                    run.run_while(1.5, None, &mut |time| {
                        assert!(panics != "watch" || time < 0.5, "a watch that gives up");
                        true
                    })
                }));
                assert!(panicked.is_err(), "{panics}");
                // Whatever was under way: nothing goes on from there, and what it says is finite.
                assert!(run.state().iter().all(|x| x.is_finite()));
                let words = "a closure of the caller panicked";
                for error in [
                    run.run(1.5).map(|_| ()),
                    run.step(),
                    run.start(),
                    run.restore(&before),
                ] {
                    let error = error.expect_err("it is interrupted");
                    assert_eq!(error.cause, StepError::Interrupted, "{error}");
                    assert!(error.to_string().contains(words), "{error}");
                }
                let mut other = cart(options(), 0.05);
                assert!(refused(other.restore(&run.snapshot())).contains(words));
                other.restore(&before).expect("of the same model");
                other.run(1.5).expect("it runs");
                assert_eq!(bits(&other), bits(&whole), "{panics}");
            }
        }
    }
}

#[test]
fn a_run_that_has_got_a_controller_goes_back_from_steps_that_are_too_long() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    let mut run = Simulation::new(&cart, Options::rk4(2e-3)).expect("options that fit");
    run.run(0.01).expect("it runs");
    // Feedback that grows by itself: the step is too long for it.
    run.control_every(0.02, |sample, inputs: &mut CartInputs| {
        inputs.push = -4e4 * sample.coordinates().rail_slide;
    })
    .expect("a period");
    run.control(|now, inputs: &mut CartInputs| {
        inputs.push -= 5e3 * now.coordinates().rail_slide_rate;
    })
    .expect("inputs of this model");
    let error = run.run(1.0).expect_err("too long a step");
    assert!(
        matches!(error.cause, StepError::UnstableStep { .. }),
        "{error}"
    );
}

/// The state of a run, and what it tells of itself and of what happened since a time [s].
fn told(run: &Simulation<f64>, since: f64) -> (Vec<u64>, String) {
    let happened = run.events().iter().filter(|event| event.time > since);
    let told = [
        format!("{:?}", run.imbalance()),
        format!("{:e}", run.rounding()),
        format!("{:?}", happened.collect::<Vec<_>>()),
    ];
    (bits(run), told.join("; "))
}

#[test]
fn a_run_that_went_beyond_goes_back_to_the_bit() {
    // Lines that come taut at a node on dampers: what switches at an instant may do so without a step.
    let capsule = read(
        "model Capsule {
           gravity: [0, 0, -9.81] m/s^2;
           body capsule {
             mass: 100 kg, inertia: full { xx: 20, yy: 30, zz: 25, xy: 2 } kg*m^2 (matrix elements),
             frame lug[i in 0..3] at polar(0.6 m, i * 120 deg, 0.5 m),
             start at [0, 0, 30] m velocity [3, 0, 0] m/s angular_velocity [0.1, 0.2, 0.3] rad/s
           }
           body chute {
             mass: 8 kg, inertia: diag(60, 60, 30) kg*m^2, frame end at [0, 0, -8] m,
             start at [0, 0, 43.5] m
           }
           point knot { equilibrium: rate }
           joint flies: free from world to capsule.com
           joint hangs: free from world to chute.com
           line riser from chute.end to knot { free_length: 3 m, stiffness: 20 kN/m, damping: 200 N*s/m }
           line leg[i in 0..3] from capsule.lug[i] to knot
             { free_length: 2 m, stiffness: 20 kN/m, damping: 100 N*s/m }
           load drag on chute = -3 kg/m * norm(chute.velocity) * chute.velocity;
         }",
    );
    let model = Generic::<f64>::with_defaults(capsule).expect("defaults");
    for options in [|| Options::tsit5(1e-6), || Options::rk4(5e-3)] {
        for time in [0.0, 0.52, 0.9] {
            let new = || Simulation::new(&model, options()).expect("options that fit");
            let mut whole = new();
            whole.start().expect("a start");
            whole.run(time).expect("it runs");
            let saved = whole.snapshot();
            whole.run(2.0).expect("it runs");
            let all = told(&whole, time);
            // Where it comes to the same instants again, in the same run and in one that has been elsewhere.
            whole.restore(&saved).expect("of the same run");
            whole.run(2.0).expect("it runs");
            assert_eq!(told(&whole, time), all, "{time}");
            let mut other = new();
            other.run(1.3).expect("it runs");
            other.restore(&saved).expect("of the same model");
            other.run(2.0).expect("it runs");
            assert_eq!(told(&other, time), all, "{time}");
        }
    }
}

#[test]
fn what_happened_many_times_after_a_snapshot_is_no_chatter_before_it() {
    let clock = read(
        "model Clock {
           gravity: none;
           state next = 20 ms { rate: 0 }
           state ticks = 0 { rate: 0 }
           event tick = time rises next { set: [next = next + 20 ms, ticks = ticks + 1] }
         }",
    );
    let model = Generic::<f64>::with_defaults(clock).expect("defaults");
    for options in METHODS {
        let mut run = Simulation::new(&model, options()).expect("options that fit");
        run.run(0.51).expect("it runs");
        let saved = run.snapshot();
        run.run(6.01).expect("it runs");
        run.restore(&saved).expect("of the same run");
        run.run(6.01).expect("a clock does not chatter");
        assert_eq!(run.state()[1], 300.0);
        assert_eq!(run.events().len(), 300);
    }
}

/// Where a run stands on an event, at its value to the last digit, its first stage is that behind what jumps there: one that went on from a snapshot began with that
/// before it, and came to its next events at other times, from the same state.
#[test]
fn a_snapshot_on_the_event_that_stopped_a_run_goes_on_behind_it() {
    let scene = tests::declared::read(
        "model Ball { gravity: [0, 0, -9.81] m/s^2;
           point ball { mass: 1 kg, start at [0, 0, 1.3] m velocity [0.5, 0, 0] m/s }
           load wind on ball = [if(ball.velocity.z < -1 m/s, 1 N, 0.3 N), 0 N, 0 N];
           event fast = ball.velocity.z falls -1 m/s { then: stop }
           event far = ball.position.x rises 0.8 m { then: stop } }",
    );
    let model = Generic::<f32>::with_defaults(scene).expect("defaults");
    for options in [
        Options::vern7(1e-5),
        Options::tsit5(1e-5),
        Options::rodas5p(1e-5),
        Options::rk4(1e-2),
    ] {
        let new = || Simulation::<f32>::new(&model, options).expect("options");
        let mut whole = new();
        whole.run(2.0).expect("the first stop");
        let mut other = new();
        other.restore(&whole.snapshot()).expect("of the same model");
        assert_eq!(whole.state(), other.state());
        for run in [&mut whole, &mut other] {
            run.run(2.0).expect("the second stop");
        }
        assert_eq!(
            whole.time().to_bits(),
            other.time().to_bits(),
            "{options:?}"
        );
        assert_eq!(whole.state(), other.state(), "{options:?}");
    }
}

/// How a run ends that went on from a snapshot at a time, beside the one that went on itself; both until the same time.
fn both_ways<T: Scalar>(
    model: &Generic<T>,
    options: Options,
    [time, end]: [f64; 2],
) -> [Vec<u64>; 2] {
    let new = || Simulation::<T>::new(model, options).expect("options");
    let mut whole = new();
    whole.run(time).expect("it runs");
    let mut other = new();
    other.restore(&whole.snapshot()).expect("of the same model");
    [whole, other].map(|mut run| {
        run.run(end).expect("it runs");
        let state = run.state().iter().map(|x| x.to_f64().to_bits());
        state.chain([run.time().to_bits()]).collect()
    })
}

/// At a time at which something jumps, and with an event close behind, the first stage of a step is on a side that neither time nor state tells: a run that went on
/// from a snapshot there took the other one.
#[test]
fn a_snapshot_where_something_jumps_with_time_goes_on_on_its_side() {
    let scene = read(
        "model Pushed { gravity: [0, 0, -9.81] m/s^2;
           table pull = { 0 s: 0 N, 0.3 s: 2 N, 0.45 s: -1 N };
           point free { mass: 1 kg }
           point tied { mass: 1 kg, start at [0.1, 0, 0] m }
           body rod { mass: 1 kg, inertia: diag(0.1, 0.1, 0.02) kg*m^2, frame top at [0, 0, 0.5] m }
           joint pin: hinge from world to rod.top { axis: y, start: 50 deg, force: if(time > 0.4 s, 3 N*m, -2 N*m) }
           load push on free = [if(time < 0.7 s, 1 N, -2 N), 0 N, pull(time)];
           load spring on tied = [if(time <= 0.35 s, 1 N, 3 N) - 40 N/m * tied.position.x, 0 N, 0 N];
           event near = time rises 0.4000003 s;
           event lowest = pin.angle falls 0 deg { lock: pin, acts: once }
           event go = time rises 0.75 s { free: pin } }",
    );
    let jumps = [0.3, 0.35, 0.4, 0.45, 0.7, 0.75];
    let pauses = |at: f64| {
        [
            at,
            at.next_up(),
            at.next_down(),
            at + 3e-10,
            at - 3e-10,
            at + 0.01,
        ]
    };
    let double = Generic::<f64>::with_defaults(scene.clone()).expect("defaults");
    let single = Generic::<f32>::with_defaults(scene).expect("defaults");
    for method in [
        Options::tsit5,
        Options::vern7,
        Options::rodas5p,
        Options::auto,
    ] {
        for time in jumps.into_iter().flat_map(pauses) {
            let [whole, other] = both_ways(&double, method(1e-6), [time, 1.0]);
            assert_eq!(whole, other, "{:?} {time:?}", method(1e-6).method);
            let [whole, other] = both_ways(&single, method(1e-4), [time, 1.0]);
            assert_eq!(whole, other, "{:?} {time:?} in f32", method(1e-4).method);
        }
    }
    for time in jumps.into_iter().flat_map(pauses) {
        let [whole, other] = both_ways(&double, Options::rk4(4e-3), [time, 1.0]);
        assert_eq!(whole, other, "RK4 {time:?}");
        let [whole, other] = both_ways(&single, Options::rk4(4e-3), [time, 1.0]);
        assert_eq!(whole, other, "RK4 {time:?} in f32");
    }
}

/// What is held may change between two calls: the next step then begins anew, from rates of before, also where a snapshot lies between.
#[test]
fn inputs_that_change_right_before_a_snapshot_jump_behind_it() {
    let cart = Cart::new(CartParams::default()).expect("defaults");
    for options in METHODS {
        let new = || Simulation::new(&cart, options()).expect("options that fit");
        let mut whole = new();
        whole.run(0.7).expect("it runs");
        whole.set_inputs(&[80.0]).expect("a force");
        let mut other = new();
        other.restore(&whole.snapshot()).expect("of the same model");
        whole.run(1.3).expect("it runs");
        other.run(1.3).expect("it runs");
        assert_eq!(told(&whole, 0.7), told(&other, 0.7));
        assert_eq!(
            whole.statistics().rejected,
            other.statistics().rejected + rejected(new())
        );
    }
}

/// How many steps are rejected until 0.7 s.
fn rejected(mut run: Simulation<f64>) -> u64 {
    run.run(0.7).expect("it runs");
    run.statistics().rejected
}

/// Functions of time and state that give the same in both calls let nothing jump: the balance of energy goes on as it was.
#[test]
fn functions_that_give_the_same_behind_a_snapshot_let_nothing_jump() {
    for options in METHODS {
        let mut whole = cart(options(), 0.05);
        whole.run(1.02).expect("it runs");
        let mut other = cart(options(), 0.05);
        other.restore(&whole.snapshot()).expect("of the same run");
        whole.run(1.9).expect("it runs");
        other.run(1.9).expect("it runs");
        assert_eq!(told(&whole, 1.02), told(&other, 1.02));
    }
}
