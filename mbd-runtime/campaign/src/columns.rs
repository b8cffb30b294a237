//! Which columns histories have to hold, so that what is asked of them can be read.

use mbd_runtime::scene::similar::did_you_mean;
use mbd_runtime::{Content, Model, Name, Sampling, Trajectory};

use crate::run::PlanError;
use crate::run::names::wrong;

/// Histories with nothing but the time.
pub const NOTHING: Content = Content {
    state: false,
    nodes: false,
    lines: false,
    reactions: false,
    outputs: false,
    energy: false,
};

/// The columns of histories with their contents, widest last.
fn groups() -> [Content; 6] {
    [
        Content {
            outputs: true,
            ..NOTHING
        },
        Content {
            lines: true,
            ..NOTHING
        },
        Content {
            nodes: true,
            ..NOTHING
        },
        Content {
            state: true,
            ..NOTHING
        },
        Content {
            reactions: true,
            ..NOTHING
        },
        Content {
            energy: true,
            ..NOTHING
        },
    ]
}

/// The columns of a history with this content.
pub fn names(model: &dyn Model<f64>, content: Content) -> Vec<Name> {
    Trajectory::new(model, Sampling::Steps, content)
        .names()
        .to_vec()
}

/// Has histories hold a column; `setting` asks for it.
///
/// # Errors
/// No history of the model has it.
pub fn include(
    content: &mut Content,
    column: &str,
    (setting, model): (&str, &dyn Model<f64>),
) -> Result<(), PlanError> {
    let holds = |group: &Content| names(model, *group).iter().any(|it| it.name == column);
    let Some(group) = groups().into_iter().find(holds) else {
        let all = names(model, Content::ALL);
        let near = did_you_mean(column, all.iter().map(|it| it.name.as_str()));
        let text = format!(
            "histories have no column `{column}`{near} The header of the history.csv of `mbd run` names them all"
        );
        return Err(wrong(setting, text));
    };
    content.state |= group.state;
    content.nodes |= group.nodes;
    content.lines |= group.lines;
    content.reactions |= group.reactions;
    content.outputs |= group.outputs;
    content.energy |= group.energy;
    Ok(())
}
