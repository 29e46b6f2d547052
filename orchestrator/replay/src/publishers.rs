//! Publishers of the messages in a log: one for each topic and sender.

use std::collections::BTreeMap;

use ipc_types::bus::{Bus, BusError, Publisher, PublisherOptions, SendError};
use ipc_types::cdr;
use ipc_types::stamp::Header as _;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};
use mcap_log::source::Logged;

use mission::MissionError;

/// Publishers of one topic.
trait Publish {
    /// Opens a publisher for a process. Returns `true` if it did not exist.
    fn open(&mut self, bus: &Bus, source: u32) -> Result<bool, BusError>;
    /// Sends a message, byte for byte. Returns `false` if it is not a message of the topic.
    fn publish(&mut self, data: &[u8]) -> Result<bool, SendError>;
    /// Connects to new subscribers, which get latched messages.
    fn connect(&self) -> Result<(), SendError>;
}

struct OfTopic<T: Topic> {
    /// Publishers by the index of the process.
    ports: BTreeMap<u32, Publisher<T>>,
    elements: Vec<T::Element>,
}

impl<T: Topic> Publish for OfTopic<T> {
    fn open(&mut self, bus: &Bus, source: u32) -> Result<bool, BusError> {
        if self.ports.contains_key(&source) {
            return Ok(false);
        }
        let port = bus.publisher(PublisherOptions::growing(source))?;
        self.ports.insert(source, port);
        Ok(true)
    }

    fn publish(&mut self, data: &[u8]) -> Result<bool, SendError> {
        let Ok(header) = cdr::decode_into::<T>(data, &mut self.elements) else {
            return Ok(false);
        };
        if let Some(port) = self.ports.get(&header.stamp().source) {
            port.repeat(header, &self.elements)?;
        }
        Ok(true)
    }

    fn connect(&self) -> Result<(), SendError> {
        self.ports
            .values()
            .try_for_each(Publisher::update_connections)
    }
}

/// Publishers of all topics.
pub(super) struct TopicPublishers {
    /// Publishers in the order of their topics in [`ipc_types::topics::NAMES`].
    topics: Vec<Box<dyn Publish>>,
}

impl TopicPublishers {
    pub(super) fn new() -> Self {
        struct Collect(Vec<Box<dyn Publish>>);
        impl TopicVisitor for Collect {
            type Error = core::convert::Infallible;
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
                self.0.push(Box::new(OfTopic::<T> {
                    ports: BTreeMap::new(),
                    elements: Vec::new(),
                }));
                Ok(())
            }
        }
        let mut collect = Collect(Vec::new());
        let Ok(()) = for_each_topic(&mut collect);
        Self { topics: collect.0 }
    }

    /// Opens the publisher of a topic for a process. Returns `true` if it was not open.
    pub(super) fn open(
        &mut self,
        bus: &Bus,
        rank: usize,
        source: u32,
    ) -> Result<bool, MissionError> {
        match self.topics.get_mut(rank) {
            Some(topic) => Ok(topic.open(bus, source)?),
            None => Ok(false),
        }
    }

    /// Sends a message; its publisher must be open. Returns `false` if it is not a message of its topic.
    pub(super) fn publish(&mut self, message: &Logged) -> Result<bool, MissionError> {
        match self.topics.get_mut(message.rank) {
            Some(topic) => Ok(topic.publish(&message.data)?),
            None => Ok(true),
        }
    }

    /// Connects to new subscribers, which get latched messages.
    pub(super) fn connect(&self) -> Result<(), SendError> {
        self.topics.iter().try_for_each(|topic| topic.connect())
    }
}
