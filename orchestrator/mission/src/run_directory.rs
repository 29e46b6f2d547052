//! Directories of the runs of this user: created for a run, and removed at its end or, after the end of its
//! orchestrator, by a later run.
//!
//! Every run has a directory below `$XDG_RUNTIME_DIR/protean` (or `/dev/shm/protean-<uid>`) with mode 0700 and a name of
//! its own ([`own_name`]). Its orchestrator keeps a lock file in it locked; the lock ends with the orchestrator in every case. The
//! directory is created under another name and renamed once it is locked, so that a run without a lock is always an
//! abandoned one. The name is also the run's prefix in shared memory, which has a lock of its own ([`MemoryUse`]): it
//! tells the use of the memory by processes of other PID namespaces, and by runs whose directory is elsewhere.
//!
//! What cannot be read or locked for another reason than its use is kept and named.

use std::fs::{DirBuilder, File, OpenOptions, Permissions, TryLockError};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use ipc_types::bus::{BusError, MemoryUse, RunSpace};
use platform::own_name::own_name;

use super::orphans;

/// File that the orchestrator of a run keeps locked.
const LOCK: &str = "lock";
/// Prefix of the directory names of runs.
const RUN: &str = "r";
/// Prefix of the names of directories under construction.
const NEW: &str = "tmp-";
/// Prefix of the names of all runs in shared memory.
const MEMORY: &str = "protean_";
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
        "{path}: owned by user {owner} with mode {mode:03o}: expected this user ({user}) and 700 so that no other \
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
        "{path}: owned by user {owner} with mode {mode:04o}: expected a directory of this user \
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

fn failed(path: &Path) -> impl FnOnce(io::Error) -> RunDirectoryError {
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
        Err(e) if e.kind() != ErrorKind::AlreadyExists => Err(failed(path)(e)),
        _ => Ok(()),
    }
}

/// Checks that no other user can read the directories of runs.
fn check_owner(path: &Path) -> Result<(), RunDirectoryError> {
    let user = rustix::process::getuid().as_raw();
    let found = path.symlink_metadata().map_err(failed(path))?;
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
    let found = above.metadata().map_err(failed(above))?;
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
            .prefix(&own_name(NEW))
            .rand_bytes(8)
            // By default, `tempfile` gives the permissions of the umask.
            .permissions(Permissions::from_mode(0o700))
            .tempdir_in(base)
            .map_err(failed(base))?;
        let path = new.path().join(LOCK);
        let lock = OpenOptions::new()
            .create_new(true)
            .write(true)
            .mode(0o600)
            .open(&path)
            .map_err(failed(&path))?;
        lock.try_lock().map_err(|e| failed(&path)(e.into()))?;
        let name = new.path().file_name().unwrap_or_default();
        let root = base.join(name.to_string_lossy().replace(NEW, RUN));
        let space = run_space(&root)?;
        std::fs::rename(new.path(), &root).map_err(failed(&root))?;
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
    RunSpace::new(root, format!("{MEMORY}{name}_"))
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

impl FoundDirectory {
    /// Returns the directory of the run, or the beginning of the names of its shared memory.
    fn path(&self) -> &Path {
        match self {
            Self::Alive(path) | Self::Removed { root: path, .. } | Self::Failed(path, _) => path,
        }
    }
}

/// Removes every run of this user whose orchestrator has ended: processes, shared memory and files. Runs with another
/// directory than the base of this user are removed from shared memory once none of their processes lives.
///
/// # Errors
/// [`RunDirectoryError`] if the runs cannot be listed; the result contains parts that could not be removed.
pub fn clean() -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    let base = base();
    let mut found = clean_below(&base)?;
    found.extend(clean_memory(&base, MEMORY, &found)?);
    Ok(found)
}

/// Does the same as [`clean`] for the runs in one directory.
fn clean_below(base: &Path) -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    check_above(base)?;
    let entries = match std::fs::read_dir(base) {
        // No run has started yet.
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed(base))?,
    };
    check_owner(base)?;
    let mut roots = Vec::new();
    for entry in entries {
        let entry = entry.map_err(failed(base))?;
        match entry.file_type() {
            Ok(kind) => roots.extend(kind.is_dir().then(|| entry.path())),
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(e) => return Err(failed(&entry.path())(e)),
        }
    }
    roots.sort();
    Ok(roots.into_iter().filter_map(clean_one).collect())
}

/// Removes the shared memory of runs that no process uses and that have no directory in `base`, as far as their names
/// begin with `beginning`; those in `known` are left out.
fn clean_memory(
    base: &Path,
    beginning: &str,
    known: &[FoundDirectory],
) -> Result<Vec<FoundDirectory>, RunDirectoryError> {
    let memory = Path::new("/dev/shm");
    let prefixes = RunSpace::prefixes_in_memory(beginning).map_err(failed(memory))?;
    let mut found = Vec::new();
    for prefix in prefixes {
        let name = prefix.strip_prefix(MEMORY).unwrap_or(&prefix);
        let root = base.join(name.trim_end_matches('_'));
        if known.iter().any(|run| run.path() == root) {
            continue;
        }
        let wipe = || -> io::Result<bool> {
            let space = RunSpace::new(root, &*prefix).map_err(io::Error::other)?;
            let MemoryUse::Unused(_lock) = space.memory_use()? else {
                return Ok(false);
            };
            space.wipe_memory().map(|()| true)
        };
        let path = memory.join(&prefix);
        match wipe() {
            Ok(true) => found.push(removed(path, Vec::new())),
            Ok(false) => {}
            Err(error) => {
                let reason = format!("kept, since its lock cannot be used: {error}");
                found.push(FoundDirectory::Failed(path, reason));
            }
        }
    }
    Ok(found)
}

fn removed(root: PathBuf, killed: Vec<u32>) -> FoundDirectory {
    FoundDirectory::Removed { root, killed }
}

/// Cleans a directory if its orchestrator has ended. Returns `None` if it is not a run, or not any more.
fn clean_one(root: PathBuf) -> Option<FoundDirectory> {
    let name = root.file_name()?.to_string_lossy();
    let cleaned = if name.starts_with(NEW) {
        clean_new(&root).map(|()| None)
    } else if name.starts_with(RUN) {
        clean_run(&root)
    } else {
        return None;
    };
    cleaned.unwrap_or_else(|error| Some(FoundDirectory::Failed(root, error.to_string())))
}

/// Removes a directory under construction, unless its owner lives.
fn clean_new(root: &Path) -> io::Result<()> {
    let cleaned = match lock_of(root)? {
        Lock::Held => return Ok(()),
        // Removed only if empty: its owner may be about to lock it, and then creates another one.
        Lock::Missing => std::fs::remove_dir(root),
        Lock::Taken(_lock) => std::fs::remove_dir_all(root),
    };
    match cleaned {
        Err(e) if !matches!(e.kind(), ErrorKind::NotFound | ErrorKind::DirectoryNotEmpty) => Err(e),
        _ => Ok(()),
    }
}

/// Removes a run whose orchestrator has ended, unless one of its processes may live.
fn clean_run(root: &Path) -> io::Result<Option<FoundDirectory>> {
    let alive = || Ok(Some(FoundDirectory::Alive(root.to_owned())));
    let lock = lock_of(root)?;
    let space = run_space(root).map_err(io::Error::other)?;
    match &lock {
        Lock::Held => return alive(),
        // The run ended in order at this moment.
        Lock::Missing if !root.try_exists()? => return Ok(None),
        Lock::Missing if matches!(space.memory_use()?, MemoryUse::Used) => return alive(),
        _ => {}
    }
    let killed = orphans::kill_run(root)?;
    let memory = space.memory_use()?;
    if matches!(memory, MemoryUse::Used) {
        // By a process of another PID namespace, which ends with its orchestrator.
        return alive();
    }
    space.wipe()?;
    Ok(Some(removed(root.to_owned(), killed)))
}

/// State of the lock in a directory.
enum Lock {
    /// Its orchestrator is alive: the run must not be changed.
    Held,
    /// It was free, and this process holds it now.
    Taken(File),
    /// The lock file does not exist.
    Missing,
}

/// Returns the state of a lock.
///
/// # Errors
/// The error of the system if it is unknown: the run must not be changed.
fn lock_of(root: &Path) -> io::Result<Lock> {
    let unknown = |error: io::Error| {
        io::Error::new(
            error.kind(),
            format!("kept, since its lock cannot be used: {error}"),
        )
    };
    let lock = match OpenOptions::new().write(true).open(root.join(LOCK)) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Lock::Missing),
        lock => lock.map_err(unknown)?,
    };
    match lock.try_lock() {
        Ok(()) => Ok(Lock::Taken(lock)),
        Err(TryLockError::WouldBlock) => Ok(Lock::Held),
        Err(TryLockError::Error(error)) => Err(unknown(error)),
    }
}

#[cfg(test)]
mod tests;
