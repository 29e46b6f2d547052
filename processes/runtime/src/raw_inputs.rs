//! Topics that a program reads by their names, with the bytes of their messages.

use core::fmt;

use ipc_types::bus::{AnyMessage, AnySubscriber, AnyTopic, Bus};
use ipc_types::stamp::Stamp;
use ipc_types::topics::TopicId;

use crate::config::{Clock, ProcessConfig};
use crate::declaration::{When, readable, reading_time};
use crate::error::ProcessError;

/// Messages taken from a topic at once.
const BATCH: usize = 1024;

/// The topics that a process reads, with the messages of the current tick.
#[derive(Debug, Default)]
pub struct RawInputs {
    topics: Vec<RawInput>,
}

/// A topic that a process reads.
pub struct RawInput {
    topic: TopicId,
    port: Box<dyn AnySubscriber>,
    when: When,
    is_lock_step: bool,
    /// Messages of later ticks.
    waiting: Vec<RawMessage>,
    /// Messages of the current tick.
    current: Vec<RawMessage>,
}

/// A message, copied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawMessage {
    /// Tick to which it belongs.
    pub tick: u64,
    /// Index of the sender in the run.
    pub source: u32,
    /// Bytes of its header.
    pub header: Vec<u8>,
    /// Bytes of its elements.
    pub elements: Vec<u8>,
}

impl RawMessage {
    /// Returns its CDR form, as logs contain it.
    pub fn cdr(&self, topic: TopicId) -> Vec<u8> {
        let mut bytes = Vec::new();
        let message = AnyMessage {
            topic,
            stamp: &Stamp::default(),
            header: &self.header,
            elements: &self.elements,
            count: self.elements.len() / topic.facts().element.size.max(1),
            shared: None,
        };
        message.encode(&mut bytes);
        bytes
    }
}

impl fmt::Debug for RawInput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("RawInput").field(&self.topic).finish()
    }
}

impl RawInput {
    /// Returns the topic.
    pub fn topic(&self) -> TopicId {
        self.topic
    }

    /// Returns the messages of the tick.
    pub fn messages(&self) -> &[RawMessage] {
        &self.current
    }
}

impl RawInputs {
    /// Opens the topics with these names.
    ///
    /// # Errors
    /// [`ProcessError`] names a topic that no process writes, or that cannot be opened.
    pub fn open(names: &[String], config: &ProcessConfig, bus: &Bus) -> Result<Self, ProcessError> {
        let open = |name: &String| {
            let topic = readable(name)?;
            let unknown = || ProcessError::Algorithm(format!("topic {name} is not registered"));
            Ok(RawInput {
                topic,
                port: AnyTopic::find(topic).ok_or_else(unknown)?.subscriber(bus)?,
                when: reading_time(topic, &config.run.topics),
                is_lock_step: config.run.clock == Clock::LockStep,
                waiting: Vec::new(),
                current: Vec::new(),
            })
        };
        let topics = names
            .iter()
            .map(open)
            .collect::<Result<_, ProcessError>>()?;
        Ok(Self { topics })
    }

    /// Returns the topics in the order of their names.
    pub fn topics(&self) -> &[RawInput] {
        &self.topics
    }

    /// Connects all topics.
    ///
    /// # Errors
    /// [`ProcessError`] if a topic cannot be connected.
    pub fn connect(&self) -> Result<(), ProcessError> {
        for input in &self.topics {
            input.port.update_connections()?;
        }
        Ok(())
    }

    /// Receives the messages of a tick.
    ///
    /// # Errors
    /// [`ProcessError`] if the transport fails.
    pub fn receive(&mut self, tick: u64) -> Result<(), ProcessError> {
        for input in &mut self.topics {
            let waiting = &mut input.waiting;
            while !input.port.drain(BATCH, &mut |message| {
                waiting.push(RawMessage {
                    tick: message.stamp.tick,
                    source: message.stamp.source,
                    header: message.header.to_vec(),
                    elements: message.elements.to_vec(),
                });
            })? {}
            let (when, is_lock_step) = (input.when, input.is_lock_step);
            let counts = |message: &mut RawMessage| {
                !is_lock_step
                    || message.tick < tick
                    || (message.tick == tick && when != When::NextTick)
            };
            let mut counted: Vec<RawMessage> = input.waiting.extract_if(.., counts).collect();
            // Of several senders, whatever arrived first.
            counted.sort_by_key(|message| (message.tick, message.source));
            if when != When::Latched {
                input.current = counted;
            } else if let Some(newest) = counted.pop() {
                input.current = vec![newest];
            }
        }
        Ok(())
    }
}
