//! Generated against generic against a dense Cholesky solver, in one run, on mechanisms: state derivative, one step of Rk4 with projection.
//!
//! `cargo bench -p benches --bench joints`. Absolute times drift from day to day; read the ratios. The three are timed in turn, in many
//! short batches, and the median of each is printed.
//!
//! - generated: the code that `model!` emits.
//! - generic: the laws on numbers, the same elimination, nothing allocated.
//! - dense: rows, masses and forces of the generic solver; S = Φ_v M⁻¹ Φ_vᵀ built block by block where two joints share a body, one
//!   preallocated dense Cholesky of S. Without q̇, which it would have to add.

mod dense;
mod timing;

use std::hint::black_box;
use std::time::Instant;

use dense::Dense;
use mbd_compiler::SceneEquations;
use mbd_runtime::{At, Generic, Model, Options, Quantity, Simulation, model};
use timing::{medians, microseconds};

/// Rods of 0.3 m and 1 kg, hinged one below the other about y, x, y, x, …
macro_rules! chain {
    ($name:ident $half:literal { $($end:tt)* }) => {
        model! {
            /// A chain of rods.
            pub model $name {
                emit: [mass_matrix, bias_force, forces];
                gravity: [0.0, 0.0, -9.81] m/s^2;
                const HALF = $half;
                const ROD = 0.3 m;
                body even[i in 0..HALF] {
                    mass: 1.0 kg,
                    inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
                    frame top at [0.0, 0.0, ROD / 2],
                    frame end at [0.0, 0.0, -ROD / 2],
                }
                body odd[i in 0..HALF] {
                    mass: 1.0 kg,
                    inertia: diag(0.0076, 0.0076, 0.0002) kg*m^2,
                    frame top at [0.0, 0.0, ROD / 2],
                    frame end at [0.0, 0.0, -ROD / 2],
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
    world { frame far at [0.0, 0.0, -2.1] m }
    joint close: spherical from odd[3].end to world.far;
});

/// IFToMM A02: windows of rods of 1 m and 1 kg between cranks, in one plane. In space the window closes in two rows, so that no row repeats
/// another.
macro_rules! four_bars {
    ($name:ident $windows:literal $close:ident { $($setting:tt)* }) => {
        model! {
            /// Coupled four-bars.
            pub model $name {
                emit: [];
                $($setting)*
                gravity: [0.0, -9.81, 0.0] m/s^2;
                const WINDOWS = $windows;
                world { frame pivot[i in 0..=WINDOWS] at [1.0 * i, 0.0, 0.0] m }
                body crank[i in 0..=WINDOWS] {
                    mass: 1.0 kg,
                    inertia: diag(1/12, 1/12, 1/12) kg*m^2,
                    frame root at [-0.5, 0.0, 0.0] m,
                    frame tip at [0.5, 0.0, 0.0] m,
                }
                body coupler[i in 0..WINDOWS] {
                    mass: 1.0 kg,
                    inertia: diag(1/12, 1/12, 1/12) kg*m^2,
                    frame left at [-0.5, 0.0, 0.0] m,
                    frame right at [0.5, 0.0, 0.0] m,
                }
                joint hold[i in 0..=WINDOWS]: hinge from world.pivot[i] to crank[i].root;
                joint pin[i in 0..WINDOWS]: hinge from crank[i].tip to coupler[i].left;
                joint close[i in 0..WINDOWS]: $close from coupler[i].right to crank[i + 1].tip;
            }
        }
    };
}

four_bars!(FourBar 1 hinge { planar: xy; });
four_bars!(FourBars10 10 hinge { planar: xy; });
four_bars!(SpatialFourBar 1 point_on_line {});
four_bars!(SpatialFourBars10 10 point_on_line {});

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

/// A body's centre of mass and attitude w x y z.
type Pose = ([f64; 3], [f64; 4]);

/// p q.
fn product(p: [f64; 4], q: [f64; 4]) -> [f64; 4] {
    let ([a, b, c, d], [w, x, y, z]) = (p, q);
    [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
}

/// The third axis of an attitude.
fn along([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    [
        2.0 * (x * z + w * y),
        2.0 * (y * z - w * x),
        1.0 - 2.0 * (x * x + y * y),
    ]
}

/// Rod `n` of a chain of rods of length `rod`, each rotated against the one before by `angle` of its number about y, x, y, x, …
fn hanging(n: usize, rod: f64, angle: impl Fn(usize) -> f64) -> Pose {
    let (mut attitude, mut end, mut centre) = ([1.0, 0.0, 0.0, 0.0], [0.0; 3], [0.0; 3]);
    for k in 0..=n {
        let (sin, cos) = (0.5 * angle(k)).sin_cos();
        let turn = if k % 2 == 0 {
            [cos, 0.0, sin, 0.0]
        } else {
            [cos, sin, 0.0, 0.0]
        };
        attitude = product(attitude, turn);
        let down = along(attitude).map(|x| rod * x);
        centre = std::array::from_fn(|i| end[i] - 0.5 * down[i]);
        end = std::array::from_fn(|i| end[i] - down[i]);
    }
    (centre, attitude)
}

/// A chain of two times `half` rods, even rods declared before odd ones, every hinge at 0.3 rad.
fn chain(half: usize) -> impl Fn(usize) -> Pose {
    move |body| hanging(2 * (body % half) + body / half, 0.3, |_| 0.3)
}

/// A state with every body in its place; `stir` m/s and rad/s of speeds of all kinds, which the start takes to the joints.
fn state(model: &dyn Model<f64>, place: impl Fn(usize) -> Pose, stir: f64) -> Vec<f64> {
    let layout = model.layout();
    let mut state = vec![0.0; layout.nx()];
    for (body, slots) in layout.own_bodies() {
        let (centre, attitude) = place(body);
        state[slots.q..slots.q + 3].copy_from_slice(&centre);
        state[slots.q + 3..slots.q + 7].copy_from_slice(&attitude);
    }
    for (index, speed) in state.iter_mut().skip(layout.nq).enumerate() {
        *speed = stir * (1.7 * index as f64).sin();
    }
    state
}

fn begun(model: &dyn Model<f64>, state: &[f64]) -> Simulation<f64> {
    let mut run = Simulation::new(model, Options::rk4(1e-3)).expect("fixed steps");
    run.set_state(0.0, state).expect("a state of the scene");
    run.start().expect("a consistent start");
    run
}

/// Times one mechanism and prints its line of the table.
fn compare(name: &str, generated: &dyn Model<f64>, place: impl Fn(usize) -> Pose) {
    let scene = generated.scene().clone();
    let equations = SceneEquations::trace_only(&scene, &[Quantity::Derivative]);
    let operations = equations
        .program(Quantity::Derivative)
        .map_or(0, |program| program.cost().total());
    let generic = Generic::with_defaults(scene).expect("defaults");
    let mut runs = (
        begun(generated, &state(generated, &place, 0.3)),
        begun(&generic, &state(generated, &place, 0.3)),
    );
    let start = (runs.0.snapshot(), runs.1.snapshot());
    let at_start = runs.0.state().to_vec();
    let at = At::of_state(0.0, &at_start, &[]);
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

/// Distance of the end of the last rod from where it should be after 1 s, and the time of the run [s].
fn drop_chain(model: &dyn Model<f64>, start: &[f64], steps: u32, want: [f64; 3]) -> (f64, f64) {
    let began = Instant::now();
    let step = 1.0 / f64::from(steps);
    let mut run = Simulation::new(model, Options::rk4(step)).expect("fixed steps");
    run.set_state(0.0, start).expect("a state of the scene");
    if run.run(1.0).is_err() {
        // Too long a step.
        return (f64::INFINITY, 0.0);
    }
    let spent = began.elapsed().as_secs_f64();
    let last = model
        .layout()
        .bodies
        .last()
        .copied()
        .flatten()
        .expect("a chain")
        .q;
    let at = |i: usize| run.state()[last + i];
    let down = along([at(3), at(4), at(5), at(6)]);
    let miss = (0..3).map(|i| (at(i) - 0.15 * down[i] - want[i]).powi(2));
    (miss.sum::<f64>().sqrt(), spent)
}

/// The longest step that puts the end of the chain within 1 mm after 1 s, and what the run takes.
fn race(name: &str, model: &dyn Model<f64>, half: usize, want: [f64; 3]) {
    let start = state(model, chain(half), 0.0);
    let tried = [
        8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 100, 125, 160, 200, 400, 800,
    ];
    let found = tried.into_iter().find_map(|steps| {
        let (miss, _) = drop_chain(model, &start, steps, want);
        (miss <= 1e-3).then_some((steps, miss))
    });
    let Some((steps, miss)) = found else {
        println!("| {name} | no step reaches 1 mm | | |");
        return;
    };
    let mut times: Vec<f64> = (0..31)
        .map(|_| drop_chain(model, &start, steps, want).1)
        .collect();
    times.sort_by(f64::total_cmp);
    println!(
        "| {name} | {steps} | {miss:.1e} m | {} |",
        microseconds(times[15])
    );
}

/// Times a step of coupled four-bars, and says how long a step keeps the first crank within 1e-6 rad for 0.4 s.
fn four_bars(name: &str, model: &dyn Model<f64>, windows: usize) {
    let layout = model.layout();
    let (flat, moves) = (
        layout.directions.plane.is_some(),
        layout.directions.translations().len(),
    );
    let mut start = vec![0.0; layout.nx()];
    for (body, slots) in layout.own_bodies() {
        let (place, angle, [vx, w]) = match body.checked_sub(windows + 1) {
            None => ([body as f64, 0.5], std::f64::consts::FRAC_PI_2, [0.5, -1.0]),
            Some(coupler) => ([coupler as f64 + 0.5, 1.0], 0.0, [1.0, 0.0]),
        };
        start[slots.q..slots.q + 2].copy_from_slice(&place);
        if flat {
            start[slots.q + 2] = angle;
        } else {
            let (sin, cos) = (0.5 * angle).sin_cos();
            (start[slots.q + 3], start[slots.q + 6]) = (cos, sin);
        }
        let v = layout.nq + slots.v;
        (start[v], start[v + layout.directions.speeds() - 1]) = (vx, w);
    }
    let angle = |step: f64| {
        let mut run = Simulation::new(model, Options::rk4(step)).expect("fixed steps");
        run.set_state(0.0, &start).expect("a state of the scene");
        if run.run(0.4).is_err() {
            // Too long a step.
            return f64::INFINITY;
        }
        let attitude = &run.state()[layout.bodies[0].expect("slots").q + moves..];
        match flat {
            true => attitude[0],
            false => 2.0 * attitude[3].atan2(attitude[0]),
        }
    };
    let exact = angle(1e-4);
    let found = [5u32, 8, 10, 12, 16, 20, 25, 32, 40, 50, 80, 100, 200, 400]
        .into_iter()
        .map(|steps| (steps, (angle(0.4 / f64::from(steps)) - exact).abs()))
        .find(|(_, error)| *error <= 1e-6);
    let (steps, error) = found.expect("a step that is short enough");
    let scene = model.scene().clone();
    let equations = SceneEquations::trace_only(&scene, &[Quantity::Derivative]);
    let operations = equations
        .program(Quantity::Derivative)
        .map_or(0, |program| program.cost().total());
    let generic = Generic::with_defaults(scene).expect("defaults");
    let mut runs = (begun(model, &start), begun(&generic, &start));
    let from = (runs.0.snapshot(), runs.1.snapshot());
    let [step, laws] = medians([
        &mut || {
            if runs.0.time() > 0.4 {
                runs.0.restore(&from.0).expect("the same model");
            }
            runs.0.step().expect("a stable step");
        },
        &mut || {
            if runs.1.time() > 0.4 {
                runs.1.restore(&from.1).expect("the same model");
            }
            runs.1.step().expect("a stable step");
        },
    ]);
    let second = step * f64::from(steps) / 0.4;
    println!(
        "| {name} | {operations} | {} | {} | {:.1} | {steps} | {error:.1e} rad | {} |",
        microseconds(step),
        microseconds(laws),
        laws / step,
        microseconds(second)
    );
}

fn main() {
    println!("Medians in µs; ratios to generated code.\n");
    println!(
        "| mechanism | operations | ẋ generated | ẋ generic | ratio | v̇ dense | ratio | Rk4 step generated | Rk4 step generic | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let (eight, many) = (
        Chain8::new(Default::default()),
        Chain32::new(Default::default()),
    );
    let (eight, many) = (eight.expect("defaults"), many.expect("defaults"));
    compare(
        "chain of 4",
        &Chain4::new(Default::default()).expect("defaults"),
        chain(2),
    );
    compare("chain of 8", &eight, chain(4));
    compare(
        "chain of 16",
        &Chain16::new(Default::default()).expect("defaults"),
        chain(8),
    );
    compare("chain of 32", &many, chain(16));
    compare(
        "chain of 64",
        &Chain64::new(Default::default()).expect("defaults"),
        chain(32),
    );
    // Two rods lean to one side, two to the other.
    let lean = (7.0f64 / 8.0).acos();
    let sides = |k: usize| match k % 4 {
        0 if k == 0 => lean,
        0 => 2.0 * lean,
        2 => -2.0 * lean,
        _ => 0.0,
    };
    compare(
        "ring of 8",
        &Ring8::new(Default::default()).expect("defaults"),
        |body| hanging(2 * (body % 4) + body / 4, 0.3, sides),
    );
    let upright = [1.0, 0.0, 0.0, 0.0];
    compare(
        "hub, 11 arms",
        &Hub11::new(Default::default()).expect("defaults"),
        |body| {
            let angle = (body.max(1) - 1) as f64 * std::f64::consts::TAU / 11.0;
            match body {
                0 => ([0.0; 3], upright),
                _ => ([angle.cos(), angle.sin(), -0.5], upright),
            }
        },
    );
    compare(
        "tree of 15",
        &Tree15::new(Default::default()).expect("defaults"),
        |body| {
            let depth = (body + 1).ilog2();
            ([0.0, 0.0, -0.5 - f64::from(depth)], upright)
        },
    );

    println!(
        "\nChains of hinges, all at 0.3 rad and at rest, for 1 s by Rk4 with projection; where the end is then: Pinocchio, DOP853 at 1e-12.\n"
    );
    println!("| chain | steps | off by | whole run, µs |\n|---|---|---|---|");
    race(
        "8 hinges",
        &eight,
        4,
        [0.8291050675206681, -0.7755380524535794, -2.0682419069445612],
    );
    race(
        "32 hinges",
        &many,
        16,
        [-0.16660035994993433, 0.0754801515881036, -5.465572737267973],
    );

    println!("\nCoupled four-bars (IFToMM A02), one step of Rk4 with projection.\n");
    println!(
        "| four-bars | operations of ẋ | step generated, µs | step generic, µs | ratio | steps to 0.4 s within 1e-6 rad | first crank off by | at such steps, µs per simulated second |\n|---|---|---|---|---|---|---|---|"
    );
    let (one, ten) = (
        FourBar::new(Default::default()),
        FourBars10::new(Default::default()),
    );
    four_bars("1, `planar: xy`", &one.expect("defaults"), 1);
    four_bars("10, `planar: xy`", &ten.expect("defaults"), 10);
    let (one, ten) = (
        SpatialFourBar::new(Default::default()),
        SpatialFourBars10::new(Default::default()),
    );
    four_bars("1, in space", &one.expect("defaults"), 1);
    four_bars("10, in space", &ten.expect("defaults"), 10);
}
