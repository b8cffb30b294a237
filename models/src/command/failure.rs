//! Why a command did not succeed, and its exit code.

use std::fmt;

use super::mistakes::{Mistakes, Paint};

/// A command that did not succeed: the text is for the user.
#[derive(Debug)]
pub enum Failure {
    /// The command was not understood, or a file cannot be read or written.
    Usage(String),
    /// The scene or its params are invalid.
    Invalid(String),
    /// A scene file has mistakes.
    Mistakes(Mistakes),
    /// The scene is invalid; that is told on the standard output, for a program.
    Told(String),
    /// The run is less accurate than it should be, or a campaign does not show what is required: the whole result, for the standard output.
    Inaccurate(String),
    /// The run stopped before its end.
    Aborted(String),
}

impl Failure {
    /// The exit code of the process.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Usage(_) => 1,
            Failure::Invalid(_) | Failure::Mistakes(_) | Failure::Told(_) => 2,
            Failure::Inaccurate(_) => 3,
            Failure::Aborted(_) => 4,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Mistakes(mistakes) => f.write_str(&mistakes.text(Paint::Plain)),
            Failure::Usage(text)
            | Failure::Invalid(text)
            | Failure::Told(text)
            | Failure::Inaccurate(text)
            | Failure::Aborted(text) => f.write_str(text),
        }
    }
}

impl From<mbd_campaign::Failure> for Failure {
    fn from(failure: mbd_campaign::Failure) -> Self {
        match failure {
            mbd_campaign::Failure::Usage(text) => Failure::Usage(text),
            mbd_campaign::Failure::Invalid(text) => Failure::Invalid(text),
            mbd_campaign::Failure::NotMet(text) => Failure::Inaccurate(text),
            mbd_campaign::Failure::Aborted(text) => Failure::Aborted(text),
        }
    }
}
