//! Ready scenes, reports and the command line `mbd`.

pub mod report;
