//! Entries of the file system that may be missing. Every other error of the system is an error, never "not there".

use std::fs::Metadata;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Returns what is at a path, without following a symbolic link; `None` if nothing is there.
///
/// # Errors
/// The error of the operating system.
pub fn entry(path: &Path) -> io::Result<Option<Metadata>> {
    unless_absent(path.symlink_metadata())
}

/// Returns `true` if both paths lead to one existing file or directory.
///
/// # Errors
/// The error of the operating system.
pub fn is_same(a: &Path, b: &Path) -> io::Result<bool> {
    let real = |path: &Path| unless_absent::<PathBuf>(path.canonicalize());
    let a = real(a)?;
    Ok(a.is_some() && a == real(b)?)
}

/// Returns what was found, or `None` if nothing is there.
///
/// # Errors
/// Every other error.
pub fn unless_absent<T>(found: io::Result<T>) -> io::Result<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn only_a_missing_entry_is_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), "").unwrap();
        symlink("nowhere", path("dangling")).unwrap();
        symlink("loop", path("loop")).unwrap();
        symlink("file", path("link")).unwrap();
        for (name, is_there) in [
            ("file", true),
            ("dangling", true),
            ("none", false),
            ("file/inside", false),
        ] {
            assert_eq!(entry(&path(name)).unwrap().is_some(), is_there, "{name}");
        }
        assert!(entry(&path("loop/inside")).is_err());
        assert!(entry(&path(&"long".repeat(100))).is_err());
        assert!(is_same(&path("file"), &path("link")).unwrap());
        assert!(!is_same(&path("file"), folder.path()).unwrap());
        assert!(!is_same(&path("none"), &path("none")).unwrap());
        assert!(is_same(&path("loop"), &path("file")).is_err());
    }
}
