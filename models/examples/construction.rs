//! What a model with new parameters costs, and a start with them: `cargo run --release -p models --example construction`.
//!
//! The first model of a declaration in a program unpacks it and lays it out; every later one evaluates its parameters alone.

use std::hint::black_box;
use std::time::Instant;

use mbd_runtime::{Model, Options, ParamError, Simulation, model};
use models::parachute::scene::{ParachuteRate, ParachuteRateParams};

model! {
    /// Sixty-four rods on hinges about y, one live mass.
    model Chain {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        param rod_mass = 1 kg in 0.5 kg ..= 2 kg;
        body rod[i in 0..64] {
            mass: rod_mass,
            inertia: diag(0.085, 0.085, 0.001) kg*m^2,
            frame top at [0, 0, 0.5] m,
            frame end at [0, 0, -0.5] m,
        }
        joint hold: hinge from world to rod[0].top { axis: [0, 1, 0] };
        joint pin[i in 1..64]: hinge from rod[i - 1].end to rod[i].top { axis: [0, 1, 0] };
    }
}

/// The first call and the median of the later ones [µs].
fn microseconds<T>(mut work: impl FnMut() -> T) -> [f64; 2] {
    let mut times: Vec<f64> = (0..201)
        .map(|_| {
            let clock = Instant::now();
            black_box(work());
            clock.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    let first = times.remove(0);
    times.sort_by(f64::total_cmp);
    [first, times[times.len() / 2]]
}

fn main() -> Result<(), ParamError> {
    let chain = microseconds(|| Chain::new(ChainParams { rod_mass: 1.1 }));
    let parachute = microseconds(|| ParachuteRate::<f64>::new(ParachuteRateParams::default()));
    let model = Chain::new(ChainParams::default())?;
    let made = microseconds(|| Simulation::new(&model, Options::rk4(1e-3)).map(drop));
    let canopy = ParachuteRate::<f64>::new(ParachuteRateParams::default())?;
    let mut run = Simulation::new(&canopy, Options::rk4(1e-3)).ok();
    let params = canopy.params().to_vec();
    let changed = microseconds(|| run.as_mut().map(|run| run.set_params(&params).is_ok()));
    println!("µs                               first   later");
    for (name, [first, later]) in [
        ("new(params), 64 hinges", chain),
        ("new(params), parachute", parachute),
        ("Simulation::new, 64 hinges", made),
        ("set_params, parachute", changed),
    ] {
        println!("{name:<30} {first:>8.1} {later:>7.2}");
    }
    Ok(())
}
