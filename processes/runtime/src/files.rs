//! Files as values of parameters.
//!
//! A scenario names a file by its path. The resolved scenario, its log and the configuration of the process have the
//! contents instead, as a `data:` URL (RFC 2397): a log needs no other file to be executed again.

use data_encoding::BASE64;

/// Maximum size of a file (bytes).
pub const MAX_FILE: u64 = 4 << 20;

/// Beginning of the text of contents.
const PREFIX: &str = "data:application/octet-stream;base64,";

/// Returns `true` if the value of a parameter is the contents of a file, not its path.
pub fn is_contents(value: &str) -> bool {
    value.starts_with("data:")
}

/// Returns the value of a parameter with these contents.
pub fn value(contents: &[u8]) -> String {
    format!("{PREFIX}{}", BASE64.encode(contents))
}

/// Returns the contents that the value of a parameter has; `None` if it is no such text.
pub fn contents(value: &str) -> Option<Vec<u8>> {
    let text = value.strip_prefix(PREFIX)?;
    BASE64.decode(text.as_bytes()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_survive_as_text() {
        let bytes: Vec<u8> = (0..=255).collect();
        let text = value(&bytes);
        assert!(is_contents(&text) && !is_contents("models/a.onnx"));
        assert_eq!(contents(&text), Some(bytes));
        assert_eq!(contents("data:application/octet-stream;base64,?"), None);
        assert_eq!(contents("data:text/plain,abc"), None);
    }
}
