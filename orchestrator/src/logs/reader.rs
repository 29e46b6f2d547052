//! Reads a log record by record, as far as it goes.
//!
//! No length in the file is believed: memory follows from what is really there and is bounded by
//! [`LIMIT`]. Checksums of chunks are checked before their messages are handed out. What cannot be
//! read is noted in the [`Condition`] and passed over; a file that ends in the middle is read to
//! its last whole record, those in a chunk that was still open included.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::ops::Range;
use std::os::unix::fs::FileExt as _;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use mcap::records::{AttachmentHeader, MessageHeader, Metadata, op};

use super::condition::Condition;
use super::error::LogsError;
use super::fields::Fields;
use super::watch::Watch;

/// Longest record or chunk that is read [bytes]: the largest map that a scenario may have, and a
/// little.
const LIMIT: usize = 384 << 20;
/// Most bytes that the descriptions of channels and schemas may take together.
const DESCRIPTIONS_LIMIT: usize = 64 << 20;
/// Opcode and length in front of every record [bytes].
const PREFIX: u64 = 9;
/// Bytes of a chunk record before the name of its compression.
const CHUNK_FIXED: usize = 32;
/// Longest name of a compression.
const COMPRESSION_NAME: usize = 64;

/// A schema of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Schema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) data: Vec<u8>,
}

/// A channel of a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Channel {
    pub(crate) id: u16,
    /// 0 for none.
    pub(crate) schema_id: u16,
    pub(crate) topic: String,
    pub(crate) message_encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
}

/// What comes next in a log.
#[derive(Debug)]
pub(crate) enum Item<'a> {
    /// The file's header.
    Header { profile: String, library: String },
    /// A schema that was not known before.
    Schema(u16, Rc<Schema>),
    /// A channel that was not known before.
    Channel(Rc<Channel>),
    /// A message of a known channel.
    Message(MessageHeader, &'a [u8]),
    /// A file within the file.
    Attachment(AttachmentHeader, &'a [u8]),
    /// Names and values.
    Metadata(Metadata),
}

/// Where the bytes of an item stand.
#[derive(Debug)]
enum Found {
    Header(String, String),
    Schema(u16, Rc<Schema>),
    Channel(Rc<Channel>),
    Message(MessageHeader, Range<usize>),
    Attachment(AttachmentHeader, Range<usize>),
    Metadata(Metadata),
}

/// The chunk that is being read.
#[derive(Debug, Clone, Copy)]
struct OpenChunk {
    /// How far its contents have been read.
    next: usize,
    /// Where it stands in the file.
    at: u64,
    /// Whether the file ends in it.
    cut: bool,
}

/// What the index says of a chunk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ChunkPlace {
    /// Where it stands in the file.
    pub(super) at: u64,
    /// Log time of its first message.
    pub(super) start: u64,
    /// Log time of its last message.
    pub(super) end: u64,
    /// The channels of its messages; nothing if the file does not say.
    channels: BTreeSet<u16>,
}

impl ChunkPlace {
    fn read(body: &[u8]) -> Option<Self> {
        let mut fields = Fields(body);
        let (start, end, at) = (fields.u64()?, fields.u64()?, fields.u64()?);
        fields.u64()?;
        let length = fields.u32()? as usize;
        let mut offsets = Fields(fields.bytes(length)?);
        let mut channels = BTreeSet::new();
        while !offsets.0.is_empty() {
            channels.insert(offsets.u16()?);
            offsets.u64()?;
        }
        Some(Self {
            at,
            start,
            end,
            channels,
        })
    }

    /// Whether it may hold messages of this channel.
    pub(super) fn may_hold(&self, channel: u16) -> bool {
        self.channels.is_empty() || self.channels.contains(&channel)
    }
}

/// See the module's text.
pub(crate) struct Reader<'w> {
    path: PathBuf,
    file: File,
    length: u64,
    next: u64,
    /// A record, or the contents of the chunk.
    buffer: Vec<u8>,
    chunk: Option<OpenChunk>,
    /// The message that was handed out last.
    last: Option<(MessageHeader, Range<usize>)>,
    schemas: BTreeMap<u16, Rc<Schema>>,
    channels: BTreeMap<u16, Rc<Channel>>,
    descriptions: usize,
    /// Where the data section ends and its checksum.
    data_end: Option<(u64, u32)>,
    indexed_chunks: u64,
    chunks: u64,
    done: bool,
    condition: Condition,
    watch: Option<&'w mut Watch>,
}

impl<'w> Reader<'w> {
    /// Opens a log.
    pub(crate) fn open(path: &Path, mut watch: Option<&'w mut Watch>) -> Result<Self, LogsError> {
        let failed = |source| LogsError::Open {
            path: path.to_owned(),
            source,
        };
        // Look before opening: opening a FIFO would block.
        if !path.metadata().map_err(failed)?.is_file() {
            return Err(failed(io::Error::other("not a regular file")));
        }
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        let mut magic = [0; 8];
        if length < 8
            || file.read_exact_at(&mut magic, 0).is_err()
            || magic.as_slice() != mcap::MAGIC
        {
            return Err(LogsError::NotMcap {
                path: path.to_owned(),
                empty: length == 0,
            });
        }
        if let Some(watch) = &mut watch {
            watch.begin(length);
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            length,
            next: 8,
            buffer: Vec::new(),
            chunk: None,
            last: None,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            descriptions: 0,
            data_end: None,
            indexed_chunks: 0,
            chunks: 0,
            done: false,
            condition: Condition {
                file_bytes: length,
                ..Condition::default()
            },
            watch,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn channels(&self) -> impl Iterator<Item = &Rc<Channel>> + Clone {
        self.channels.values()
    }

    pub(crate) fn schema(&self, id: u16) -> Option<Rc<Schema>> {
        self.schemas.get(&id).cloned()
    }

    /// In what condition the log is, as far as it has been read.
    pub(crate) fn condition(&self) -> &Condition {
        &self.condition
    }

    /// The next item; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Item<'_>>, LogsError> {
        let found = loop {
            if self.chunk.is_some() {
                if let Some(found) = self.next_in_chunk()? {
                    break found;
                }
            } else if self.done {
                if let Some(watch) = &mut self.watch {
                    watch.end();
                }
                return Ok(None);
            } else if let Some(found) = self.next_in_file()? {
                break found;
            }
        };
        self.last = match &found {
            Found::Message(header, range) => Some((*header, range.clone())),
            _ => None,
        };
        let bytes = |range| self.buffer.get::<Range<usize>>(range).unwrap_or_default();
        Ok(Some(match found {
            Found::Header(profile, library) => Item::Header { profile, library },
            Found::Schema(id, schema) => Item::Schema(id, schema),
            Found::Channel(channel) => Item::Channel(channel),
            Found::Message(header, range) => Item::Message(header, bytes(range)),
            Found::Attachment(header, range) => Item::Attachment(header, bytes(range)),
            Found::Metadata(metadata) => Item::Metadata(metadata),
        }))
    }

    /// The item that came last, if it was a message.
    pub(super) fn last_message(&self) -> Option<(MessageHeader, &[u8])> {
        let (header, range) = self.last.clone()?;
        Some((header, self.buffer.get(range)?))
    }

    /// Where the record stands, or the chunk, that is read next or is being read.
    pub(super) fn at(&self) -> u64 {
        self.chunk.map_or(self.next, |chunk| chunk.at)
    }

    /// Goes on with the record that begins at this byte of the file.
    pub(super) fn jump(&mut self, at: u64) {
        self.next = at;
        self.chunk = None;
        self.last = None;
        self.buffer.clear();
        self.done = false;
    }

    /// Reads the index at the end of the file, and takes up the schemas and channels in it; `None`
    /// if there is none that holds. What is read next stays what it was, but for an open chunk.
    pub(super) fn index(&mut self) -> Result<Option<Vec<ChunkPlace>>, LogsError> {
        let next = self.at();
        let index = self.read_index();
        self.jump(next);
        index
    }

    fn read_index(&mut self) -> Result<Option<Vec<ChunkPlace>>, LogsError> {
        // Footer and end mark.
        let mut tail = [0; PREFIX as usize + 20 + 8];
        let Some(footer) = self.length.checked_sub(tail.len() as u64) else {
            return Ok(None);
        };
        self.file
            .read_exact_at(&mut tail, footer)
            .map_err(|e| self.failed(e))?;
        let mut fields = Fields(&tail);
        let mut read = || {
            let opcode = *fields.bytes(1)?.first()?;
            let length = fields.u64()?;
            let start = fields.u64()?;
            fields.u64()?;
            let crc = fields.u32()?;
            (opcode == op::FOOTER && length == 20 && fields.0 == mcap::MAGIC)
                .then_some((start, crc))
        };
        let Some((start, crc)) = read() else {
            return Ok(None);
        };
        if start < 8 || start >= footer || footer - start > DESCRIPTIONS_LIMIT as u64 {
            return Ok(None);
        }
        let mut summary = vec![0; (footer - start) as usize];
        self.file
            .read_exact_at(&mut summary, start)
            .map_err(|e| self.failed(e))?;
        // The checksum covers the footer too, up to itself.
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&summary);
        hasher.update(tail.get(..PREFIX as usize + 16).unwrap_or_default());
        if crc != 0 && hasher.finalize() != crc {
            return Ok(None);
        }
        let mut chunks = Vec::new();
        let mut at = 0;
        while let Some(rest) = summary.get(at..).filter(|rest| !rest.is_empty()) {
            let mut fields = Fields(rest);
            let prefix = fields.bytes(1).and_then(|opcode| {
                let length = usize::try_from(fields.u64()?).ok()?;
                Some((*opcode.first()?, length))
            });
            let Some((opcode, length)) = prefix.filter(|(_, length)| *length <= fields.0.len())
            else {
                return Ok(None);
            };
            let body = at + PREFIX as usize;
            match opcode {
                op::SCHEMA | op::CHANNEL => {
                    self.buffer.clear();
                    self.buffer
                        .extend_from_slice(summary.get(body..body + length).unwrap_or_default());
                    self.record(opcode, 0..length, start + at as u64)?;
                }
                op::CHUNK_INDEX => {
                    let place = fields.bytes(length).and_then(ChunkPlace::read);
                    let Some(place) = place.filter(|place| place.at < start) else {
                        return Ok(None);
                    };
                    chunks.push(place);
                }
                _ => {}
            }
            at = body + length;
        }
        chunks.sort_by_key(|chunk| chunk.at);
        Ok((!chunks.is_empty()).then_some(chunks))
    }

    /// Checks the checksum over the whole data section, if there is one: call it at the end.
    pub(crate) fn check_all(&mut self) -> Result<(), LogsError> {
        let Some((end, expected)) = self.data_end.filter(|(_, crc)| *crc != 0) else {
            return Ok(());
        };
        let mut hasher = crc32fast::Hasher::new();
        let mut block = vec![0; 1 << 20];
        let mut at = 0;
        while at < end {
            let wanted = block.len().min((end - at) as usize);
            let Some(part) = block.get_mut(..wanted) else {
                break;
            };
            self.file
                .read_exact_at(part, at)
                .map_err(|e| self.failed(e))?;
            hasher.update(part);
            at += wanted as u64;
            if let Some(watch) = &mut self.watch {
                watch.at(0)?;
            }
        }
        if hasher.finalize() != expected {
            self.condition.data = false;
            self.condition.fault(
                end,
                "the checksum of the data section does not fit: something in it has changed",
            );
        }
        Ok(())
    }

    fn failed(&self, source: io::Error) -> LogsError {
        LogsError::Open {
            path: self.path.clone(),
            source,
        }
    }

    /// The file ends in the middle of something that begins here.
    fn cut(&mut self, at: u64, what: &str) {
        self.condition.cut_at = Some(at);
        self.condition.fault(
            at,
            format!(
                "the file ends in the middle of {what} ({} bytes of it are there): the run was \
                 killed or is not over yet, or the copy is incomplete",
                self.length.saturating_sub(at)
            ),
        );
        self.done = true;
    }

    /// The next record of the file; `None` if it is nothing to hand out.
    fn next_in_file(&mut self) -> Result<Option<Found>, LogsError> {
        let at = self.next;
        if let Some(watch) = &mut self.watch {
            watch.at(at)?;
        }
        let mut prefix = [0; PREFIX as usize];
        if self.length.saturating_sub(at) < PREFIX {
            let what = if at >= self.length {
                "the data: there is no end mark"
            } else {
                "a record"
            };
            self.cut(at, what);
            return Ok(None);
        }
        self.file
            .read_exact_at(&mut prefix, at)
            .map_err(|e| self.failed(e))?;
        let [opcode, length @ ..] = prefix;
        let length = u64::from_le_bytes(length);
        let body = at + PREFIX;
        let available = self.length - body;
        if opcode == 0 {
            self.condition.fault(
                at,
                format!(
                    "no record begins here: {} bytes are lost",
                    available + PREFIX
                ),
            );
            self.condition.cut_at = Some(at);
            self.done = true;
            return Ok(None);
        }
        if opcode == op::CHUNK {
            self.chunk(at, length.min(available), length > available)?;
            self.next = body.saturating_add(length);
            return Ok(None);
        }
        if length > available {
            self.cut(at, name_of(opcode));
            return Ok(None);
        }
        self.next = body + length;
        // Indexes are made anew or counted only.
        if matches!(
            opcode,
            op::MESSAGE_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX
        ) {
            return Ok(None);
        }
        if length > LIMIT as u64 {
            let what = format!(
                "{} of {length} bytes is passed over: more than {LIMIT} are not read at once",
                name_of(opcode)
            );
            self.condition.fault(at, what);
            return Ok(None);
        }
        self.buffer.resize(length as usize, 0);
        let mut buffer = core::mem::take(&mut self.buffer);
        let read = self.file.read_exact_at(&mut buffer, body);
        self.buffer = buffer;
        read.map_err(|e| self.failed(e))?;
        self.record(opcode, 0..length as usize, at)
    }

    /// The next record of the open chunk; `None` behind its last.
    fn next_in_chunk(&mut self) -> Result<Option<Found>, LogsError> {
        let Some(mut chunk) = self.chunk else {
            return Ok(None);
        };
        let rest = self.buffer.get(chunk.next..).unwrap_or_default();
        let mut fields = Fields(rest);
        let prefix = fields.bytes(1).and_then(|opcode| {
            let length = usize::try_from(fields.u64()?).ok()?;
            Some((*opcode.first()?, length))
        });
        let Some((opcode, length)) = prefix.filter(|(_, length)| *length <= fields.0.len()) else {
            if !rest.is_empty() && !chunk.cut {
                self.condition
                    .fault(chunk.at, "a record in this chunk runs past its end");
            }
            self.chunk = None;
            self.buffer.clear();
            return Ok(None);
        };
        let body = chunk.next + PREFIX as usize;
        chunk.next = body + length;
        self.chunk = Some(chunk);
        let found = self.record(opcode, body..body + length, chunk.at)?;
        if chunk.cut && matches!(found, Some(Found::Message(..))) {
            self.condition.salvaged += 1;
        }
        Ok(found)
    }

    /// Takes up a record whose bytes stand in the buffer.
    fn record(
        &mut self,
        opcode: u8,
        place: Range<usize>,
        at: u64,
    ) -> Result<Option<Found>, LogsError> {
        // The buffer is put back below: nothing is copied.
        let buffer = core::mem::take(&mut self.buffer);
        let body = buffer.get(place.clone()).unwrap_or_default();
        let found = match opcode {
            op::SCHEMA => self.take_schema(body, at),
            op::CHANNEL => self.take_channel(body, at),
            _ => Ok(self.take_other(opcode, body, place, at)),
        };
        self.buffer = buffer;
        Ok(found?.unwrap_or_else(|()| {
            let what = format!("{} makes no sense and is passed over", name_of(opcode));
            self.condition.fault(at, what);
            None
        }))
    }

    fn take_schema(
        &mut self,
        body: &[u8],
        at: u64,
    ) -> Result<Result<Option<Found>, ()>, LogsError> {
        let mut fields = Fields(body);
        let mut read = || {
            let id = fields.u16().filter(|id| *id != 0)?;
            let (name, encoding) = (fields.text()?, fields.text()?);
            let length = fields.u32()? as usize;
            let data = fields.bytes(length)?.to_vec();
            let schema = Schema {
                name,
                encoding,
                data,
            };
            Some((id, schema))
        };
        let Some((id, schema)) = read() else {
            return Ok(Err(()));
        };
        match self.schemas.get(&id) {
            Some(known) if **known == schema => Ok(Ok(None)),
            Some(_) => {
                let what = format!("schema {id} is defined again, otherwise: passed over");
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None => {
                self.describe(body.len())?;
                let schema = Rc::new(schema);
                self.schemas.insert(id, Rc::clone(&schema));
                Ok(Ok(Some(Found::Schema(id, schema))))
            }
        }
    }

    fn take_channel(
        &mut self,
        body: &[u8],
        at: u64,
    ) -> Result<Result<Option<Found>, ()>, LogsError> {
        let mut fields = Fields(body);
        let mut read = || {
            Some(Channel {
                id: fields.u16()?,
                schema_id: fields.u16()?,
                topic: fields.text()?,
                message_encoding: fields.text()?,
                metadata: fields.map()?,
            })
        };
        let Some(channel) = read() else {
            return Ok(Err(()));
        };
        let (id, schema_id) = (channel.id, channel.schema_id);
        match self.channels.get(&id) {
            Some(known) if **known == channel => Ok(Ok(None)),
            Some(known) => {
                let what = format!(
                    "channel {id} ({}) is defined again, as {}: passed over",
                    known.topic, channel.topic
                );
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None if schema_id != 0 && !self.schemas.contains_key(&schema_id) => {
                let what = format!(
                    "channel {id} ({}) has schema {schema_id}, which is not there: passed over",
                    channel.topic
                );
                self.condition.fault(at, what);
                Ok(Ok(None))
            }
            None => {
                self.describe(body.len())?;
                let channel = Rc::new(channel);
                self.channels.insert(id, Rc::clone(&channel));
                Ok(Ok(Some(Found::Channel(channel))))
            }
        }
    }

    fn describe(&mut self, bytes: usize) -> Result<(), LogsError> {
        self.descriptions += bytes;
        if self.descriptions > DESCRIPTIONS_LIMIT {
            return Err(LogsError::TooLarge {
                path: self.path.clone(),
                what: "the descriptions of its channels",
                limit: DESCRIPTIONS_LIMIT,
            });
        }
        Ok(())
    }

    fn take_other(
        &mut self,
        opcode: u8,
        body: &[u8],
        place: Range<usize>,
        at: u64,
    ) -> Result<Option<Found>, ()> {
        let mut fields = Fields(body);
        match opcode {
            op::MESSAGE => {
                let mut read = || {
                    Some(MessageHeader {
                        channel_id: fields.u16()?,
                        sequence: fields.u32()?,
                        log_time: fields.u64()?,
                        publish_time: fields.u64()?,
                    })
                };
                let header = read().ok_or(())?;
                if !self.channels.contains_key(&header.channel_id) {
                    let what = format!(
                        "a message of channel {}, which is not there: passed over",
                        header.channel_id
                    );
                    self.condition.fault(at, what);
                    return Ok(None);
                }
                let start = place.end - fields.0.len();
                Ok(Some(Found::Message(header, start..place.end)))
            }
            op::HEADER => {
                let profile = fields.text().ok_or(())?;
                let library = fields.text().ok_or(())?;
                Ok(Some(Found::Header(profile, library)))
            }
            op::ATTACHMENT => {
                let mut read = || {
                    let header = AttachmentHeader {
                        log_time: fields.u64()?,
                        create_time: fields.u64()?,
                        name: fields.text()?,
                        media_type: fields.text()?,
                    };
                    let length = usize::try_from(fields.u64()?).ok()?;
                    let start = body.len() - fields.0.len();
                    fields.bytes(length)?;
                    let crc = fields.u32()?;
                    let covered = body.get(..start + length)?;
                    (crc == 0 || crc == crc32fast::hash(covered))
                        .then_some((header, start..start + length))
                };
                let (header, data) = read().ok_or(())?;
                let data = place.start + data.start..place.start + data.end;
                Ok(Some(Found::Attachment(header, data)))
            }
            op::METADATA => {
                let name = fields.text().ok_or(())?;
                let metadata = fields.map().ok_or(())?;
                Ok(Some(Found::Metadata(Metadata { name, metadata })))
            }
            op::DATA_END => {
                self.data_end = Some((at, fields.u32().ok_or(())?));
                self.condition.data_end();
                Ok(None)
            }
            op::CHUNK_INDEX => {
                self.indexed_chunks += 1;
                Ok(None)
            }
            op::STATISTICS => {
                self.condition.claimed_messages = Some(fields.u64().ok_or(())?);
                Ok(None)
            }
            op::FOOTER => {
                self.footer(fields.u64().ok_or(())?);
                Ok(None)
            }
            _ => Ok(None),
        }
    }

    /// Behind the footer stands the end mark, and nothing else.
    fn footer(&mut self, summary_start: u64) {
        let mut magic = [0; 8];
        let ends = self.length.saturating_sub(self.next) == 8
            && self.file.read_exact_at(&mut magic, self.next).is_ok()
            && magic.as_slice() == mcap::MAGIC;
        self.condition.summary = summary_start != 0;
        self.condition.index = summary_start != 0 && self.indexed_chunks == self.chunks;
        self.done = true;
        if ends {
            self.condition.complete = true;
        } else if self.length.saturating_sub(self.next) < 8 {
            self.cut(self.next, "the end mark");
        } else {
            let what = "what stands behind the footer is not the end mark of an MCAP file";
            self.condition.fault(self.next, what);
        }
    }

    /// Reads a chunk into the buffer, if it holds.
    fn chunk(&mut self, at: u64, record: u64, cut: bool) -> Result<(), LogsError> {
        self.chunks += 1;
        if cut {
            self.cut(at, "a chunk");
        }
        let mut head = vec![0; (CHUNK_FIXED + COMPRESSION_NAME + 8).min(record as usize)];
        self.file
            .read_exact_at(&mut head, at + PREFIX)
            .map_err(|e| self.failed(e))?;
        let mut fields = Fields(&head);
        let mut read = || {
            fields.bytes(16)?;
            let uncompressed = fields.u64()?;
            let crc = fields.u32()?;
            let compression = fields.text()?;
            let compressed = fields.u64()?;
            Some((uncompressed, crc, compression, compressed))
        };
        let header = read();
        let start = at + PREFIX + (head.len() - fields.0.len()) as u64;
        let Some((uncompressed, crc, compression, compressed)) = header else {
            if !cut {
                self.lose_chunk(at, "the header of this chunk makes no sense");
            }
            return Ok(());
        };
        let there = (at + PREFIX + record).saturating_sub(start);
        if !cut && compressed > there {
            self.lose_chunk(at, "the lengths of this chunk contradict each other");
            return Ok(());
        }
        if !cut && uncompressed > LIMIT as u64 {
            let what = format!(
                "this chunk claims {uncompressed} bytes: more than {LIMIT} are not read at once"
            );
            self.lose_chunk(at, &what);
            return Ok(());
        }
        let limit = if cut { LIMIT as u64 } else { uncompressed };
        let data = Part {
            file: &self.file,
            next: start,
            end: start + compressed.min(there),
        };
        self.buffer.clear();
        // One byte more than there should be tells that there is more.
        let read = match compression.as_str() {
            "" => data.take(limit + 1).read_to_end(&mut self.buffer),
            "zstd" => zstd::Decoder::with_buffer(BufReader::new(data))
                .and_then(|decoder| decoder.take(limit + 1).read_to_end(&mut self.buffer)),
            other => {
                let shown: String = other.chars().take(20).collect();
                let what = format!(
                    "this chunk is compressed with `{shown}`, which is not known here (zstd and \
                     none are); `mcap compress --compression zstd` converts it"
                );
                self.lose_chunk(at, &what);
                return Ok(());
            }
        };
        if cut {
            // What came out before the end is right: decompression goes from front to back.
            self.buffer.truncate(LIMIT);
        } else if let Err(error) = read {
            self.lose_chunk(at, &format!("this chunk does not decompress: {error}"));
            return Ok(());
        } else if self.buffer.len() as u64 != uncompressed {
            self.lose_chunk(at, "this chunk holds less or more than it says");
            return Ok(());
        } else if crc == 0 {
            self.condition.chunks_unchecked += 1;
        } else if crc32fast::hash(&self.buffer) != crc {
            self.lose_chunk(at, "the checksum of this chunk does not fit");
            return Ok(());
        }
        let of_kind = self.condition.chunks.entry(compression).or_default();
        of_kind.count += 1;
        of_kind.compressed_bytes += compressed.min(there);
        of_kind.uncompressed_bytes += self.buffer.len() as u64;
        self.chunk = Some(OpenChunk { next: 0, at, cut });
        Ok(())
    }

    fn lose_chunk(&mut self, at: u64, why: &str) {
        self.condition.chunks_lost += 1;
        self.condition
            .fault(at, format!("{why}; its messages are lost"));
        self.buffer.clear();
    }
}

/// What a record is called in messages.
fn name_of(opcode: u8) -> &'static str {
    match opcode {
        op::HEADER => "the header",
        op::FOOTER => "the footer",
        op::SCHEMA => "a schema",
        op::CHANNEL => "a channel",
        op::MESSAGE => "a message",
        op::CHUNK => "a chunk",
        op::ATTACHMENT => "an attachment",
        op::METADATA => "a metadata record",
        op::DATA_END => "the end of the data",
        op::STATISTICS => "the statistics",
        op::MESSAGE_INDEX | op::CHUNK_INDEX | op::ATTACHMENT_INDEX | op::METADATA_INDEX => {
            "an index"
        }
        _ => "a record",
    }
}

/// A part of a file, read from front to back.
struct Part<'a> {
    file: &'a File,
    next: u64,
    end: u64,
}

impl Read for Part<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let wanted = (self.end - self.next).min(buffer.len() as u64) as usize;
        let read = self
            .file
            .read_at(buffer.get_mut(..wanted).unwrap_or_default(), self.next)?;
        self.next += read as u64;
        Ok(read)
    }
}
