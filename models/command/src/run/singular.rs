//! What to say of a run that passed a singular position of its joints in a way that a tolerance does not see.

use mbd_runtime::scene::Scene;

use super::RunOutcome;

/// The warning of a run some stages of which were solved with all rows regularised; `None` where none was.
#[must_use]
pub fn regularised(scene: &Scene, outcome: &RunOutcome) -> Option<String> {
    let stages = match outcome.trajectory.statistics.rows_regularised {
        0 => return None,
        1 => "a stage of a step was".to_owned(),
        stages => format!("{stages} stages of steps were"),
    };
    Some(format!(
        "warning: {}: the joints pass a singular position (bars in one line, say), where {stages} solved with all rows regularised, to order two: rates, accelerations \
         and reactions close to it may be less accurate than the tolerance asks for; compare with a run of another tolerance or step",
        scene.name
    ))
}
