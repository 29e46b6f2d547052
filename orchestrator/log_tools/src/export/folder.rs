//! Directory of exported files.

use std::fs;
use std::path::Path;

use mcap_log::{DerivedError, derived};

/// Directory of exported files; removed again if it was created for them and stays empty.
pub struct Folder<'a> {
    path: &'a Path,
    made: bool,
}

impl<'a> Folder<'a> {
    /// Creates the directory; with `force` it may exist and contain files.
    pub(super) fn make(path: &'a Path, force: bool) -> Result<Self, DerivedError> {
        let refused = derived::refused(path);
        let made = match fs::create_dir(path) {
            Ok(()) => true,
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {
                if !path.metadata().map_err(&refused)?.is_dir() {
                    return Err(refused(e));
                }
                if !force && fs::read_dir(path).map_err(&refused)?.next().is_some() {
                    return Err(DerivedError::Exists {
                        path: path.to_owned(),
                    });
                }
                false
            }
            Err(e) => return Err(refused(e)),
        };
        Ok(Self { path, made })
    }

    /// Keeps the directory.
    pub(super) fn keep(mut self) {
        self.made = false;
    }
}

impl Drop for Folder<'_> {
    fn drop(&mut self) {
        if self.made {
            // Removes only an empty directory: other files in it belong to the user.
            let _ = fs::remove_dir(self.path);
        }
    }
}
