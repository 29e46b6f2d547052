//! Writing a picture into a file, whole or not at all.

use std::io::Write as _;
use std::path::Path;

use crate::logs::LogsError;
use crate::logs::place::{Place, Readers};

/// Writes the picture beside its destination and then puts it there in one step: whoever looks
/// sees the old file, no file, or the whole picture. `log` is what it was drawn from.
///
/// # Errors
/// [`LogsError`] without `force` if there is a file already, in any case if that is the
/// log, and if it cannot be written.
pub fn save(svg: &str, path: &Path, log: &Path, force: bool) -> Result<(), LogsError> {
    let (place, mut file) = Place::new(path, log, force, Readers::Anybody)?;
    file.write_all(svg.as_bytes())
        .map_err(|source| place.failed(source))?;
    place.take(file)
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
        assert!(error.to_string().contains("exists already"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        save("two", &path, &log, true).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        let error = save("svg", &log, &log, true).unwrap_err();
        assert!(error.to_string().contains("is the log itself"), "{error}");
        assert_eq!(fs::read_to_string(&log).unwrap(), "log");
    }

    #[test]
    fn nothing_is_left_when_the_picture_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("a.mcap");
        let missing = folder.path().join("no/such/a.svg");
        let error = save("svg", &missing, &log, false).unwrap_err();
        assert!(matches!(error, LogsError::Write { .. }), "{error}");
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
