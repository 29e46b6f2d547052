//! Writing a picture into a file, whole or not at all.

use std::fs::Permissions;
use std::io::{self, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use super::error::PictureError;

/// Writes the picture beside its destination and then puts it there in one step: whoever looks
/// sees the old file, no file, or the whole picture. `log` is what it was drawn from.
///
/// # Errors
/// [`PictureError::Exists`] without `force` if there is a file already, [`PictureError::IsTheLog`]
/// in any case if that is the log, [`PictureError::Write`].
pub fn save(svg: &str, path: &Path, log: &Path, force: bool) -> Result<(), PictureError> {
    let failed = |source| PictureError::Write {
        path: path.to_owned(),
        source,
    };
    let exists = || PictureError::Exists {
        path: path.to_owned(),
    };
    if let (Ok(a), Ok(b)) = (path.canonicalize(), log.canonicalize())
        && a == b
    {
        return Err(PictureError::IsTheLog {
            path: log.to_owned(),
        });
    }
    if !force && path.symlink_metadata().is_ok() {
        return Err(exists());
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new()
        .prefix(".protean-picture-")
        // The system takes away what the user's umask forbids.
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(svg.as_bytes()).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    let placed = if force {
        file.persist(path)
    } else {
        file.persist_noclobber(path)
    };
    match placed {
        Ok(_) => Ok(()),
        Err(e) if e.error.kind() == io::ErrorKind::AlreadyExists => Err(exists()),
        Err(e) => Err(failed(e.error)),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn an_existing_picture_is_replaced_only_by_force_and_the_log_never() {
        let folder = tempfile::tempdir().unwrap();
        let (log, path) = (folder.path().join("a.mcap"), folder.path().join("a.svg"));
        fs::write(&log, "log").unwrap();
        save("one", &path, &log, false).unwrap();
        let error = save("two", &path, &log, false).unwrap_err();
        assert!(matches!(error, PictureError::Exists { .. }), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        save("two", &path, &log, true).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        let error = save("svg", &log, &log, true).unwrap_err();
        assert!(matches!(error, PictureError::IsTheLog { .. }), "{error}");
        assert_eq!(fs::read_to_string(&log).unwrap(), "log");
    }

    #[test]
    fn nothing_is_left_when_the_picture_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("a.mcap");
        let missing = folder.path().join("no/such/a.svg");
        let error = save("svg", &missing, &log, false).unwrap_err();
        assert!(matches!(error, PictureError::Write { .. }), "{error}");
        // A folder stands where the picture should go.
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        assert!(save("svg", &taken, &log, true).is_err());
        let names: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(names, ["taken"]);
    }
}
