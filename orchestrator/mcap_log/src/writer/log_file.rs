//! The file below the MCAP writer: locked, buffered, and truncated to complete records when a write fails.

use std::fs::{File, OpenOptions, Permissions};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::{OpenOptionsExt as _, PermissionsExt as _};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use platform::file_lock::{LockOutcome, try_lock};
use platform::own_file;

use crate::LogWriteError;
use crate::writer::storage::Storage;

/// Size of the write buffer for small records such as message indexes and headers (bytes).
const BUFFER_BYTES: usize = 64 * 1024;

/// Permissions of a log: the scenario in it contains the keys of its patrols.
const PRIVATE: u32 = 0o600;

/// Creates the file of a log and locks it while it is open.
///
/// Without `force` the file must not exist. With `force` it truncates an existing regular file of this user that no
/// other run has locked; symbolic links are not followed.
pub fn create(path: &Path, force: bool) -> Result<File, LogWriteError> {
    let failed = |source| LogWriteError::Create {
        path: path.to_owned(),
        source,
    };
    let mut options = OpenOptions::new();
    let options = options.write(true).mode(PRIVATE);
    match options.clone().create_new(true).open(path) {
        Ok(file) => lock(path, file).inspect_err(|error| {
            if !matches!(error, LogWriteError::InUse { .. }) {
                let _ = std::fs::remove_file(path);
            }
        }),
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            if !path.symlink_metadata().map_err(failed)?.is_file() {
                return Err(LogWriteError::NotAFile {
                    path: path.to_owned(),
                });
            }
            if !force {
                return Err(LogWriteError::Exists {
                    path: path.to_owned(),
                });
            }
            let file = lock(path, own_file::open(path, options).map_err(failed)?)?;
            file.set_permissions(Permissions::from_mode(PRIVATE))
                .and_then(|()| file.set_len(0))
                .map_err(failed)?;
            Ok(file)
        }
        Err(e) => Err(failed(e)),
    }
}

fn lock(path: &Path, file: File) -> Result<File, LogWriteError> {
    let outcome = try_lock(&file).map_err(|source| LogWriteError::Create {
        path: path.to_owned(),
        source,
    })?;
    if matches!(outcome, LockOutcome::InUse) {
        return Err(LogWriteError::InUse {
            path: path.to_owned(),
        });
    }
    if let Some(remark) = outcome.remark(path) {
        tracing::warn!("{remark}");
    }
    Ok(file)
}

/// Byte stream that the MCAP writer writes to.
///
/// `flush` marks a boundary between records. When a write fails (disk full), the file is truncated to the
/// last boundary, so that readers find complete records only; every later write fails too.
pub struct LogFile {
    storage: Box<dyn Storage>,
    buffer: Vec<u8>,
    /// Bytes received so far; the MCAP writer queries it for its indexes.
    position: u64,
    /// Length of the file up to the last boundary (bytes), shared with [`Readable`].
    boundary: Arc<AtomicU64>,
    failed: bool,
}

/// Length of the complete records of the file, readable without owning the stream.
#[derive(Debug, Clone)]
pub struct Readable(Arc<AtomicU64>);

impl Readable {
    /// Returns the length of the complete records (bytes).
    pub(super) fn bytes(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl LogFile {
    pub(super) fn new(storage: Box<dyn Storage>) -> Self {
        Self {
            storage,
            buffer: Vec::with_capacity(BUFFER_BYTES),
            position: 0,
            boundary: Arc::default(),
            failed: false,
        }
    }

    /// Returns a handle on the readable length of the file.
    pub(super) fn readable(&self) -> Readable {
        Readable(Arc::clone(&self.boundary))
    }

    /// Waits until all flushed data are on the disk.
    pub(super) fn sync(&mut self) -> io::Result<()> {
        self.storage.sync()
    }

    fn empty_buffer(&mut self) -> io::Result<()> {
        let result = self.storage.append(&self.buffer);
        self.buffer.clear();
        self.keep(result)
    }

    fn keep(&mut self, result: io::Result<()>) -> io::Result<()> {
        if result.is_err() {
            self.failed = true;
            self.buffer.clear();
            // The first error is reported; a file that cannot be truncated keeps a partial record, which
            // readers report after the last complete one.
            let _ = self.storage.cut(self.boundary.load(Ordering::Relaxed));
        }
        result
    }
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        if self.buffer.len() + bytes.len() > BUFFER_BYTES {
            self.empty_buffer()?;
        }
        if bytes.len() >= BUFFER_BYTES {
            let result = self.storage.append(bytes);
            self.keep(result)?;
        } else {
            self.buffer.extend_from_slice(bytes);
        }
        self.position += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        self.empty_buffer()?;
        self.boundary.store(self.position, Ordering::Relaxed);
        Ok(())
    }
}

impl Seek for LogFile {
    /// Returns the position; the MCAP writer is configured not to seek.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.position),
            _ => Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "a log can only be appended to",
            )),
        }
    }
}
