//! The simulated history in a log, tick by tick.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ipc_types::consumer::LoggedMessage;
use ipc_types::messages::world::WorldHeader;
use ipc_types::topics::{Topic as _, TopicId, WorldEvents, WorldState};
use mcap_log::known::{self, ENCAPSULATION};
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::ros2::Schema;
use mcap_log::{Condition, LogReadError, Origin};
use recorder::{EventEntry, RunInfo};
use zerocopy::FromBytes as _;

use crate::message::{Message, TopicFormat};

/// Maximum number of events that are kept of a log.
const MAX_EVENTS: usize = 10_000;

/// All messages of one log time.
#[derive(Debug, Default)]
pub struct Moment {
    /// Log time (ns).
    pub(crate) time_ns: u64,
    /// Its messages, in the order of the log.
    pub(crate) messages: Vec<Message>,
}

/// The history in a log, and what else is known of the run after the part that has been read.
pub struct History {
    reader: Reader<'static>,
    topics: BTreeMap<u16, Arc<TopicFormat>>,
    ahead: Option<(u64, Message)>,
    /// Log time at which the compared part ends (ns).
    before: u64,
    /// `true` if the last state of the world is that of the end of the run.
    over: bool,
    /// Manifest, scenario and result.
    pub(crate) origin: Origin,
    /// Description of the run.
    pub(crate) run: RunInfo,
    /// Events of the world.
    pub(crate) events: Vec<EventEntry>,
}

impl History {
    /// Opens a log and reads what precedes its messages; the history ends before a log time (ns).
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read or is not a Protean log.
    pub(crate) fn open(log: &Path, before: u64) -> Result<Self, LogReadError> {
        let mut history = Self {
            reader: Reader::open(log, None)?,
            topics: BTreeMap::new(),
            ahead: None,
            before,
            over: false,
            origin: Origin::default(),
            run: RunInfo::default(),
            events: Vec::new(),
        };
        history.ahead = history.next()?;
        history.origin.check(log)?;
        Ok(history)
    }

    /// Returns all messages of the next log time; `None` at the end of the history.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read, or its times are not in order.
    pub(crate) fn moment(&mut self) -> Result<Option<Moment>, LogReadError> {
        let before = self.before;
        let Some((time_ns, first)) = self.ahead.take_if(|(time_ns, _)| *time_ns < before) else {
            return Ok(None);
        };
        let mut moment = Moment {
            time_ns,
            messages: vec![first],
        };
        while let Some((time, message)) = self.next()? {
            if time < time_ns {
                return Err(LogReadError::NotRepeatable {
                    path: self.reader.path().to_owned(),
                    reason: "its messages are not in order of time".to_owned(),
                });
            }
            if time > time_ns {
                self.ahead = Some((time, message));
                break;
            }
            moment.messages.push(message);
        }
        Ok(Some(moment))
    }

    /// Reads the rest of the log for its events and its result.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read.
    pub(crate) fn finish(&mut self) -> Result<(), LogReadError> {
        while self.next()?.is_some() {}
        self.reader.check_all()
    }

    /// Returns `true` if the messages that have been read reach the end of the run.
    pub(crate) fn has_ended(&self) -> bool {
        self.ahead.is_none()
            && self.over
            && self.origin.result.contains_key("digest")
            && self.reader.condition().data
    }

    /// Returns the read position in the file (bytes).
    pub(crate) fn offset(&self) -> u64 {
        self.reader.offset()
    }

    /// Returns the condition of the log.
    pub(crate) fn condition(&self) -> &Condition {
        self.reader.condition()
    }

    /// Returns the next message of the simulated history, with its log time.
    fn next(&mut self) -> Result<Option<(u64, Message)>, LogReadError> {
        loop {
            let Some(item) = self.reader.next()? else {
                return Ok(None);
            };
            match item {
                Item::Channel(channel) => self.channel(&channel),
                Item::Message(header, data) => {
                    let topic = self.topics.get(&header.channel_id);
                    if let Some(topic) = topic
                        && let Some(stamp) = known::stamp(data)
                    {
                        let message = Message {
                            topic: Arc::clone(topic),
                            stamp,
                            data: data.to_vec(),
                        };
                        self.note(header.log_time, &message);
                        return Ok(Some((header.log_time, message)));
                    }
                }
                other => {
                    self.origin.add(&other);
                    if matches!(&other, Item::Attachment(header, _) if header.name == Origin::RUN) {
                        self.run = RunInfo::from_log(&self.origin).unwrap_or_default();
                    }
                }
            }
        }
    }

    /// Takes a channel of the simulated history.
    fn channel(&mut self, channel: &Channel) {
        let is_simulated = channel.metadata.get("simulated");
        if is_simulated.is_none_or(|value| value != "true") {
            return;
        }
        let schema = self.reader.schema(channel.schema_id);
        let schema = schema.filter(|schema| schema.encoding == "ros2msg");
        let format = TopicFormat {
            name: channel.topic.clone(),
            schema: schema
                .as_ref()
                .and_then(|schema| Schema::parse(&schema.name, &schema.data).ok()),
            definition: schema.map_or_else(Vec::new, |schema| schema.data.clone()),
        };
        self.topics.insert(channel.id, Arc::new(format));
    }

    /// Keeps the events of a message, and if the run is over.
    fn note(&mut self, time_ns: u64, message: &Message) {
        if message.topic.name == WorldState::NAME {
            let state = message.data.get(ENCAPSULATION..).unwrap_or_default();
            self.over = WorldHeader::read_from_prefix(state)
                .is_ok_and(|(state, _)| state.phase == WorldHeader::OVER);
        }
        if message.topic.name != TopicId::WorldEvents.name() || self.events.len() >= MAX_EVENTS {
            return;
        }
        let Some(message) = LoggedMessage::new(TopicId::WorldEvents, time_ns, &message.data) else {
            return;
        };
        if let Some((_, events)) = message.view::<WorldEvents>() {
            let names = self.run.event_names();
            let entries = events.map(|event| EventEntry::new(message.time_s(), &event, &names));
            self.events.extend(entries);
        }
    }
}
