//! Scenes that are large and simple: points on a rope. What each part of a run costs for it.

use std::fmt::Write as _;
use std::time::Instant;

use mbd_compiler::{Interpreted, read_text};
use mbd_runtime::{Generic, Model, Options, RunError, Simulation};
use mbd_scene::{Layout, Scene};

/// The declaration of `count` points of 0.1 kg, one on the other by taut lines, the first on the world; every one written out, as a program writes
/// a net.
#[must_use]
pub fn rope(count: usize) -> String {
    let mut text = String::from("model Rope {\n    gravity: [0.0, 0.0, -9.81] m/s^2;\n");
    for point in 0..count {
        let height = -0.1 * (point + 1) as f64;
        let from = match point {
            0 => "world".to_owned(),
            _ => format!("p{}", point - 1),
        };
        let _ = write!(
            text,
            "    point p{point} {{ mass: 0.1 kg, start at [0.0, 0.0, {height:.1}] m }}\n    \
             line l{point} from {from} to p{point} {{ free_length: 0.0999 m, stiffness: 10 kN/m, damping: 1 N*s/m }}\n"
        );
    }
    text + "    output pull = l0.tension;\n}\n"
}

/// What a scene costs [s].
#[derive(Clone, Copy, Debug, Default)]
pub struct Costs {
    /// Reading and resolving its declaration.
    pub read: f64,
    /// Laying it out.
    pub layout: f64,
    /// The model that runs its laws.
    pub generic: f64,
    /// The start of a run of that, its first stage included.
    pub start: f64,
    /// A step of RK4 of it.
    pub step: f64,
    /// The model that interprets its equations, as the command line runs files.
    pub interpreted: f64,
    /// The start of a run of that.
    pub start_interpreted: f64,
}

fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let made = work();
    *seconds = began.elapsed().as_secs_f64();
    made
}

/// Reads and starts a rope.
///
/// # Errors
/// A run that fails.
///
/// # Panics
/// If the declaration is no scene.
pub fn costs(count: usize) -> Result<Costs, RunError> {
    let mut costs = Costs::default();
    let text = rope(count);
    let scene: Scene = timed(&mut costs.read, || read_text(&text).scene).expect("a scene");
    let layout = timed(&mut costs.layout, || Layout::new(&scene));
    assert_eq!((layout.points.len(), layout.lines.len()), (count, count));
    let model = timed(&mut costs.generic, || {
        Generic::<f64>::with_defaults(scene.clone()).expect("defaults")
    });
    (costs.start, costs.step) = started(&model, 10)?;
    let model = timed(&mut costs.interpreted, || {
        Interpreted::<f64>::new(scene, &[]).expect("no params")
    });
    (costs.start_interpreted, _) = started(&model, 0)?;
    Ok(costs)
}

/// What the start of a run and a step of it cost [s].
fn started(model: &dyn Model<f64>, steps: u32) -> Result<(f64, f64), RunError> {
    const STEP: f64 = 1e-4;
    let (mut start, mut run) = (0.0, 0.0);
    let mut simulation = timed(&mut start, || {
        let mut simulation = Simulation::new(model, Options::rk4(STEP))?;
        simulation.start()?;
        Ok(simulation)
    })?;
    timed(&mut run, || simulation.run(f64::from(steps) * STEP))?;
    Ok((start, run / f64::from(steps.max(1))))
}
