//! Lock and manifest of a directory of results.

use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::path::Path;

use platform::atomic_file::{AtomicFile, ExistingFile, Readers};
use platform::file_lock::{LockOutcome, try_lock};
use platform::own_file;
use platform::presence::unless_absent;

use super::error::SweepError;
use super::kind::Kind;
use super::manifest::{FORMAT, Manifest};

/// Name of the manifest.
pub const MANIFEST: &str = "manifest.json";
/// Name of the file that a running sweep locks.
const LOCK: &str = "lock";

/// Returns the kind of the missions whose results a directory contains.
///
/// # Errors
/// [`SweepError`] if it contains none, or its manifest cannot be read.
pub fn kind_of(directory: &Path) -> Result<Kind, SweepError> {
    let manifest = read_manifest(directory)?.ok_or_else(|| SweepError::NotResults {
        path: directory.to_owned(),
        file: MANIFEST,
        expected: "name the --out of a sweep",
    })?;
    Ok(manifest.kind)
}

/// A lock of a directory of results, until this is dropped.
#[derive(Debug)]
pub struct Lock {
    file: File,
    /// Remark for the user if the file system of the directory has no locks.
    pub(super) remark: Option<String>,
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing the file is not enough: a process that another thread is starting has it open
        // too, until it executes its own program.
        let _ = self.file.unlock();
    }
}

/// Locks a directory of results.
///
/// # Errors
/// [`SweepError::InUse`] if another sweep uses it.
pub fn lock(directory: &Path) -> Result<Lock, SweepError> {
    let path = directory.join(LOCK);
    let mut options = OpenOptions::new();
    options.create(true).write(true);
    let file = own_file::open(&path, &options);
    let file = file.map_err(SweepError::io(&path, "cannot be opened"))?;
    let outcome = try_lock(&file).map_err(SweepError::io(&path, "the directory is not used"))?;
    if matches!(outcome, LockOutcome::InUse) {
        return Err(SweepError::InUse {
            path: directory.to_owned(),
        });
    }
    let remark = outcome.remark(directory);
    Ok(Lock { file, remark })
}

/// Reads the manifest of a directory; `None` if it has none.
///
/// # Errors
/// [`SweepError`] if it is damaged or has another format.
pub fn read_manifest(directory: &Path) -> Result<Option<Manifest>, SweepError> {
    let path = directory.join(MANIFEST);
    let found = unless_absent(std::fs::read(&path));
    let Some(text) = found.map_err(SweepError::io(&path, "cannot be read"))? else {
        return Ok(None);
    };
    let damaged = |what: String, line: usize| SweepError::Damaged {
        path: path.clone(),
        line,
        what,
        found: String::from_utf8_lossy(text.get(..text.len().min(60)).unwrap_or_default())
            .into_owned(),
        expected: "the manifest of a sweep's results",
    };
    // The format first: other keys may depend on it.
    let json: serde_json::Value =
        serde_json::from_slice(&text).map_err(|e| damaged(e.to_string(), e.line()))?;
    let format = json.get("format").and_then(serde_json::Value::as_u64);
    if let Some(format) = format.filter(|&format| format != u64::from(FORMAT)) {
        return Err(SweepError::Other {
            path: directory.to_owned(),
            difference: format!(
                "its files have format {format}, this program writes format {FORMAT}"
            ),
        });
    }
    let manifest: Manifest =
        serde_json::from_slice(&text).map_err(|e| damaged(e.to_string(), e.line()))?;
    if manifest.blake3 != manifest.fingerprint() {
        return Err(damaged("its hash does not match: it was edited".into(), 1));
    }
    Ok(Some(manifest))
}

/// Replaces the manifest of a directory.
///
/// # Errors
/// [`SweepError`] if it cannot be written.
pub fn write_manifest(directory: &Path, manifest: &Manifest) -> Result<(), SweepError> {
    let path = directory.join(MANIFEST);
    let mut text = serde_json::to_vec_pretty(manifest)
        .map_err(|e| SweepError::io(&path, "cannot be written")(e.into()))?;
    text.push(b'\n');
    replace(&path, &text)
}

/// Replaces a file atomically.
///
/// # Errors
/// [`SweepError`] if it cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<(), SweepError> {
    replace_with(path, |mut file| file.write_all(bytes).map(|()| file))
}

/// Replaces a file atomically by a temporary file that `write` fills.
///
/// # Errors
/// [`SweepError`] if it cannot be written.
pub fn replace_with(
    path: &Path,
    write: impl FnOnce(AtomicFile) -> io::Result<AtomicFile>,
) -> Result<(), SweepError> {
    AtomicFile::create(path, ExistingFile::Replace, Readers::All)
        .and_then(write)
        .and_then(AtomicFile::commit)
        .map_err(SweepError::io(path, "cannot be written"))
}
