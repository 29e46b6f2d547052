//! Directories of the runs of this user: created for a run, and removed at its end or, after the end of its
//! orchestrator, by a later run.
//!
//! Every run has a directory below `$XDG_RUNTIME_DIR/protean` (or `/dev/shm/protean-<uid>`) with a random name and
//! mode 0700. Its orchestrator keeps a lock file in it locked; the lock ends with the orchestrator in every case. The
//! name is also the run's prefix in shared memory. The directory is created under another name and renamed once it
//! is locked, so that a run without a lock is always an abandoned one.

use std::fs::{DirBuilder, File, OpenOptions, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use ipc_types::bus::{BusError, RunSpace};
use rustix::fs::{FlockOperation, flock};

use super::lost_memory;
use super::orphans;

/// File that the orchestrator of a run keeps locked.
const LOCK: &str = "lock";
/// Prefix of the directory names of runs.
const RUN: &str = "r";
/// Prefix of the names of directories under construction.
const NEW: &str = "tmp-";
/// Maximum number of attempts to create a directory, since `clean` may remove an unlocked one.
const MAX_ATTEMPTS: u32 = 100;

/// Error of creating a run directory.
#[derive(Debug, thiserror::Error)]
pub enum RunDirectoryError {
    /// A system call failed.
    #[error("{path}: {source}")]
    Io {
        /// File or directory.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// Another user can read the directories of runs.
    #[error(
        "{path}: owned by user {owner} with mode {mode:03o}, expected this user ({user}) and 700 so that no other \
         user can read its runs"
    )]
    Open {
        /// Directory.
        path: PathBuf,
        /// Owner of the directory.
        owner: u32,
        /// Permissions of the directory.
        mode: u32,
        /// Current user.
        user: u32,
    },
    /// Another user could replace the directory of the runs.
    #[error(
        "{path}: owned by user {owner} with mode {mode:04o}, expected a directory of this user \
         ({user}) or of the system in which no other user can rename its files; set \
         XDG_RUNTIME_DIR to one"
    )]
    Unsafe {
        /// Parent directory.
        path: PathBuf,
        /// Owner of the directory.
        owner: u32,
        /// Permissions of the directory.
        mode: u32,
        /// Current user.
        user: u32,
    },
    /// The name is invalid.
    #[error(transparent)]
    Name(#[from] BusError),
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> RunDirectoryError {
    let path = path.to_owned();
    move |source| RunDirectoryError::Io { path, source }
}

/// Returns the directory that contains the directories of this user's runs.
pub(crate) fn base() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        // A longer runtime directory leaves no room for socket names (see `RunSpace`).
        Some(dir) if !dir.is_empty() && dir.len() <= 36 => Path::new(&dir).join("protean"),
        // In memory, like the messages: on a disk, creating and removing the files of a run takes longer than starting
        // its processes. `/dev/shm` has the sticky bit, like `/tmp`.
        _ => PathBuf::from(format!(
            "/dev/shm/protean-{}",
            rustix::process::getuid().as_raw()
        )),
    }
}

/// Creates the directory if it is missing.
fn make_private(path: &Path) -> Result<(), RunDirectoryError> {
    match DirBuilder::new().mode(0o700).create(path) {
        Err(e) if e.kind() != std::io::ErrorKind::AlreadyExists => Err(io(path)(e)),
        _ => Ok(()),
    }
}

/// Checks that no other user can read the directories of runs.
fn check_owner(path: &Path) -> Result<(), RunDirectoryError> {
    let user = rustix::process::getuid().as_raw();
    let found = path.symlink_metadata().map_err(io(path))?;
    let is_open = found.is_dir() && found.mode() & 0o077 != 0;
    if found.uid() == user && !is_open {
        return Ok(());
    }
    Err(RunDirectoryError::Open {
        path: path.to_owned(),
        owner: found.uid(),
        mode: found.mode() & 0o777,
        user,
    })
}

/// Checks that only this user and the system can rename files in the parent directory: it belongs to one of them,
/// and others cannot write there, or its sticky bit protects files of this user.
fn check_above(path: &Path) -> Result<(), RunDirectoryError> {
    let user = rustix::process::getuid().as_raw();
    let above = match path.parent() {
        Some(above) if !above.as_os_str().is_empty() => above,
        _ => Path::new("."),
    };
    let found = above.metadata().map_err(io(above))?;
    let ours = [0, user].contains(&found.uid());
    let shared = found.mode() & 0o002 != 0 && found.mode() & 0o1000 == 0;
    if ours && !shared {
        return Ok(());
    }
    Err(RunDirectoryError::Unsafe {
        path: above.to_owned(),
        owner: found.uid(),
        mode: found.mode() & 0o7777,
        user,
    })
}

/// The directory of one run. Dropping it kills the remaining processes of the run and removes the directory and the
/// run's shared memory.
#[derive(Debug)]
pub struct RunDirectory {
    space: RunSpace,
    _lock: File,
}

impl RunDirectory {
    /// Creates a directory for a new run.
    ///
    /// # Errors
    /// [`RunDirectoryError`] if the system refuses.
    pub fn create() -> Result<Self, RunDirectoryError> {
        Self::create_in(&base())
    }

    fn create_in(base: &Path) -> Result<Self, RunDirectoryError> {
        check_above(base)?;
        make_private(base)?;
        check_owner(base)?;
        let mut attempts = 1;
        loop {
            match Self::try_create(base) {
                // A `clean` removed it before it was locked.
                Err(RunDirectoryError::Io { source, .. })
                    if attempts < MAX_ATTEMPTS
                        && matches!(source.kind(), ErrorKind::NotFound | ErrorKind::WouldBlock) =>
                {
                    attempts += 1;
                }
                made => return made,
            }
        }
    }

    fn try_create(base: &Path) -> Result<Self, RunDirectoryError> {
        let new = tempfile::Builder::new()
            .prefix(NEW)
            .rand_bytes(8)
            // By default, `tempfile` gives the permissions of the umask.
            .permissions(Permissions::from_mode(0o700))
            .tempdir_in(base)
            .map_err(io(base))?;
        let path = new.path().join(LOCK);
        let lock = OpenOptions::new()
            .create_new(true)
            .write(true)
            .mode(0o600)
            .open(&path)
            .map_err(io(&path))?;
        flock(&lock, FlockOperation::NonBlockingLockExclusive).map_err(|e| io(&path)(e.into()))?;
        let name = new.path().file_name().unwrap_or_default();
        let root = base.join(name.to_string_lossy().replace(NEW, RUN));
        let space = run_space(&root)?;
        std::fs::rename(new.path(), &root).map_err(io(&root))?;
        // It has another name now and is not temporary.
        let _ = new.keep();
        orphans::begin_run();
        Ok(Self { space, _lock: lock })
    }

    /// Returns the root and the prefix of the run.
    pub fn space(&self) -> &RunSpace {
        &self.space
    }
}

impl Drop for RunDirectory {
    fn drop(&mut self) {
        if let Err(error) = orphans::end_run(self.space.root()) {
            tracing::warn!("processes of external programs may remain: {error}");
        }
        if let Err(error) = self.space.wipe() {
            tracing::warn!(
                "{}: cannot be removed: {error}",
                self.space.root().display()
            );
        }
    }
}

fn run_space(root: &Path) -> Result<RunSpace, BusError> {
    let name = root
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default();
    RunSpace::new(root, format!("protean_{name}_"))
}

/// A run directory found by `clean`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FoundDirectory {
    /// Its orchestrator is alive; it was not changed.
    Alive(PathBuf),
    /// Its orchestrator had ended; the run was removed.
    Removed {
        /// Directory of the run.
        root: PathBuf,
        /// Living processes of the run, which were killed.
        killed: Vec<u32>,
    },
    /// Its orchestrator had ended, but some part could not be removed.
    Failed(PathBuf, String),
}

/// Removes every run of this user whose orchestrator has ended: processes, shared memory and files.
///
/// # Errors
/// [`RunDirectoryError`] if the base directory is unusable; the result contains parts that could not be removed.
pub fn clean() -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    let base = base();
    let mut found = clean_below(&base)?;
    // Unknown means that it exists.
    match lost_memory::remove(|run| base.join(run).try_exists().unwrap_or(true)) {
        Ok(lost) => found.extend(lost.into_iter().map(|root| FoundDirectory::Removed {
            root,
            killed: Vec::new(),
        })),
        Err(error) => found.push(FoundDirectory::Failed(
            PathBuf::from("/dev/shm"),
            error.to_string(),
        )),
    }
    Ok(found)
}

/// Does the same as [`clean`] for the runs in one directory.
fn clean_below(base: &Path) -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    check_above(base)?;
    let entries = match std::fs::read_dir(base) {
        // No run has started yet.
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(io(base))?,
    };
    check_owner(base)?;
    let mut roots: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    roots.sort();
    Ok(roots.into_iter().filter_map(clean_one).collect())
}

/// Cleans a directory if its orchestrator has ended. Returns `None` if it is not a run, or not any more.
fn clean_one(root: PathBuf) -> Option<FoundDirectory> {
    let name = root.file_name()?.to_string_lossy();
    if name.starts_with(NEW) {
        match lock_of(&root) {
            Lock::Held => {}
            // Removed only if empty: its owner may be about to lock it, and then creates another one.
            Lock::Missing => drop(std::fs::remove_dir(&root)),
            Lock::Taken(_lock) => drop(std::fs::remove_dir_all(&root)),
        }
        return None;
    }
    if !name.starts_with(RUN) {
        return None;
    }
    let lock = lock_of(&root);
    if matches!(lock, Lock::Held) {
        return Some(FoundDirectory::Alive(root));
    }
    if !root.is_dir() {
        // The run ended in order at this moment.
        return None;
    }
    Some(match remove(&root) {
        Ok(killed) => FoundDirectory::Removed { root, killed },
        Err(reason) => FoundDirectory::Failed(root, reason),
    })
}

/// Removes a run whose orchestrator has ended, unless one of its processes may live. Returns the killed processes.
fn remove(root: &Path) -> Result<Vec<u32>, String> {
    let space = run_space(root).map_err(|e| e.to_string())?;
    let killed = orphans::kill_run(root).map_err(|e| e.to_string())?;
    space.wipe().map_err(|e| e.to_string())?;
    Ok(killed)
}

/// State of the lock in a directory.
enum Lock {
    /// Its orchestrator is alive, or the lock is unreadable: the run must not be changed.
    Held,
    /// It was free, and this process holds it now.
    Taken(File),
    /// The lock file does not exist.
    Missing,
}

fn lock_of(root: &Path) -> Lock {
    match OpenOptions::new().write(true).open(root.join(LOCK)) {
        Ok(lock) => match flock(&lock, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => Lock::Taken(lock),
            Err(_) => Lock::Held,
        },
        Err(e) if e.kind() == ErrorKind::NotFound => Lock::Missing,
        Err(_) => Lock::Held,
    }
}

#[cfg(test)]
mod tests;
