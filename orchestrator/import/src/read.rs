//! Files.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use super::ImportError;

/// Maximum size of a file (bytes).
const MAX_FILE: u64 = 256 << 20;

/// Reads a regular file of at most [`MAX_FILE`] bytes.
pub fn text(path: &Path) -> Result<String, ImportError> {
    let read = || {
        // Opening a FIFO would block.
        if !path.metadata()?.is_file() {
            return Err(io::Error::other("not a regular file"));
        }
        let mut text = String::new();
        let file = File::open(path)?.take(MAX_FILE + 1);
        if io::BufReader::new(file).read_to_string(&mut text)? as u64 > MAX_FILE {
            let message = format!("more than {MAX_FILE} bytes");
            return Err(io::Error::other(message));
        }
        Ok(text)
    };
    read().map_err(|source| ImportError::Io {
        path: path.to_owned(),
        source,
    })
}

/// Returns the extension of a path in lower case; empty if it has none.
pub fn extension(path: &Path) -> String {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.unwrap_or_default().to_ascii_lowercase()
}

/// Returns the name of a file without its extensions, of the characters that names of scenarios and maps permit.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().and_then(|name| name.to_str());
    let stem = name.unwrap_or_default().split('.').next();
    let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let stem: String = stem.unwrap_or_default().chars().map(allowed).collect();
    if stem.is_empty() {
        "world".to_owned()
    } else {
        stem
    }
}
