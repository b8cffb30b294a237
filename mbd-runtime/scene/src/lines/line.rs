//! A linear line: f = K s, tension only. Stops and the lines of equilibrium points follow it, too.

use crate::lines::LineLaw;

/// f = K s, as a law is unless it says otherwise.
pub struct LinearLine;

impl LineLaw for LinearLine {}
