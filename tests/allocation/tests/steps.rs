//! After construction and start a run allocates nothing, whatever it meets: nodes, slack lines, joints, events, changed parameters.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use mbd_runtime::{
    Batch, Case, Content, Generic, InLanes, Model, Options, Sampling, Simulation, model,
};
use models::parachute::scene::{
    ParachuteMass, ParachuteRate, ParachuteStatic, ParachuteStepwise, SceneInstant, TestCase,
};
use models::parachute::variant::state;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator, counting what each thread asks for.
struct Counting;

fn count() {
    // A thread that ends has no counter any more.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call is handed on to the system's allocator unchanged; counting does not allocate.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promise about `layout` is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: `at` came from `System` with this layout.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: `at` came from `System` with this layout.
        unsafe { System.realloc(at, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often the thread asked for memory meanwhile.
fn allocations(work: impl FnOnce()) -> u64 {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

model! {
    /// A driven crank, a rod on a damped joint with stops, a cord that slackens, an event.
    model Machine {
        units: si;
        gravity: [0, 0, -9.81];
        param cord_stiffness = 800 in 100 ..= 2000;
        world { frame eye at [1, 0, 1] }
        body crank {
            mass: 2,
            inertia: diag(0.1, 0.1, 0.02),
            frame pin at [0, 0, 0.3],
            frame tip at [0, 0, -0.3],
        }
        body rod {
            mass: 1,
            inertia: diag(0.05, 0.05, 0.01),
            frame top at [0, 0, 0.4],
            frame end at [0, 0, -0.4],
        }
        joint shoulder: hinge from world to crank.pin { axis: [0, 1, 0] };
        joint elbow: universal from crank.tip to rod.top;
        line cord from world.eye to rod.end {
            free_length: 1.9,
            stiffness: cord_stiffness,
            damping: 5,
        }
        event low = rod.end.position.z crosses -0.9;
        output pull = cord.tension;
    }
}

model! {
    /// An arm of seven links with a torque at each joint.
    model Arm {
        units: si;
        gravity: [0, 0, -9.81];
        emit: [derivative];
        input torque[i in 0..7]: torque;
        body link[i in 0..7] {
            mass: 3.5 - 0.4 * i,
            inertia: diag(0.03, 0.03, 0.01),
            frame root at [0, 0, -0.15],
            frame tip at [0, 0, 0.15],
        }
        joint base: hinge from world to link[0].root { axis: [0, 0, 1], force: torque[0] }
        joint bend[i in 0..3]: hinge from link[2 * i].tip to link[2 * i + 1].root {
            axis: [0, 1, 0],
            force: torque[2 * i + 1],
        }
        joint roll[i in 0..3]: hinge from link[2 * i + 1].tip to link[2 * i + 2].root {
            axis: [0, 0, 1],
            force: torque[2 * i + 2],
        }
    }
}

model! {
    /// A loop in relative coordinates: a hinge on a skew axis, a screw, a ball joint walked from its child, a bar that closes the loop, a cord.
    model Press {
        units: si;
        coordinates: relative;
        gravity: [0, 0, -9.81];
        world { frame stand at [1.2, 0, 0], frame eye at [0, 1, 1] }
        body lever {
            mass: 2,
            inertia: diag(0.1, 0.1, 0.02),
            frame pin at [0, 0, 0.3],
            frame tip at [0, 0, -0.3],
        }
        body nut {
            mass: 1,
            inertia: diag(0.05, 0.05, 0.01),
            frame hole at [0, 0, 0.1],
            frame ear at [0.2, 0, 0],
        }
        body rod {
            mass: 0.5,
            inertia: diag(0.02, 0.02, 0.002),
            frame top at [0, 0, 0.3],
            frame end at [0, 0, -0.3],
        }
        joint pin: hinge from world to lever.pin { axis: [0.6, 0.8, 0] };
        joint thread: screw from lever.tip to nut.hole { axis: [0, 0.6, 0.8], pitch: 0.1 };
        joint ball: spherical from rod.top to nut.ear;
        joint bar: distance from world.stand to rod.end { length: 1.4 };
        line cord from world.eye to rod.end { free_length: 1.6, stiffness: 500, damping: 5 }
    }
}

fn silent(name: &str, run: &mut Simulation<f64>, until: f64) {
    run.start()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let count = allocations(|| {
        run.run(until)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        for _ in 0..10 {
            run.step().unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    });
    assert!(run.statistics().steps > 10, "{name}");
    assert_eq!(
        count,
        0,
        "{name}: allocations in {} steps",
        run.statistics().steps
    );
}

#[test]
fn a_parachute_flies_without_asking_for_memory() {
    let from = SceneInstant::start(TestCase::Two);
    let fly = |name: &str, model: &dyn Model<f64>, options: Options| {
        let mut run = Simulation::new(model, options).expect("options that fit");
        run.set_state(0.0, &state(model, &from)).expect("a state");
        if model.layout().nz == 0 && !model.layout().nodes.is_empty() {
            run.set_nodes(&from.point).expect("one node");
        }
        // Slack for 0.7 s, then taut with a jerk.
        silent(name, &mut run, 1.5);
    };
    let mass = ParachuteMass::new(Default::default()).expect("defaults");
    fly("mass, rk4", &mass, Options::rk4(5e-5));
    fly("mass, rattle", &mass, Options::rattle(1e-4));
    fly("mass, tsit5", &mass, Options::tsit5(1e-6));
    fly("mass, vern7", &mass, Options::vern7(1e-6));
    fly("mass, rodas5p", &mass, Options::rodas5p(1e-6));
    fly("mass, auto", &mass, Options::auto(1e-6));
    let rate = ParachuteRate::new(Default::default()).expect("defaults");
    fly("rate, rk4", &rate, Options::rk4(5e-3));
    fly("rate, tsit5", &rate, Options::tsit5(1e-6));
    fly("rate, vern7", &rate, Options::vern7(1e-8));
    fly("rate, rodas5p", &rate, Options::rodas5p(1e-6));
    let fixed = ParachuteStatic::new(Default::default()).expect("defaults");
    fly("static, rk4", &fixed, Options::rk4(1e-3));
    fly("static, rattle", &fixed, Options::rattle(1e-3));
    fly("static, rodas5p", &fixed, Options::rodas5p(1e-5));
    let stepwise = ParachuteStepwise::new(Default::default()).expect("defaults");
    fly("stepwise, rk4", &stepwise, Options::rk4(5e-3));
}

#[test]
fn a_machine_runs_without_asking_for_memory() {
    let machine = Machine::new(MachineParams::default()).expect("defaults");
    let mut start = MachineState::at_origin();
    start.set_crank(mbd_runtime::BodyState::at([0.0, 0.0, -0.3]));
    start.set_rod(mbd_runtime::BodyState::at([0.0, 0.0, -1.0]));
    let mut start = start.to_vec();
    // The crank turns with 4 rad/s about its pin, the rod goes along.
    start[14] = -1.2;
    start[18] = 4.0;
    start[20] = -2.4;
    let generic = Generic::<f64>::with_defaults(machine.scene().clone()).expect("a scene");
    let both: [(&str, &dyn Model<f64>); 2] = [("generated", &machine), ("generic", &generic)];
    for (kind, model) in both {
        for (method, options) in [
            ("rk4", Options::rk4(1e-3)),
            ("rattle", Options::rattle(1e-3)),
            ("tsit5", Options::tsit5(1e-7)),
            ("vern7", Options::vern7(1e-9)),
            ("rodas5p", Options::rodas5p(1e-6)),
            ("auto", Options::auto(1e-9)),
        ] {
            let mut run = Simulation::new(model, options).expect("options that fit");
            run.set_state(0.0, &start).expect("a state");
            silent(&format!("{kind}, {method}"), &mut run, 1.0);
        }
    }
}

#[test]
fn a_loop_in_relative_coordinates_runs_without_asking_for_memory() {
    let press = Press::new(PressParams::default()).expect("defaults");
    let generic = Generic::<f64>::with_defaults(press.scene().clone()).expect("a scene");
    let both: [(&str, &dyn Model<f64>); 2] = [("generated", &press), ("generic", &generic)];
    for (kind, model) in both {
        for options in [
            Options::rk4(1e-3),
            Options::tsit5(1e-7),
            Options::rodas5p(1e-6),
        ] {
            let name = format!("{kind}, {:?}", options.method);
            let mut run = Simulation::new(model, options).expect("options that fit");
            silent(&name, &mut run, 0.5);
        }
    }
}

/// A control loop of 1 kHz, closed from outside and by controllers inside.
#[test]
fn an_arm_is_controlled_without_asking_for_memory() {
    let arm = Arm::new(ArmParams::default()).expect("defaults");
    for options in [Options::rk4(1e-3), Options::tsit5(1e-6)] {
        let make = || {
            let mut run = Simulation::new(&arm, options).expect("options that fit");
            run.set_joints(&[("bend[0].angle", 0.3)]).expect("a start");
            run
        };
        let mut held = make();
        held.start().expect("a consistent start");
        let count = allocations(|| {
            for k in 0..200 {
                let torque = std::array::from_fn(|i| 0.1 * (0.05 * f64::from(k)).sin() * i as f64);
                held.set_inputs(&ArmInputs { torque }).expect("finite");
                held.run(1e-3 * f64::from(k + 1)).expect("it moves");
            }
        });
        assert_eq!(count, 0, "held");
        let mut inside = make();
        inside
            .control(|sample, inputs: &mut ArmInputs| {
                inputs.torque[0] -= 0.1 * sample.coordinates().base_angle_rate;
            })
            .expect("its inputs");
        inside
            .control_every(1e-3, |sample, inputs: &mut ArmInputs| {
                let joints = sample.coordinates();
                for i in 0..3 {
                    inputs.torque[2 * i + 1] =
                        -20.0 * joints.bend_angle[i] - joints.bend_angle_rate[i];
                    inputs.torque[2 * i + 2] = -joints.roll_angle_rate[i];
                }
            })
            .expect("its inputs");
        inside.start().expect("a consistent start");
        inside.run(1e-3).expect("the first sample");
        let count = allocations(|| {
            inside.run(0.2).expect("it moves");
        });
        assert_eq!(count, 0, "inside");
    }
}

/// Cases of a batch ask for memory when they begin, not in their steps: runs of twice the length ask as often. Histories are used again.
#[test]
fn a_case_of_a_batch_asks_for_memory_as_often_however_long_it_is() {
    let arm = Arm::new(ArmParams::default()).expect("defaults");
    let per_case = |until: f64| {
        let counts = Batch::new(&arm, Options::rk4(1e-3), until)
            .cases((0..4).map(|_| Case::new().joint("bend[0].angle", 0.3)))
            .threads(1)
            .run(|_, history| (COUNT.with(Cell::get), history.len()));
        let counts: Vec<(u64, usize)> =
            counts.into_iter().filter_map(|it| it.result.ok()).collect();
        assert!(counts[3].1 as f64 > until / 1e-3);
        counts[3].0 - counts[2].0
    };
    assert_eq!(per_case(0.1), per_case(0.3));
}

/// The same of cases in lanes: what is asked for from the first that ends to the last does not depend on how long they are.
#[test]
fn cases_beside_each_other_ask_for_memory_as_often_however_long_they_are() {
    let from = SceneInstant::start(TestCase::Three);
    let parachute = ParachuteStepwise::new(Default::default()).expect("defaults");
    let start = state(&parachute, &from);
    let parachute = parachute.in_lanes();
    let between = |until: f64| {
        let case = |_| Case::new().state(0.0, start.clone()).nodes(from.point);
        let counts = Batch::new(&parachute, Options::rk4(0.02), until)
            .cases((0..24).map(case))
            .threads(1)
            .lanes(8)
            .record(Sampling::At(vec![until]), Content::RESULTS)
            .run(|_, _| COUNT.with(Cell::get));
        assert!(counts.iter().all(|it| 2 * it.beside > it.statistics.steps));
        let counts: Vec<u64> = counts.into_iter().filter_map(|it| it.result.ok()).collect();
        counts[23] - counts[0]
    };
    assert_eq!(between(10.0), between(20.0));
}
