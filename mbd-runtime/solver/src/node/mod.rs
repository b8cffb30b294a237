//! Nodes: massless points where lines meet, placed where the forces of their lines balance.
//!
//! - [`Nodes`] runs the nodes of a model inside an integration: start, solve at a stage, commit after an accepted step, switch at an event.
//! - [`NodeMemory`] is what they carry from step to step.
//! - [`Solver`] is the fallback chain behind `static` and `stepwise` nodes; [`RateNode`] the law of `rate` nodes.
//! - [`Tied`] is an equilibrium problem of its own, without a scene.
//! - [`BlockCholesky`] is the sparse factor of coupled nodes.
//!
//! Source: B. Raiszadeh, AAS 03-163 (2003); convexity, uniqueness, damping and rank are worked out in the files that use them.

mod balance;
pub(crate) mod eigen;
mod error;
mod factor;
mod memory;
mod modes;
mod one;
mod rate;
mod rates;
mod scene;
mod solver;
mod stage;
mod start;
mod stepwise;
pub(crate) mod warm;

pub(crate) use balance::triple;
pub use balance::{Balance, BalanceEvaluation, Tie, Tied};
pub use error::{NodeError, UNEVEN, Uneven};
pub use factor::{Block, BlockCholesky};
pub use memory::NodeMemory;
pub use rate::{Crossing, Leg, RateNode, RateOutcome};
pub(crate) use rate::{inverse, projection, spanned};
pub(crate) use scene::{NetworkPlan, own_anchors};
pub(crate) use solver::WARM_STEPS;
pub use solver::{Outcome, Solver, Strategy, Tolerance};
pub use stage::{NodeStatistics, Nodes, Stage};
pub(crate) use stepwise::RateFormula;
pub use stepwise::{History, effective};
