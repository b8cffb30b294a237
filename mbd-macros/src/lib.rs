//! The procedural macro `model!`.
