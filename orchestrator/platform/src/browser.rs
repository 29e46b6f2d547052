//! The browser of the user.

use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

/// Shows a file in the browser; may last until the browser ends.
///
/// # Errors
/// There is no browser, or no such file.
pub fn open(file: &Path) -> io::Result<()> {
    // A name that begins with a hyphen is no option.
    let file = file.canonicalize()?;
    let mut command = Command::new("xdg-open");
    // Without a browser it lists all that it looked for.
    let ended = command
        .arg(file)
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    if ended.success() {
        return Ok(());
    }
    Err(io::Error::other(ended.to_string()))
}
