//! Running a scene: what is asked ([`RunPlan`]), the run itself ([`RunOutcome`]), how well it kept its laws ([`Quality`]), and what it leaves behind.

mod estimate;
mod metrics;
mod outcome;
mod phases;
mod publish;
mod publish_phases;
mod quality;
mod singular;
mod start;
mod summary;

pub use estimate::{Estimate, Unestimated, doubt, doubt_of_all, short_of_digits};
pub use mbd_campaign::run::{
    CampaignMistakes, Phase, PlanError, RunPlan, Settings, SettingsError, line_of, misnamed_table,
    split,
};
pub use metrics::{cut_of_campaign, cut_windows, metrics, windows};
pub use outcome::{RunOutcome, fly, fly_measuring, fly_model};
pub use phases::{PhasedRun, Segment, fly_phases};
pub use publish::{publish, publish_gltf, shown};
pub use publish_phases::{cut_windows_of_all, publish_phases, summary as phases_json};
pub use quality::{Quality, not_finite};
pub use singular::regularised;
pub use start::{warning, warning_before, warning_of, warning_of_handover, warnings_of_unkept};
pub use summary::summary_json;

#[cfg(test)]
mod tests;
