//! What a step of RK4 costs, to be counted in instructions: time depends on the machine and what else it does, instructions do not.
//!
//!     cargo build --release -p mbd-runtime --example step_cost
//!     valgrind --tool=callgrind --toggle-collect='*Scalar>::take_step' target/release/examples/step_cost chain 1000
//!
//! prints what a thousand steps have collected. Without arguments every scene is stepped, and told by the bits of the state it ends with.

use std::error::Error;

use mbd_runtime::{Model, Options, Simulation, model};

/// Rods on hinges about y and x in turn, in relative coordinates.
macro_rules! chain {
    ($name:ident $half:literal) => {
        model! {
            /// A chain of rods.
            model $name {
                coordinates: relative;
                emit: [derivative];
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

chain!(Two 1);
chain!(Eight 4);

/// A capsule that swings on a riser and three legs, which meet in a point of one kind or another.
macro_rules! capsule {
    ($name:ident { $($point:tt)* } { $($damping:tt)* } { $($more:tt)* }) => {
        model! {
            /// A capsule on lines.
            model $name {
                emit: [derivative];
                gravity: [0.0, 0.0, -3.7] m/s^2;
                body capsule { mass: 760 kg, inertia: diag(235, 225, 290) kg*m^2, start at [0.6, 0.0, -6.0] m,
                    frame bridle[i in 0..3] at polar(0.6 m, i * 120 deg, 1.2 m) }
                joint capsule_free: free from world to capsule.com;
                point confluence { $($point)* }
                line riser from world to confluence { free_length: 3.0 m, stiffness: 60 kN/m $($damping)* }
                line leg[i in 0..3] from capsule.bridle[i] to confluence { free_length: 1.5 m, stiffness: 47 kN/m $($damping)* }
                $($more)*
            }
        }
    };
}

capsule!(Mass { mass: 0.5 kg, start at [0.3, 0.0, -3.4] m } { , damping: 500 N*s/m } {});
capsule!(Static { equilibrium: static } {} {});
capsule!(Rate { equilibrium: rate } { , damping: 500 N*s/m } {});
capsule!(Stepwise { equilibrium: stepwise } { , damping: 500 N*s/m } {});
capsule!(Passing { equilibrium: rate } { , damping: 500 N*s/m } { event low = capsule.position.x falls 0 m; });

/// Makes steps, and tells the bits they end with.
fn run(
    name: &str,
    model: &impl Model<f64>,
    options: Options,
    steps: u64,
) -> Result<(), Box<dyn Error>> {
    let mut run = Simulation::new(model, options)?;
    run.start()?;
    for _ in 0..steps {
        run.step()?;
    }
    let mix = |sum: u64, x: &f64| sum.rotate_left(7) ^ x.to_bits();
    let bits = run.state().iter().fold(0, mix);
    println!(
        "{name:<10} {:>10.6} s  {:>3} events  {bits:016x}",
        run.time(),
        run.events().len()
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let only = arguments.next();
    let steps = arguments.next().map_or(Ok(2000), |steps| steps.parse())?;
    let fixed = |step: f64| Options {
        locate: false,
        ..Options::rk4(step)
    };
    let wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    macro_rules! each {
        ($($name:literal $model:ident $params:ident $options:expr;)*) => {
            $(if wanted($name) {
                run($name, &$model::new($params::default())?, $options, steps)?;
            })*
        };
    }
    each! {
        "chain" Two TwoParams fixed(1e-3);
        "chain8" Eight EightParams fixed(1e-3);
        "mass" Mass MassParams fixed(1e-4);
        "static" Static StaticParams fixed(2e-3);
        "rate" Rate RateParams fixed(2e-3);
        "stepwise" Stepwise StepwiseParams fixed(2e-3);
        "located" Rate RateParams Options::rk4(2e-3);
        "passing" Passing PassingParams Options::rk4(2e-3);
        "adaptive" Passing PassingParams Options::tsit5(1e-6);
    }
    Ok(())
}
