//! Errors of libraries: their tables, and their functions.

use runtime::declaration::DeclarationError;
use thiserror::Error;

/// A part of a table, or an argument of a call, that is not as expected.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{part}: expected {expected}")]
pub struct Unexpected {
    /// Name of the part, with its value.
    pub part: String,
    /// Description of an accepted part.
    pub expected: String,
}

impl Unexpected {
    /// Returns the error of a part.
    pub(crate) fn new(part: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            part: part.into(),
            expected: expected.into(),
        }
    }

    /// Prefixes the part with the one that contains it.
    pub(crate) fn within(self, part: &str) -> Self {
        Self::new(format!("{part}: {}", self.part), self.expected)
    }
}

/// Fault of the table of a library.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum TableError {
    /// A part of it.
    #[error(transparent)]
    Unexpected(#[from] Unexpected),
    /// A topic of a process.
    #[error(transparent)]
    Declaration(#[from] DeclarationError),
}

/// Reason why a planner or process in a library does not start, or cannot continue.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CallError {
    /// The parameters name no library.
    #[error("no library is loaded")]
    NoLibrary,
    /// The robot of the planner.
    #[error("the run has no robot {0}")]
    NoRobot(u32),
    /// The library reports it, in its own words.
    #[error("{0}")]
    Reported(String),
    /// A parameter, or an argument or result of a function.
    #[error(transparent)]
    Unexpected(#[from] Unexpected),
}
