//! A log that takes the place of an older file: not before its run has begun.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};

use super::error::LogError;

/// Added to a log's name until it takes its place.
const PARTIAL: &str = ".partial";

/// The place that a log will take. Until then the log is written beside the older file, and if it
/// never takes the place it is removed.
#[derive(Debug)]
pub(super) struct Replacement {
    partial: PathBuf,
    path: PathBuf,
    /// Open for its lock only: until it is replaced, no other run may want the same place.
    _older: File,
    done: bool,
}

impl Replacement {
    /// Of `older`, the locked file at `path`, by the log that `write` opens at the place that it is
    /// given.
    ///
    /// # Errors
    /// As `write`, and [`LogError::Create`] if the older file cannot be found any more.
    pub(super) fn of(
        path: &Path,
        older: File,
        write: impl FnOnce(&Path) -> Result<File, LogError>,
    ) -> Result<(File, Self), LogError> {
        // Behind a symbolic link stands the file that is meant.
        let path = path.canonicalize().map_err(|source| LogError::Create {
            path: path.to_owned(),
            source,
        })?;
        let mut partial = OsString::from(&path);
        partial.push(PARTIAL);
        let partial = PathBuf::from(partial);
        // Only what was opened here may be removed later.
        let file = write(&partial)?;
        let replacement = Self {
            partial,
            path,
            _older: older,
            done: false,
        };
        Ok((file, replacement))
    }

    /// Puts the log in the older file's place, in one step.
    ///
    /// # Errors
    /// [`LogError::Replace`]; the older file then stays, and the log is removed.
    pub(super) fn take_place(mut self) -> Result<(), LogError> {
        std::fs::rename(&self.partial, &self.path).map_err(|source| LogError::Replace {
            path: self.path.clone(),
            source,
        })?;
        self.done = true;
        Ok(())
    }
}

impl Drop for Replacement {
    fn drop(&mut self) {
        if !self.done {
            // What stays for want of permission is told from a log by its name.
            let _ = std::fs::remove_file(&self.partial);
        }
    }
}
