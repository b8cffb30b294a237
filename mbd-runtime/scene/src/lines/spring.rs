//! A spring: f = K s, tension and compression.

use crate::lines::LineLaw;

/// f = K s, both ways.
pub struct Spring;

impl LineLaw for Spring {
    fn word(&self) -> &'static str {
        "spring"
    }

    fn is_unilateral(&self) -> bool {
        false
    }

    fn not_at_node(&self) -> Option<&'static str> {
        Some("where pushing springs have no unique balance: use `line`")
    }
}
