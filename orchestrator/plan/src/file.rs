//! Files of instances: a JSON array.

use core::fmt;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use geometry::text_file;
use platform::file_kind::FileKind;
use serde::de::{Deserializer as _, IgnoredAny, SeqAccess, Visitor};

use super::field::{FieldError, read_instance};
use super::instance::Instance;
use super::loose::Loose;

/// Maximum size of a file (bytes).
pub const MAX_FILE: u64 = 64 << 20;
/// Maximum number of invalid instances of a usable file.
pub const MAX_INVALID: usize = 1000;
/// Maximum length of an id (characters).
pub const MAX_ID: usize = 200;

/// An element of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Id of the instance; `element` and the index without a valid one.
    pub id: String,
    /// The instance, or its fault.
    pub instance: Result<Instance, FieldError>,
}

/// Error of a file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}{}", path.display(), kind.map_or_else(String::new, |kind| format!("; {}", kind.help(path))))]
pub struct FileError {
    /// Path of the file.
    pub path: PathBuf,
    /// Its kind, if it is a known one of another file.
    pub kind: Option<FileKind>,
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
    #[error("not a regular file: expected a JSON array of instances")]
    NotAFile,
    /// It is larger than [`MAX_FILE`].
    #[error("larger than {} MiB: expected a JSON array of instances, split over several files", MAX_FILE >> 20)]
    TooLarge,
    /// It is not valid JSON.
    #[error("not JSON: {0}: expected an array of instances")]
    Json(#[from] serde_json::Error),
    /// More than [`MAX_INVALID`] instances are invalid.
    #[error(
        "more than {MAX_INVALID} invalid instances, the first: {first}: expected an array of instances"
    )]
    TooManyInvalid {
        /// Error of the first one.
        first: FieldError,
    },
    /// It is JSON, but not an array of instances.
    #[error("{found}: expected an array of at least one instance")]
    NotInstances {
        /// Description of the contents.
        found: String,
    },
}

/// Reads a file. Each of up to [`MAX_INVALID`] invalid instances has its own error; the others are usable.
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
        kind: FileKind::from_path(path)
            .filter(|kind| !matches!(kind, FileKind::Instances | FileKind::Json)),
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
    let bytes = text_file::without_mark(bytes);
    let start = bytes.iter().find(|b| !b.is_ascii_whitespace());
    if start != Some(&b'[') {
        let json: Loose = serde_json::from_slice(bytes)?;
        let found = json.to_string();
        return Err(FileProblem::NotInstances { found });
    }
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let elements = json.deserialize_seq(ElementsVisitor)?;
    json.end()?;
    if elements.is_empty() {
        let found = "an empty array".to_owned();
        return Err(FileProblem::NotInstances { found });
    }
    let mut errors = elements.iter().filter_map(|e| e.instance.as_ref().err());
    let first = errors.next().cloned();
    match (first, errors.nth(MAX_INVALID - 1)) {
        (Some(first), Some(_)) => Err(FileProblem::TooManyInvalid { first }),
        _ => Ok(elements),
    }
}

/// Reads the elements of the array one by one: the JSON of only one is in memory.
struct ElementsVisitor;

impl<'de> Visitor<'de> for ElementsVisitor {
    type Value = Vec<Element>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array of instances")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<Element>, A::Error> {
        let mut elements = Vec::new();
        let mut ids = BTreeMap::new();
        let mut invalid = 0;
        while let Some(json) = list.next_element::<Loose>()? {
            let index = elements.len();
            elements.push(match id(&json, index, &mut ids) {
                Ok(id) => Element {
                    instance: read_instance(&id, &json),
                    id,
                },
                Err(error) => Element {
                    id: format!("element {index}"),
                    instance: Err(error),
                },
            });
            // Each error takes more memory than its text in the file.
            invalid += usize::from(
                elements
                    .last()
                    .is_some_and(|e: &Element| e.instance.is_err()),
            );
            if invalid > MAX_INVALID {
                while list.next_element::<IgnoredAny>()?.is_some() {}
                break;
            }
        }
        Ok(elements)
    }
}

/// Returns the id of an element. `ids` holds those of the elements before it.
fn id(json: &Loose, index: usize, ids: &mut BTreeMap<String, usize>) -> Result<String, FieldError> {
    if !matches!(json, Loose::Object(_)) {
        let field = format!("element {index}");
        return Err(FieldError::new(field, json, "an instance, an object"));
    }
    let id = match json.get("id") {
        Some(Loose::Text(id)) if (1..=MAX_ID).contains(&id.chars().count()) => id.clone(),
        other => {
            let found = other.map_or_else(|| "nothing".to_owned(), ToString::to_string);
            let expected = format!("a text of 1 to {MAX_ID} characters");
            return Err(FieldError::new("id", found, expected));
        }
    };
    match ids.entry(id.clone()) {
        Entry::Occupied(first) => {
            let expected = format!("an id of its own: element {} has it", first.get());
            Err(FieldError::new("id", format!("{id:?}"), expected))
        }
        Entry::Vacant(place) => {
            place.insert(index);
            Ok(id)
        }
    }
}
