//! What is said of the cases of a campaign: by counting, never by fitting.

mod binomial;
mod indices;
mod order;
mod ranks;

pub use binomial::at_most;
pub use indices::first_order;
pub use order::{Percentile, cases_needed, percentile, rank_above, rank_below, shows};
pub use ranks::spearman;
