//! The simulated history in a log, tick by tick.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use ipc_types::consumer::LoggedMessage;
use ipc_types::stamp::Stamp;
use ipc_types::topics::{TopicId, WorldEvents};
use mcap_log::known;
use mcap_log::output::{MANIFEST, RESULT};
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::ros2::Schema;
use mcap_log::{Condition, LogReadError};
use recorder::{EventEntry, RunInfo};

/// Maximum number of events that are kept of a log.
const MAX_EVENTS: usize = 10_000;

/// A topic of a log.
#[derive(Debug)]
pub(crate) struct TopicFormat {
    /// Its name.
    pub(crate) name: String,
    /// Definition of its messages.
    pub(crate) definition: Vec<u8>,
    /// The same, parsed; `None` if it cannot be.
    pub(crate) schema: Option<Schema>,
}

/// A message of the simulated history.
#[derive(Debug)]
pub(crate) struct Message {
    pub(crate) topic: Rc<TopicFormat>,
    pub(crate) stamp: Stamp,
    /// CDR form.
    pub(crate) data: Vec<u8>,
}

/// All messages of one log time.
#[derive(Debug, Default)]
pub(crate) struct Moment {
    /// Log time (ns).
    pub(crate) time_ns: u64,
    /// Its messages, in the order of the log.
    pub(crate) messages: Vec<Message>,
}

/// The history in a log, and what else is known of the run after the part that has been read.
pub(crate) struct History {
    reader: Reader<'static>,
    topics: BTreeMap<u16, Rc<TopicFormat>>,
    ahead: Option<(u64, Message)>,
    /// Entries of the manifest.
    pub(crate) manifest: BTreeMap<String, String>,
    /// Text of the scenario.
    pub(crate) scenario: String,
    /// Description of the run.
    pub(crate) run: RunInfo,
    /// Result of the run; empty if it was killed, or before its end.
    pub(crate) result: BTreeMap<String, String>,
    /// Events of the world.
    pub(crate) events: Vec<EventEntry>,
}

impl History {
    /// Opens a log and reads what precedes its messages.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read or is not a Protean log.
    pub(crate) fn open(log: &Path) -> Result<Self, LogReadError> {
        let mut history = Self {
            reader: Reader::open(log, None)?,
            topics: BTreeMap::new(),
            ahead: None,
            manifest: BTreeMap::new(),
            scenario: String::new(),
            run: RunInfo::default(),
            result: BTreeMap::new(),
            events: Vec::new(),
        };
        history.ahead = history.next()?;
        if history.manifest.is_empty() {
            return Err(LogReadError::Foreign {
                path: log.to_owned(),
                missing: "manifest",
            });
        }
        Ok(history)
    }

    /// Returns all messages of the next log time; `None` at the end of the log.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read, or its times are not in order.
    pub(crate) fn moment(&mut self) -> Result<Option<Moment>, LogReadError> {
        let Some((time_ns, first)) = self.ahead.take() else {
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

    /// Returns the name of a process of the run.
    pub(crate) fn process(&self, source: u32) -> String {
        let mut processes = self.run.processes.iter();
        let process = processes.find(|process| process.index == source);
        process.map_or_else(|| format!("process {source}"), |found| found.name.clone())
    }

    /// Returns the read position in the file (bytes).
    pub(crate) fn at(&self) -> u64 {
        self.reader.at()
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
                Item::Metadata(record) if record.name == MANIFEST => {
                    self.manifest = record.metadata;
                }
                Item::Metadata(record) if record.name == RESULT => self.result = record.metadata,
                Item::Attachment(header, data) if header.name == "scenario.toml" => {
                    self.scenario = String::from_utf8_lossy(data).into_owned();
                }
                Item::Attachment(header, data) if header.name == RunInfo::ATTACHMENT => {
                    self.run = serde_json::from_slice(data).unwrap_or_default();
                }
                Item::Channel(channel) => self.channel(&channel),
                Item::Message(header, data) => {
                    let topic = self.topics.get(&header.channel_id);
                    if let Some(topic) = topic
                        && let Some(stamp) = known::stamp(data)
                    {
                        let message = Message {
                            topic: Rc::clone(topic),
                            stamp,
                            data: data.to_vec(),
                        };
                        self.event(header.log_time, &message);
                        return Ok(Some((header.log_time, message)));
                    }
                }
                _ => {}
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
        self.topics.insert(channel.id, Rc::new(format));
    }

    /// Keeps the events of a message.
    fn event(&mut self, time_ns: u64, message: &Message) {
        if message.topic.name != TopicId::WorldEvents.name() || self.events.len() >= MAX_EVENTS {
            return;
        }
        let Some(message) = LoggedMessage::new(TopicId::WorldEvents, time_ns, &message.data) else {
            return;
        };
        if let Some((_, events)) = message.view::<WorldEvents>() {
            let names = self.run.event_names();
            let entries = events.map(|event| names.entry(message.time_s(), &event));
            self.events.extend(entries);
        }
    }
}
