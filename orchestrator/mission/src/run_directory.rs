//! Directories of the runs of this user: made for a run, wiped at its end, or found when the orchestrator is
//! gone.
//!
//! Every run has a directory below `$XDG_RUNTIME_DIR/protean` (or `/dev/shm/protean-<uid>`) with a random name,
//! mode 0700, and a lock file in it that its orchestrator keeps locked: the lock ends with the
//! orchestrator, however that ends. The name is also the run's prefix in shared memory. The directory is made
//! under another name and renamed once it is locked, so that a run without a lock is always an abandoned one.

use std::fs::{DirBuilder, File, OpenOptions, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use ipc_types::bus::{BusError, RunSpace};
use rustix::fs::{FlockOperation, flock};

use super::orphans;

/// File that the orchestrator of a run keeps locked.
const LOCK: &str = "lock";
/// DigestPrefix of the names of directories of runs.
const RUN: &str = "r";
/// DigestPrefix of the names of directories that are being made.
const NEW: &str = "tmp-";
/// Attempts to make a directory, each of which may meet a `clean` that takes it for abandoned.
const ATTEMPTS: u32 = 100;

/// Why a run directory cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum RunDirectoryError {
    /// The system refuses.
    #[error("{path}: {source}")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Another user can look into the runs.
    #[error(
        "{path}: owned by user {owner} with mode {mode:03o}, expected this user ({user}) and 700 so that no \
         other can look into its runs"
    )]
    Open {
        /// The directory.
        path: PathBuf,
        /// Its owner.
        owner: u32,
        /// Its permissions.
        mode: u32,
        /// This user.
        user: u32,
    },
    /// Somebody else could put another directory in place of that of the runs.
    #[error(
        "{path}: owned by user {owner} with mode {mode:04o}, expected a directory of this user \
         ({user}) or of the system in which nobody else can rename what is ours; set \
         XDG_RUNTIME_DIR to one"
    )]
    Unsafe {
        /// The directory above.
        path: PathBuf,
        /// Its owner.
        owner: u32,
        /// Its permissions.
        mode: u32,
        /// This user.
        user: u32,
    },
    /// The name does not do.
    #[error(transparent)]
    Name(#[from] BusError),
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> RunDirectoryError {
    let path = path.to_owned();
    move |source| RunDirectoryError::Io { path, source }
}

/// The directory below which this user's runs live.
pub(crate) fn base() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        // A long runtime directory leaves no room for socket names (see `RunSpace`).
        Some(dir) if !dir.is_empty() && dir.len() <= 36 => Path::new(&dir).join("protean"),
        // In memory like the messages themselves: on a disk making and wiping the files of a run
        // takes longer than starting its processes. It has the sticky bit that `/tmp` has.
        _ => PathBuf::from(format!(
            "/dev/shm/protean-{}",
            rustix::process::getuid().as_raw()
        )),
    }
}

/// Makes the directory if it is missing.
fn make_private(path: &Path) -> Result<(), RunDirectoryError> {
    match DirBuilder::new().mode(0o700).create(path) {
        Err(e) if e.kind() != std::io::ErrorKind::AlreadyExists => Err(io(path)(e)),
        _ => Ok(()),
    }
}

/// Makes sure that no other user can look into the runs.
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

/// In the directory above only this user and the system may rename: it is theirs, and either others
/// cannot write there or its sticky bit keeps them from what is not theirs.
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

/// The directory of one run. Dropped, it kills what is left of the run's processes and removes the
/// directory and the run's shared memory.
#[derive(Debug)]
pub struct RunDirectory {
    space: RunSpace,
    _lock: File,
}

impl RunDirectory {
    /// Makes a directory for a new run.
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
                // A `clean` came between making and locking it.
                Err(RunDirectoryError::Io { source, .. })
                    if attempts < ATTEMPTS
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
            // Left to itself `tempfile` lets in whom the umask lets in.
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
        // It has another name now and is no longer temporary.
        let _ = new.keep();
        orphans::begin_run();
        Ok(Self { space, _lock: lock })
    }

    /// Root and prefix of the run.
    pub fn space(&self) -> &RunSpace {
        &self.space
    }
}

impl Drop for RunDirectory {
    fn drop(&mut self) {
        orphans::end_run(self.space.root());
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

/// A run directory as `clean` finds it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FoundDirectory {
    /// Its orchestrator lives: left alone.
    Alive(PathBuf),
    /// Its orchestrator was gone; everything of it has been removed.
    Removed {
        /// Its directory.
        root: PathBuf,
        /// Processes of it that still lived and were killed.
        killed: Vec<u32>,
    },
    /// Its orchestrator was gone, but something could not be removed.
    Failed(PathBuf, String),
}

/// Removes every run of this user whose orchestrator is gone: processes, shared memory, files.
///
/// # Errors
/// [`RunDirectoryError`] if the base directory cannot be used; what cannot be removed is in the result.
pub fn clean() -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    clean_below(&base())
}

/// As [`clean`], of the runs in one directory.
fn clean_below(base: &Path) -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    check_above(base)?;
    let entries = match std::fs::read_dir(base) {
        // No run has ever begun.
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

/// Cleans a directory if its orchestrator is gone; `None` for one that is no run (yet), or no more.
fn clean_one(root: PathBuf) -> Option<FoundDirectory> {
    let name = root.file_name()?.to_string_lossy();
    if name.starts_with(NEW) {
        match lock_of(&root) {
            Lock::Held => {}
            // Only if it is empty: its owner may be about to lock it, and makes another then.
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
        // It ended in order just now.
        return None;
    }
    let killed = orphans::kill_run(&root);
    let wiped = run_space(&root)
        .map_err(|e| e.to_string())
        .and_then(|space| space.wipe().map_err(|e| e.to_string()));
    Some(match wiped {
        Ok(()) => FoundDirectory::Removed { root, killed },
        Err(reason) => FoundDirectory::Failed(root, reason),
    })
}

/// The lock in a directory.
enum Lock {
    /// Its orchestrator lives, or the lock cannot be asked for: nothing may be touched.
    Held,
    /// It was free and is held now.
    Taken(File),
    /// There is none.
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
