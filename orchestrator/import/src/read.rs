//! Files and their names.

use std::path::Path;

use scenario::files::{Base, Refused};

/// Maximum size of a text (bytes).
pub const MAX_TEXT: u64 = 256 << 20;

/// Reads a text file.
pub fn text(path: &Path) -> Result<String, Refused> {
    let name = path.file_name().and_then(|name| name.to_str());
    base(path, true).read_text(name.unwrap_or_default(), MAX_TEXT)
}

/// Returns the base of the paths in a file: its folder, which they may leave if `allow_outside` is set.
pub fn base(path: &Path, allow_outside: bool) -> Base {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    Base::Folder {
        folder: folder.unwrap_or(Path::new(".")).to_owned(),
        allow_outside,
    }
}

/// Returns the extension of a path in lower case; empty if it has none.
pub fn extension(path: &Path) -> String {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.unwrap_or_default().to_ascii_lowercase()
}

/// Returns the name of a file without its extension, other characters than letters, digits, `.`, `-` and `_` replaced.
pub fn stem(path: &Path) -> String {
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let allowed = |c: char| {
        if c.is_alphanumeric() || ".-".contains(c) {
            c
        } else {
            '_'
        }
    };
    let stem: String = stem.unwrap_or_default().chars().map(allowed).collect();
    if stem.is_empty() {
        "world".to_owned()
    } else {
        stem
    }
}
