//! New files that are there whole or not at all.

use std::fs::Permissions;
use std::io;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::error::LogsError;

/// Who may read a new file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Readers {
    /// This user only: the scenario in a log holds the keys of its patrols.
    Owner,
    /// Whom the user's umask lets.
    Anybody,
}

/// A file that takes its place when it is complete; until then, and if it never is, whatever was
/// there stays.
#[derive(Debug)]
pub(crate) struct Place {
    path: PathBuf,
    force: bool,
}

impl Place {
    /// Beside `path`, where nothing may be without `force`; `log`, from which the file is made, is
    /// never replaced.
    pub(crate) fn new(
        path: &Path,
        log: &Path,
        force: bool,
        readers: Readers,
    ) -> Result<(Self, NamedTempFile), LogsError> {
        if let (Ok(a), Ok(b)) = (path.canonicalize(), log.canonicalize())
            && a == b
        {
            return Err(LogsError::IsTheLog { path: a });
        }
        let place = Self {
            path: path.to_owned(),
            force,
        };
        if !force && path.symlink_metadata().is_ok() {
            return Err(place.exists());
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = tempfile::Builder::new()
            .prefix(".protean-log-")
            // The system takes away what the user's umask forbids.
            .permissions(Permissions::from_mode(match readers {
                Readers::Owner => 0o600,
                Readers::Anybody => 0o666,
            }))
            .tempfile_in(folder)
            .map_err(|e| place.failed(e))?;
        Ok((place, file))
    }

    pub(crate) fn failed(&self, source: io::Error) -> LogsError {
        LogsError::Write {
            path: self.path.clone(),
            source,
        }
    }

    fn exists(&self) -> LogsError {
        LogsError::Exists {
            path: self.path.clone(),
        }
    }

    /// Puts the complete file there in one step.
    pub(crate) fn take(&self, file: NamedTempFile) -> Result<(), LogsError> {
        file.as_file().sync_all().map_err(|e| self.failed(e))?;
        let placed = if self.force {
            file.persist(&self.path)
        } else {
            file.persist_noclobber(&self.path)
        };
        match placed {
            Ok(_) => Ok(()),
            Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => Err(self.exists()),
            Err(e) => Err(self.failed(e.error)),
        }
    }
}
