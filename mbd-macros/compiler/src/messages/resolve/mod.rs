//! Messages of resolving.

mod items;
mod joints;
mod metrics;
mod names;
mod origin;
mod tables;
mod values;

pub use items::*;
pub use joints::*;
pub use metrics::*;
pub use names::*;
pub use origin::*;
pub use tables::*;
pub use values::*;
