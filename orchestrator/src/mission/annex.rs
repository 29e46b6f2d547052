//! Directories that a command makes for runs of its own, for their logs or as their runtime directory, beside
//! that of the user: noted in a run directory that is locked as long as the command lives, so that `clean` finds them when it does
//! not any more, however it ended.

use std::fs::DirBuilder;
use std::os::unix::ffi::{OsStrExt as _, OsStringExt as _};
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};

use super::spaces::{self, Found, OwnedSpace, SpaceError};

/// File of a run directory that names the directory with the annex.
const NOTE: &str = "annex";
/// Its runtime directory, below that.
const RUNTIME: &str = "rt";

/// A directory with a runtime directory in it. Dropped, it goes with all that is in it; what runs in
/// it have of shared memory must have gone before.
#[derive(Debug)]
pub struct Annex {
    directory: tempfile::TempDir,
    // After the directory: as long as that is there, it is noted.
    _noted_in: OwnedSpace,
}

impl Annex {
    /// Makes one, for this user only.
    ///
    /// # Errors
    /// [`SpaceError`] if the system refuses.
    pub fn create() -> Result<Self, SpaceError> {
        // Short: names of sockets below it are limited.
        Self::create_in(Path::new("/tmp"))
    }

    /// Makes one for files only, where the user has those that are temporary.
    ///
    /// # Errors
    /// [`SpaceError`] if the system refuses.
    pub fn for_files() -> Result<Self, SpaceError> {
        let above = std::env::temp_dir();
        Self::create_in(&std::path::absolute(&above).map_err(spaces::io(&above))?)
    }

    fn create_in(above: &Path) -> Result<Self, SpaceError> {
        let space = OwnedSpace::create()?;
        let directory = tempfile::Builder::new()
            .prefix("pc")
            .rand_bytes(6)
            .permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700))
            .tempdir_in(above)
            .map_err(spaces::io(above))?;
        let note = space.space().root().join(NOTE);
        std::fs::write(&note, directory.path().as_os_str().as_bytes())
            .map_err(spaces::io(&note))?;
        let runtime = directory.path().join(RUNTIME);
        let made = DirBuilder::new().mode(0o700).create(&runtime);
        made.map_err(spaces::io(&runtime))?;
        Ok(Self {
            directory,
            _noted_in: space,
        })
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        self.directory.path()
    }

    /// What `XDG_RUNTIME_DIR` is for runs in it.
    pub fn runtime_dir(&self) -> PathBuf {
        self.path().join(RUNTIME)
    }

    /// The directory of all runs in it.
    pub fn base(&self) -> PathBuf {
        spaces::base_below(&self.runtime_dir())
    }
}

/// What becomes of an annex whose command is gone.
pub(super) enum Abandoned {
    /// There is none, or no more.
    Gone(Vec<Found>),
    /// Runs in it live on, or something of it cannot be removed: it stays.
    Stays(Vec<Found>),
}

/// Cleans the annex that is noted in the directory of a run whose orchestrator is gone.
pub(super) fn clean(root: &Path) -> Abandoned {
    let Ok(note) = std::fs::read(root.join(NOTE)) else {
        return Abandoned::Gone(Vec::new());
    };
    let directory = PathBuf::from(std::ffi::OsString::from_vec(note));
    let user = rustix::process::getuid().as_raw();
    // Gone, or somebody else's by now: above it anybody may make one of its name.
    let is_ours = directory.symlink_metadata().is_ok_and(|found| {
        let is_open = found.mode() & 0o077 != 0;
        found.is_dir() && found.uid() == user && !is_open
    });
    if !is_ours {
        return Abandoned::Gone(Vec::new());
    }
    let base = spaces::base_below(&directory.join(RUNTIME));
    let mut found = match base.is_dir().then(|| spaces::clean_below(base)) {
        None => Vec::new(),
        Some(Ok(found)) => found,
        Some(Err(error)) => return stays(directory, &error, Vec::new()),
    };
    if found.iter().any(|f| !matches!(f, Found::Removed { .. })) {
        return Abandoned::Stays(found);
    }
    if let Err(error) = std::fs::remove_dir_all(&directory) {
        return stays(directory, &error, found);
    }
    found.push(Found::Removed {
        root: directory,
        killed: Vec::new(),
    });
    Abandoned::Gone(found)
}

fn stays(directory: PathBuf, why: &dyn std::fmt::Display, mut found: Vec<Found>) -> Abandoned {
    found.push(Found::Failed(directory, why.to_string()));
    Abandoned::Stays(found)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    /// A run directory whose annex is the directory with this mode.
    fn noted(mode: u32) -> (tempfile::TempDir, tempfile::TempDir) {
        let (root, annex) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let note = annex.path().as_os_str().as_bytes();
        fs::write(root.path().join(NOTE), note).unwrap();
        fs::set_permissions(annex.path(), fs::Permissions::from_mode(mode)).unwrap();
        (root, annex)
    }

    #[test]
    fn an_abandoned_annex_goes_with_what_is_in_it() {
        let (root, annex) = noted(0o700);
        fs::write(annex.path().join("mission.mcap"), "log").unwrap();
        let found = match clean(root.path()) {
            Abandoned::Gone(found) => found,
            Abandoned::Stays(found) => panic!("stays: {found:?}"),
        };
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(!annex.path().exists());
        // And once more, when it is gone.
        assert!(matches!(clean(root.path()), Abandoned::Gone(found) if found.is_empty()));
    }

    #[test]
    fn what_others_can_open_or_is_only_a_link_is_no_annex_of_ours() {
        let (root, annex) = noted(0o755);
        assert!(matches!(clean(root.path()), Abandoned::Gone(found) if found.is_empty()));
        assert!(annex.path().exists());

        let private = tempfile::tempdir().unwrap();
        fs::set_permissions(private.path(), fs::Permissions::from_mode(0o700)).unwrap();
        let link = annex.path().join("link");
        std::os::unix::fs::symlink(private.path(), &link).unwrap();
        fs::write(root.path().join(NOTE), link.as_os_str().as_bytes()).unwrap();
        assert!(matches!(clean(root.path()), Abandoned::Gone(found) if found.is_empty()));
        assert!(private.path().exists());
    }

    #[test]
    fn a_run_without_an_annex_has_none() {
        let root = tempfile::tempdir().unwrap();
        assert!(matches!(clean(root.path()), Abandoned::Gone(found) if found.is_empty()));
    }
}
