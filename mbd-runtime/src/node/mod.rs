//! Nodes: massless points where lines meet, placed where the forces of their lines balance.
//!
//! - [`Nodes`] runs the nodes of a model inside an integration: start, solve at a stage, commit after an accepted step, switch at an event.
//! - [`NodeMemory`] is what they carry from step to step.
//! - [`Solver`] is the fallback chain behind `static` and `stepwise` nodes; [`RateNode`] the law of `rate` nodes.
//! - [`Confluence`] and [`Web`] are equilibrium problems of their own, without a scene.
//! - [`BlockCholesky`] is the sparse factor of coupled nodes.
//!
//! Source: B. Raiszadeh, AAS 03-163 (2003); convexity, uniqueness, damping and rank are worked out in the files that use them.

mod balance;
mod confluence;
mod eigen;
mod error;
mod factor;
mod memory;
mod modes;
mod rate;
mod scene;
mod solver;
mod stage;
mod start;
mod stepwise;

pub use balance::{Balance, Evaluation};
pub use confluence::{Confluence, Equilibrium, Tie, Web, WebBalance, WebLine};
pub use eigen::eigen;
pub use error::NodeError;
pub use factor::{Block, BlockCholesky};
pub use memory::{Mode, NodeMemory};
pub use modes::Guard;
pub(crate) use modes::{is_node_line, switches};
pub use rate::{Leg, RateNode, Spread};
pub use solver::{Outcome, Solver, Strategy, Tolerance};
pub use stage::{Nodes, Statistics};
pub use stepwise::{History, effective};
