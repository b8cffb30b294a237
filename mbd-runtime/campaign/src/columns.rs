//! Which columns histories have to hold, so that what is asked of them can be read.

use mbd_runtime::scene::similar::did_you_mean;
use mbd_runtime::{Content, Joined, Model, Name, Sampling, Trajectory};

use crate::run::PlanError;
use crate::run::names::{column_name, no_coordinate, wrong};

/// The models that a run comes to.
pub type Models<'m> = [&'m dyn Model<f64>];

/// The columns of a history with this content, of a run that comes to these models.
pub fn names(models: &Models<'_>, content: Content) -> Vec<Name> {
    let empty = |model: &&dyn Model<f64>| Trajectory::new(*model, Sampling::Steps, content);
    match models {
        [alone] => empty(alone).names().to_vec(),
        models => joined(models, content).names().to_vec(),
    }
}

/// The columns of several models together.
pub fn joined(models: &Models<'_>, content: Content) -> Joined {
    let empty = |model: &&dyn Model<f64>| Trajectory::new(*model, Sampling::Steps, content);
    let histories: Vec<Trajectory> = models.iter().map(empty).collect();
    Joined::new(&histories.iter().collect::<Vec<_>>())
}

/// The models whose histories with this content have a column, by its place in [`names`]; that of time all of them.
pub fn models_with(models: &Models<'_>, content: Content, column: usize) -> Vec<usize> {
    match models {
        [_] => vec![0],
        models => {
            let all = joined(models, content);
            (0..models.len())
                .filter(|model| all.has(*model, column))
                .collect()
        }
    }
}

/// Has histories hold a column; `setting` asks for it.
///
/// # Errors
/// No history of the models has it.
pub fn include(
    content: &mut Content,
    column: &str,
    (setting, models): (&str, &Models<'_>),
) -> Result<(), PlanError> {
    let name = column_name(column);
    let holds = |group: &Content| names(models, *group).iter().any(|it| it.name == name);
    let Some(group) = Content::ALL.groups().find(holds) else {
        let coordinate = |model: &&dyn Model<f64>| model.scene().joint_coordinate(column);
        if models.iter().any(|model| coordinate(model).is_some()) {
            return Err(wrong(setting, no_coordinate(column)));
        }
        let all = names(models, Content::ALL);
        let near = did_you_mean(column, all.iter().map(|it| it.name.as_str()));
        let near = if near.is_empty() { "." } else { &near };
        let text = format!(
            "histories have no column `{column}`{near} The header of the history.csv of `mbd run` names them all"
        );
        return Err(wrong(setting, text));
    };
    *content = content.and(group);
    Ok(())
}
