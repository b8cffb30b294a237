//! What is said of the cases of a campaign: by counting; what is fitted, an ellipse, is told with its count.

mod binomial;
mod ellipse;
mod indices;
mod order;
mod ranks;

pub use binomial::at_most;
pub use ellipse::{Ellipse, Spot};
pub use indices::first_order;
pub use order::{Percentile, cases_needed, percentile, quantile, rank_above, rank_below, shows};
pub use ranks::{spearman, spearman_of_all};
