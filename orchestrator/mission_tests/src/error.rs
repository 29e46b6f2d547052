//! Errors of tests beside those of their files.

use std::path::PathBuf;

/// Failure to run tests, or to write their results.
#[derive(Debug, thiserror::Error)]
pub enum TestError {
    /// A file or directory cannot be used.
    #[error("{}: {what}: {source}", path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// Attempted operation.
        what: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A baseline is not the output of `protean test --json`.
    #[error("{}: not a baseline: {source}: expected the output of `protean test --json`", path.display())]
    Baseline {
        /// The file.
        path: PathBuf,
        /// Problem, with line and column.
        source: serde_json::Error,
    },
    /// The threads of the missions cannot be started.
    #[error(transparent)]
    Threads(#[from] sweep::SweepError),
    /// A test file changed during the run.
    #[error("{}: the file changed during the tests; repeat the command", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
}

impl TestError {
    /// Returns a closure for `map_err`: wraps an error of the operating system with path and operation.
    pub fn io<P: Into<PathBuf>>(
        path: P,
        what: &'static str,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, what, source }
    }
}
