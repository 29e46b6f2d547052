//! Error of an import.

use std::io;
use std::path::{Path, PathBuf};

/// Reason why a file cannot be imported.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// A file is missing or unreadable.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file's extension does not determine its format.
    #[error("{}: unknown kind of file: expected {}", path.display(), list())]
    Kind {
        /// The file.
        path: PathBuf,
    },
    /// A line is invalid.
    #[error("{}, line {line}: {found}: expected {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Actual text.
        found: String,
        /// Expected text.
        expected: String,
    },
    /// The file is not XML.
    #[error("{}: {source}", path.display())]
    Xml {
        /// The file.
        path: PathBuf,
        /// Error and position.
        source: roxmltree::Error,
    },
    /// The file as a whole cannot become a scenario.
    #[error("{}: {found}: expected {expected}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Fault.
        found: String,
        /// Expected content.
        expected: String,
    },
}

impl ImportError {
    pub(crate) fn line(path: &Path, line: usize, found: &str, expected: &str) -> Self {
        const MAX_SHOWN: usize = 60;
        Self::Line {
            path: path.to_owned(),
            line,
            found: format!("{:?}", found.chars().take(MAX_SHOWN).collect::<String>()),
            expected: expected.to_owned(),
        }
    }

    pub(crate) fn content(
        path: &Path,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Content {
            path: path.to_owned(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

fn list() -> String {
    let names: Vec<String> = super::EXTENSIONS
        .iter()
        .map(|extension| format!(".{extension}"))
        .collect();
    names.join(", ")
}
