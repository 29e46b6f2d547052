//! Files made from a log; they never replace the log.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use platform::atomic_file::{AtomicFile, ExistingFile, Readers};
use platform::file_kind::FileKind;
use platform::presence;

use crate::LogReadError;

/// Error of making a file from a log.
#[derive(Debug, thiserror::Error)]
pub enum DerivedError {
    /// The log cannot be read, or the user interrupted the command.
    #[error("{}{}", .0, if matches!(.0, LogReadError::Interrupted) { "; nothing was written" } else { "" })]
    Log(#[from] LogReadError),
    /// The output file exists already.
    #[error("{} exists already; choose another name with --out or overwrite it with --force", path.display())]
    Exists {
        /// The file or directory.
        path: PathBuf,
    },
    /// The output would replace the log.
    #[error("{} is the log itself; choose another name with --out", path.display())]
    IsTheLog {
        /// The log.
        path: PathBuf,
    },
    /// The output could not be created.
    #[error("{}: cannot be created: {source}", path.display())]
    Create {
        /// The file or directory.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The output could not be written; a file that existed before is unchanged.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system or of the writer.
        source: io::Error,
    },
}

/// Creates an empty file for `path`, to be filled with data made from `log`.
///
/// # Errors
/// [`DerivedError::IsTheLog`]; [`DerivedError::Exists`] without `force` if the file exists;
/// [`DerivedError::Create`].
pub fn create(
    path: &Path,
    log: &Path,
    force: bool,
    readers: Readers,
) -> Result<AtomicFile, DerivedError> {
    if presence::is_same(path, log).map_err(refused(path))? {
        // The page of a page would replace it, too.
        return Err(
            match FileKind::from_path(log).filter(|kind| *kind != FileKind::Log) {
                Some(kind) => DerivedError::Log(LogReadError::NotMcap {
                    path: log.to_owned(),
                    kind: Some(kind),
                }),
                None => DerivedError::IsTheLog {
                    path: path.to_owned(),
                },
            },
        );
    }
    AtomicFile::create(path, ExistingFile::of_force(force), readers).map_err(refused(path))
}

/// Writes a file made from `log`, completely or not at all.
///
/// # Errors
/// As [`create`]; [`DerivedError::Write`].
pub fn write(
    bytes: &[u8],
    path: &Path,
    log: &Path,
    force: bool,
    readers: Readers,
) -> Result<(), DerivedError> {
    let mut file = create(path, log, force, readers)?;
    file.write_all(bytes).map_err(failed(path))?;
    file.commit().map_err(failed(path))
}

/// Returns the constructor of the error of a file or directory that cannot be created.
pub fn refused(path: &Path) -> impl Fn(io::Error) -> DerivedError {
    exists_or(path, |path, source| DerivedError::Create { path, source })
}

/// Returns the constructor of the error of a file that cannot be written.
pub fn failed(path: &Path) -> impl Fn(io::Error) -> DerivedError {
    exists_or(path, |path, source| DerivedError::Write { path, source })
}

fn exists_or(
    path: &Path,
    other: fn(PathBuf, io::Error) -> DerivedError,
) -> impl Fn(io::Error) -> DerivedError {
    let path = path.to_owned();
    move |source| match source.kind() {
        io::ErrorKind::AlreadyExists => DerivedError::Exists { path: path.clone() },
        _ => other(path.clone(), source),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn save(text: &str, path: &Path, log: &Path, force: bool) -> Result<(), DerivedError> {
        write(text.as_bytes(), path, log, force, Readers::All)
    }

    #[test]
    fn an_existing_file_is_replaced_only_with_force_and_the_log_never() {
        let folder = tempfile::tempdir().unwrap();
        let (log, path) = (folder.path().join("a.mcap"), folder.path().join("a.svg"));
        fs::write(&log, "log").unwrap();
        save("one", &path, &log, false).unwrap();
        let error = save("two", &path, &log, false).unwrap_err();
        assert!(error.to_string().contains("exists already"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        save("two", &path, &log, true).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        let error = save("svg", &log, &log, true).unwrap_err();
        assert!(error.to_string().contains("is the log itself"), "{error}");
        assert_eq!(fs::read_to_string(&log).unwrap(), "log");
    }

    #[test]
    fn a_failed_write_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("a.mcap");
        let missing = folder.path().join("no/such/a.svg");
        let error = save("svg", &missing, &log, false).unwrap_err();
        assert!(matches!(error, DerivedError::Create { .. }), "{error}");
        // A directory exists at the path of the file.
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(save("svg", &taken, &log, true).is_err());
        let names: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(names, ["taken"]);
    }
}
