//! Messages of a log from any time on.
//!
//! With the index at the end of the file, a seek takes constant time; without it (the run was killed) the
//! source reads everything before the start. Memory contains one chunk and the latched messages.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use mcap::records::MessageHeader;

use super::known;
use super::output::ROBOTS_TOPIC;
use super::reader::{Channel, ChunkPlace, Item, Reader, Schema};
use super::states::{States, is_latched};
use crate::LogReadError;
use crate::Origin;
use crate::ReadProgress;
use crate::Topics;

/// Number of chunks that are searched for the last message of every sender of a topic with several senders.
const LOOK_BACK: u32 = 32;

/// Number of first messages that are read to find the senders.
const FIRST_MESSAGES: usize = 4096;
/// Maximum size of these messages (bytes).
const FIRST_MESSAGES_BYTES: usize = 8 << 20;

/// Maximum size of the messages of one tick (bytes).
const MAX_TICK_BYTES: usize = 512 << 20;

/// Offset of the first record, after the magic bytes (bytes).
const BEGINNING: u64 = 8;

/// Rank of messages for viewers only.
const FOR_VIEWERS: usize = usize::MAX;

/// A message of a selected channel.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct LogMessage {
    /// Log time (ns).
    pub time: u64,
    /// Index of its topic in [`ipc_types::topics::NAMES`]; beyond the end for viewer messages.
    pub rank: usize,
    /// Id of its channel in the log.
    pub channel: u16,
    /// Bytes in the log: CDR.
    pub data: Vec<u8>,
}

impl LogMessage {
    /// Returns the index of the process that sent it.
    pub fn sender(&self) -> u32 {
        known::stamp(&self.data).map_or(0, |stamp| stamp.source)
    }

    /// Returns `true` for a message of a project topic, `false` for a viewer message.
    pub fn is_ours(&self) -> bool {
        self.rank != FOR_VIEWERS
    }
}

/// A selected channel.
#[derive(Debug, Clone, Copy)]
struct SelectedChannel {
    rank: usize,
    latched: bool,
    one_sender: bool,
}

impl SelectedChannel {
    /// Returns the sender of a message; the recorder sends all viewer messages.
    fn sender(&self, data: &[u8]) -> u32 {
        if self.rank == FOR_VIEWERS {
            return 0;
        }
        known::stamp(data).map_or(0, |stamp| stamp.source)
    }
}

/// Messages of a log from any time on; see the [module](self).
pub struct Source {
    reader: Reader<'static>,
    origin: Origin,
    topics: Topics,
    /// `true` to include viewer messages.
    pictures: bool,
    index: Option<Vec<ChunkPlace>>,
    played: BTreeMap<u16, SelectedChannel>,
    /// First message after the start, read ahead by the seek.
    ahead: Option<LogMessage>,
    /// Exclusive end of the log time of returned messages (ns).
    before: u64,
    /// Offset in the file after which no message is earlier than `before` (bytes).
    end: u64,
}

impl Source {
    /// Opens a Protean log for these topics, up to log time `before` (ns); includes viewer messages if
    /// `pictures` is set.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn open(
        log: &Path,
        topics: &Topics,
        before: u64,
        pictures: bool,
    ) -> Result<Self, LogReadError> {
        let reader = Reader::open(log, None)?;
        let mut source = Self {
            reader,
            origin: Origin::default(),
            topics: topics.clone(),
            pictures,
            index: None,
            played: BTreeMap::new(),
            ahead: None,
            before,
            end: u64::MAX,
        };
        source.read_head()?;
        source.index = source.reader.index()?;
        let channels: Vec<Arc<Channel>> = source.reader.channels().cloned().collect();
        for channel in &channels {
            source.take_up(channel)?;
        }
        let names = channels.iter().map(|channel| channel.topic.as_str());
        source.topics.check(&names)?;
        if let Some(index) = &source.index {
            let last = index.iter().rev().find(|chunk| chunk.start < before);
            source.end = last.map_or(0, |chunk| chunk.at);
        }
        Ok(source)
    }

    /// Returns manifest and scenario of the log.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        self.reader.path()
    }

    /// Returns `true` if the file has an index.
    pub fn has_index(&self) -> bool {
        self.index.is_some()
    }

    /// Returns the selected channels that are known so far.
    pub fn channels(&self) -> impl Iterator<Item = (u16, &Arc<Channel>, Option<Arc<Schema>>)> {
        let played = |channel: &&Arc<Channel>| self.played.contains_key(&channel.id);
        let channels = self.reader.channels().filter(played);
        channels.map(|channel| (channel.id, channel, self.reader.schema(channel.schema_id)))
    }

    /// Returns the faults of the part that has been read.
    pub fn faults(&self) -> Vec<String> {
        self.reader.condition().lines()
    }

    /// Reads the records before the first message.
    fn read_head(&mut self) -> Result<(), LogReadError> {
        while let Some(item) = self.reader.next()? {
            if matches!(item, Item::Message(..)) {
                break;
            }
            self.origin.add(&item);
        }
        self.origin.check(self.reader.path())
    }

    /// Selects a channel if it is requested; the layout of a project topic must be that of this version.
    fn take_up(&mut self, channel: &Channel) -> Result<(), LogReadError> {
        if channel.topic.starts_with('/') || channel.topic == ROBOTS_TOPIC {
            if self.pictures && self.topics.take(&channel.topic) {
                let played = SelectedChannel {
                    rank: FOR_VIEWERS,
                    latched: is_latched(&channel.topic, &channel.metadata),
                    one_sender: true,
                };
                self.played.insert(channel.id, played);
            }
            return Ok(());
        }
        self.origin.check_layout(self.reader.path(), channel)?;
        if let Some(topic) = known::topic_of(channel)
            && self.topics.take(&channel.topic)
        {
            let played = SelectedChannel {
                rank: topic.rank(),
                latched: topic.facts().latched,
                one_sender: topic.has_one_publisher(),
            };
            self.played.insert(channel.id, played);
        }
        Ok(())
    }

    /// Seeks to the first message at or after log time `from` (ns); returns the latched messages from before,
    /// oldest first.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn seek(
        &mut self,
        from: u64,
        read_progress: &mut ReadProgress,
    ) -> Result<Vec<LogMessage>, LogReadError> {
        self.ahead = None;
        let mut older = States::default();
        match &self.index {
            None => self.reader.jump(BEGINNING),
            Some(index) => {
                let start = index.partition_point(|chunk| chunk.end < from);
                let (before, rest) = index.split_at(start);
                let at = rest.first().or(before.last()).map_or(BEGINNING, |c| c.at);
                let before = before.to_vec();
                self.look_back(&before, from, &mut older)?;
                self.reader.jump(at);
            }
        }
        let mut newer = States::default();
        while let Some((header, played)) = self.advance()? {
            let data = self.bytes();
            if header.log_time >= from {
                self.ahead = Some(LogMessage {
                    time: header.log_time,
                    rank: played.rank,
                    channel: header.channel_id,
                    data: data.to_vec(),
                });
                break;
            }
            if played.latched {
                let source = played.sender(data);
                newer.keep(self.reader.path(), source, header, data)?;
            }
            read_progress.at(0)?;
        }
        newer.fill_from(self.reader.path(), older)?;
        Ok(newer
            .take()
            .into_iter()
            .filter_map(|(header, data)| {
                let played = self.played.get(&header.channel_id)?;
                Some(LogMessage {
                    time: header.log_time,
                    rank: played.rank,
                    channel: header.channel_id,
                    data,
                })
            })
            .collect())
    }

    /// Finds the last latched message before `from` of every channel and sender, in the chunks before the
    /// start.
    fn look_back(
        &mut self,
        before: &[ChunkPlace],
        from: u64,
        found: &mut States,
    ) -> Result<(), LogReadError> {
        let latched = self.played.iter().filter(|(_, played)| played.latched);
        let mut wanted: BTreeMap<u16, (bool, u32)> = latched
            .map(|(channel, played)| (*channel, (played.one_sender, 0)))
            .collect();
        for chunk in before.iter().rev() {
            if wanted.is_empty() {
                break;
            }
            if !wanted.keys().any(|channel| chunk.may_hold(*channel)) {
                continue;
            }
            let mut here = States::default();
            let mut channels = BTreeSet::new();
            let path = self.reader.path().to_owned();
            self.reader.jump(chunk.at);
            while self.reader.next()?.is_some() && self.reader.offset() == chunk.at {
                if let Some((header, data)) = self.reader.last_message()
                    && header.log_time < from
                    && wanted.contains_key(&header.channel_id)
                    && let Some(played) = self.played.get(&header.channel_id)
                {
                    let source = played.sender(data);
                    channels.insert(header.channel_id);
                    here.keep(&path, source, header, data)?;
                }
            }
            for channel in channels {
                if let Some((one_sender, looked)) = wanted.get_mut(&channel) {
                    *looked += 1;
                    if *one_sender || *looked >= LOOK_BACK {
                        wanted.remove(&channel);
                    }
                }
            }
            found.fill_from(self.reader.path(), here)?;
        }
        Ok(())
    }

    /// Advances to the next selected message and returns its header; `None` at the end. The reader keeps its
    /// bytes as last message.
    fn advance(&mut self) -> Result<Option<(MessageHeader, SelectedChannel)>, LogReadError> {
        while self.reader.offset() <= self.end {
            match self.reader.next()? {
                None => break,
                Some(Item::Message(header, _)) if header.log_time < self.before => {
                    if let Some(&played) = self.played.get(&header.channel_id) {
                        return Ok(Some((header, played)));
                    }
                }
                Some(Item::Channel(channel)) => self.take_up(&channel)?,
                Some(_) => {}
            }
        }
        Ok(None)
    }

    /// Returns the bytes of the message that [`Source::advance`] reached.
    fn bytes(&self) -> &[u8] {
        self.reader.last_message().map_or(&[], |(_, data)| data)
    }

    /// Replaces the contents of `into` by all messages of the next log time; returns `false` at the end.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn tick(&mut self, into: &mut Vec<LogMessage>) -> Result<bool, LogReadError> {
        let (mut count, mut bytes) = (0, 0);
        loop {
            if count == into.len() {
                into.push(LogMessage::default());
            }
            let Some((message, before)) = into.get_mut(..=count).and_then(<[_]>::split_last_mut)
            else {
                break;
            };
            if !self.next(message)? {
                break;
            }
            if before.last().is_some_and(|last| last.time != message.time) {
                self.ahead = Some(core::mem::take(message));
                break;
            }
            bytes += message.data.len();
            if bytes > MAX_TICK_BYTES {
                return Err(LogReadError::TooLarge {
                    path: self.reader.path().to_owned(),
                    what: "the messages of one tick",
                    limit: MAX_TICK_BYTES,
                });
            }
            count += 1;
        }
        into.truncate(count);
        Ok(count > 0)
    }

    /// Seeks to the beginning and visits topic and sender of the first messages. With few exceptions, every
    /// sender of a run is among them.
    ///
    /// # Errors
    /// The log cannot be read, or `visit` fails.
    pub fn visit_senders<E: From<LogReadError>>(
        &mut self,
        read_progress: &mut ReadProgress,
        visit: &mut dyn FnMut(usize, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        self.seek(0, read_progress)?;
        let mut message = LogMessage::default();
        let mut bytes = 0;
        for _ in 0..FIRST_MESSAGES {
            if bytes > FIRST_MESSAGES_BYTES || !self.next(&mut message)? {
                break;
            }
            bytes += message.data.len();
            if message.is_ours() {
                visit(message.rank, message.sender())?;
            }
        }
        Ok(())
    }

    /// Reads the next message; returns `false` at the end.
    fn next(&mut self, into: &mut LogMessage) -> Result<bool, LogReadError> {
        if let Some(ahead) = self.ahead.take() {
            *into = ahead;
            return Ok(true);
        }
        let Some((header, played)) = self.advance()? else {
            return Ok(false);
        };
        into.time = header.log_time;
        into.rank = played.rank;
        into.channel = header.channel_id;
        into.data.clear();
        into.data.extend_from_slice(self.bytes());
        Ok(true)
    }
}
