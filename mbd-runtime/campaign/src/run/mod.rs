//! How a scene is run: the settings as they are written, and what they mean for a scene.

mod mistakes;
pub(crate) mod names;
pub(crate) mod number;
mod phases;
pub(crate) mod plan;
mod scales;
mod settings;
pub(crate) mod words;

pub use mistakes::CampaignMistakes;
pub use names::PlanError;
pub(crate) use phases::always_mapped;
pub use phases::{GivenSettings, GoingRun, Phase, fly_in_turn, go_on, settings_of_all};
pub use plan::{RunPlan, check_units};
pub use settings::{Settings, SettingsError, line_of, misnamed_table, split};
pub(crate) use settings::{belongs_to_the_run, unknown_field};
