//! Messages of resolving.

mod bodies;
mod events;
mod items;
mod joints;
mod loads;
mod locks;
mod metrics;
mod names;
mod next;
mod origin;
mod tables;
mod values;

pub use bodies::*;
pub use events::*;
pub use items::*;
pub use joints::*;
pub use loads::*;
pub use locks::*;
pub use metrics::*;
pub use names::*;
pub use next::*;
pub use origin::*;
pub use tables::*;
pub use values::*;
