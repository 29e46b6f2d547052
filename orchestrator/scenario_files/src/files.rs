//! Access to the files that a scenario refers to, and its restrictions.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use geometry::text_file;

use crate::builtin;

/// Base of the relative paths of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Base {
    /// A folder on disk.
    Folder {
        /// The folder of the scenario file.
        folder: PathBuf,
        /// `true` if paths may lead out of the folder.
        allow_outside: bool,
    },
    /// The maps compiled into the program, and the current folder for paths of `--set`.
    Builtin {
        /// `true` if paths may lead out of the folder.
        allow_outside: bool,
    },
    /// No files: the scenario must be self-contained, as one stored in a log is.
    Nothing,
}

/// A file of a scenario.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ScenarioFile {
    /// On disk; it exists and its place is permitted.
    Disk(PathBuf),
    /// Compiled into the program.
    Text(&'static str),
}

/// Reason why a path of a scenario is refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}: expected {expected}")]
pub struct PathRefusal {
    /// Description of the problem.
    pub message: String,
    /// Description of a valid value.
    pub expected: String,
}

fn refused<T>(message: impl Into<String>, expected: impl Into<String>) -> Result<T, PathRefusal> {
    Err(PathRefusal {
        message: message.into(),
        expected: expected.into(),
    })
}

impl Base {
    /// Returns the absolute path of a folder in the scenario; without a folder of its own, relative paths refer to the
    /// current one.
    ///
    /// # Errors
    /// The path is not UTF-8, or the current folder is unknown.
    pub fn absolute(&self, path: &str) -> Result<String, PathRefusal> {
        let base = match self {
            Self::Folder { folder, .. } => folder.as_path(),
            Self::Builtin { .. } | Self::Nothing => Path::new("."),
        };
        let full = match std::path::absolute(base.join(path)) {
            Ok(full) => full,
            Err(e) => return refused(format!("{path:?}: {e}"), "a folder"),
        };
        let text = full.to_str().map(|text| text.trim_end_matches('/'));
        match text {
            Some("") => Ok("/".to_owned()),
            Some(text) => Ok(text.to_owned()),
            None => refused(format!("{}: not UTF-8", full.display()), "a UTF-8 path"),
        }
    }

    /// Reads a file of at most `max` bytes that is no map.
    ///
    /// # Errors
    /// As [`Base::find`]; the file is too large. Built-in scenarios and those from logs have no such files.
    pub fn read(&self, path: &str, max: u64) -> Result<Vec<u8>, PathRefusal> {
        let found = match self {
            Self::Folder { .. } => self.find(path)?,
            Self::Builtin { .. } | Self::Nothing => {
                return refused(
                    "this scenario cannot refer to files",
                    "the file's contents, or a scenario in a folder",
                );
            }
        };
        match found {
            ScenarioFile::Disk(real) => read_bytes(&real, max),
            ScenarioFile::Text(text) => Ok(text.as_bytes().to_vec()),
        }
    }

    /// Finds the file that a path in the scenario refers to.
    ///
    /// # Errors
    /// The path leads out of the scenario's folder (directly or by a symbolic link) without permission, or
    /// it is not a readable file.
    pub fn find(&self, path: &str) -> Result<ScenarioFile, PathRefusal> {
        let (folder, allow_outside) = match self {
            Self::Nothing => {
                return refused(
                    "this scenario cannot refer to files",
                    "a map written in the scenario itself",
                );
            }
            Self::Builtin { allow_outside } => match builtin::map(path) {
                Some(text) => return Ok(ScenarioFile::Text(text)),
                None => (Path::new("."), *allow_outside),
            },
            Self::Folder {
                folder,
                allow_outside,
            } => (folder.as_path(), *allow_outside),
        };
        if path.is_empty() || path.contains('\0') {
            return refused("not a path", "the path of a file");
        }
        let leaves = |c: Component| !matches!(c, Component::Normal(_) | Component::CurDir);
        if !allow_outside && Path::new(path).components().any(leaves) {
            return refused(
                "path leads out of the scenario's folder",
                "a relative path without `..`",
            );
        }
        let full = folder.join(path);
        let real = match full.canonicalize() {
            Ok(real) => real,
            Err(e) => return refused(format!("{}: cannot be read: {e}", full.display()), "a file"),
        };
        if !allow_outside {
            let folder = match folder.canonicalize() {
                Ok(folder) => folder,
                Err(e) => {
                    return refused(
                        format!("{}: cannot be read: {e}", folder.display()),
                        "a folder",
                    );
                }
            };
            if !real.starts_with(folder) {
                return refused(
                    format!(
                        "path leads out of the scenario's folder, to {}",
                        real.display()
                    ),
                    "a file inside the folder",
                );
            }
        }
        match fs::metadata(&real) {
            Ok(data) if data.is_file() => Ok(ScenarioFile::Disk(real)),
            Ok(_) => refused(format!("{} is not a file", full.display()), "a file"),
            Err(e) => refused(format!("{}: cannot be read: {e}", full.display()), "a file"),
        }
    }
}

/// Reads a text file of at most `max` bytes, without its byte order mark.
///
/// # Errors
/// The file is unreadable, is larger than `max`, or is not UTF-8.
pub fn read_text(path: &Path, max: u64) -> Result<String, PathRefusal> {
    let read = fs::File::open(path).and_then(|file| text_file::read(file, max));
    read.map_err(|error| refusal(path, max, &error))
}

/// Reads a file of at most `max` bytes.
fn read_bytes(path: &Path, max: u64) -> Result<Vec<u8>, PathRefusal> {
    let read = fs::File::open(path).and_then(|file| text_file::read_bytes(file, max));
    read.map_err(|error| refusal(path, max, &error))
}

/// Returns the description of an error of reading.
fn refusal(path: &Path, max: u64, error: &io::Error) -> PathRefusal {
    let shown = path.display();
    let (message, expected) = match error.kind() {
        io::ErrorKind::FileTooLarge => (
            format!("{shown} is too large"),
            format!("at most {max} bytes"),
        ),
        io::ErrorKind::InvalidData => (format!("{shown} is not text"), "UTF-8 text".to_owned()),
        _ => (
            format!("{shown}: cannot be read: {error}"),
            "a readable file".to_owned(),
        ),
    };
    PathRefusal { message, expected }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("in")).unwrap();
        fs::write(dir.path().join("in/map.toml"), "x = 1").unwrap();
        fs::write(dir.path().join("secret"), "s").unwrap();
        std::os::unix::fs::symlink("../secret", dir.path().join("in/link")).unwrap();
        dir
    }

    #[test]
    fn paths_stay_inside_the_folder_unless_allowed_out() {
        let dir = folder();
        let base = |allow_outside| Base::Folder {
            folder: dir.path().join("in"),
            allow_outside,
        };
        assert!(base(false).find("map.toml").is_ok());
        assert!(base(false).find("./map.toml").is_ok());
        let absolute = dir.path().join("secret").display().to_string();
        for path in ["../secret", "x/../../secret", "link", &absolute] {
            let e = base(false).find(path).unwrap_err();
            assert!(
                e.message.contains("out of the scenario's folder"),
                "{path}: {e:?}"
            );
        }
        for path in ["../secret", "link", &absolute] {
            assert!(base(true).find(path).is_ok(), "{path}");
        }
    }

    #[test]
    fn missing_files_and_folders_are_named() {
        let dir = folder();
        let base = Base::Folder {
            folder: dir.path().to_owned(),
            allow_outside: false,
        };
        assert!(
            base.find("nope.toml")
                .unwrap_err()
                .message
                .contains("nope.toml")
        );
        assert!(base.find("in").unwrap_err().message.contains("not a file"));
        assert!(base.find("").is_err());
        assert!(base.find("a\0b").is_err());
        assert!(Base::Nothing.find("in/map.toml").is_err());
    }

    #[test]
    fn files_of_parameters_are_in_folders_alone() {
        let dir = folder();
        let base = Base::Folder {
            folder: dir.path().join("in"),
            allow_outside: false,
        };
        assert_eq!(base.read("map.toml", 5), Ok(b"x = 1".to_vec()));
        assert!(
            base.read("map.toml", 4)
                .unwrap_err()
                .message
                .contains("too large")
        );
        assert!(base.read("../secret", 5).is_err());
        let builtin = Base::Builtin {
            allow_outside: true,
        };
        for base in [builtin, Base::Nothing] {
            let e = base.read("maps/city.toml", 1 << 20).unwrap_err();
            assert_eq!(e.message, "this scenario cannot refer to files");
        }
    }

    #[test]
    fn large_and_binary_files_are_refused() {
        let dir = folder();
        let path = dir.path().join("big");
        fs::write(&path, vec![b'a'; 100]).unwrap();
        assert!(read_text(&path, 100).is_ok());
        assert!(
            read_text(&path, 99)
                .unwrap_err()
                .message
                .contains("too large")
        );
        fs::write(&path, [0xff, 0xfe]).unwrap();
        assert_eq!(read_text(&path, 99).unwrap_err().expected, "UTF-8 text");
    }
}
