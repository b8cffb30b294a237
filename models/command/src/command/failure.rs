//! Why a command did not succeed, and its exit code.

use std::fmt;

use super::mistakes::{Mistakes, Paint};

/// A command that did not succeed: the text is for the user.
#[derive(Debug)]
pub enum CommandFailure {
    /// The command was not understood, or a file cannot be read or written.
    Usage(String),
    /// The scene or its params are invalid.
    Invalid(String),
    /// A scene file has mistakes.
    Mistakes(Box<Mistakes>),
    /// The scene is invalid; that is told on the standard output, for a program.
    Told(String),
    /// The run is less accurate than it should be, or a campaign does not show what is required: the whole result, for the standard output.
    Inaccurate(String),
    /// The run stopped before its end.
    Aborted(String),
}

impl CommandFailure {
    /// The exit code of the process.
    pub fn code(&self) -> u8 {
        match self {
            CommandFailure::Usage(_) => 1,
            CommandFailure::Invalid(_) | CommandFailure::Mistakes(_) | CommandFailure::Told(_) => 2,
            CommandFailure::Inaccurate(_) => 3,
            CommandFailure::Aborted(_) => 4,
        }
    }
}

impl fmt::Display for CommandFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            CommandFailure::Mistakes(mistakes) => f.write_str(&mistakes.text(Paint::Plain)),
            CommandFailure::Usage(text)
            | CommandFailure::Invalid(text)
            | CommandFailure::Told(text)
            | CommandFailure::Inaccurate(text)
            | CommandFailure::Aborted(text) => f.write_str(text),
        }
    }
}

impl From<mbd_campaign::Failure> for CommandFailure {
    fn from(failure: mbd_campaign::Failure) -> Self {
        match failure {
            mbd_campaign::Failure::Usage(text) => CommandFailure::Usage(text),
            mbd_campaign::Failure::Invalid(text) => CommandFailure::Invalid(text),
            mbd_campaign::Failure::NotMet(text) => CommandFailure::Inaccurate(text),
            mbd_campaign::Failure::Aborted(text) => CommandFailure::Aborted(text),
        }
    }
}
