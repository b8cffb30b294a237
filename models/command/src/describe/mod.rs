//! What a scene contains, as tables: for `mbd check` and for the first page of a report.

mod counts;
mod metrics;
mod operations;
mod things;

pub use counts::{counts, warnings_of_reactions};
pub use metrics::{metric_json, metrics};
pub use operations::operations;
pub use things::{factor, node_model, params, things};

#[cfg(test)]
mod tests;
