//! Text files that users write.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Opens a regular file: opening a FIFO would block, and reading a device may never end.
///
/// # Errors
/// The file is missing, not permitted, or not a regular one.
pub fn open(path: &Path) -> io::Result<File> {
    if path.metadata()?.is_file() {
        File::open(path)
    } else {
        Err(io::Error::other("not a regular file"))
    }
}

/// Reads a text of at most `max` bytes, without its byte order mark.
///
/// # Errors
/// As [`read_bytes`]; [`ErrorKind::InvalidData`] if the text is not UTF-8.
pub fn read(input: impl Read, max: u64) -> io::Result<String> {
    let bytes = read_bytes(input, max)?;
    let text = str::from_utf8(without_mark(&bytes));
    let not_text = |_| io::Error::new(ErrorKind::InvalidData, "not text: expected UTF-8 text");
    text.map(str::to_owned).map_err(not_text)
}

/// Reads at most `max` bytes.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`], or the error of the reader.
pub fn read_bytes(input: impl Read, max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(max.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        let message = format!("too large: expected at most {max} bytes");
        return Err(io::Error::new(ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// Returns a text without the byte order mark with which some editors begin a file.
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_mark_at_the_start_is_left_out_and_counts_as_bytes() {
        let marked = "\u{feff}a\u{feff}".as_bytes();
        assert_eq!(read(marked, 7).unwrap(), "a\u{feff}");
        assert_eq!(read("\u{feff}".as_bytes(), 3).unwrap(), "");
        let error = read(marked, 6).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("at most 6 bytes"), "{error}");
    }

    #[test]
    fn other_encodings_and_other_files_are_refused() {
        // The mark of UTF-16.
        let error = read(&b"\xff\xfea\0"[..], 9).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
        assert!(open(Path::new("/dev/null")).is_err());
    }
}
