//! Capture of the messages that the processes under test send.

use std::collections::BTreeSet;

use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::cdr;
use ipc_types::stamp::Header as _;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};
use mcap_log::source::Logged;

/// Subscriber of a topic.
trait Take {
    fn connect(&self) -> Result<(), ReceiveError>;
    /// Receives the new messages of these processes, with their sequence numbers.
    fn take(
        &self,
        of: &BTreeSet<u32>,
        taken: &mut dyn FnMut(u64, Vec<u8>),
    ) -> Result<(), ReceiveError>;
}

impl<T: Topic> Take for Subscriber<T> {
    fn connect(&self) -> Result<(), ReceiveError> {
        self.update_connections()
    }

    fn take(
        &self,
        of: &BTreeSet<u32>,
        taken: &mut dyn FnMut(u64, Vec<u8>),
    ) -> Result<(), ReceiveError> {
        while let Some(message) = self.receive()? {
            let stamp = message.header().stamp();
            if of.contains(&stamp.source) {
                let mut data = Vec::new();
                cdr::encode::<T>(message.header(), message.elements(), &mut data);
                taken(stamp.sequence, data);
            }
        }
        Ok(())
    }
}

/// Subscribers of all topics of the simulated history.
pub(super) struct OutputCapture {
    /// Subscribers with the indices of their topics in [`ipc_types::topics::NAMES`].
    topics: Vec<(usize, Box<dyn Take>)>,
}

impl OutputCapture {
    pub(super) fn open(bus: &Bus) -> Result<Self, BusError> {
        struct Open<'a>(&'a Bus, Vec<(usize, Box<dyn Take>)>);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                if T::ID.facts().simulated {
                    let topic = self.0.recorder::<T>()?;
                    self.1.push((T::ID.rank(), Box::new(topic)));
                }
                Ok(())
            }
        }
        let mut open = Open(bus, Vec::new());
        for_each_topic(&mut open)?;
        Ok(Self { topics: open.1 })
    }

    /// Connects to all publishers.
    pub(super) fn connect(&self) -> Result<(), ReceiveError> {
        self.topics
            .iter()
            .try_for_each(|(_, topic)| topic.connect())
    }

    /// Returns the new messages of these processes, in the order of their sequence numbers, with this log time.
    pub(super) fn take(&self, of: &BTreeSet<u32>, time: u64) -> Result<Vec<Logged>, ReceiveError> {
        let mut taken = Vec::new();
        for (rank, topic) in &self.topics {
            topic.take(of, &mut |sequence, data| {
                let message = Logged {
                    time,
                    rank: *rank,
                    channel: 0,
                    data,
                };
                taken.push((sequence, message));
            })?;
        }
        taken.sort_by_key(|(sequence, _)| *sequence);
        Ok(taken.into_iter().map(|(_, message)| message).collect())
    }
}
