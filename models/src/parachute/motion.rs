//! The flights that the report of the study shows as they move: test case 2 with a point of mass, and with the equilibrium point that replaces it.

use mbd_runtime::scene::Scene;

use super::comparison::{END, grid, options};
use super::scene::TestCase;
use super::variant::{Confluence, Damping, Flight, FlightError, FlightPlan, fly_model, with_model};
use crate::report::{RecordedMotion, Run};

/// What is shown over each other, and the steps it is flown at [s].
const SHOWN: [(Confluence, f64); 2] = [
    (Confluence::Mass(1.0, Damping::On), 1e-3),
    (Confluence::Rate, 0.01),
];

/// A flight whose history holds its motion.
#[derive(Clone, Debug)]
pub struct MovingFlight {
    confluence: Confluence,
    scene: Scene,
    params: Vec<f64>,
    flight: Flight,
}

/// Flies what is shown.
///
/// # Errors
/// What stopped a flight that must not stop.
pub fn moving() -> Result<Vec<MovingFlight>, FlightError> {
    let fly = |(confluence, step)| {
        let plan = FlightPlan::new(TestCase::Two, confluence, options(step, true), END);
        let plan = plan.sampled(&grid()).moving();
        with_model(confluence, |model| {
            Ok(MovingFlight {
                confluence,
                scene: model.scene().clone(),
                params: model.params().to_vec(),
                flight: fly_model(&plan, model)?,
            })
        })
    };
    SHOWN.into_iter().map(fly).collect()
}

/// All of them over each other, for a page.
#[must_use]
pub fn motion(flights: &[MovingFlight]) -> RecordedMotion {
    let labels: Vec<String> = flights
        .iter()
        .map(|shown| shown.confluence.to_string())
        .collect();
    let labels = labels.iter().map(String::as_str);
    let runs = flights
        .iter()
        .map(|shown| Run::new(&shown.scene, &shown.params, &shown.flight.history));
    RecordedMotion::of_several(&labels.zip(runs).collect::<Vec<_>>())
}
