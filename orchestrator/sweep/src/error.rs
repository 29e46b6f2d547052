//! Errors of sweeps.

use std::path::PathBuf;

/// Failure to store results, or to execute a sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file or directory of the results cannot be used. Results recorded before are kept.
    #[error("{}: {what}: {source}{}", path.display(), if_full(source))]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// Attempted operation.
        what: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Another sweep uses the directory.
    #[error("{}: another sweep uses the directory; wait for its end, or choose another --out", path.display())]
    InUse {
        /// The directory.
        path: PathBuf,
    },
    /// The results belong to another experiment, or to another version of it or of the program.
    #[error(
        "{} contains the results of another experiment: {difference}; \
         choose another --out, or remove the directory if its results are no longer needed",
        path.display()
    )]
    Other {
        /// The directory.
        path: PathBuf,
        /// Difference between the experiments.
        difference: String,
    },
    /// The directory contains files, but no results.
    #[error(
        "{} is not a directory of results: it has no {file}; {expected}",
        path.display()
    )]
    NotResults {
        /// The directory.
        path: PathBuf,
        /// Missing file.
        file: &'static str,
        /// Expected directory.
        expected: &'static str,
    },
    /// A file of the results has invalid content.
    #[error("{}:{line}: {what}: {found}: expected {expected}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Problem.
        what: String,
        /// Actual content.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// Two results of the same mission differ.
    #[error(
        "{}: two different results of {mission}: {difference}; \
         a result depends only on the experiment, so one of them was made by another \
         program: remove one of the two directories",
        path.display()
    )]
    Contradiction {
        /// Directory with the second result.
        path: PathBuf,
        /// Description of the mission.
        mission: String,
        /// Difference between the results.
        difference: String,
    },
    /// A figure cannot be drawn.
    #[error("figure `{name}`: {reason}")]
    Figure {
        /// Name of the figure.
        name: String,
        /// Reason.
        reason: String,
    },
    /// The operating system provides no thread or no signal handler.
    #[error("sweep: {what}{help}")]
    Resource {
        /// Problem.
        what: String,
        /// Suggested action, with a leading separator; empty if there is none.
        help: &'static str,
    },
}

impl SweepError {
    /// Returns a closure for `map_err`: wraps an error of the operating system with path and
    /// operation.
    pub(super) fn io<P: Into<PathBuf>>(
        path: P,
        what: &'static str,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, what, source }
    }
}

/// Suggested action for a full disk.
fn if_full(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind::{QuotaExceeded, StorageFull};
    match source.kind() {
        StorageFull | QuotaExceeded => {
            "; free disk space and repeat the command: recorded missions do not run again"
        }
        _ => "",
    }
}
