//! A control loop of 1 kHz on an arm of seven hinges, of the size of a Franka Panda: simulated time over time on the clock, RK4 with steps of 1 ms.
//!
//! `cargo bench -p benches --bench control`. The time of an iteration is that of one simulated second: below 10 ms it is 100 times real time.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use mbd_runtime::{Options, Simulation, model};

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

/// Torques that hold the arm near upright.
fn torques(joints: &ArmCoordinates) -> ArmInputs {
    let mut torque = [-2.0 * joints.base_angle_rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for i in 0..3 {
        torque[2 * i + 1] = -150.0 * joints.bend_angle[i] - 15.0 * joints.bend_angle_rate[i];
        torque[2 * i + 2] = -2.0 * joints.roll_angle_rate[i];
    }
    ArmInputs { torque }
}

fn start() -> Simulation<f64> {
    let arm = Arm::new(ArmParams::default()).expect("defaults");
    let mut simulation = Simulation::new(&arm, Options::rk4(1e-3)).expect("options that fit");
    let bent = [
        ("bend[0].angle", 0.2),
        ("roll[0].angle", 0.4),
        ("bend[1].angle", -0.3),
    ];
    simulation.set_joints(&bent).expect("an open chain");
    simulation
}

fn loops(c: &mut Criterion) {
    let mut group = c.benchmark_group("one second at 1 kHz");
    let mut held = start();
    held.start().expect("a consistent start");
    let mut k: u32 = 0;
    group.bench_function("inputs set each millisecond", |b| {
        b.iter(|| {
            for _ in 0..1000 {
                k += 1;
                let torque = [(1e-3 * f64::from(k)).sin(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                held.set_inputs(black_box(&ArmInputs { torque }))
                    .expect("finite");
                held.run(1e-3 * f64::from(k)).expect("a stable step");
            }
        });
    });
    let mut inside = start();
    inside
        .control_every(1e-3, |sample, inputs: &mut ArmInputs| {
            *inputs = torques(&sample.coordinates());
        })
        .expect("its inputs");
    group.bench_function("a controller of joint coordinates", |b| {
        b.iter(|| {
            let until = inside.time() + 1.0;
            inside.run(until).expect("a stable step");
        });
    });
    group.finish();
}

criterion_group!(benches, loops);
criterion_main!(benches);
