//! Declarations and files as nobody means them: what is read ends soon, never panics, loses no item, and a failure has a place.
//!
//! A case is known by its number alone, so that one that breaks a promise can be looked at again.

mod items;
mod large;
mod mutate;
pub mod random_scene;
mod verdict;

pub use items::{declared_in_text, declared_in_toml, resolved};
pub use large::{LARGE, large_file};
pub use mutate::{Corpus, Form, Input};
pub use verdict::{SLOWEST, Tally, Verdict, judge, memory};
