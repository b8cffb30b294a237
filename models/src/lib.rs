//! Ready scenes, the parachute with its report, and scenes that are not compiled in lanes.

pub mod in_lanes;
pub mod parachute;
pub mod scenes;

pub use mbd_campaign::progress;
pub use mbd_report as report;
pub use mbd_report::files;
