//! The repository itself: what its pages promise a reader, and what its crates stand on.

mod dependencies;
mod names;
mod pages;
mod robots;
