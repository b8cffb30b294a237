//! Running a scene that was read from a file: what is asked ([`Plan`]), the run itself ([`Outcome`]), and what it leaves behind.

mod outcome;
mod plan;
mod publish;
mod settings;

pub use outcome::{Outcome, fly};
pub use plan::{Plan, PlanError};
pub use publish::{publish, summary_json};
pub use settings::{Settings, split};

#[cfg(test)]
mod tests;
