//! Messages of resolving.

mod items;
mod names;
mod values;

pub use items::*;
pub use names::*;
pub use values::*;
