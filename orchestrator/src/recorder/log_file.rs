//! The file below the MCAP writer: exclusive, locked, buffered, and cut back to whole records when
//! a write fails.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rustix::fs::{FlockOperation, flock};

use super::error::LogError;
use super::replacement::Replacement;
use crate::storage::Storage;

/// Small records (message indexes, headers) are gathered up to this size before they are written.
const BUFFER_BYTES: usize = 64 * 1024;

/// How often a new file's lock is tried, a millisecond apart.
const LOCK_ATTEMPTS: usize = 50;

/// Creates the file of a log and locks it for as long as it is open.
///
/// Without `force` the file must not exist. With `force` an existing regular file that no other
/// run has locked may be there; the log is then written beside it until it takes its place.
pub(super) fn create(path: &Path, force: bool) -> Result<(File, Option<Replacement>), LogError> {
    let failed = |source| LogError::Create {
        path: path.to_owned(),
        source,
    };
    let in_use = || LogError::InUse {
        path: path.to_owned(),
    };
    match private().write(true).create_new(true).open(path) {
        Ok(file) => {
            lock_new(&file).map_err(|_| in_use())?;
            Ok((file, None))
        }
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
            // Look before opening: opening a FIFO would block.
            if !path.metadata().map_err(failed)?.is_file() {
                return Err(LogError::NotAFile {
                    path: path.to_owned(),
                });
            }
            if !force {
                let locked = File::open(path).is_ok_and(|file| lock(&file).is_err());
                return Err(if locked {
                    in_use()
                } else {
                    LogError::Exists {
                        path: path.to_owned(),
                    }
                });
            }
            let older = OpenOptions::new().write(true).open(path).map_err(failed)?;
            lock(&older).map_err(|_| in_use())?;
            let (file, replacement) = Replacement::of(path, older, beside)?;
            Ok((file, Some(replacement)))
        }
        Err(e) => Err(failed(e)),
    }
}

/// Opens the file in which a log is written that will replace another; one that a killed run left
/// there is emptied.
fn beside(partial: &Path) -> Result<File, LogError> {
    let path = || partial.to_owned();
    let failed = |source| LogError::Create {
        path: path(),
        source,
    };
    if partial
        .symlink_metadata()
        .is_ok_and(|found| !found.is_file())
    {
        return Err(LogError::NotAFile { path: path() });
    }
    let file = private()
        .write(true)
        .create(true)
        .truncate(false)
        // Of a link that somebody put there, the target would be emptied.
        .custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed())
        .open(partial)
        .map_err(failed)?;
    lock(&file).map_err(|_| LogError::InUse { path: path() })?;
    file.set_len(0).map_err(failed)?;
    Ok(file)
}

/// For new files that only this user can read: the scenario in a log holds the keys of its patrols.
fn private() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.mode(0o600);
    options
}

fn lock(file: &File) -> rustix::io::Result<()> {
    flock(file, FlockOperation::NonBlockingLockExclusive)
}

/// Locks a file that was created just now. Somebody who found it there already may hold its lock
/// for the moment it takes to see that it is not theirs to take.
fn lock_new(file: &File) -> rustix::io::Result<()> {
    for _ in 0..LOCK_ATTEMPTS {
        if lock(file).is_ok() {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    lock(file)
}

/// The byte stream that the MCAP writer writes to.
///
/// `flush` marks a boundary between records. When a write fails (disk full), the file is cut back
/// to the last boundary, so that readers find whole records only; every later write fails too.
pub(super) struct LogFile {
    storage: Box<dyn Storage>,
    buffer: Vec<u8>,
    /// Bytes handed in so far; the MCAP writer asks for it to fill its indexes.
    position: u64,
    /// Length of the file up to the last boundary, shared with [`Readable`].
    boundary: Arc<AtomicU64>,
    failed: bool,
}

/// How much of the file consists of whole records, for those who do not own the stream.
#[derive(Debug, Clone)]
pub(super) struct Readable(Arc<AtomicU64>);

impl Readable {
    /// Bytes of whole records.
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

    /// A view on how much of the file is readable.
    pub(super) fn readable(&self) -> Readable {
        Readable(Arc::clone(&self.boundary))
    }

    /// Waits until everything that was flushed is on the disk.
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
            // The first error is the one to report; a file that cannot be cut keeps a partial
            // record, which readers report after the last whole one.
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
    /// Tells the position; the MCAP writer is told not to seek.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.position),
            _ => Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "a log is only appended to",
            )),
        }
    }
}
