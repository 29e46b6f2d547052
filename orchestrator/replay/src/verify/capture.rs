//! Capture of the messages that the processes under test send.

use std::collections::BTreeSet;

use diff::Message;
use ipc_types::bus::{AnySubscriber, AnyTopic, Bus, BusError, ReceiveError};

/// Subscribers of all topics of the simulated history.
pub(super) struct OutputCapture {
    topics: Vec<Box<dyn AnySubscriber>>,
}

impl OutputCapture {
    pub(super) fn open(bus: &Bus) -> Result<Self, BusError> {
        let topics = AnyTopic::all().into_iter();
        let topics = topics.filter(|topic| topic.id.facts().simulated);
        Ok(Self {
            topics: topics
                .map(|topic| topic.recorder(bus))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Connects to all publishers.
    pub(super) fn connect(&self) -> Result<(), ReceiveError> {
        self.topics
            .iter()
            .try_for_each(|topic| topic.update_connections())
    }

    /// Returns the new messages of these processes, in the order of their sequence numbers.
    pub(super) fn take(&self, of: &BTreeSet<u32>) -> Result<Vec<Message>, ReceiveError> {
        let mut taken = Vec::new();
        for topic in &self.topics {
            topic.drain(usize::MAX, &mut |message| {
                if of.contains(&message.stamp.source) {
                    let mut data = Vec::new();
                    message.encode(&mut data);
                    let captured = Message::from_cdr(message.topic, data);
                    taken.extend(captured.map(|captured| (message.stamp.sequence, captured)));
                }
            })?;
        }
        taken.sort_by_key(|(sequence, _)| *sequence);
        Ok(taken.into_iter().map(|(_, message)| message).collect())
    }
}
