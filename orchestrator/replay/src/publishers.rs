//! Publishers of the messages in a log: one for each topic and sender.

use std::collections::BTreeMap;

use ipc_types::bus::{AnyPublisher, AnyTopic, Bus, SendError};
use mcap_log::known;
use mcap_log::source::LogMessage;

use mission::MissionError;

/// Publishers of all topics.
pub(super) struct TopicPublishers {
    /// The topics by rank, each with its publishers.
    topics: Vec<(AnyTopic, Ports)>,
}

/// Publishers of a topic by the index of the process.
type Ports = BTreeMap<u32, Box<dyn AnyPublisher>>;

impl TopicPublishers {
    pub(super) fn new() -> Self {
        let topics = AnyTopic::all().into_iter();
        Self {
            topics: topics.map(|topic| (topic, Ports::new())).collect(),
        }
    }

    /// Opens the publisher of a topic for a process. Returns `true` if it was not open.
    pub(super) fn open(
        &mut self,
        bus: &Bus,
        rank: usize,
        source: u32,
    ) -> Result<bool, MissionError> {
        let Some((topic, ports)) = self.topics.get_mut(rank) else {
            return Ok(false);
        };
        let is_new = !ports.contains_key(&source);
        if is_new {
            ports.insert(source, topic.repeater(bus, source)?);
        }
        Ok(is_new)
    }

    /// Sends a message; its publisher must be open. Returns `false` if it is not a message of its topic.
    pub(super) fn publish(&mut self, message: &LogMessage) -> Result<bool, MissionError> {
        let Some((_, ports)) = self.topics.get_mut(message.rank) else {
            return Ok(true);
        };
        // Not a message without a stamp.
        let Some(stamp) = known::stamp(&message.data) else {
            return Ok(false);
        };
        match ports.get_mut(&stamp.source) {
            Some(port) => Ok(port.repeat(&message.data)?),
            None => Ok(true),
        }
    }

    /// Connects to new subscribers, which get latched messages.
    pub(super) fn connect(&self) -> Result<(), SendError> {
        let mut ports = self.topics.iter().flat_map(|(_, ports)| ports.values());
        ports.try_for_each(|port| port.update_connections())
    }
}
