//! What the riser force of test case 2 costs with every model of the confluence and every method, by two criteria: over the whole drop, and from 2 s
//! on, when the slack is used up. `cargo run --release -p models --example parachute_trade`.

use mbd_runtime::scene::Layout;
use mbd_runtime::{Model, Question, RunError, Simulation, Variant, trade};
use models::parachute::scene::{
    ParachuteMass, ParachuteMassParams, ParachuteRate, ParachuteRateParams, ParachuteStepwise,
    ParachuteStepwiseParams, SceneInstant, TestCase,
};
use models::parachute::variant::state;

/// When the slack is used up, and when the drop is over [s].
const SETTLED: f64 = 2.0;
const END: f64 = 10.0;

/// How a flight of any of the models begins.
fn begin(model: &dyn Model<f64>) -> impl Fn(&mut Simulation<f64>) -> Result<(), RunError> {
    let from = SceneInstant::start(TestCase::Two);
    let state = state(model, &from);
    let Layout { nodes, nz, .. } = model.layout();
    let placed = !nodes.is_empty() && *nz == 0;
    move |run| {
        run.set_state(from.time, &state)?;
        if placed {
            run.set_nodes(&from.point)?;
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mass = |kg: f64| {
        ParachuteMass::new(ParachuteMassParams {
            m_point: kg,
            ..ParachuteMassParams::default()
        })
    };
    let rate = ParachuteRate::new(ParachuteRateParams::default())?;
    let stepwise = ParachuteStepwise::new(ParachuteStepwiseParams::default())?;
    let (light, heavy) = (mass(0.1)?, mass(1.0)?);
    let models: [(&str, &dyn Model<f64>); 4] = [
        ("rate node", &rate),
        ("stepwise node", &stepwise),
        ("point of 0.1 kg", &light),
        ("point of 1 kg", &heavy),
    ];
    let variants = models.map(|(name, model)| Variant::new(name, model, begin(model)));
    for from in [0.0, SETTLED] {
        let race = trade(&variants, &Question::new("riser_force", [from, END]))?;
        println!(
            "Riser force from {from} s to {END} s; the references are {:.1e} N apart (rms)",
            race.apart.rms
        );
        for wanted in [10.0, 1.0, 0.1] {
            println!("  within {wanted} N");
            for (index, (name, _)) in models.iter().enumerate() {
                let own = race.entries.iter().filter(|entry| entry.variant == index);
                let good = own.filter(|entry| entry.error.rms <= wanted);
                let best = good.min_by(|a, b| a.seconds.total_cmp(&b.seconds));
                match best {
                    Some(best) => println!("    {best}"),
                    None => println!("    {name}: no setting"),
                }
            }
        }
    }
    Ok(())
}
