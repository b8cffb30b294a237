//! Absolute against relative coordinates of the same mechanisms, generated, in one run: state derivative, one step of Rk4 with projection where rows
//! are left.
//!
//! `cargo bench -p benches --bench relative`. Absolute times drift from day to day; read the ratios. Both are timed in turn, in many short
//! batches, and the median of each is printed.

#[path = "joints/timing.rs"]
mod timing;

use std::hint::black_box;

use mbd_runtime::{At, Model, Options, Quantity, Simulation, model};
use timing::{medians, microseconds};

/// Rods of 0.3 m and 1 kg, hinged one below the other about y, x, y, x, …, at 0.3 rad.
macro_rules! chain {
    ($name:ident $half:literal $family:ident) => {
        model! {
            /// A chain of rods.
            pub model $name {
                coordinates: $family;
                emit: [energy];
                gravity: [0.0, 0.0, -9.81] m/s^2;
                const HALF = $half;
                body even[i in 0..HALF] { mass: 1.0 kg, inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
                    frame top at [0.0, 0.0, 0.15] m, frame end at [0.0, 0.0, -0.15] m }
                body odd[i in 0..HALF] { mass: 1.0 kg, inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
                    frame top at [0.0, 0.0, 0.15] m, frame end at [0.0, 0.0, -0.15] m }
                joint hold: hinge from world to even[0].top { axis: y, start: 0.3 rad }
                joint pin_odd[i in 0..HALF]: hinge from even[i].end to odd[i].top { axis: x, start: 0.3 rad }
                joint pin_even[i in 1..HALF]: hinge from odd[i - 1].end to even[i].top { axis: y, start: 0.3 rad }
            }
        }
    };
}

/// Seven links, each with its centre of mass beside the axis, on hinges about z and y in turn.
macro_rules! arm {
    ($name:ident $family:ident) => {
        model! {
            /// An arm of seven joints.
            pub model $name {
                coordinates: $family;
                emit: [energy];
                gravity: [0.0, 0.0, -9.81] m/s^2;
                const N = 7;
                body link[i in 0..N] { mass: 3.0 kg, inertia: full { xx: 0.03, yy: 0.028, zz: 0.01, xy: 0.001, xz: -0.002, yz: 0.0015 } kg*m^2 (matrix elements),
                    frame root at [0.01, -0.02, -0.12] m, frame tip at [0.01, -0.02, 0.15] m }
                joint turn0: hinge from world to link[0].root { axis: z, start: 0.3 rad }
                joint bend[i in 0..3]: hinge from link[2 * i].tip to link[2 * i + 1].root { axis: y, start: 0.3 rad }
                joint turn[i in 1..4]: hinge from link[2 * i - 1].tip to link[2 * i].root { axis: z, start: 0.3 rad }
            }
        }
    };
}

/// Crank, coupler and rocker on hinges about y.
macro_rules! four_bar {
    ($name:ident $family:ident { $($setting:tt)* }) => {
        model! {
            /// A four-bar.
            pub model $name {
                coordinates: $family;
                emit: [energy];
                $($setting)*
                gravity: [0.0, 0.0, -9.81] m/s^2;
                world { frame pivot at [1.0, 0.0, 0.0] m }
                body crank { mass: 0.48 kg, inertia: diag(1e-5, 0.0036, 0.0036) kg*m^2, frame left at [-0.15, 0.0, 0.0] m, frame right at [0.15, 0.0, 0.0] m }
                body coupler { mass: 1.44 kg, inertia: diag(1e-5, 0.0972, 0.0972) kg*m^2, frame left at [-0.45, 0.0, 0.0] m, frame right at [0.45, 0.0, 0.0] m }
                body rocker { mass: 1.28 kg, inertia: diag(1e-5, 0.06827, 0.06827) kg*m^2, frame left at [-0.4, 0.0, 0.0] m, frame right at [0.4, 0.0, 0.0] m }
                joint crank_pin: hinge from world to crank.left { axis: y, start: -60 deg }
                joint coupler_pin: hinge from crank.right to coupler.left { axis: y }
                joint rocker_pin: hinge from coupler.right to rocker.right { axis: y }
                joint ground_pin: hinge from world.pivot to rocker.left { axis: y }
            }
        }
    };
}

chain!(Chain8 4 absolute);
chain!(RelativeChain8 4 relative);
chain!(Chain32 16 absolute);
chain!(RelativeChain32 16 relative);
chain!(Chain64 32 absolute);
chain!(RelativeChain64 32 relative);
arm!(Arm absolute);
arm!(RelativeArm relative);
four_bar!(SpatialBar absolute {});
four_bar!(RelativeSpatialBar relative {});
four_bar!(FlatBar absolute { planar: xz; });
four_bar!(RelativeFlatBar relative { planar: xz; });

/// Steps from a start, begun again every 200 steps.
fn stepping(model: &dyn Model<f64>) -> (Vec<f64>, impl FnMut()) {
    const STEPS: u64 = 200;
    let mut run = Simulation::new(model, Options::rk4(1e-3)).expect("fixed steps suit every model");
    run.start().expect("a start that closes");
    let (start, state) = (run.snapshot(), run.state().to_vec());
    let mut steps = 0;
    let step = move || {
        steps += 1;
        if steps % STEPS == 0 {
            run.restore(&start).expect("its own snapshot");
        }
        run.step().expect("a step");
    };
    (state, step)
}

fn derivative<'a>(model: &'a dyn Model<f64>, state: &'a [f64]) -> impl FnMut() + 'a {
    let (mut work, mut out) = (model.work(), vec![0.0; model.layout().nx()]);
    let at = At::of_state(0.0, state, &[]);
    move || {
        model.evaluate(
            Quantity::Derivative,
            black_box(&at),
            &mut work,
            black_box(&mut out),
        );
    }
}

fn compare(name: &str, [absolute, relative]: [&dyn Model<f64>; 2]) {
    let [(one, mut step_one), (other, mut step_other)] = [absolute, relative].map(stepping);
    let (mut first, mut second) = (derivative(absolute, &one), derivative(relative, &other));
    let derivatives = medians([&mut first, &mut second]);
    let steps = medians([&mut step_one, &mut step_other]);
    let cells = [derivatives, steps].map(|[a, b]| {
        format!(
            "{} µs | {} µs | {:.2}",
            microseconds(a),
            microseconds(b),
            b / a
        )
    });
    println!("| {name} | {} |", cells.join(" | "));
}

fn main() {
    println!(
        "| mechanism | state derivative, absolute | relative | ratio | RK4 step, absolute | relative | ratio |\n|---|---|---|---|---|---|---|"
    );
    macro_rules! row {
        ($name:literal $one:ident $other:ident) => {
            compare(
                $name,
                [
                    &$one::new(Default::default()).expect("defaults"),
                    &$other::new(Default::default()).expect("defaults"),
                ],
            );
        };
    }
    row!("chain of 8 hinges" Chain8 RelativeChain8);
    row!("chain of 32" Chain32 RelativeChain32);
    row!("chain of 64" Chain64 RelativeChain64);
    row!("arm of seven joints" Arm RelativeArm);
    row!("four-bar in space" SpatialBar RelativeSpatialBar);
    row!("four-bar, `planar: xz;`" FlatBar RelativeFlatBar);
}
