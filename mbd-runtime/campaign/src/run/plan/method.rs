//! The method of a run, its step or tolerance, and what else its options say.

use mbd_compiler::nearest;
use mbd_runtime::scene::{NodeModel, Scene};
use mbd_runtime::{Layout, Method, Options};

use crate::run::names::{PlanError, wrong};
use crate::run::number::positive;
use crate::run::scales::scales;
use crate::run::settings::Settings;
use crate::run::words;

/// A step that is taken when neither step nor tolerance is given and the scene needs fixed steps [s].
const STEP: f64 = 1e-3;
/// The relative tolerance of adaptive steps when nothing is given.
const TOLERANCE: f64 = 1e-8;
/// What is said of a method for absolute coordinates alone.
const NO_RATTLE: &str = "`rattle` needs a mass matrix that stays, and in relative coordinates it changes with them: declare `coordinates: absolute;`, or take `vern7`, on the command line `--method vern7`";

/// How the scene is run.
pub(super) fn options(
    scene: &Scene,
    layout: &Layout,
    settings: &Settings,
) -> Result<Options, PlanError> {
    let stepwise = layout
        .nodes
        .iter()
        .any(|node| matches!(node.model, NodeModel::Stepwise { .. }));
    let (step, tolerance) = (settings.step.as_ref(), settings.tolerance.as_ref());
    if step.is_some() && tolerance.is_some() {
        return Err(wrong(
            "tolerance",
            "give either a step (fixed) or a tolerance (adaptive)",
        ));
    }
    let fixed = || step.map_or(Ok(STEP), |step| positive("step", step, "s"));
    let adaptive = || {
        let given = tolerance.map_or(Ok(TOLERANCE), |given| positive("tolerance", given, ""))?;
        match given > Method::LOOSEST {
            true => Err(wrong(
                "tolerance",
                format!(
                    "must be at most {}: above it nothing is resolved",
                    Method::LOOSEST
                ),
            )),
            false => Ok(given),
        }
    };
    // Books write RK4 and Tsit5.
    let word = settings.method.as_deref().map(|word| {
        let mut known = Method::FIXED.into_iter().chain(Method::ADAPTIVE);
        let ours = known.find(|known| known.eq_ignore_ascii_case(word));
        ours.unwrap_or(word)
    });
    let mut options = match word {
        None if step.is_some() || (stepwise && tolerance.is_none()) => Options::rk4(fixed()?),
        None => Options::tsit5(adaptive()?),
        Some(word) if Method::FIXED.contains(&word) && tolerance.is_some() => {
            let text =
                format!("`{word}` has a fixed step: give `step`, or take an adaptive method");
            return Err(wrong("tolerance", text));
        }
        Some(word) if Method::ADAPTIVE.contains(&word) && step.is_some() => {
            let text = format!("`{word}` chooses its steps: give `tolerance`, or take `rk4`");
            return Err(wrong("step", text));
        }
        Some(word) => Options::of(method(word, fixed()?, adaptive()?)?),
    };
    if matches!(options.method, Method::Rattle { .. }) && layout.tree.is_some() {
        return Err(wrong("method", NO_RATTLE));
    }
    options.locate = settings.locate.unwrap_or(true);
    if let Some(steps) = settings.max_steps {
        if steps == 0 {
            return Err(wrong("max_steps", "must be positive"));
        }
        options.max_steps = steps;
    }
    options.scales = scales(&settings.scales)?;
    // The balance of energy needs the work of what gives and takes it.
    options.work = scene.exchanges_energy();
    Ok(options)
}

/// The method of a word, with a step [s] or a tolerance.
fn method(word: &str, step: f64, tolerance: f64) -> Result<Method, PlanError> {
    let method = Method::fixed(word, step).or_else(|| Method::adaptive(word, tolerance));
    method.ok_or_else(|| {
        let known = || Method::FIXED.into_iter().chain(Method::ADAPTIVE);
        let near = match (words::of_method(word), nearest(word, known())) {
            (Some(ours), _) => format!("; {ours}."),
            (None, Some(near)) => format!("; did you mean `{near}`?"),
            (None, None) => ".".to_owned(),
        };
        let list: Vec<&str> = known().collect();
        let text = format!(
            "there is no method `{word}`{near} There are: {}",
            list.join(", ")
        );
        wrong("method", text)
    })
}
