//! The messages of a log from any time on.
//!
//! With the index at the end of the file a start takes the same time anywhere in it; without one
//! (the run was killed) everything before the start is read. Memory holds a chunk, and what lasts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::rc::Rc;

use mcap::records::MessageHeader;

use super::known;
use super::output::MANIFEST;
use super::reader::{Channel, ChunkPlace, Item, Reader, Schema};
use super::states::{States, is_latched};
use crate::LogReadError;
use crate::Origin;
use crate::ReadProgress;
use crate::Topics;

/// Chunks that are looked through for the last words of every sender of a topic that several send.
const LOOK_BACK: u32 = 32;

/// Messages that are looked at beforehand for who speaks.
const FIRST_MESSAGES: usize = 4096;
/// Bytes of messages after which that ends.
const FIRST_MESSAGES_BYTES: usize = 8 << 20;

/// Most bytes that the messages of one time may take.
const TICK_LIMIT: usize = 512 << 20;

/// Behind the magic number at the beginning of a file.
const BEGINNING: u64 = 8;

/// In place of the rank of what only viewers get.
const FOR_VIEWERS: usize = usize::MAX;

/// A message that is played.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Logged {
    /// Log time (ns).
    pub time: u64,
    /// Place of its topic in [`ipc_types::topics::NAMES`]; beyond their end for viewers' pictures.
    pub rank: usize,
    /// Its channel in the log.
    pub channel: u16,
    /// As it is in the log: CDR, or of viewers' pictures protobuf.
    pub data: Vec<u8>,
}

impl Logged {
    /// Index of the process that sent it.
    pub fn sender(&self) -> u32 {
        known::stamp(&self.data).map_or(0, |stamp| stamp.source)
    }

    /// Whether it is of one of our topics, and no picture for viewers.
    pub fn is_ours(&self) -> bool {
        self.rank != FOR_VIEWERS
    }
}

/// A channel that is played.
#[derive(Debug, Clone, Copy)]
struct Played {
    rank: usize,
    latched: bool,
    one_sender: bool,
}

impl Played {
    /// Who sent a message of the channel; viewers' pictures all come from the recorder.
    fn sender(&self, data: &[u8]) -> u32 {
        if self.rank == FOR_VIEWERS {
            return 0;
        }
        known::stamp(data).map_or(0, |stamp| stamp.source)
    }
}

/// See the module's text.
pub struct Source {
    reader: Reader<'static>,
    origin: Origin,
    topics: Topics,
    /// Whether viewers' pictures are wanted too.
    pictures: bool,
    index: Option<Vec<ChunkPlace>>,
    played: BTreeMap<u16, Played>,
    /// The first message from the start on, which was read to find it.
    ahead: Option<Logged>,
    /// Log time before which messages are handed out (ns).
    before: u64,
    /// Behind this place of the file there is none before `before`.
    end: u64,
}

impl Source {
    /// Opens a log of ours of which these topics are wanted, up to log time `before` (ns); viewers'
    /// pictures only if `pictures` says so.
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
        let channels: Vec<Rc<Channel>> = source.reader.channels().cloned().collect();
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

    /// The run that the log comes from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The file.
    pub fn path(&self) -> &Path {
        self.reader.path()
    }

    /// Its size (bytes).
    pub fn length(&self) -> u64 {
        self.reader.condition().file_bytes
    }

    /// Where in the file it stands (bytes).
    pub fn at(&self) -> u64 {
        self.reader.at()
    }

    /// Whether the file has an index.
    pub fn has_index(&self) -> bool {
        self.index.is_some()
    }

    /// The channels that are played, as far as they are known.
    pub fn channels(&self) -> impl Iterator<Item = (u16, &Rc<Channel>, Option<Rc<Schema>>)> {
        let played = |channel: &&Rc<Channel>| self.played.contains_key(&channel.id);
        let channels = self.reader.channels().filter(played);
        channels.map(|channel| (channel.id, channel, self.reader.schema(channel.schema_id)))
    }

    /// What is wrong with what was read of the file.
    pub fn faults(&self) -> Vec<String> {
        self.reader.condition().lines()
    }

    /// What stands before the first message.
    fn read_head(&mut self) -> Result<(), LogReadError> {
        while let Some(item) = self.reader.next()? {
            match item {
                Item::Metadata(record) if record.name == MANIFEST => {
                    self.origin.manifest = record.metadata;
                }
                Item::Attachment(header, data) if header.name == "scenario.toml" => {
                    self.origin.scenario = Some(data.to_vec());
                }
                Item::Message(..) => break,
                _ => {}
            }
        }
        self.origin.check(self.reader.path())
    }

    /// Plays a channel if it is one of ours and wanted; one of ours must look as it does here.
    fn take_up(&mut self, channel: &Channel) -> Result<(), LogReadError> {
        if channel.topic.starts_with("/viewer/") {
            if self.pictures && self.topics.take(&channel.topic) {
                let played = Played {
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
            let played = Played {
                rank: topic.rank(),
                latched: topic.facts().latched,
                one_sender: topic.has_one_publisher(),
            };
            self.played.insert(channel.id, played);
        }
        Ok(())
    }

    /// Goes to the first message from log time `from` on; what lasts from before it is returned,
    /// the oldest first.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn seek(
        &mut self,
        from: u64,
        read_progress: &mut ReadProgress,
    ) -> Result<Vec<Logged>, LogReadError> {
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
                self.ahead = Some(Logged {
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
                Some(Logged {
                    time: header.log_time,
                    rank: played.rank,
                    channel: header.channel_id,
                    data,
                })
            })
            .collect())
    }

    /// Finds the last message before `from` of every channel and sender that lasts, in the chunks
    /// before the start.
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
            let mut seen = BTreeSet::new();
            let path = self.reader.path().to_owned();
            self.reader.jump(chunk.at);
            while self.reader.next()?.is_some() && self.reader.at() == chunk.at {
                if let Some((header, data)) = self.reader.last_message()
                    && header.log_time < from
                    && wanted.contains_key(&header.channel_id)
                    && let Some(played) = self.played.get(&header.channel_id)
                {
                    let source = played.sender(data);
                    seen.insert(header.channel_id);
                    here.keep(&path, source, header, data)?;
                }
            }
            for channel in seen {
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

    /// Goes to the next message that is played; `None` at the end. Its header is returned, its bytes
    /// are the reader's last message.
    fn advance(&mut self) -> Result<Option<(MessageHeader, Played)>, LogReadError> {
        while self.reader.at() <= self.end {
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

    /// The bytes of the message that [`Source::advance`] went to.
    fn bytes(&self) -> &[u8] {
        self.reader.last_message().map_or(&[], |(_, data)| data)
    }

    /// Everything of the next time, in place of what `into` holds; false at the end.
    ///
    /// # Errors
    /// The log cannot be read: [`LogReadError`].
    pub fn tick(&mut self, into: &mut Vec<Logged>) -> Result<bool, LogReadError> {
        let (mut count, mut bytes) = (0, 0);
        loop {
            if count == into.len() {
                into.push(Logged::default());
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
            if bytes > TICK_LIMIT {
                return Err(LogReadError::TooLarge {
                    path: self.reader.path().to_owned(),
                    what: "the messages of one tick",
                    limit: TICK_LIMIT,
                });
            }
            count += 1;
        }
        into.truncate(count);
        Ok(count > 0)
    }

    /// Goes to the beginning and visits topic and sender of the first messages. Whoever speaks in a
    /// run speaks there, with few exceptions.
    ///
    /// # Errors
    /// The log cannot be read, or `visit` fails.
    pub fn visit_senders<E: From<LogReadError>>(
        &mut self,
        read_progress: &mut ReadProgress,
        visit: &mut dyn FnMut(usize, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        self.seek(0, read_progress)?;
        let mut message = Logged::default();
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

    /// The next message; false at the end.
    fn next(&mut self, into: &mut Logged) -> Result<bool, LogReadError> {
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
