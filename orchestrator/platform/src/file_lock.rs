//! Locks of files, by which processes exclude each other.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;

use rustix::io::Errno;

/// Outcome of an attempt to lock a file.
#[derive(Debug)]
pub enum LockOutcome {
    /// The lock holds until all copies of the open file are closed, or until [`File::unlock`].
    Acquired,
    /// Another process has locked the file.
    InUse,
    /// The file system has no locks, for the reason of the operating system.
    Unsupported(io::Error),
}

impl LockOutcome {
    /// Returns a remark on the file if nothing guards it.
    pub fn remark(&self, path: &Path) -> Option<String> {
        let Self::Unsupported(error) = self else {
            return None;
        };
        Some(format!(
            "{}: its file system has no locks ({error}): nothing guards it against a second writer",
            path.display()
        ))
    }
}

/// Attempts to lock a file for this process alone, without waiting.
///
/// # Errors
/// The error of the operating system, if it is about neither another lock nor the file system.
pub fn try_lock(file: &File) -> io::Result<LockOutcome> {
    let error = match file.try_lock() {
        Ok(()) => return Ok(LockOutcome::Acquired),
        Err(TryLockError::WouldBlock) => return Ok(LockOutcome::InUse),
        Err(TryLockError::Error(error)) => error,
    };
    if has_no_locks(&error) {
        return Ok(LockOutcome::Unsupported(error));
    }
    let text = format!("cannot be locked: {error}");
    Err(io::Error::new(error.kind(), text))
}

/// Returns `true` for an error of a file system without locks: no lock service, or no such call.
fn has_no_locks(error: &io::Error) -> bool {
    let error = Errno::from_io_error(error);
    error.is_some_and(|error| [Errno::NOLCK, Errno::NOSYS, Errno::OPNOTSUPP].contains(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_excludes_every_other_open_file_until_it_is_released() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let (a, b) = (File::create(&path).unwrap(), File::create(&path).unwrap());
        assert!(matches!(try_lock(&a).unwrap(), LockOutcome::Acquired));
        assert!(matches!(try_lock(&b).unwrap(), LockOutcome::InUse));
        a.unlock().unwrap();
        assert!(matches!(try_lock(&b).unwrap(), LockOutcome::Acquired));
        drop(b);
        assert!(matches!(try_lock(&a).unwrap(), LockOutcome::Acquired));
    }

    #[test]
    fn a_remark_names_the_file_and_the_cause() {
        let error = io::Error::from(Errno::NOLCK);
        assert!(has_no_locks(&error));
        assert!(!has_no_locks(&Errno::ACCESS.into()));
        let remark = LockOutcome::Unsupported(error).remark(Path::new("a.mcap"));
        let words = "a.mcap: its file system has no locks (No locks available (os error 37)): ";
        assert!(remark.unwrap().starts_with(words));
        assert_eq!(LockOutcome::InUse.remark(Path::new("a.mcap")), None);
    }
}
