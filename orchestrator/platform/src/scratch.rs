//! Scratch directories, which are removed also after `kill -9` of their process.
//!
//! A process keeps its scratch directory locked; one that is not locked is abandoned. The Python package does the same
//! (`_scratch` in `python/protean_robotics/_sweep.py`).

use std::fs::{File, Permissions};
use std::io::{self, ErrorKind};
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};

use rustix::process::geteuid;
use tempfile::TempDir;

use crate::file_lock::{LockOutcome, try_lock};
use crate::own_name::own_name;

/// First characters of their names.
const NAMES: &str = "protean-scratch-";

/// A directory of this user below the temporary directory of the system, until this is dropped.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    _lock: File,
}

impl Scratch {
    /// Creates a directory.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn create() -> io::Result<Self> {
        let prefix = own_name(NAMES);
        loop {
            let folder = tempfile::Builder::new()
                .prefix(&prefix)
                .permissions(Permissions::from_mode(0o700))
                .tempdir()?;
            // Until it is locked, a `clean` may remove it.
            let lock = match File::open(folder.path()) {
                Err(error) if error.kind() == ErrorKind::NotFound => continue,
                lock => lock?,
            };
            // A file system without locks refuses that of a `clean`, too.
            let is_taken = matches!(try_lock(&lock), Ok(LockOutcome::InUse));
            if !is_taken && folder.path().try_exists()? {
                return Ok(Self {
                    folder,
                    _lock: lock,
                });
            }
        }
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes the scratch directories of this user that no process has locked. Returns each, with the error if it remains.
///
/// # Errors
/// The error of the operating system if they cannot be listed.
pub fn clean() -> io::Result<Vec<(PathBuf, Option<io::Error>)>> {
    let entries = match std::fs::read_dir(std::env::temp_dir()) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry?;
        if !entry
            .file_name()
            .as_encoded_bytes()
            .starts_with(NAMES.as_bytes())
        {
            continue;
        }
        match remove(&entry.path()) {
            Ok(false) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            removed => found.push((entry.path(), removed.err())),
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(found)
}

/// Removes a scratch directory; returns `false` if it is used, or no directory of this user.
fn remove(path: &Path) -> io::Result<bool> {
    let facts = path.symlink_metadata()?;
    if !facts.is_dir() || facts.uid() != geteuid().as_raw() {
        return Ok(false);
    }
    let lock = File::open(path)?;
    match try_lock(&lock)? {
        LockOutcome::Acquired => std::fs::remove_dir_all(path).map(|()| true),
        LockOutcome::InUse => Ok(false),
        LockOutcome::Unsupported(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    #[test]
    fn a_used_directory_is_kept_and_an_abandoned_one_removed() {
        let used = Scratch::create().unwrap();
        std::fs::write(used.path().join("file"), "text").unwrap();
        assert!(!remove(used.path()).unwrap());
        let Scratch {
            mut folder,
            _lock: lock,
        } = used;
        folder.disable_cleanup(true);
        assert!(!remove(folder.path()).unwrap());
        drop(lock);
        // A program that another test starts holds all locks of this process until it is executed.
        let begin = Instant::now();
        while !remove(folder.path()).unwrap() {
            assert!(begin.elapsed() < Duration::from_secs(10));
            std::thread::yield_now();
        }
        assert!(!folder.path().exists());
        assert!(!remove(Path::new("/dev/null")).unwrap());
    }
}
