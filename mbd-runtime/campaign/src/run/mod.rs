//! How a scene is run: the settings as they are written, and what they mean for a scene.

pub(crate) mod names;
pub(crate) mod number;
pub(crate) mod plan;
mod settings;

pub use names::PlanError;
pub use plan::RunPlan;
pub use settings::{Settings, line_of, split};
