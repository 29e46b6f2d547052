//! Files that are written completely or not at all.

use std::fs::Permissions;
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::presence;

/// The action for a file that exists already at the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Keep it and report an error.
    Keep,
    /// Replace it.
    Replace,
}

impl Existing {
    /// Returns [`Existing::Replace`] if `force` is set, else [`Existing::Keep`].
    pub fn of_force(force: bool) -> Self {
        if force { Self::Replace } else { Self::Keep }
    }
}

/// Read permission of a new file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Readers {
    /// The owner only: the scenario in a log contains the keys of its patrols.
    Owner,
    /// All users that the umask permits.
    All,
}

/// A file that appears at its path when it is committed. Until then the data are in a temporary file beside
/// it, and an existing file stays unchanged.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    existing: Existing,
    file: NamedTempFile,
}

impl AtomicFile {
    /// Creates an empty file for `path`, whose directory must exist.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if a file exists that is to be kept; the error of the operating
    /// system if the directory is not writable.
    pub fn create(path: &Path, existing: Existing, readers: Readers) -> io::Result<Self> {
        if existing == Existing::Keep && presence::entry(path)?.is_some() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        let file = tempfile::Builder::new()
            .prefix(".protean-")
            // The operating system applies the umask.
            .permissions(Permissions::from_mode(match readers {
                Readers::Owner => 0o600,
                Readers::All => 0o666,
            }))
            .tempfile_in(folder_of(path))?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            file,
        })
    }

    /// Returns the number of bytes written so far.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn size(&self) -> io::Result<u64> {
        Ok(self.file.as_file().metadata()?.len())
    }

    /// Moves the complete file to its path atomically.
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

/// Error of [`save`]; a file that existed before is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct SaveError {
    /// The file.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: io::Error,
}

/// Writes a file, replacing an existing one. Creates missing directories.
///
/// # Errors
/// [`SaveError`].
pub fn save(bytes: &[u8], path: &Path) -> Result<(), SaveError> {
    let write = || {
        std::fs::create_dir_all(folder_of(path))?;
        let mut file = AtomicFile::create(path, Existing::Replace, Readers::All)?;
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
    fn a_file_appears_when_it_is_committed_and_not_before() {
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
        assert_eq!(names(folder.path()), ["a"], "no temporary file is left");
    }

    #[test]
    fn a_file_created_meanwhile_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let file = AtomicFile::create(&path, Existing::Keep, Readers::All).unwrap();
        fs::write(&path, "theirs").unwrap();
        let refused = file.commit().unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"theirs");
    }

    #[test]
    fn directories_are_created_and_files_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/c.txt");
        save(b"one", &path).unwrap();
        save(b"two", &path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(
            names(path.parent().unwrap()),
            ["c.txt"],
            "no temporary file is left"
        );
    }

    #[test]
    fn an_error_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::create_dir(&path).unwrap();
        let error = save(b"x", &path).unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(names(folder.path()), ["taken"], "no temporary file is left");
    }
}
