//! Generated against generic against a dense Cholesky solver, in one run, on mechanisms: state derivative, one step of Rk4 with projection.
//!
//! `cargo bench -p models --bench joints`. Absolute times drift from day to day; read the ratios. The three are timed in turn, in many
//! short batches, and the median of each is printed.
//!
//! - generated: the code that `model!` emits.
//! - generic: the laws on numbers, the same elimination, nothing allocated.
//! - dense: rows, masses and forces of the generic solver; S = Φ_v M⁻¹ Φ_vᵀ built block by block where two joints share a body, one
//!   preallocated dense Cholesky of S. Without q̇, which it would have to add.

mod dense;
mod timing;

use std::hint::black_box;

use dense::Dense;
use mbd_compiler::Equations;
use mbd_runtime::{At, Generic, Model, Options, Quantity, Simulation, model};
use timing::{medians, microseconds};

/// Rods of 1 m, hinged one below the other about y, x, y, x, …
macro_rules! chain {
    ($name:ident $half:literal { $($end:tt)* }) => {
        model! {
            /// A chain of rods.
            pub model $name {
                emit: [mass_matrix, bias_force, forces];
                gravity: [0.0, 0.0, -9.81] m/s^2;
                const HALF = $half;
                body even[i in 0..HALF] {
                    mass: 1.0 kg,
                    inertia: diag(0.085, 0.085, 0.001) kg*m^2,
                    frame top at [0.0, 0.0, 0.5] m,
                    frame end at [0.0, 0.0, -0.5] m,
                }
                body odd[i in 0..HALF] {
                    mass: 1.0 kg,
                    inertia: diag(0.085, 0.085, 0.001) kg*m^2,
                    frame top at [0.0, 0.0, 0.5] m,
                    frame end at [0.0, 0.0, -0.5] m,
                }
                joint hold: hinge from world to even[0].top { axis: y }
                joint pin_odd[i in 0..HALF]: hinge from even[i].end to odd[i].top { axis: x }
                joint pin_even[i in 1..HALF]: hinge from odd[i - 1].end to even[i].top { axis: y }
                $($end)*
            }
        }
    };
}

chain!(Chain4 2 {});
chain!(Chain8 4 {});
chain!(Chain16 8 {});
chain!(Chain32 16 {});
chain!(Chain64 32 {});
chain!(Ring8 4 {
    world { frame far at [0.0, 0.0, -7.0] m }
    joint close: spherical from odd[3].end to world.far;
});

model! {
    /// A free hub with eleven arms.
    pub model Hub11 {
        emit: [mass_matrix, bias_force, forces];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body centre {
            mass: 5.0 kg,
            inertia: diag(1.0, 1.0, 1.0) kg*m^2,
            frame rim[i in 0..11] at polar(1 m, i * 360 deg / 11, 0 m),
        }
        body arm[i in 0..11] {
            mass: 1.0 kg,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint centre_free: free from world to centre.com;
        joint pin[i in 0..11]: hinge from centre.rim[i] to arm[i].top { axis: y }
    }
}

model! {
    /// A binary tree of fifteen rods.
    pub model Tree15 {
        emit: [mass_matrix, bias_force, forces];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        body root {
            mass: 1.0 kg,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame end at [0.0, 0.0, -0.5] m,
        }
        body limb[i in 0..2] {
            mass: 1.0 kg,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame end at [0.0, 0.0, -0.5] m,
        }
        body branch[i in 0..4] {
            mass: 1.0 kg,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
            frame end at [0.0, 0.0, -0.5] m,
        }
        body twig[i in 0..8] {
            mass: 1.0 kg,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0.0, 0.0, 0.5] m,
        }
        joint hold: hinge from world to root.top { axis: y }
        joint fork[i in 0..2]: hinge from root.end to limb[i].top { axis: x }
        joint left[i in 0..2]: hinge from limb[i].end to branch[2 * i].top { axis: y }
        joint right[i in 0..2]: hinge from limb[i].end to branch[2 * i + 1].top { axis: y }
        joint near[i in 0..4]: hinge from branch[i].end to twig[2 * i].top { axis: x }
        joint far[i in 0..4]: hinge from branch[i].end to twig[2 * i + 1].top { axis: x }
    }
}

/// A body's centre of mass and its turn about y.
type Place = ([f64; 3], f64);

/// Rod `n` of a chain that zigzags: two rods leaning by `lean`, two by −`lean`, …
fn zigzag(n: usize, lean: f64) -> Place {
    let side = |rod: usize| if rod % 4 < 2 { lean } else { -lean };
    let mut end = [0.0, 0.0, 0.0];
    for rod in 0..n {
        end[0] -= side(rod).sin();
        end[2] -= side(rod).cos();
    }
    let angle = side(n);
    let centre = [end[0] - 0.5 * angle.sin(), 0.0, end[2] - 0.5 * angle.cos()];
    (centre, angle)
}

/// A state with every body in its place; speeds of all kinds, which the start takes to the joints.
fn state<M: Model<f64>>(model: &M, place: impl Fn(usize) -> Place) -> Vec<f64> {
    let layout = model.layout();
    let mut state = vec![0.0; layout.nx()];
    for (body, slots) in layout.bodies.iter().enumerate() {
        let (centre, angle) = place(body);
        state[slots.q..slots.q + 3].copy_from_slice(&centre);
        state[slots.q + 3] = (0.5 * angle).cos();
        state[slots.q + 5] = (0.5 * angle).sin();
    }
    for (index, speed) in state.iter_mut().skip(layout.nq).enumerate() {
        *speed = 0.3 * (1.7 * index as f64).sin();
    }
    state
}

fn begun<'m, M: Model<f64>>(model: &'m M, state: &[f64]) -> Simulation<'m, f64, M> {
    let mut run = Simulation::new(model, Options::rk4(1e-3)).expect("fixed steps");
    run.set_state(0.0, state).expect("a state of the scene");
    run.start().expect("a consistent start");
    run
}

/// Times one mechanism and prints its line of the table.
fn compare<M: Model<f64>>(name: &str, generated: &M, place: impl Fn(usize) -> Place) {
    let scene = generated.scene().clone();
    let equations = Equations::trace_only(&scene, &[Quantity::Derivative]);
    let operations = equations
        .program(Quantity::Derivative)
        .map_or(0, |program| program.cost().total());
    let generic = Generic::with_defaults(scene).expect("defaults");
    let mut runs = (
        begun(generated, &state(generated, &place)),
        begun(&generic, &state(generated, &place)),
    );
    let start = (runs.0.snapshot(), runs.1.snapshot());
    let at_start = runs.0.state().to_vec();
    let at = At {
        time: 0.0,
        state: &at_start,
        nodes: &[],
        effective: &[],
        hold: &[],
        ends: &[],
        inputs: &[],
        rows: &[],
    };
    let mut dense = Dense::new(&generic, &at);
    let (mut ours, mut laws) = (vec![0.0; at_start.len()], vec![0.0; at_start.len()]);
    let mut work = (generated.work(), generic.work(), generic.work());
    let derivative = Quantity::Derivative;
    generated.evaluate(derivative, &at, &mut work.0, &mut ours);
    generic.evaluate(derivative, &at, &mut work.1, &mut laws);
    let accelerations = dense.accelerations(&generic, &at, &mut work.2);
    let nq = generated.layout().nq;
    let all = accelerations.iter().zip(&ours[nq..]).zip(&laws[nq..]);
    let worst = all.fold(0.0f64, |most, ((a, b), c)| {
        most.max((a - b).abs()).max((a - c).abs())
    });
    assert!(worst < 1e-8, "{name}: the three differ by {worst:e}");

    let [a, b, c] = medians([
        &mut || {
            generated.evaluate(
                derivative,
                black_box(&at),
                &mut work.0,
                black_box(&mut ours),
            )
        },
        &mut || {
            generic.evaluate(
                derivative,
                black_box(&at),
                &mut work.1,
                black_box(&mut laws),
            )
        },
        &mut || {
            black_box(dense.accelerations(&generic, black_box(&at), &mut work.2));
        },
    ]);
    let [d, e] = medians([
        &mut || {
            if runs.0.time() > 0.2 {
                runs.0.restore(&start.0).expect("the same model");
            }
            runs.0.step().expect("a stable step");
        },
        &mut || {
            if runs.1.time() > 0.2 {
                runs.1.restore(&start.1).expect("the same model");
            }
            runs.1.step().expect("a stable step");
        },
    ]);
    println!(
        "| {name} | {operations} | {} | {} | {:.1} | {} | {:.1} | {} | {} | {:.1} |",
        microseconds(a),
        microseconds(b),
        b / a,
        microseconds(c),
        c / a,
        microseconds(d),
        microseconds(e),
        e / d
    );
}

fn main() {
    println!("Medians in µs; ratios to generated code.\n");
    println!(
        "| mechanism | operations | ẋ generated | ẋ generic | ratio | v̇ dense | ratio | Rk4 step generated | Rk4 step generic | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    // Even rods are declared before odd ones.
    let rod = |half: usize| move |body: usize| zigzag(2 * (body % half) + body / half, 0.1);
    compare(
        "chain of 4",
        &Chain4::new(Default::default()).expect("defaults"),
        rod(2),
    );
    compare(
        "chain of 8",
        &Chain8::new(Default::default()).expect("defaults"),
        rod(4),
    );
    compare(
        "chain of 16",
        &Chain16::new(Default::default()).expect("defaults"),
        rod(8),
    );
    compare(
        "chain of 32",
        &Chain32::new(Default::default()).expect("defaults"),
        rod(16),
    );
    compare(
        "chain of 64",
        &Chain64::new(Default::default()).expect("defaults"),
        rod(32),
    );
    let lean = (7.0f64 / 8.0).acos();
    compare(
        "ring of 8",
        &Ring8::new(Default::default()).expect("defaults"),
        |body| zigzag(2 * (body % 4) + body / 4, lean),
    );
    compare(
        "hub, 11 arms",
        &Hub11::new(Default::default()).expect("defaults"),
        |body| {
            let angle = (body.max(1) - 1) as f64 * std::f64::consts::TAU / 11.0;
            match body {
                0 => ([0.0; 3], 0.0),
                _ => ([angle.cos(), angle.sin(), -0.5], 0.0),
            }
        },
    );
    compare(
        "tree of 15",
        &Tree15::new(Default::default()).expect("defaults"),
        |body| {
            let depth = (body + 1).ilog2();
            ([0.0, 0.0, -0.5 - f64::from(depth)], 0.0)
        },
    );
}
