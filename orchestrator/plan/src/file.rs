//! Files of instances: a JSON array.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::field::{FieldError, read_instance};
use super::instance::Instance;
use super::loose::Loose;

/// Maximum size of a file (bytes).
pub const MAX_FILE: u64 = 64 << 20;
/// Maximum length of an id (characters).
pub const MAX_ID: usize = 200;

/// An element of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Id of the instance.
    pub id: String,
    /// The instance, or its fault.
    pub instance: Result<Instance, FieldError>,
}

/// Error of a file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct FileError {
    /// Path of the file.
    pub path: PathBuf,
    /// Problem of the file.
    pub problem: FileProblem,
}

/// Problem of a whole file.
#[derive(Debug, thiserror::Error)]
pub enum FileProblem {
    /// The file is unreadable.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is a directory or a device.
    #[error("not a regular file; expected a JSON array of instances")]
    NotAFile,
    /// It is larger than [`MAX_FILE`].
    #[error("larger than {} MiB; expected a JSON array of instances, split over several files", MAX_FILE >> 20)]
    TooLarge,
    /// It is not valid JSON.
    #[error("not JSON: {0}; expected an array of instances")]
    Json(#[from] serde_json::Error),
    /// It is JSON, but not an array of instances.
    #[error("{found}; expected an array of at least one instance")]
    NotInstances {
        /// Description of the contents.
        found: String,
    },
    /// An element is not an instance.
    #[error("element {index} is {found}; expected an instance, an object")]
    NotAnObject {
        /// Index of the element, from 0.
        index: usize,
        /// Description of the element.
        found: String,
    },
    /// An element has no valid id.
    #[error("element {index}: id = {found}; expected a text of 1 to {MAX_ID} characters")]
    Nameless {
        /// Index of the element, from 0.
        index: usize,
        /// Value of the id.
        found: String,
    },
    /// Two elements have the same id.
    #[error("elements {first} and {second} have the same id {id:?}; expected different ones")]
    Duplicate {
        /// Id of both.
        id: String,
        /// Index of the first element.
        first: usize,
        /// Index of the second element.
        second: usize,
    },
}

/// Reads a file. Each invalid instance has its own error; the others are usable.
///
/// # Errors
/// [`FileError`] if the whole file is unusable.
pub fn read(path: &Path) -> Result<Vec<Element>, FileError> {
    let read = || -> Result<Vec<Element>, FileProblem> {
        // Check before opening: opening a FIFO would block.
        if !path.metadata()?.is_file() {
            return Err(FileProblem::NotAFile);
        }
        let file = std::fs::File::open(path)?;
        let mut bytes = Vec::new();
        file.take(MAX_FILE + 1).read_to_end(&mut bytes)?;
        parse(&bytes)
    };
    read().map_err(|problem| FileError {
        path: path.to_owned(),
        problem,
    })
}

/// Reads the text of a file.
///
/// # Errors
/// [`FileProblem`] if the whole text is unusable.
pub fn parse(bytes: &[u8]) -> Result<Vec<Element>, FileProblem> {
    if bytes.len() as u64 > MAX_FILE {
        return Err(FileProblem::TooLarge);
    }
    // Not as one `Loose`, which limits the number of stored elements.
    let start = bytes.iter().find(|b| !b.is_ascii_whitespace());
    if start != Some(&b'[') {
        let json: Loose = serde_json::from_slice(bytes)?;
        let found = json.to_string();
        return Err(FileProblem::NotInstances { found });
    }
    let list: Vec<Loose> = serde_json::from_slice(bytes)?;
    if list.is_empty() {
        let found = "an empty array".to_owned();
        return Err(FileProblem::NotInstances { found });
    }
    let mut elements = Vec::with_capacity(list.len());
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for (index, value) in list.iter().enumerate() {
        if !matches!(value, Loose::Object(_)) {
            let found = value.to_string();
            return Err(FileProblem::NotAnObject { index, found });
        }
        let id = match value.get("id") {
            Some(Loose::Text(id)) if (1..=MAX_ID).contains(&id.chars().count()) => id.clone(),
            other => {
                let found = other.map_or_else(|| "nothing".to_owned(), ToString::to_string);
                return Err(FileProblem::Nameless { index, found });
            }
        };
        if let Some(&first) = seen.get(&id) {
            let second = index;
            return Err(FileProblem::Duplicate { id, first, second });
        }
        seen.insert(id.clone(), index);
        let instance = read_instance(&id, value);
        elements.push(Element { id, instance });
    }
    Ok(elements)
}
