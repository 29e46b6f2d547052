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
/// Beginning of the names of directories of runs.
const RUN: &str = "r";
/// Beginning of the names of directories that are being made.
const NEW: &str = "tmp-";
/// Attempts to make a directory, each of which may meet a `clean` that takes it for abandoned.
const ATTEMPTS: u32 = 100;

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

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> SpaceError {
    let path = path.to_owned();
    move |source| SpaceError::Io { path, source }
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
fn make_private(path: &Path) -> Result<(), SpaceError> {
    match DirBuilder::new().mode(0o700).create(path) {
        Err(e) if e.kind() != std::io::ErrorKind::AlreadyExists => Err(io(path)(e)),
        _ => Ok(()),
    }
}

/// Makes sure that no other user can look into the runs.
fn check_owner(path: &Path) -> Result<(), SpaceError> {
    let user = rustix::process::getuid().as_raw();
    let found = path.symlink_metadata().map_err(io(path))?;
    let is_open = found.is_dir() && found.mode() & 0o077 != 0;
    if found.uid() == user && !is_open {
        return Ok(());
    }
    Err(SpaceError::Open {
        path: path.to_owned(),
        owner: found.uid(),
        mode: found.mode() & 0o777,
        user,
    })
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

/// The directory of one run. Dropped, it kills what is left of the run's processes and removes the
/// directory and the run's shared memory.
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
        Self::create_in(&base())
    }

    fn create_in(base: &Path) -> Result<Self, SpaceError> {
        check_above(base)?;
        make_private(base)?;
        check_owner(base)?;
        let mut attempts = 1;
        loop {
            match Self::try_create(base) {
                // A `clean` came between making and locking it.
                Err(SpaceError::Io { source, .. })
                    if attempts < ATTEMPTS
                        && matches!(source.kind(), ErrorKind::NotFound | ErrorKind::WouldBlock) =>
                {
                    attempts += 1;
                }
                made => return made,
            }
        }
    }

    fn try_create(base: &Path) -> Result<Self, SpaceError> {
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

impl Drop for OwnedSpace {
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
    clean_below(&base())
}

/// As [`clean`], of the runs in one directory.
fn clean_below(base: &Path) -> Result<Vec<Found>, SpaceError> {
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
fn clean_one(root: PathBuf) -> Option<Found> {
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
        return Some(Found::Alive(root));
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
        Ok(()) => Found::Removed { root, killed },
        Err(reason) => Found::Failed(root, reason),
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
mod tests {
    use super::*;

    fn mode(path: &Path, mode: u32) {
        std::fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    }

    fn names(base: &Path) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(base)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_run_is_alive_until_its_owner_ends_and_leaves_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        assert_eq!(clean_below(&base).unwrap(), []);
        let owned = OwnedSpace::create_in(&base).unwrap();
        let root = owned.space().root().to_owned();
        assert_eq!(clean_below(&base).unwrap(), [Found::Alive(root.clone())]);
        assert!(root.join(LOCK).exists());
        drop(owned);
        assert_eq!(names(&base), [] as [&str; 0]);
        assert_eq!(clean_below(&base).unwrap(), []);
    }

    #[test]
    fn only_a_lock_that_is_free_or_missing_means_that_a_run_is_abandoned() {
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        make_private(&base).unwrap();
        let root = |name: &str| {
            let root = base.join(name);
            std::fs::create_dir(&root).unwrap();
            root
        };
        // A lock that cannot be opened, like one when there are too many open files.
        let unknown = root("r1");
        std::fs::create_dir(unknown.join(LOCK)).unwrap();
        let free = root("r2");
        File::create(free.join(LOCK)).unwrap();
        let missing = root("r3");
        let half_made = root("tmp-4");
        File::create(half_made.join(LOCK)).unwrap();
        root("tmp-5");
        root("other");
        let removed = |root| Found::Removed {
            root,
            killed: Vec::new(),
        };
        let expected = [Found::Alive(unknown), removed(free), removed(missing)];
        assert_eq!(clean_below(&base).unwrap(), expected);
        assert_eq!(names(&base), ["other", "r1"]);
    }

    #[test]
    fn runs_are_made_while_others_clean() {
        use std::sync::atomic::{AtomicBool, Ordering};
        let directory = tempfile::tempdir().unwrap();
        let base = directory.path().join("protean");
        make_private(&base).unwrap();
        let stop = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !stop.load(Ordering::SeqCst) {
                    for found in clean_below(&base).unwrap() {
                        assert!(!matches!(found, Found::Failed(..)), "{found:?}");
                    }
                }
            });
            for _ in 0..200 {
                let owned = OwnedSpace::create_in(&base).unwrap();
                assert!(owned.space().root().join(LOCK).exists());
            }
            stop.store(true, Ordering::SeqCst);
        });
        assert_eq!(names(&base), [] as [&str; 0]);
    }

    #[test]
    fn a_directory_that_others_can_open_or_swap_is_refused_by_its_name() {
        let directory = tempfile::tempdir().unwrap();
        let refused = |base: &Path| OwnedSpace::create_in(base).err().map(|e| e.to_string());
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
                }
                (found, _) => panic!("{of_above:o} {of_base:o}: {found:?}"),
            }
            std::fs::remove_dir(&base).unwrap();
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
        let error = OwnedSpace::create_in(&base).err().unwrap().to_string();
        assert!(error.starts_with(base.to_str().unwrap()), "{error}");
    }
}
