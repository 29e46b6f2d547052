//! Files that are written completely or not at all.
//!
//! Until it is committed, a file has no name (`O_TMPFILE`): the system removes it with its process, also after `kill -9`.
//! Only the replacement of an existing file gives it a temporary name, for the moment between two system calls, and file
//! systems without `O_TMPFILE` need one from the beginning. Its process keeps a file with a temporary name locked, and
//! the next file that needs one in the directory removes those that no process has locked.

use std::fs::{File, OpenOptions, Permissions};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, CWD, OFlags, linkat};
use tempfile::TempPath;

use crate::file_lock::{LockOutcome, try_lock};
use crate::own_file;
use crate::own_name::own_name;

/// Beginning and end of temporary names.
const TEMPORARY: (&str, &str) = (".protean-", ".partial");

use super::presence;

/// The action for a file that exists already at the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExistingFile {
    /// Keep it and report an error.
    Keep,
    /// Replace it.
    Replace,
}

impl ExistingFile {
    /// Returns [`ExistingFile::Replace`] if `force` is set, else [`ExistingFile::Keep`].
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

/// A file that appears at its path when it is committed. Until then an existing file stays unchanged.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    existing: ExistingFile,
    file: File,
    /// Its temporary name, if the file system needs one.
    name: Option<TempPath>,
}

impl AtomicFile {
    /// Creates an empty file for `path`, whose directory must exist.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if a file exists that is to be kept; the error of the operating
    /// system if the directory is not writable.
    pub fn create(path: &Path, existing: ExistingFile, readers: Readers) -> io::Result<Self> {
        if existing == ExistingFile::Keep && presence::entry(path)?.is_some() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        // The operating system applies the umask.
        let mode = match readers {
            Readers::Owner => 0o600,
            Readers::All => 0o666,
        };
        let folder = folder_of(path);
        let (file, name) = match unnamed(folder, mode) {
            Ok(file) => (file, None),
            Err(_) => named(folder, mode).map(|(file, name)| (file, Some(name)))?,
        };
        Ok(Self {
            path: path.to_owned(),
            existing,
            file,
            name,
        })
    }

    /// Returns the number of bytes written so far.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn size(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len())
    }

    /// Moves the complete file to its path atomically.
    ///
    /// # Errors
    /// As [`AtomicFile::create`].
    pub fn commit(self) -> io::Result<()> {
        self.file.sync_all()?;
        let name = match self.name {
            Some(name) => name,
            None => match (link(&self.file, &self.path), self.existing) {
                (Err(e), ExistingFile::Replace) if e.kind() == io::ErrorKind::AlreadyExists => {
                    // No system call replaces a file by one without a name.
                    let folder = folder_of(&self.path);
                    remove_abandoned(folder);
                    // Before the file has a name. Without locks no file is taken for abandoned.
                    let _ = try_lock(&self.file);
                    let link = |name: &Path| link(&self.file, name);
                    let beginning = own_name(TEMPORARY.0);
                    let named = builder(&beginning).make_in(folder, link)?;
                    named.into_temp_path()
                }
                (linked, _) => return linked,
            },
        };
        match self.existing {
            ExistingFile::Replace => name.persist(&self.path),
            ExistingFile::Keep => name.persist_noclobber(&self.path),
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

/// Creates a file without a name in a directory.
fn unnamed(folder: &Path, mode: u32) -> io::Result<File> {
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .mode(mode)
        .custom_flags(OFlags::TMPFILE.bits().cast_signed())
        .open(folder)?;
    // Without `/proc` it would never get a name.
    std::fs::symlink_metadata(descriptor(&file)).map(|_| file)
}

/// Gives a file without a name this one.
fn link(file: &File, path: &Path) -> io::Result<()> {
    let flags = AtFlags::SYMLINK_FOLLOW;
    Ok(linkat(CWD, descriptor(file), CWD, path, flags)?)
}

/// Returns the path of an open file.
fn descriptor(file: &File) -> String {
    format!("/proc/self/fd/{}", file.as_raw_fd())
}

/// Returns the builder of temporary names that begin with an [`own_name`].
fn builder(beginning: &str) -> tempfile::Builder<'_, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(beginning).suffix(TEMPORARY.1);
    builder
}

/// Creates a file with a temporary name in a directory, and locks it where the file system can.
fn named(folder: &Path, mode: u32) -> io::Result<(File, TempPath)> {
    remove_abandoned(folder);
    let beginning = own_name(TEMPORARY.0);
    loop {
        let (file, name) = builder(&beginning)
            .permissions(Permissions::from_mode(mode))
            .tempfile_in(folder)?
            .into_parts();
        // Until it is locked, another process may take it for abandoned.
        let is_taken = matches!(try_lock(&file), Ok(LockOutcome::InUse));
        if !is_taken && file.metadata()?.nlink() > 0 {
            return Ok((file, name));
        }
    }
}

/// Removes the files of this user in a directory that have a temporary name and no process.
fn remove_abandoned(folder: &Path) {
    // What cannot be read or locked may have one.
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.as_encoded_bytes();
        if name.starts_with(TEMPORARY.0.as_bytes())
            && name.ends_with(TEMPORARY.1.as_bytes())
            && let Ok(file) = own_file::open(&entry.path(), OpenOptions::new().write(true))
            && matches!(try_lock(&file), Ok(LockOutcome::Acquired))
        {
            let _ = std::fs::remove_file(entry.path());
        }
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
#[error("{}: cannot be written: {source}", path.display())]
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
        let mut file = AtomicFile::create(path, ExistingFile::Replace, Readers::All)?;
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
        let mut file = create(ExistingFile::Keep).unwrap();
        file.write_all(b"one").unwrap();
        assert!(!path.exists());
        let is_unnamed = file.name.is_none();
        assert_eq!(names(folder.path()).is_empty(), is_unnamed);
        file.commit().unwrap();
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o600
        );
        let refused = create(ExistingFile::Keep).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        let mut file = create(ExistingFile::Replace).unwrap();
        file.write_all(b"two").unwrap();
        drop(file);
        assert_eq!(fs::read(&path).unwrap(), b"one", "never committed");
        assert_eq!(names(folder.path()), ["a"], "no temporary file is left");
    }

    #[test]
    fn temporary_names_without_a_process_are_removed_and_others_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let (locked, abandoned) = (path(".protean-a.partial"), path(".protean-b.partial"));
        let other = path(".protean-c");
        for path in [&locked, &abandoned, &other, &path("out")] {
            fs::write(path, "text").unwrap();
        }
        let lock = File::open(&locked).unwrap();
        lock.lock().unwrap();
        save(b"new", &path("out")).unwrap();
        assert_eq!(fs::read(path("out")).unwrap(), b"new");
        assert!(locked.exists() && other.exists() && !abandoned.exists());
        // As on a file system that needs a name.
        fs::write(&abandoned, "text").unwrap();
        let (file, name) = named(folder.path(), 0o600).unwrap();
        assert!(!abandoned.exists());
        drop(named(folder.path(), 0o600).unwrap());
        assert!(name.exists(), "it is locked");
        drop((file, name));
        assert_eq!(names(folder.path()).len(), 3, "{:?}", names(folder.path()));
    }

    #[test]
    fn a_file_created_meanwhile_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let file = AtomicFile::create(&path, ExistingFile::Keep, Readers::All).unwrap();
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
