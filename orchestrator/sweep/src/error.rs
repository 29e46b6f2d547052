//! Why a sweep cannot go on.

use std::path::PathBuf;

/// Why results cannot be kept, or a sweep not be carried out.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file or directory of the results cannot be used. What was recorded before is kept.
    #[error("{}: {what}: {source}{}", path.display(), if_full(source))]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What was attempted.
        what: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// Another sweep is at work in the directory.
    #[error("{}: another sweep is at work there; wait for its end, or choose another --out", path.display())]
    InUse {
        /// The directory.
        path: PathBuf,
    },
    /// The results are of another experiment, or of another version of it or of the program.
    #[error(
        "{} holds the results of another experiment: {difference}; \
         choose another --out, or remove the directory if its results are not needed any more",
        path.display()
    )]
    Other {
        /// The directory.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// The directory holds something, but no results.
    #[error(
        "{} is not a directory of results: it has no {file}; {expected}",
        path.display()
    )]
    NotResults {
        /// The directory.
        path: PathBuf,
        /// What is missing.
        file: &'static str,
        /// What to name instead.
        expected: &'static str,
    },
    /// A file of the results does not hold what it should.
    #[error("{}:{line}: {what}: {found}; expected {expected}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
        /// What is there.
        found: String,
        /// What should be there.
        expected: &'static str,
    },
    /// Two results of the same mission differ.
    #[error(
        "{}: two different results of {mission}: {difference}; \
         a mission's result follows from the experiment alone, so one of them was made by another \
         program: remove one of the two directories",
        path.display()
    )]
    Contradiction {
        /// The directory with the second result.
        path: PathBuf,
        /// The mission in words.
        mission: String,
        /// What differs.
        difference: String,
    },
    /// A figure cannot be drawn.
    #[error("figure `{name}`: {reason}")]
    Figure {
        /// Its name.
        name: String,
        /// Why not.
        reason: String,
    },
    /// The system grants no thread or no signal handler.
    #[error("sweep: {what}{help}")]
    Resource {
        /// What went wrong.
        what: String,
        /// What to do about it, from the separator on; empty if nothing.
        help: &'static str,
    },
}

impl SweepError {
    /// For `map_err`: an error of the system while something was attempted with a file.
    pub(super) fn io<P: Into<PathBuf>>(
        path: P,
        what: &'static str,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, what, source }
    }
}

/// What to do when there is no room.
fn if_full(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind::{QuotaExceeded, StorageFull};
    match source.kind() {
        StorageFull | QuotaExceeded => {
            "; what is done is kept: make room and give the same command again"
        }
        _ => "",
    }
}
