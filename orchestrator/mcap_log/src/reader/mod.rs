//! Reader of the records of a log.
//!
//! The reader checks every length in the file; `limits` bound its memory. It verifies the checksum of a chunk
//! before it returns the messages. It lists what it cannot read in the [`Condition`] and skips it. It reads a
//! truncated file up to its last complete record, but not a truncated chunk, whose part no checksum covers.
//!
//! `file` reads the records of the file, `chunk` those of a compressed chunk; `record` parses a record;
//! `index` finds chunks without reading the file up to them.

mod chunk;
mod file;
mod index;
mod item;
mod limits;
mod record;

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::ops::Range;
use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::records::MessageHeader;
use platform::file_kind::FileKind;

use self::chunk::OpenChunk;
use self::file::MAGIC_BYTES;
pub(super) use self::index::ChunkPlace;
use self::item::ItemLocation;
pub use self::item::{Channel, Item, Schema};
use crate::Condition;
use crate::LogReadError;
use crate::ReadProgress;

/// Reader of a log; see the [module](self).
#[derive(Debug)]
pub struct Reader<'w> {
    path: PathBuf,
    file: File,
    length: u64,
    /// Offset of the log in the file (bytes).
    start: u64,
    next: u64,
    /// The current record, or the contents of the current chunk.
    buffer: Vec<u8>,
    chunk: Option<OpenChunk>,
    /// The message that was returned last.
    last: Option<(MessageHeader, Range<usize>)>,
    schemas: BTreeMap<u16, Arc<Schema>>,
    channels: BTreeMap<u16, Arc<Channel>>,
    descriptions: usize,
    /// End of the data section (bytes) and its checksum.
    data_end: Option<(u64, u32)>,
    /// Part of the file that the checksum of the summary covers (bytes), and this checksum.
    summary: Option<(Range<u64>, u32)>,
    /// Offset of a further log that follows the end of this one (bytes).
    following: Option<u64>,
    /// Number of messages read; unknown after a jump.
    messages: Option<u64>,
    /// `true` if messages are outside chunks, where no index finds them.
    loose: bool,
    indexed_chunks: u64,
    chunks: u64,
    done: bool,
    condition: Condition,
    read_progress: Option<&'w mut ReadProgress>,
}

impl<'w> Reader<'w> {
    /// Opens a log, from the first record.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn open(
        path: &Path,
        read_progress: Option<&'w mut ReadProgress>,
    ) -> Result<Self, LogReadError> {
        Self::open_at(path, 0, read_progress)
    }

    /// Opens the log that begins at this offset of a file (bytes), [`Self::following`] of another one, to read it
    /// sequentially.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_at(
        path: &Path,
        start: u64,
        mut read_progress: Option<&'w mut ReadProgress>,
    ) -> Result<Self, LogReadError> {
        let failed = |source| LogReadError::Open {
            path: path.to_owned(),
            source,
        };
        // Checked before opening: opening a FIFO would block.
        let kind = path.metadata().map_err(failed)?;
        if !kind.is_file() {
            let bag = "a directory; the log of a ROS 2 bag is the `.mcap` file in it";
            let what = if kind.is_dir() {
                bag
            } else {
                "not a regular file"
            };
            return Err(failed(io::Error::other(what)));
        }
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let mut magic = vec![0; length.saturating_sub(start).min(MAGIC_BYTES) as usize];
        file.read_exact_at(&mut magic, start).map_err(failed)?;
        if magic != mcap::MAGIC {
            return Err(LogReadError::NotMcap {
                path: path.to_owned(),
                kind: FileKind::from_path(path),
            });
        }
        if let Some(read_progress) = &mut read_progress {
            read_progress.begin(length);
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            length,
            start,
            next: start + MAGIC_BYTES,
            buffer: Vec::new(),
            chunk: None,
            last: None,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            descriptions: 0,
            data_end: None,
            summary: None,
            following: None,
            messages: Some(0),
            loose: false,
            indexed_chunks: 0,
            chunks: 0,
            done: false,
            condition: Condition {
                file_bytes: length,
                ..Condition::default()
            },
            read_progress,
        })
    }

    /// Returns the offset of a further log that follows the end of this one, after it has been read (bytes).
    pub fn following(&self) -> Option<u64> {
        self.following
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the channels read so far.
    pub fn channels(&self) -> impl Iterator<Item = &Arc<Channel>> + Clone {
        self.channels.values()
    }

    /// Returns the schema with this id, if it has been read.
    pub fn schema(&self, id: u16) -> Option<Arc<Schema>> {
        self.schemas.get(&id).cloned()
    }

    /// Returns the condition of the part that has been read.
    pub fn condition(&self) -> &Condition {
        &self.condition
    }

    /// Returns the next item; `None` at the end.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    #[allow(
        clippy::should_implement_trait,
        reason = "an item borrows from the reader"
    )]
    pub fn next(&mut self) -> Result<Option<Item<'_>>, LogReadError> {
        let found = loop {
            if self.chunk.is_some() {
                if let Some(found) = self.next_in_chunk()? {
                    break found;
                }
            } else if self.done {
                if let Some(read_progress) = &mut self.read_progress {
                    read_progress.end();
                }
                return Ok(None);
            } else if let Some(found) = self.next_in_file()? {
                break found;
            }
        };
        self.last = match &found {
            ItemLocation::Message(header, range) => Some((*header, range.clone())),
            _ => None,
        };
        let bytes = |range| self.buffer.get::<Range<usize>>(range).unwrap_or_default();
        Ok(Some(match found {
            ItemLocation::Header(profile, library) => Item::Header { profile, library },
            ItemLocation::Schema(id, schema) => Item::Schema(id, schema),
            ItemLocation::Channel(channel) => Item::Channel(channel),
            ItemLocation::Message(header, range) => Item::Message(header, bytes(range)),
            ItemLocation::Attachment(header, range) => Item::Attachment(header, bytes(range)),
            ItemLocation::Metadata(metadata) => Item::Metadata(metadata),
        }))
    }

    /// Returns the last item, if it was a message.
    pub fn last_message(&self) -> Option<(MessageHeader, &[u8])> {
        let (header, range) = self.last.clone()?;
        Some((header, self.buffer.get(range)?))
    }

    /// Returns the offset of the record that is read next, or of the open chunk (bytes).
    pub fn offset(&self) -> u64 {
        self.chunk.map_or(self.next, |chunk| chunk.at)
    }

    /// Continues with the record at this offset of the file (bytes).
    pub fn jump(&mut self, at: u64) {
        self.next = at;
        self.messages = None;
        self.chunk = None;
        self.last = None;
        self.buffer.clear();
        self.done = false;
    }

    /// Continues at the end of a file that may have grown since it was found to be cut there.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn resume(&mut self) -> Result<(), LogReadError> {
        if self.done
            && let Some(cut_at) = self.condition.cut_at.take()
        {
            self.condition.faults.pop_if(|fault| fault.at == cut_at);
            self.length = self.file.metadata().map_err(|e| self.failed(e))?.len();
            self.condition.file_bytes = self.length;
            self.done = false;
        }
        Ok(())
    }

    fn failed(&self, source: io::Error) -> LogReadError {
        LogReadError::Open {
            path: self.path.clone(),
            source,
        }
    }
}
