//! Files that are there whole or not at all.

use std::fs::Permissions;
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What a file that takes its place does with one that is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// It stays: the new one is an error.
    Keep,
    /// It is replaced.
    Replace,
}

impl Existing {
    /// [`Existing::Replace`] with `--force`.
    pub fn of_force(force: bool) -> Self {
        if force { Self::Replace } else { Self::Keep }
    }
}

/// Who may read a new file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readers {
    /// This user only: the scenario in a log holds the keys of its patrols.
    Owner,
    /// Those whom the user's umask lets.
    Anybody,
}

/// A file that takes its place when it is complete; until then, and if it never is, what was there
/// stays. What is written is in a temporary file beside it.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    existing: Existing,
    file: NamedTempFile,
}

impl AtomicFile {
    /// An empty file that is to stand at `path`, in a folder that is there.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if a file is there that is to be kept; what the system said if
    /// the folder cannot be written.
    pub fn create(path: &Path, existing: Existing, readers: Readers) -> io::Result<Self> {
        if existing == Existing::Keep && path.symlink_metadata().is_ok() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        let file = tempfile::Builder::new()
            .prefix(".protean-")
            // The system takes away what the user's umask forbids.
            .permissions(Permissions::from_mode(match readers {
                Readers::Owner => 0o600,
                Readers::Anybody => 0o666,
            }))
            .tempfile_in(folder_of(path))?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            file,
        })
    }

    /// Bytes written so far.
    ///
    /// # Errors
    /// What the system said.
    pub fn size(&self) -> io::Result<u64> {
        Ok(self.file.as_file().metadata()?.len())
    }

    /// Puts the complete file in its place in one step.
    ///
    /// # Errors
    /// As [`AtomicFile::create`].
    pub fn commit(self) -> io::Result<()> {
        self.file.as_file().sync_all()?;
        match self.existing {
            Existing::Replace => self.file.persist(&self.path),
            Existing::Keep => self.file.persist_noclobber(&self.path),
        }?;
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Why a file could not be written; what was at its place before is untouched.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct SaveError {
    /// The file.
    pub path: PathBuf,
    /// What the operating system said.
    pub source: io::Error,
}

/// Writes a file in place of what may be there. Folders that are missing are made.
///
/// # Errors
/// [`SaveError`].
pub fn save(bytes: &[u8], path: &Path) -> Result<(), SaveError> {
    let write = || {
        std::fs::create_dir_all(folder_of(path))?;
        let mut file = AtomicFile::create(path, Existing::Replace, Readers::Anybody)?;
        file.write_all(bytes)?;
        file.commit()
    };
    write().map_err(|source| SaveError {
        path: path.to_owned(),
        source,
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn a_file_is_there_when_it_is_committed_and_not_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let create = |existing| AtomicFile::create(&path, existing, Readers::Owner);
        let mut file = create(Existing::Keep).unwrap();
        file.write_all(b"one").unwrap();
        assert!(!path.exists());
        file.commit().unwrap();
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o600
        );
        let refused = create(Existing::Keep).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        let mut file = create(Existing::Replace).unwrap();
        file.write_all(b"two").unwrap();
        drop(file);
        assert_eq!(fs::read(&path).unwrap(), b"one", "never committed");
        assert_eq!(names(folder.path()), ["a"], "nothing beside");
    }

    #[test]
    fn a_file_that_came_meanwhile_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let file = AtomicFile::create(&path, Existing::Keep, Readers::Anybody).unwrap();
        fs::write(&path, "theirs").unwrap();
        let refused = file.commit().unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"theirs");
    }

    #[test]
    fn folders_are_made_and_files_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/c.txt");
        save(b"one", &path).unwrap();
        save(b"two", &path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(path.parent().unwrap()), ["c.txt"], "nothing beside");
    }

    #[test]
    fn what_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::create_dir(&path).unwrap();
        let error = save(b"x", &path).unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(names(folder.path()), ["taken"], "nothing beside");
    }
}
