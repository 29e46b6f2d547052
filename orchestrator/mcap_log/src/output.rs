//! A new log made from parts of another one.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::records::{AttachmentHeader, MessageHeader, Metadata};
use mcap::{Attachment, McapError, WriteOptions};
use platform::atomic_file::{AtomicFile, Readers};

use super::derived::{self, DerivedError};
use super::reader::{Channel, Schema};
use crate::{Compression, LogOptions};

/// Writer of records of another log, with the same ids, in new chunks with checksums and an index.
pub struct Output {
    writer: mcap::Writer<BufWriter<AtomicFile>>,
    path: PathBuf,
}

impl Output {
    /// Creates the file; see [`derived::create`]. `profile` is that of the log.
    ///
    /// # Errors
    /// The file cannot be written: [`DerivedError`].
    pub fn create(
        path: &Path,
        log: &Path,
        force: bool,
        profile: &str,
    ) -> Result<Self, DerivedError> {
        let file = derived::create(path, log, force, Readers::Owner)?;
        let options = LogOptions::default();
        let (compression, level) = match options.compression {
            Compression::None => (None, 0),
            Compression::Zstd(level) => (Some(mcap::Compression::Zstd), level),
        };
        let writer = WriteOptions::new()
            .compression(compression)
            // See `recorder::LogWriter`.
            .compression_level(level.cast_unsigned())
            .compression_threads(0)
            .disable_seeking(true)
            .chunk_size(Some(options.chunk_bytes))
            .profile(profile)
            .library(concat!("protean/", env!("CARGO_PKG_VERSION")))
            .create(BufWriter::new(file))
            .map_err(|e| failed(path, e))?;
        Ok(Self {
            writer,
            path: path.to_owned(),
        })
    }

    /// Writes a schema with its id.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn schema(&mut self, id: u16, schema: &Schema) -> Result<(), DerivedError> {
        let Schema {
            name,
            encoding,
            data,
        } = schema;
        let added = self.writer.add_schema_with_id(id, name, encoding, data);
        self.check(added.map(drop))
    }

    /// Writes a channel with its id.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn channel(&mut self, channel: &Channel) -> Result<(), DerivedError> {
        let added = self.writer.add_channel_with_id(
            channel.id,
            channel.schema_id,
            &channel.topic,
            &channel.message_encoding,
            &channel.metadata,
        );
        self.check(added.map(drop))
    }

    /// Writes a message.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), DerivedError> {
        let written = self.writer.write_to_known_channel(header, data);
        self.check(written)
    }

    /// Writes an attachment.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn attachment(
        &mut self,
        header: &AttachmentHeader,
        data: &[u8],
    ) -> Result<(), DerivedError> {
        let written = self.writer.attach(&Attachment {
            log_time: header.log_time,
            create_time: header.create_time,
            name: header.name.clone(),
            media_type: header.media_type.clone(),
            data: Cow::Borrowed(data),
        });
        self.check(written)
    }

    /// Writes a metadata record.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn metadata(&mut self, metadata: &Metadata) -> Result<(), DerivedError> {
        let written = self.writer.write_metadata(metadata);
        self.check(written)
    }

    /// Writes a metadata record of names and values.
    ///
    /// # Errors
    /// The file cannot be written: [`DerivedError`].
    pub fn note<'a>(
        &mut self,
        name: &str,
        entries: impl IntoIterator<Item = (&'a str, String)>,
    ) -> Result<(), DerivedError> {
        let metadata: BTreeMap<String, String> = entries
            .into_iter()
            .map(|(key, value)| (key.to_owned(), value))
            .collect();
        let name = name.to_owned();
        self.metadata(&Metadata { name, metadata })
    }

    /// Ends the log, moves it to its path and returns its size (bytes).
    ///
    /// # Errors
    /// The file cannot be written: [`DerivedError`].
    pub fn finish(mut self) -> Result<u64, DerivedError> {
        let finished = self.writer.finish().map(drop);
        self.check(finished)?;
        let Self { writer, path } = self;
        let commit = || {
            let file = writer.into_inner().into_inner();
            let file = file.map_err(io::IntoInnerError::into_error)?;
            let bytes = file.size()?;
            file.commit().map(|()| bytes)
        };
        commit().map_err(derived::failed(&path))
    }

    fn check<T>(&self, result: Result<T, McapError>) -> Result<T, DerivedError> {
        result.map_err(|e| failed(&self.path, e))
    }
}

fn failed(path: &Path, error: McapError) -> DerivedError {
    derived::failed(path)(match error {
        McapError::Io(e) => e,
        other => io::Error::other(other),
    })
}

/// Renames the digest in the result of a run, for a log that no longer contains all messages of the run.
pub fn mark_incomplete(mut metadata: Metadata) -> Metadata {
    if metadata.name == RESULT
        && let Some(digest) = metadata.metadata.remove("digest")
    {
        metadata.metadata.insert(RUN_DIGEST.to_owned(), digest);
    }
    metadata
}

/// Topic with the names of the robots. The recorder writes it; it is not on the bus.
pub const ROBOTS_TOPIC: &str = "world/robots";

/// Name of the metadata record with the manifest.
pub const MANIFEST: &str = "protean";
/// Name of the metadata record with the result of a run.
pub const RESULT: &str = "protean.result";
/// Key of the digest in a log that does not contain the whole run.
pub const RUN_DIGEST: &str = "run_digest";
/// Name of the metadata record of a recovered log.
pub const RECOVERED: &str = "protean.recovered";
