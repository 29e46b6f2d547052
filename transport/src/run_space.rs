//! Location of the services of one run, separate from those of every other run.

use std::fs::{DirEntry, File, OpenOptions, Permissions, TryLockError};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt};
use std::path::{Path, PathBuf};

use iceoryx2::prelude::{Config, FileName, Path as TransportPath};
use rustix::fs::OFlags;
use rustix::process::geteuid;

use crate::error::BusError;

/// iceoryx2 keeps Unix sockets below the root; a socket's path is limited to 107 bytes.
const MAX_ROOT_BYTES: usize = 60;

/// Permissions of all users except the owner in a file's mode.
const OTHERS: u32 = 0o077;

/// Directory of all shared memory.
const MEMORY: &str = "/dev/shm";

/// Name of a run's lock in shared memory, after the prefix.
const LOCK: &str = "lock";

/// Use of a run's shared memory.
#[derive(Debug)]
pub enum MemoryUse {
    /// A process of the run lives, in this or another PID namespace.
    Used,
    /// No process of the run lives, and none can join it until this lock is dropped.
    Unused(File),
    /// The run has no shared memory with a lock.
    Absent,
}

/// The iceoryx2 prefix and root path of one run.
///
/// Names in `/dev/shm` depend on the prefix only and files below the root on both, so a run needs
/// its own prefix and root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunSpace {
    root: PathBuf,
    prefix: String,
}

impl RunSpace {
    /// Creates the names of a run space without any file access.
    ///
    /// # Errors
    /// [`BusError::Space`] if the root is longer than 60 bytes or not UTF-8, or the prefix does not
    /// consist of letters, digits and underscores with an underscore at its end (so that `run_1_` is
    /// not a prefix of `run_12_`).
    pub fn new(root: impl Into<PathBuf>, prefix: impl Into<String>) -> Result<Self, BusError> {
        let (root, prefix) = (root.into(), prefix.into());
        let problem = if root.as_os_str().len() > MAX_ROOT_BYTES {
            Some(format!(
                "the path has {} bytes; Unix sockets below it allow at most {MAX_ROOT_BYTES} \
                 (set XDG_RUNTIME_DIR to a shorter one)",
                root.as_os_str().len()
            ))
        } else if root.to_str().is_none() {
            Some("the path is not UTF-8".to_owned())
        } else if prefix.is_empty()
            || prefix.len() > 64
            || !prefix
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b == b'_')
        {
            Some(format!(
                "prefix {prefix:?} is not 1 to 64 letters, digits and underscores"
            ))
        } else {
            None
        };
        match problem {
            Some(reason) => Err(BusError::Space { path: root, reason }),
            None => Ok(Self { root, prefix }),
        }
    }

    /// Creates the root for the current user only (mode 0700).
    ///
    /// # Errors
    /// [`BusError::Space`] if it exists or cannot be created.
    pub fn create_root(&self) -> Result<(), BusError> {
        std::fs::DirBuilder::new()
            .mode(0o700)
            .create(&self.root)
            .map_err(|e| BusError::Space {
                path: self.root.clone(),
                reason: e.to_string(),
            })
    }

    /// Directory of the run's files.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Prefix of all names of the run in `/dev/shm`.
    pub fn prefix(&self) -> &str {
        &self.prefix
    }

    /// The iceoryx2 configuration of a run in which at most this many publishers of a topic end.
    ///
    /// # Errors
    /// [`BusError::Space`] if iceoryx2 rejects the names.
    pub fn config(&self, publishers: usize) -> Result<Config, BusError> {
        let refused = |reason: String| BusError::Space {
            path: self.root.clone(),
            reason,
        };
        let mut config = Config::default();
        config.global.prefix =
            FileName::try_from(self.prefix.as_str()).map_err(|e| refused(format!("{e:?}")))?;
        let root = TransportPath::try_from(self.root.to_string_lossy().as_ref())
            .map_err(|e| refused(format!("{e:?}")))?;
        config.global.set_root_path(&root);
        // A node of this run never has dead nodes of another to clean up, and cleaning is expensive:
        // the orchestrator does it after the death of a process. A search for dead nodes at every
        // opened service would take a dozen system calls per live process.
        config.global.node.cleanup_dead_nodes_on_creation = false;
        config.global.node.cleanup_dead_nodes_on_destruction = false;
        config.global.service.cleanup_dead_nodes_on_open = false;
        // Buffer for messages of ended publishers. Every subscriber allocates it, with some
        // kilobytes for each, even if no publisher ends: the default of 128 costs more than the rest
        // of opening a port.
        config
            .defaults
            .publish_subscribe
            .subscriber_expired_connection_buffer = publishers.max(2);
        Ok(config)
    }

    /// Holds the lock of the run's shared memory until the result is dropped. Every process of the run holds it, shared,
    /// from before its first segment: no shared memory of a run is without a lock, and the lock tells its use in every
    /// PID namespace.
    ///
    /// # Errors
    /// Errors of the file system.
    pub fn hold(&self) -> std::io::Result<File> {
        loop {
            let lock = open_lock(&self.lock(), OpenOptions::new().create(true))?;
            match lock.lock_shared() {
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                held => held?,
            }
            // Removed meanwhile, by a process that held it before.
            if lock.metadata()?.nlink() > 0 {
                return Ok(lock);
            }
        }
    }

    /// Returns the use of the run's shared memory.
    ///
    /// # Errors
    /// The error of the system if it is unknown: the memory may be in use.
    pub fn memory_use(&self) -> std::io::Result<MemoryUse> {
        let lock = match open_lock(&self.lock(), &mut OpenOptions::new()) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(MemoryUse::Absent),
            lock => lock?,
        };
        match lock.try_lock() {
            Ok(()) => Ok(MemoryUse::Unused(lock)),
            Err(TryLockError::WouldBlock) => Ok(MemoryUse::Used),
            Err(TryLockError::Error(error)) => Err(error),
        }
    }

    /// Returns the prefixes of this user's runs that begin with `beginning` and have shared memory with a lock, sorted.
    ///
    /// # Errors
    /// The error of the system if shared memory cannot be listed.
    pub fn prefixes_in_memory(beginning: &str) -> std::io::Result<Vec<String>> {
        let mut prefixes = Vec::new();
        for entry in std::fs::read_dir(MEMORY)? {
            let entry = entry?;
            let name = entry.file_name();
            let prefix = name.to_str().and_then(|name| name.strip_suffix(LOCK));
            let Some(prefix) = prefix.filter(|prefix| prefix.starts_with(beginning)) else {
                continue;
            };
            match entry.metadata() {
                Err(e) if e.kind() == ErrorKind::NotFound => {}
                facts => {
                    let is_own = facts?.uid() == geteuid().as_raw();
                    prefixes.extend(is_own.then(|| prefix.to_owned()));
                }
            }
        }
        prefixes.sort();
        Ok(prefixes)
    }

    /// Removes all shared memory of the run, then its files: a run is found by its root as long as memory of it is left.
    /// Call it only when none of its processes is alive.
    ///
    /// # Errors
    /// The first failure; the root stays then.
    pub fn wipe(&self) -> std::io::Result<()> {
        self.wipe_memory()?;
        gone(std::fs::remove_dir_all(&self.root))
    }

    /// Removes all shared memory of the run, its lock last. Call it only when none of its processes is alive.
    ///
    /// # Errors
    /// The first failure; the lock stays then.
    pub fn wipe_memory(&self) -> std::io::Result<()> {
        let lock = self.lock();
        let mut removed = Ok(());
        for segment in self.segments()? {
            if segment.path() != lock {
                removed = removed.and(gone(std::fs::remove_file(segment.path())));
            }
        }
        removed?;
        gone(std::fs::remove_file(lock))
    }

    /// Removes the permissions of other users: iceoryx2 creates the segment with the nodes of a run
    /// for all users, regardless of the umask.
    ///
    /// # Errors
    /// If shared memory cannot be listed, or a segment's mode cannot be changed.
    pub fn keep_others_out(&self) -> std::io::Result<()> {
        for segment in self.segments()? {
            // A segment that disappears meanwhile needs no change.
            let found = match segment.metadata() {
                Err(e) if e.kind() == ErrorKind::NotFound => continue,
                found => found?,
            };
            let mode = found.permissions().mode();
            if mode & OTHERS != 0 {
                let own = Permissions::from_mode(mode & !OTHERS & 0o7777);
                match std::fs::set_permissions(segment.path(), own) {
                    Err(e) if e.kind() != ErrorKind::NotFound => return Err(e),
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Path of the lock of the run's shared memory.
    fn lock(&self) -> PathBuf {
        Path::new(MEMORY).join(format!("{}{LOCK}", self.prefix))
    }

    /// The shared-memory segments of the run, and its lock.
    fn segments(&self) -> std::io::Result<Vec<DirEntry>> {
        let of_run = |entry: &DirEntry| {
            let name = entry.file_name();
            name.as_encoded_bytes().starts_with(self.prefix.as_bytes())
        };
        let entries: std::io::Result<Vec<_>> = std::fs::read_dir(MEMORY)?.collect();
        Ok(entries?.into_iter().filter(of_run).collect())
    }
}

fn open_lock(path: &Path, options: &mut OpenOptions) -> std::io::Result<File> {
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    let options = options.read(true).write(true).mode(0o600);
    options.custom_flags(flags.bits().cast_signed()).open(path)
}

/// Takes a file that does not exist for removed.
fn gone(removed: std::io::Result<()>) -> std::io::Result<()> {
    match removed {
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_in_use_while_a_process_holds_it_and_its_lock_is_removed_last() {
        let prefix = format!("protean_held{}_", std::process::id());
        let space = RunSpace::new("/tmp/none", &*prefix).unwrap();
        assert!(matches!(space.memory_use().unwrap(), MemoryUse::Absent));
        let (first, second) = (space.hold().unwrap(), space.hold().unwrap());
        let segment = Path::new(MEMORY).join(format!("{prefix}turn"));
        std::fs::write(&segment, "text").unwrap();
        drop(first);
        assert!(matches!(space.memory_use().unwrap(), MemoryUse::Used));
        let of_this = || RunSpace::prefixes_in_memory(&prefix).unwrap();
        assert_eq!(of_this(), [&*prefix]);
        drop(second);
        let MemoryUse::Unused(lock) = space.memory_use().unwrap() else {
            panic!("no process holds it");
        };
        assert!(matches!(space.memory_use().unwrap(), MemoryUse::Used));
        // A process that joins meanwhile makes another lock.
        let joining = std::thread::spawn({
            let space = space.clone();
            move || space.hold().unwrap()
        });
        space.wipe_memory().unwrap();
        assert!(!segment.exists());
        drop(lock);
        let held = joining.join().unwrap();
        assert!(matches!(space.memory_use().unwrap(), MemoryUse::Used));
        drop(held);
        space.wipe_memory().unwrap();
        assert_eq!(of_this(), [] as [&str; 0]);
    }

    #[test]
    fn long_roots_and_odd_prefixes_are_refused_with_the_limit() {
        let long = RunSpace::new(format!("/tmp/{}", "x".repeat(60)), "p_").unwrap_err();
        assert!(long.to_string().contains("at most 60"), "{long}");
        let odd = RunSpace::new("/tmp/x", "a/b").unwrap_err();
        assert!(odd.to_string().contains("a/b"), "{odd}");
    }
}
