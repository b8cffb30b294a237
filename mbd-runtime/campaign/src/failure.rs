//! Why a command did not succeed, and its exit code.

use std::fmt;
use std::io;

/// A command that did not succeed: the text is for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The command was not understood, or a file cannot be read or written.
    Usage(String),
    /// The model, its params or the campaign file are invalid.
    Invalid(String),
    /// A requirement is not met, or not shown: the whole result, for the standard output.
    NotMet(String),
    /// A run stopped before its end.
    Aborted(String),
}

impl Failure {
    /// The exit code of the process.
    #[must_use]
    pub fn code(&self) -> u8 {
        match self {
            Failure::Usage(_) => 1,
            Failure::Invalid(_) => 2,
            Failure::NotMet(_) => 3,
            Failure::Aborted(_) => 4,
        }
    }

    /// A file that cannot be written; the error names it.
    #[must_use]
    pub fn unwritten(error: &io::Error) -> Self {
        Failure::Usage(format!("cannot write {error}"))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Usage(text)
            | Failure::Invalid(text)
            | Failure::NotMet(text)
            | Failure::Aborted(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for Failure {}
