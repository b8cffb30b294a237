//! Campaigns of runs: what is dispersed, what is read from every run, shards on any number of machines, statistics, and the command line of a user's
//! own compiled model.
//!
//! | to … | use |
//! |---|---|
//! | give your model a command line: `list`, `run`, `campaign`, `gather`, `report` | [`main`] |
//! | read a campaign file for a model | [`Campaign::read`] |
//! | run a shard of it into a folder, put the folder together | [`blocks::run`], [`blocks::gather`] |
//! | read the results and what they say | [`Results`], [`CampaignSummary`] |
//! | say how a scene is run: the table `[run]` | [`run::Settings`], [`run::RunPlan`] |
//!
//! Many runs without files are a [`mbd_runtime::Batch`]. The page `docs/campaigns.md` has the campaign file, and how clusters run it.

pub mod blocks;
mod campaign;
mod columns;
mod command;
pub mod dispersion;
pub mod envelopes;
mod failure;
mod footprint;
pub mod histories;
mod manifest;
mod metric;
mod page;
mod parquet;
pub mod phases;
pub mod progress;
mod results;
pub mod run;
pub mod sampling;
pub mod statistics;
mod summary;
mod table;

pub use blocks::Shard;
pub use campaign::{Campaign, FlownCase, Resources};
pub use command::{CampaignArgs, GatherArgs, ResultSource, campaign, gather, main, report, text};
pub use failure::Failure;
pub use footprint::{Footprint, FootprintStatistics};
pub use manifest::{Manifest, ResultColumn, ResultOptions};
pub use metric::{CampaignMetric, Metrics, Requirement};
pub use results::{CaseRow, LARGE_ERROR, Results};
pub use summary::{
    CONFIDENCE, CampaignSummary, Companion, CutWindow, Failures, MetricDriver, MissingReason,
    PARTS, RequirementVerdict, Told,
};
