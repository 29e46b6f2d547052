//! Existing files that a command locks, continues or replaces.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt as _, OpenOptionsExt as _};
use std::path::Path;

use rustix::fs::OFlags;
use rustix::process::geteuid;

/// Opens a regular file of this user, without following a symbolic link in its place. A link, or the file of another
/// user in a shared directory, would direct the output elsewhere.
///
/// # Errors
/// The error of the operating system; [`io::ErrorKind::InvalidInput`] for a link and for anything but a regular file;
/// [`io::ErrorKind::PermissionDenied`] for a file of another user.
pub fn open(path: &Path, options: &OpenOptions) -> io::Result<File> {
    // A FIFO without a reader would block.
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    let opened = options
        .clone()
        .custom_flags(flags.bits().cast_signed())
        .open(path);
    let file = opened.map_err(|error| {
        if error.raw_os_error() == Some(rustix::io::Errno::LOOP.raw_os_error()) {
            return io::Error::new(io::ErrorKind::InvalidInput, "it is a symbolic link");
        }
        error
    })?;
    let facts = file.metadata()?;
    if !facts.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is not a regular file",
        ));
    }
    if facts.uid() != geteuid().as_raw() {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "it belongs to another user",
        ));
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{chown, symlink};

    use super::*;

    #[test]
    fn links_directories_and_files_of_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("own"), "text").unwrap();
        symlink(path("own"), path("link")).unwrap();
        let mut options = OpenOptions::new();
        options.read(true).write(true);
        assert!(open(&path("own"), &options).is_ok());
        let error = open(&path("link"), &options).unwrap_err();
        assert_eq!(error.to_string(), "it is a symbolic link");
        let error = open(folder.path(), OpenOptions::new().read(true)).unwrap_err();
        assert_eq!(error.to_string(), "it is not a regular file");
        // Only root can give a file away.
        if chown(path("own"), Some(12_345), None).is_ok() {
            let error = open(&path("own"), &options).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
        }
        assert!(open(&path("none"), &options).is_err());
    }
}
