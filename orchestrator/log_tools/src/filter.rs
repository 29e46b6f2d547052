//! Extraction of a part of a log by time and topics.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use mcap_log::Condition;
use mcap_log::MessageHeader;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::known;
use mcap_log::output::{FILTERED, Output, mark_incomplete};
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::states::{States, is_latched};
use mcap_log::{DerivedError, LogReadError};
use serde::Serialize;

use crate::time_span::TimeSpan;

/// Options of a filter.
#[derive(Debug, Clone, Default)]
pub struct FilterOptions {
    /// Start of the part (s): simulated time in Protean logs, else relative to the first message.
    pub start_s: Option<f64>,
    /// End of the part, included (s).
    pub end_s: Option<f64>,
    /// Selected topics.
    pub topics: Topics,
    /// `true` if an existing file may be overwritten.
    pub force: bool,
}

/// Result of a filter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Filtered {
    /// Number of messages in the new log, including those from before its start.
    pub messages: u64,
    /// Number of messages from before the start, written at the start: the states that held then.
    pub restored: u64,
    /// Number of omitted states: they follow the first message of the part in the log, but are older.
    pub late_states: u64,
    /// Number of topics with messages in the new log.
    pub topics: usize,
    /// Size of the new log (bytes).
    pub bytes: u64,
    /// Condition of the source log.
    pub source: Condition,
}

/// Writes the selected topics and time of a log into a new log, with all other contents. The last message before the
/// start of every topic that describes a lasting state is written at the start.
///
/// # Errors
/// [`DerivedError`]; then no new log is written.
pub fn filter(
    log: &Path,
    out: &Path,
    options: &FilterOptions,
    watch: &mut ReadProgress,
) -> Result<Filtered, DerivedError> {
    let mut part = Part::new(log, options, watch)?;
    let mut reader = Reader::open(log, Some(watch))?;
    let mut output: Option<Output> = None;
    while let Some(item) = reader.next()? {
        let output = match (&mut output, &item) {
            (Some(output), _) => output,
            (none, Item::Header { profile, .. }) => {
                *none = Some(Output::create(out, log, options.force, profile)?);
                continue;
            }
            (none, _) => none.insert(Output::create(out, log, options.force, "")?),
        };
        match item {
            Item::Header { .. } => {}
            Item::Schema(id, schema) => output.schema(id, &schema)?,
            Item::Channel(channel) => part.channel(&channel, output)?,
            Item::Message(header, data) => part.message(header, data, output)?,
            Item::Attachment(header, data) => output.attachment(&header, data)?,
            Item::Metadata(record) => output.metadata(&mark_incomplete(record))?,
        }
    }
    options
        .topics
        .check(&reader.channels().map(|channel| channel.topic.as_str()))?;
    let output = match output {
        Some(output) => output,
        None => Output::create(out, log, options.force, "")?,
    };
    part.finish(output, reader.condition().clone())
}

/// The selected part, while the log is read.
struct Part<'a> {
    log: &'a Path,
    options: &'a FilterOptions,
    span: TimeSpan,
    /// Selected channels.
    channels: BTreeMap<u16, KeptChannel>,
    /// States before the start.
    states: States,
    /// `true` once a message has been written.
    begun: bool,
    with_messages: BTreeSet<u16>,
    count: Filtered,
}

/// Properties of a selected channel.
#[derive(Clone, Copy)]
struct KeptChannel {
    /// `true` if its last message describes a lasting state.
    is_state: bool,
    /// `true` if its messages have Protean's stamp.
    is_stamped: bool,
}

impl<'a> Part<'a> {
    fn new(
        log: &'a Path,
        options: &'a FilterOptions,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let span = TimeSpan::new(log, options.start_s, options.end_s, watch)?;
        Ok(Self {
            log,
            options,
            span,
            channels: BTreeMap::new(),
            states: States::default(),
            begun: false,
            with_messages: BTreeSet::new(),
            count: Filtered {
                messages: 0,
                restored: 0,
                late_states: 0,
                topics: 0,
                bytes: 0,
                source: Condition::default(),
            },
        })
    }

    fn channel(&mut self, channel: &Channel, output: &mut Output) -> Result<(), DerivedError> {
        if !self.options.topics.take(&channel.topic) {
            return Ok(());
        }
        let kept = KeptChannel {
            is_state: is_latched(&channel.topic, &channel.metadata),
            is_stamped: known::topic_of(channel).is_some(),
        };
        self.channels.insert(channel.id, kept);
        output.channel(channel)
    }

    fn message(
        &mut self,
        header: MessageHeader,
        data: &[u8],
        output: &mut Output,
    ) -> Result<(), DerivedError> {
        let Some(&channel) = self.channels.get(&header.channel_id) else {
            return Ok(());
        };
        if header.log_time > self.span.to {
            return Ok(());
        }
        if header.log_time < self.span.from {
            if channel.is_state && self.begun {
                self.count.late_states += 1;
            } else if channel.is_state {
                let stamp = known::stamp(data).filter(|_| channel.is_stamped);
                let source = stamp.map_or(0, |stamp| stamp.source);
                self.states.keep(self.log, source, header, data)?;
            }
            return Ok(());
        }
        if !self.begun {
            self.begun = true;
            self.count.restored = restore(&mut self.states, self.span.from, output)?;
        }
        self.with_messages.insert(header.channel_id);
        self.count.messages += 1;
        output.message(&header, data)
    }

    fn finish(mut self, mut output: Output, source: Condition) -> Result<Filtered, DerivedError> {
        self.with_messages.extend(self.states.channels());
        if !self.begun {
            self.count.restored = restore(&mut self.states, self.span.from, &mut output)?;
        }
        let mut count = self.count;
        count.messages += count.restored;
        count.topics = self.with_messages.len();
        count.source = source;
        let time = |time: Option<f64>| time.map_or_else(String::new, |time| time.to_string());
        let name = self.log.file_name().unwrap_or_default().to_string_lossy();
        output.note(
            FILTERED,
            [
                ("from", name.into_owned()),
                ("start_s", time(self.options.start_s)),
                ("end_s", time(self.options.end_s)),
                ("topics", self.options.topics.only.join(",")),
                ("exclude", self.options.topics.without.join(",")),
                ("restored", count.restored.to_string()),
            ],
        )?;
        count.bytes = output.finish()?;
        Ok(count)
    }
}

/// Writes the states at the start, in their original order.
fn restore(states: &mut States, from: u64, output: &mut Output) -> Result<u64, DerivedError> {
    let last = states.take();
    for (header, data) in &last {
        let header = MessageHeader {
            log_time: from,
            ..*header
        };
        output.message(&header, data)?;
    }
    Ok(last.len() as u64)
}
