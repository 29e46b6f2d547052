//! This program, to be started again.

use std::io;
use std::path::{Path, PathBuf};

/// What starts a program in memory again, also one whose file is gone.
const OF_MEMORY: &str = "/proc/self/exe";

/// What to execute to have this same program again: its file, or, if that has been replaced or removed since
/// (an update in the middle of a run), what is still in memory of it. Another version at its place is never
/// taken for it.
///
/// # Errors
/// What the system says.
pub fn this() -> io::Result<PathBuf> {
    std::env::current_exe().map(present)
}

/// The system tells of a file that is gone by ` (deleted)` behind its name.
fn present(file: PathBuf) -> PathBuf {
    let is_gone = file.to_string_lossy().ends_with(" (deleted)") && !file.exists();
    if is_gone {
        Path::new(OF_MEMORY).to_owned()
    } else {
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_gone_is_not_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("protean");
        assert_eq!(present(file.clone()), file);
        let gone = folder.path().join("protean (deleted)");
        assert_eq!(present(gone.clone()), Path::new(OF_MEMORY));
        // One may be called that.
        std::fs::write(&gone, "").unwrap();
        assert_eq!(present(gone.clone()), gone);
    }
}
