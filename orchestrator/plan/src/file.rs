//! Files of instances: a JSON array.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::field::{FieldError, read_instance};
use super::instance::Instance;
use super::loose::Loose;

/// Largest file that is read (bytes).
pub const MAX_FILE: u64 = 64 << 20;
/// Most characters of an id.
pub const MAX_ID: usize = 200;

/// An element of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its name.
    pub id: String,
    /// The instance, or what is wrong with it.
    pub instance: Result<Instance, FieldError>,
}

/// Why a file is of no use.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: FileProblem,
}

/// What is wrong with a file as a whole.
#[derive(Debug, thiserror::Error)]
pub enum FileProblem {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// It is no file, but a directory or a device.
    #[error("not a regular file; expected a JSON array of instances")]
    NotAFile,
    /// It is larger than anything that is meant.
    #[error("larger than {} MiB; expected a JSON array of instances, in several files if need be", MAX_FILE >> 20)]
    TooLarge,
    /// It is not JSON.
    #[error("not JSON: {0}; expected an array of instances")]
    Json(#[from] serde_json::Error),
    /// It is JSON of another form.
    #[error("{found}; expected an array of at least one instance")]
    NotInstances {
        /// What it is.
        found: String,
    },
    /// An element is not an instance.
    #[error("element {index} is {found}; expected an instance, an object")]
    NotAnObject {
        /// Its number, from 0.
        index: usize,
        /// What it is.
        found: String,
    },
    /// An element has no name.
    #[error("element {index}: id = {found}; expected a text of 1 to {MAX_ID} characters")]
    Nameless {
        /// Its number, from 0.
        index: usize,
        /// What is there.
        found: String,
    },
    /// Two elements have the same name.
    #[error("elements {first} and {second} have the same id {id:?}; expected different ones")]
    Duplicate {
        /// The name.
        id: String,
        /// Number of the first.
        first: usize,
        /// Number of the second.
        second: usize,
    },
}

/// Reads a file. What is wrong with single instances is said at these; the others can be used.
///
/// # Errors
/// [`FileError`] if nothing of it can.
pub fn read(path: &Path) -> Result<Vec<Element>, FileError> {
    let read = || -> Result<Vec<Element>, FileProblem> {
        // Look before opening: opening a FIFO would block.
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
/// [`FileProblem`].
pub fn parse(bytes: &[u8]) -> Result<Vec<Element>, FileProblem> {
    if bytes.len() as u64 > MAX_FILE {
        return Err(FileProblem::TooLarge);
    }
    // Not as one `Loose`, which keeps only so many elements of a list.
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
