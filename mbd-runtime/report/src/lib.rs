//! Pictures and reports: what a run leaves behind for people.
//!
//! - [`report()`] is the page of a run of your own model, in one call.
//! - [`Figure`] draws line plots as SVG: axes with units, legend, several [`Series`] that stay apart in black and white.
//! - [`Drawing`] draws a mechanism at several instants, with equal scales on both axes.
//! - [`ReportTable`] is one table for the terminal, the report and a CSV file.
//! - [`Report`] is one HTML file that needs no network; with a [`Playback`] it shows the run as it moves.
//! - [`gltf()`] is a run as an animated glTF file, for viewers and Blender.
//! - [`Spectrum`] says which frequencies a history contains.
//!
//! Everything here is a pure function of its input: the same data give the same bytes.

mod axis;
mod band;
mod compared;
mod drawing;
mod drawn;
mod figure;
pub mod files;
mod film;
mod gltf;
mod html;
mod live;
mod loads;
mod look;
mod mechanism;
mod metrics;
mod motion;
mod number;
mod of_run;
mod packing;
mod playback;
mod plot;
mod plots;
mod series;
mod spectrum;
mod stage;
mod surface;
mod svg;
mod table;
mod thin;
mod trace;
mod views;

pub use compared::Compared;
pub use drawing::{Drawing, DrawingPart};
pub use figure::Figure;
pub use gltf::gltf;
pub use html::Report;
pub use look::Look;
pub use mbd_runtime::scene::significant;
pub use mechanism::drawings;
pub use metrics::metrics_table;
pub use motion::RecordedMotion;
pub use of_run::{report, with_run};
pub use playback::Playback;
pub use plots::{PlotGroup, groups};
pub use series::Series;
pub use spectrum::{Peak, Spectrum};
pub use table::{Cell, ReportTable};
pub use views::{Run, Views};
