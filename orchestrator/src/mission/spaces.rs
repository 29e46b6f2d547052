//! The directories of the runs of this user: made for a run, recognised when its owner is gone,
//! wiped.
//!
//! Every run has a directory below `$XDG_RUNTIME_DIR/protean` (or `/dev/shm/protean-<uid>`), named by
//! chance, mode 0700, with a lock file that its orchestrator keeps locked: the lock ends with the
//! orchestrator, however that ends. The name is also the run's prefix in shared memory.

use std::fs::{DirBuilder, File, OpenOptions};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use ipc_types::bus::{BusError, RunSpace};
use rustix::fs::{FlockOperation, flock};

use super::annex::{self, Abandoned};
use super::leftovers;

/// File that the orchestrator of a run keeps locked.
const LOCK: &str = "lock";
/// File that lists the process ids of a run, one per line.
const PIDS: &str = "pids";

/// Times that the directory of all runs may vanish under whoever wants to hold it.
const ATTEMPTS: u32 = 1000;

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
    /// Somebody else may look into the runs.
    #[error("{path}: mode {mode:03o}, expected 700 so that nobody else can look into its runs")]
    Open {
        /// The directory.
        path: PathBuf,
        /// Its permissions.
        mode: u32,
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

pub(super) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> SpaceError {
    let path = path.to_owned();
    move |source| SpaceError::Io { path, source }
}

/// The directory below which this user's runs live.
pub(crate) fn base() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        // A long runtime directory leaves no room for socket names (see `RunSpace`).
        Some(dir) if !dir.is_empty() && dir.len() <= 36 => base_below(Path::new(&dir)),
        // In memory like the messages themselves: on a disk making and wiping the files of a run
        // takes longer than starting its processes. It has the sticky bit that `/tmp` has.
        _ => PathBuf::from(format!(
            "/dev/shm/protean-{}",
            rustix::process::getuid().as_raw()
        )),
    }
}

/// The directory of runs below a runtime directory.
pub(super) fn base_below(runtime_dir: &Path) -> PathBuf {
    runtime_dir.join("protean")
}

/// Makes the directory if it is missing.
fn make_private(path: &Path) -> Result<(), SpaceError> {
    match DirBuilder::new().mode(0o700).create(path) {
        Err(e) if e.kind() != std::io::ErrorKind::AlreadyExists => Err(io(path)(e)),
        _ => Ok(()),
    }
}

/// Makes sure that nobody else can look into the runs.
fn check_owner(path: &Path) -> Result<(), SpaceError> {
    let user = rustix::process::getuid().as_raw();
    match path.symlink_metadata() {
        Ok(found) if found.uid() != user => Err(SpaceError::Foreign {
            path: path.to_owned(),
            owner: found.uid(),
            user,
        }),
        Ok(found) if found.is_dir() && found.mode() & 0o077 != 0 => Err(SpaceError::Open {
            path: path.to_owned(),
            mode: found.mode() & 0o777,
        }),
        // Gone with its last run since it was made.
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(io(path)(e)),
        _ => Ok(()),
    }
}

/// In the directory above only this user and the system may rename: it is theirs, and either others
/// cannot write there or its sticky bit keeps them from what is not theirs.
fn check_above(path: &Path) -> Result<(), SpaceError> {
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
    Err(SpaceError::Unsafe {
        path: above.to_owned(),
        owner: found.uid(),
        mode: found.mode() & 0o7777,
        user,
    })
}

/// The directory of all runs, held while run directories appear or go, so that a directory without
/// its lock is never taken for an abandoned one. Let go of, it takes the directory with it when no
/// run is left.
struct HeldBase {
    path: PathBuf,
    // Unlocked when closed, after `drop`.
    _lock: File,
}

impl HeldBase {
    fn hold(base: PathBuf) -> Result<Self, SpaceError> {
        let path = base.join(LOCK);
        let mut attempts = 0;
        loop {
            attempts += 1;
            check_above(&base)?;
            make_private(&base)?;
            check_owner(&base)?;
            let lock = OpenOptions::new()
                .create(true)
                .truncate(false)
                .write(true)
                .mode(0o600)
                .open(&path);
            let lock = match lock {
                // The directory went with its last run since it was made. What stays away is no
                // directory but, say, a link to nowhere.
                Err(e) if e.kind() == std::io::ErrorKind::NotFound && attempts < ATTEMPTS => {
                    continue;
                }
                lock => lock.map_err(io(&path))?,
            };
            flock(&lock, FlockOperation::LockExclusive).map_err(|e| io(&path)(e.into()))?;
            // Whoever held it before may have removed it: then it keeps nobody out.
            let held = lock.metadata().map_err(io(&path))?;
            if path
                .metadata()
                .is_ok_and(|named| (named.dev(), named.ino()) == (held.dev(), held.ino()))
            {
                check_owner(&base)?;
                return Ok(Self {
                    path: base,
                    _lock: lock,
                });
            }
        }
    }
}

impl Drop for HeldBase {
    fn drop(&mut self) {
        let lock = self.path.join(LOCK);
        let no_runs = std::fs::read_dir(&self.path)
            .is_ok_and(|entries| entries.flatten().all(|entry| !entry.path().is_dir()));
        if no_runs {
            // Whoever comes next uses what is left, should one of them fail.
            let _ = std::fs::remove_file(&lock);
            let _ = std::fs::remove_dir(&self.path);
        }
    }
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
        let base = HeldBase::hold(base())?;
        let root = tempfile::Builder::new()
            .prefix("r")
            .rand_bytes(8)
            // Left to itself `tempfile` lets in whom the umask lets in.
            .permissions(std::fs::Permissions::from_mode(0o700))
            .tempdir_in(&base.path)
            .map_err(io(&base.path))?
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

    /// Writes down the processes of the run, for people and tools that look at it from outside.
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
        // The directory of all runs goes with the last of them.
        drop(HeldBase::hold(base()));
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
    clean_below(base())
}

/// The same of the runs in one directory.
pub(super) fn clean_below(base: PathBuf) -> Result<Vec<Found>, SpaceError> {
    let base = HeldBase::hold(base)?;
    let mut roots: Vec<PathBuf> = std::fs::read_dir(&base.path)
        .map_err(io(&base.path))?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    roots.sort();
    Ok(roots.into_iter().flat_map(clean_one).collect())
}

/// Cleans a run, with its annex if it has one.
fn clean_one(root: PathBuf) -> Vec<Found> {
    if let Ok(lock) = OpenOptions::new().write(true).open(root.join(LOCK))
        && flock(&lock, FlockOperation::NonBlockingLockExclusive).is_err()
    {
        return vec![Found::Alive(root)];
    }
    let mut found = match annex::clean(&root) {
        // Noted there until it is gone.
        Abandoned::Stays(found) => return found,
        Abandoned::Gone(found) => found,
    };
    let killed = leftovers::kill_all_of(&root);
    found.push(
        match run_space(&root)
            .map_err(|e| e.to_string())
            .and_then(|space| space.wipe().map_err(|e| e.to_string()))
        {
            Ok(()) => Found::Removed { root, killed },
            Err(reason) => Found::Failed(root, reason),
        },
    );
    found
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn one_at_a_time_holds_the_directory_and_the_last_takes_it_along() {
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        let (taken, turns) = (AtomicBool::new(false), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..200 {
                        let held = HeldBase::hold(base.clone()).unwrap();
                        assert!(!taken.swap(true, Ordering::SeqCst), "two hold it");
                        assert!(base.join(LOCK).exists());
                        turns.fetch_add(1, Ordering::SeqCst);
                        taken.store(false, Ordering::SeqCst);
                        drop(held);
                    }
                });
            }
        });
        assert_eq!(turns.into_inner(), 800);
        assert!(!base.exists());
    }

    #[test]
    fn the_directory_stays_while_a_run_is_there() {
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        let held = HeldBase::hold(base.clone()).unwrap();
        let run = base.join("r12345678");
        std::fs::create_dir(&run).unwrap();
        drop(held);
        assert!(run.exists());
        std::fs::remove_dir(&run).unwrap();
        drop(HeldBase::hold(base.clone()).unwrap());
        assert!(!base.exists());
    }

    #[test]
    fn a_directory_that_others_can_open_or_swap_is_refused_by_its_name() {
        use std::os::unix::fs::PermissionsExt as _;
        let directory = tempfile::tempdir().unwrap();
        let mode = |path: &Path, mode| {
            let mode = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(path, mode).unwrap();
        };
        let refused = |base: &Path| HeldBase::hold(base.to_owned()).err().map(|e| e.to_string());
        let above = directory.path().join("above");
        std::fs::create_dir(&above).unwrap();
        let base = above.join("protean");
        for (of_above, of_base, named) in [
            (0o700, 0o755, Some(&base)),
            (0o700, 0o770, Some(&base)),
            (0o777, 0o700, Some(&above)),
            (0o1777, 0o700, None),
            (0o755, 0o700, None),
        ] {
            std::fs::create_dir(&base).unwrap();
            mode(&base, of_base);
            mode(&above, of_above);
            match (refused(&base), named) {
                (None, None) => {}
                (Some(error), Some(path)) => {
                    let start = format!("{}: ", path.display());
                    assert!(error.starts_with(&start), "{error}");
                    std::fs::remove_dir(&base).unwrap();
                }
                (found, _) => panic!("{of_above:o} {of_base:o}: {found:?}"),
            }
        }
        if !rustix::process::getuid().is_root() {
            eprintln!("skipped: only root can give a directory away");
            return;
        }
        for given in [&base, &above] {
            std::fs::create_dir_all(&base).unwrap();
            mode(&base, 0o700);
            std::os::unix::fs::chown(given, Some(65534), None).unwrap();
            let error = refused(&base).unwrap();
            assert!(error.starts_with(&format!("{}: owned by user 65534", given.display())));
            std::os::unix::fs::chown(&base, Some(0), None).unwrap();
        }
    }

    #[test]
    fn a_link_to_nowhere_is_refused_by_its_name() {
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        std::os::unix::fs::symlink(directory.path().join("nowhere"), &base).unwrap();
        let error = HeldBase::hold(base.clone()).err().unwrap().to_string();
        assert!(error.starts_with(base.to_str().unwrap()), "{error}");
    }
}
