//! The largest declaration of this repository: 64 rods on hinges, let go from a slant, for one second.
//!
//! `cargo run --release -p models --example long_chain`. The profile `dev` does not optimise it, and there rustc fails on functions of some thousand
//! terms: kernels keep them short.

use std::time::Instant;

use mbd_runtime::{Options, Quantity, Simulation, model};

model! {
    /// Rods hinged one below the other about y, x, y, x, …
    pub model LongChain {
        emit: [energy, multipliers, reactions];
        gravity: [0.0, 0.0, -9.81] m/s^2;
        const HALF = 32;
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
    }
}

const STEPS: u32 = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let chain = LongChain::new(Default::default())?;
    let mut start = vec![0.0; LongChain::NQ + LongChain::NV];
    // Every rod leans by 0.5 rad about y; even rods stand before odd ones.
    let (sin, cos) = 0.25f64.sin_cos();
    for (body, pose) in start.chunks_exact_mut(7).take(64).enumerate() {
        let number = (2 * (body % 32) + body / 32) as f64 + 0.5;
        pose[0] = -0.3 * number * 2.0 * sin * cos;
        pose[2] = -0.3 * number * (cos * cos - sin * sin);
        pose[3] = cos;
        pose[5] = sin;
    }
    let mut run = Simulation::new(&chain, Options::rk4(1.0 / f64::from(STEPS)))?;
    run.set_state(0.0, &start)?;
    let mut energy = vec![0.0; mbd_runtime::Model::<f64>::layout(&chain).len(Quantity::Energy)];
    run.evaluate(Quantity::Energy, &mut energy)?;
    let before = energy[0] + energy[1];
    let began = Instant::now();
    run.run(1.0)?;
    let spent = began.elapsed().as_secs_f64();
    run.evaluate(Quantity::Energy, &mut energy)?;
    println!(
        "{STEPS} steps, {:.1} µs each; energy {before:.6} J, then {:.6} J",
        spent * 1e6 / f64::from(STEPS),
        energy[0] + energy[1]
    );
    Ok(())
}
