//! The two conventions of angular velocity.

use serde::{Deserialize, Serialize};

/// The components in which the state carries angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum AngularVelocity {
    /// Along the body's own axes: constant mass matrix.
    #[default]
    Body,
    /// Along world axes: mass matrix R I′ Rᵀ.
    World,
}
