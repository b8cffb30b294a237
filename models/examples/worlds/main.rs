//! Scenes from the worlds of users, each with what drives it and its checks against closed forms, in one file of its own.
//!
//! `cargo run -p models --example worlds` lists them, `cargo run -p models --example worlds -- cart_pole` runs one and prints a short table;
//! `cargo test -p models --example worlds` checks them.

use std::error::Error;
use std::process::ExitCode;

mod cart_pole;
mod chain;
mod dc_motor;
mod double_wishbone;
mod gantry;
mod hoisting_crane;
mod kite;
mod mooring_line;
mod motion_base;
mod press;
mod quadrotor;
mod quarter_car;
mod staged_descent;
mod stewart_platform;
mod tower_crane;
mod wind_turbine;

/// What a scene's run gives.
type Outcome = Result<(), Box<dyn Error>>;

/// A scene: its name, what it is, and what runs it.
struct World(&'static str, &'static str, fn() -> Outcome);

const WORLDS: &[World] = &[
    World(
        "cart_pole",
        "a pole on a cart, held upright by a sampled optimal controller",
        cart_pole::run,
    ),
    World(
        "chain",
        "a hanging chain of twenty links and its swings",
        chain::run,
    ),
    World(
        "dc_motor",
        "a motor whose current is a state beside the mechanics",
        dc_motor::run,
    ),
    World(
        "double_wishbone",
        "camber and track of a suspension over its travel",
        double_wishbone::run,
    ),
    World(
        "gantry",
        "a load on two pendulums, moved so that neither swings afterwards",
        gantry::run,
    ),
    World(
        "hoisting_crane",
        "a load that swings while its rope is drawn in and let out",
        hoisting_crane::run,
    ),
    World(
        "kite",
        "a kite on bridles in a steady wind, at rest",
        kite::run,
    ),
    World(
        "mooring_line",
        "a line of chain between an anchor and a moored platform",
        mooring_line::run,
    ),
    World(
        "motion_base",
        "a cabin on six legs, brought to its place by a sampled controller",
        motion_base::run,
    ),
    World(
        "press",
        "a flywheel, a crank and a die that takes what the wheel has stored",
        press::run,
    ),
    World(
        "quadrotor",
        "four rotors and a load on a sling: hover, and how the load swings",
        quadrotor::run,
    ),
    World(
        "quarter_car",
        "what of the road reaches the body of a car",
        quarter_car::run,
    ),
    World(
        "staged_descent",
        "a capsule that comes down in phases: drogue, reefed and full parachute, a shield that drops",
        staged_descent::run,
    ),
    World(
        "stewart_platform",
        "a platform on six legs that follow its inverse kinematics",
        stewart_platform::run,
    ),
    World(
        "tower_crane",
        "a load brought along the jib without sway",
        tower_crane::run,
    ),
    World(
        "wind_turbine",
        "a rotor at constant speed, braked by its generator",
        wind_turbine::run,
    ),
];

fn main() -> ExitCode {
    let Some(asked) = std::env::args().nth(1) else {
        for World(name, what, _) in WORLDS {
            println!("{name:18} {what}");
        }
        return ExitCode::SUCCESS;
    };
    let Some(World(.., run)) = WORLDS.iter().find(|World(name, ..)| *name == asked) else {
        let known: Vec<&str> = WORLDS.iter().map(|World(name, ..)| *name).collect();
        eprintln!("`{asked}` is none of these scenes: {}", known.join(", "));
        return ExitCode::FAILURE;
    };
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(cause) => {
            eprintln!("{asked}: {cause}");
            ExitCode::FAILURE
        }
    }
}
