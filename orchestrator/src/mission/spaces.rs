//! The directories of the runs of this user: made for a run, recognised when its owner is gone,
//! wiped.
//!
//! Every run has a directory below `$XDG_RUNTIME_DIR/protean` (or `/tmp/protean-<uid>`), named by
//! chance, mode 0700, with a lock file that its orchestrator keeps locked: the lock ends with the
//! orchestrator, however that ends. The name is also the run's prefix in shared memory.

use std::fs::{DirBuilder, File, OpenOptions};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use ipc_types::bus::{BusError, RunSpace};
use rustix::fs::{FlockOperation, flock};
use rustix::process::{Pid, Signal};

use super::children::CONFIG_VARIABLE;

/// File that the orchestrator of a run keeps locked.
const LOCK: &str = "lock";
/// File that lists the process ids of a run, one per line.
const PIDS: &str = "pids";

/// Why a run directory cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum SpaceError {
    /// The system refuses.
    #[error("{path}: {source}")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Somebody else could look into the runs.
    #[error(
        "{path}: owned by user {owner}, expected this user ({user}) so that nobody else can look into its runs"
    )]
    Foreign {
        /// The directory.
        path: PathBuf,
        /// Its owner.
        owner: u32,
        /// This user.
        user: u32,
    },
    /// The name does not do.
    #[error(transparent)]
    Name(#[from] BusError),
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> SpaceError {
    let path = path.to_owned();
    move |source| SpaceError::Io { path, source }
}

/// The directory below which this user's runs live; made if it is missing.
///
/// # Errors
/// [`SpaceError`] if it cannot be made or belongs to somebody else.
pub fn base() -> Result<PathBuf, SpaceError> {
    let user = rustix::process::getuid().as_raw();
    let path = match std::env::var_os("XDG_RUNTIME_DIR") {
        // A long runtime directory leaves no room for socket names (see `RunSpace`).
        Some(dir) if !dir.is_empty() && dir.len() <= 36 => PathBuf::from(dir).join("protean"),
        _ => PathBuf::from(format!("/tmp/protean-{user}")),
    };
    match DirBuilder::new().mode(0o700).create(&path) {
        Err(e) if e.kind() != std::io::ErrorKind::AlreadyExists => return Err(io(&path)(e)),
        _ => {}
    }
    let owner = path.symlink_metadata().map_err(io(&path))?.uid();
    if owner != user {
        return Err(SpaceError::Foreign { path, owner, user });
    }
    Ok(path)
}

/// Held while run directories appear or are cleaned, so that a directory without its lock is never
/// taken for an abandoned one.
fn base_lock(base: &Path) -> Result<File, SpaceError> {
    let path = base.join(LOCK);
    let file = OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .mode(0o600)
        .open(&path)
        .map_err(io(&path))?;
    flock(&file, FlockOperation::LockExclusive).map_err(|e| io(&path)(e.into()))?;
    Ok(file)
}

/// The directory of one run, wiped when dropped.
#[derive(Debug)]
pub struct OwnedSpace {
    space: RunSpace,
    _lock: File,
}

impl OwnedSpace {
    /// Makes a directory for a new run.
    ///
    /// # Errors
    /// [`SpaceError`] if the system refuses.
    pub fn create() -> Result<Self, SpaceError> {
        let base = base()?;
        let _guard = base_lock(&base)?;
        // 0700 and O_EXCL are what `tempfile` makes directories with.
        let root = tempfile::Builder::new()
            .prefix("r")
            .rand_bytes(8)
            .tempdir_in(&base)
            .map_err(io(&base))?
            .keep();
        let path = root.join(LOCK);
        let lock = OpenOptions::new()
            .create_new(true)
            .write(true)
            .mode(0o600)
            .open(&path)
            .map_err(io(&path))?;
        flock(&lock, FlockOperation::NonBlockingLockExclusive).map_err(|e| io(&path)(e.into()))?;
        Ok(Self {
            space: run_space(&root)?,
            _lock: lock,
        })
    }

    /// Root and prefix of the run.
    pub fn space(&self) -> &RunSpace {
        &self.space
    }

    /// Writes down the processes of the run, for whoever must clean up after a dead orchestrator.
    ///
    /// # Errors
    /// [`SpaceError`] if the file cannot be written.
    pub fn note_processes(&self, pids: impl Iterator<Item = u32>) -> Result<(), SpaceError> {
        let path = self.space.root().join(PIDS);
        let text = pids
            .map(|pid| pid.to_string())
            .collect::<Vec<_>>()
            .join("\n");
        std::fs::write(&path, text).map_err(io(&path))
    }
}

impl Drop for OwnedSpace {
    fn drop(&mut self) {
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
pub enum Found {
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
/// [`SpaceError`] if the base directory cannot be used; what cannot be removed is in the result.
pub fn clean() -> Result<Vec<Found>, SpaceError> {
    let base = base()?;
    let _guard = base_lock(&base)?;
    let mut roots: Vec<PathBuf> = std::fs::read_dir(&base)
        .map_err(io(&base))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    roots.sort();
    Ok(roots.into_iter().map(clean_one).collect())
}

fn clean_one(root: PathBuf) -> Found {
    if let Ok(lock) = OpenOptions::new().write(true).open(root.join(LOCK))
        && flock(&lock, FlockOperation::NonBlockingLockExclusive).is_err()
    {
        return Found::Alive(root);
    }
    let killed = kill_leftovers(&root);
    match run_space(&root)
        .map_err(|e| e.to_string())
        .and_then(|space| space.wipe().map_err(|e| e.to_string()))
    {
        Ok(()) => Found::Removed { root, killed },
        Err(reason) => Found::Failed(root, reason),
    }
}

/// Kills the listed processes that still live and are of this run (ids are reused: the process must
/// have been given its configuration in the run's directory).
fn kill_leftovers(root: &Path) -> Vec<u32> {
    let listed = std::fs::read_to_string(root.join(PIDS)).unwrap_or_default();
    // The command line would not do: programs of the user's own are told by their environment only.
    let mut needle = format!("{CONFIG_VARIABLE}=").into_bytes();
    needle.extend_from_slice(root.as_os_str().as_encoded_bytes());
    needle.push(b'/');
    listed
        .lines()
        .filter_map(|line| line.trim().parse::<u32>().ok())
        .filter(|pid| {
            std::fs::read(format!("/proc/{pid}/environ")).is_ok_and(|environment| {
                environment
                    .split(|&byte| byte == 0)
                    .any(|entry| entry.starts_with(&needle))
            })
        })
        .filter(|&pid| {
            i32::try_from(pid)
                .ok()
                .and_then(Pid::from_raw)
                .is_some_and(|pid| rustix::process::kill_process(pid, Signal::KILL).is_ok())
        })
        .collect()
}
