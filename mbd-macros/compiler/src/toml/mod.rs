//! Scenes in TOML, for people: the same words, the same units, the same checks as the text form.
//!
//! [`read`] turns a document into the items of [`crate::syntax`]; keys are the keywords, values are strings in the language of
//! `model!` (a bare number or list of numbers may stand without quotes). [`write`] turns a scene into such a document, [`declaration`] a document into
//! the text form, [`document`] the text form into a document.

mod comments;
mod declaration;
mod document;
mod forms;
mod formula;
mod read;
mod write;

pub use declaration::{toml_to_text, write_text};
pub use document::text_to_toml;
pub use read::{read_toml, read_toml_in};
pub use write::write_toml;
