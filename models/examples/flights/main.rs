//! Ten thousand flights of the parachute: a campaign of a compiled model, in lanes. This is all that a program of your own needs.
//!
//! ```text
//! RUSTFLAGS="-C target-cpu=native" cargo run --release -p models --example flights -- campaign models/examples/flights/dispersions.toml --out out/flights
//! RUSTFLAGS="-C target-cpu=native" cargo run --release -p models --example flights -- report out/flights
//! ```

use mbd_runtime::InLanes;
use models::parachute::scene::{ParachuteStepwise, ParachuteStepwiseParams};

fn main() -> std::process::ExitCode {
    let parachute = ParachuteStepwise::new(ParachuteStepwiseParams::default());
    mbd_campaign::main(parachute.map(InLanes::in_lanes))
}
