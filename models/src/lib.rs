//! Ready scenes, reports and what the command line `mbd` is made of.

pub mod advice;
pub mod describe;
pub mod extremes;
pub mod in_lanes;
pub mod parachute;
pub mod quantities;
pub mod run;
pub mod scenes;
pub mod trade;

pub use mbd_campaign::progress;
pub use mbd_report as report;
pub use mbd_report::files;
