//! Messages of resolving.

mod items;
mod joints;
mod locks;
mod metrics;
mod names;
mod next;
mod origin;
mod tables;
mod values;

pub use items::*;
pub use joints::*;
pub use locks::*;
pub use metrics::*;
pub use names::*;
pub use next::*;
pub use origin::*;
pub use tables::*;
pub use values::*;
