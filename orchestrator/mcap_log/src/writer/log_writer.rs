//! Writer of the MCAP file of a run.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError, WriteOptions};

use super::channel::ChannelSpec;
use super::log_file::{self, LogFile, Readable};
use crate::LogObserver;
use crate::LogWriteError;
use crate::writer::storage::Storage;

/// Compression of the chunks of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    /// No compression: fastest, largest file.
    None,
    /// Zstandard at this level, −7 (fastest) to 19 (smallest); 0 means the default level, 3.
    Zstd(i32),
}

/// Options of a log writer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogOptions {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Uncompressed size at which a chunk is closed (bytes).
    pub chunk_bytes: u64,
    /// Wall-clock time after which an open chunk is closed and written to the operating system: the maximum
    /// loss of a killed recorder.
    pub flush_every: Duration,
    /// `true` to overwrite an existing file.
    pub force: bool,
}

impl Default for LogOptions {
    /// Returns Zstandard level −3, chunks of 0.5 MB and flushes every 100 ms. On traffic that is mostly
    /// particles this level takes 40 % of the time of the default level, for a file 8 % larger (see
    /// `benches/recorder.rs`).
    fn default() -> Self {
        Self {
            compression: Compression::Zstd(-3),
            chunk_bytes: 512 * 1024,
            flush_every: Duration::from_millis(100),
            force: false,
        }
    }
}

/// Head of a log, before the first message.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Manifest {
    /// Version, seed, scenario hash, host, processor …, written as metadata record `protean`.
    pub entries: BTreeMap<String, String>,
    /// Scenario and maps: everything needed to execute the run again.
    pub attachments: Vec<ManifestFile>,
}

/// One attachment of a [`Manifest`].
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ManifestFile {
    /// Its name.
    pub name: String,
    /// Its media type, e.g. `application/toml`.
    pub media_type: String,
    /// Its contents.
    pub data: Vec<u8>,
}

/// A channel of a [`LogWriter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ChannelId(usize);

/// Totals of a channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelTotals {
    /// Name of the topic.
    pub topic: String,
    /// Messages written.
    pub messages: u64,
    /// Size of these messages, uncompressed and without MCAP record headers (bytes).
    pub bytes: u64,
}

/// Totals of a finished log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogTotals {
    /// The channels, in the order in which they were added.
    pub channels: Vec<ChannelTotals>,
    /// Size of the file (bytes).
    pub file_bytes: u64,
}

struct Channel {
    id: u16,
    totals: ChannelTotals,
    last_log_time: u64,
}

/// Writer of the MCAP file of a run.
///
/// The file is chunked, compressed, indexed, checksummed, newly created and locked while open. Chunks are
/// collected in memory and written to the operating system as a whole, so that any MCAP reader can read the
/// file at any moment.
pub struct LogWriter {
    writer: mcap::Writer<LogFile>,
    readable: Readable,
    path: PathBuf,
    chunk_bytes: u64,
    flush_every: Duration,
    last_flush: Instant,
    /// Uncompressed bytes of the open chunk.
    open_bytes: u64,
    channels: Vec<Channel>,
    log_observer: Option<Box<dyn LogObserver>>,
}

impl LogWriter {
    /// Creates the file and writes the manifest.
    ///
    /// # Errors
    /// [`LogWriteError::Exists`], [`LogWriteError::InUse`], [`LogWriteError::NotAFile`] or
    /// [`LogWriteError::Create`] if the file cannot be created, [`LogWriteError::Write`] if it cannot be
    /// written.
    pub fn create(
        path: &Path,
        options: &LogOptions,
        manifest: &Manifest,
    ) -> Result<Self, LogWriteError> {
        Self::create_on(path, options, manifest, |file| Box::new(file))
    }

    /// [`LogWriter::create`] with a storage above the file. A file of which nothing can be read is removed.
    pub(super) fn create_on(
        path: &Path,
        options: &LogOptions,
        manifest: &Manifest,
        storage: impl FnOnce(File) -> Box<dyn Storage>,
    ) -> Result<Self, LogWriteError> {
        let file = log_file::create(path, options.force)?;
        // Holds the lock until the file is removed: another run may not have overwritten it by then.
        let lock = file.try_clone();
        let log = Self::on(storage(file), path, options, manifest).inspect_err(|error| {
            if matches!(error, LogWriteError::Write { readable: 0, .. }) {
                let _ = std::fs::remove_file(path);
            }
        });
        drop(lock);
        log
    }

    pub(super) fn on(
        storage: Box<dyn Storage>,
        path: &Path,
        options: &LogOptions,
        manifest: &Manifest,
    ) -> Result<Self, LogWriteError> {
        let (compression, level) = match options.compression {
            Compression::None => (None, 0),
            Compression::Zstd(level) => (Some(mcap::Compression::Zstd), level),
        };
        let file = LogFile::new(storage);
        let readable = file.readable();
        let writer = WriteOptions::new()
            .compression(compression)
            // The crate passes the bits of this number to zstd as a signed integer, so that negative levels
            // work.
            .compression_level(level.cast_unsigned())
            // Worker threads would delay output until the chunk ends, and use a third core.
            .compression_threads(0)
            .profile("ros2")
            .library(concat!("protean/", env!("CARGO_PKG_VERSION")))
            // `LogWriter` closes the chunks, so that every chunk ends at a boundary of `LogFile`.
            .chunk_size(None)
            .disable_seeking(true)
            .create(file)
            .map_err(|e| write_error(path, &readable, e))?;
        let mut log = Self {
            writer,
            readable,
            path: path.to_owned(),
            chunk_bytes: options.chunk_bytes.max(1),
            flush_every: options.flush_every,
            last_flush: Instant::now(),
            open_bytes: 0,
            channels: Vec::new(),
            log_observer: None,
        };
        log.metadata("protean", manifest.entries.clone())?;
        for file in &manifest.attachments {
            log.attach(file)?;
        }
        log.flush()?;
        Ok(log)
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Sets the observer of all channels and messages from now on.
    pub fn set_observer(&mut self, log_observer: Box<dyn LogObserver>) {
        self.log_observer = Some(log_observer);
    }

    /// Adds a channel.
    ///
    /// # Errors
    /// [`LogWriteError::Write`] if the file cannot be written or holds 65 535 channels already.
    pub fn add_channel(&mut self, spec: &ChannelSpec<'_>) -> Result<ChannelId, LogWriteError> {
        let schema = self
            .writer
            .add_schema(spec.schema_name, spec.schema_encoding, spec.schema);
        let schema = self.check(schema)?;
        let id = self
            .writer
            .add_channel(schema, spec.topic, spec.message_encoding, spec.metadata);
        let id = self.check(id)?;
        let topic = spec.topic.to_owned();
        let totals = ChannelTotals {
            topic,
            messages: 0,
            bytes: 0,
        };
        self.channels.push(Channel {
            id,
            totals,
            last_log_time: 0,
        });
        if let Some(log_observer) = &mut self.log_observer {
            log_observer.channel(spec);
        }
        Ok(ChannelId(self.channels.len() - 1))
    }

    /// Writes one message.
    ///
    /// Times are simulated (ns). Within a channel `log_time` never decreases: an earlier time is raised to
    /// that of the previous message; `publish_time` is written as given. An id of another log writes nothing.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn write(
        &mut self,
        id: ChannelId,
        sequence: u32,
        log_time: u64,
        publish_time: u64,
        data: &[u8],
    ) -> Result<(), LogWriteError> {
        let Some(channel) = self.channels.get_mut(id.0) else {
            return Ok(());
        };
        let log_time = log_time.max(channel.last_log_time);
        channel.last_log_time = log_time;
        channel.totals.messages += 1;
        channel.totals.bytes += data.len() as u64;
        let header = MessageHeader {
            channel_id: channel.id,
            sequence,
            log_time,
            publish_time,
        };
        let result = self.writer.write_to_known_channel(&header, data);
        self.check(result)?;
        if let Some(log_observer) = &mut self.log_observer {
            log_observer.message(id.0, log_time, data);
        }
        self.open_bytes += data.len() as u64;
        if self.open_bytes >= self.chunk_bytes {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Returns the maximum age of messages that are not written to the operating system.
    pub fn flush_every(&self) -> Duration {
        self.flush_every
    }

    /// Closes the open chunk if it is older than half of `flush_every`. Call it twice in that time.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn flush_if_due(&mut self) -> Result<(), LogWriteError> {
        if self.open_bytes > 0 && self.last_flush.elapsed() * 2 >= self.flush_every {
            self.flush()?;
        }
        Ok(())
    }

    /// Closes the open chunk and writes all data to the operating system.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn flush(&mut self) -> Result<(), LogWriteError> {
        let result = self.writer.flush();
        self.open_bytes = 0;
        self.last_flush = Instant::now();
        self.check(result)
    }

    /// Writes a metadata record.
    ///
    /// # Errors
    /// [`LogWriteError::Write`].
    pub fn metadata(
        &mut self,
        name: &str,
        entries: BTreeMap<String, String>,
    ) -> Result<(), LogWriteError> {
        let record = Metadata {
            name: name.to_owned(),
            metadata: entries,
        };
        let result = self.writer.write_metadata(&record);
        self.check(result)
    }

    fn attach(&mut self, file: &ManifestFile) -> Result<(), LogWriteError> {
        let result = self.writer.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: file.name.clone(),
            media_type: file.media_type.clone(),
            data: Cow::Borrowed(&file.data),
        });
        self.check(result)
    }

    /// Writes the summary section, waits until the file is on the disk, and returns its totals.
    ///
    /// # Errors
    /// [`LogWriteError::Write`]; the file then stays readable without its summary.
    pub fn finish(mut self) -> Result<LogTotals, LogWriteError> {
        self.flush()?;
        let result = self.writer.finish().map(drop);
        self.check(result)?;
        let Self {
            writer,
            readable,
            path,
            channels,
            ..
        } = self;
        let mut file = writer.into_inner();
        file.sync()
            .map_err(|e| write_error(&path, &readable, e.into()))?;
        Ok(LogTotals {
            channels: channels.into_iter().map(|c| c.totals).collect(),
            file_bytes: readable.bytes(),
        })
    }

    fn check<T>(&self, result: Result<T, McapError>) -> Result<T, LogWriteError> {
        result.map_err(|e| write_error(&self.path, &self.readable, e))
    }
}

impl core::fmt::Debug for LogWriter {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("LogWriter")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

fn write_error(path: &Path, readable: &Readable, error: McapError) -> LogWriteError {
    let source = match error {
        McapError::Io(e) => e,
        other => io::Error::other(other),
    };
    LogWriteError::Write {
        path: path.to_owned(),
        readable: readable.bytes(),
        source,
    }
}
