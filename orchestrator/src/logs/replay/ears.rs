//! Hears what the processes under test say.

use std::collections::BTreeSet;

use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::cdr;
use ipc_types::stamp::Header as _;
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};

use super::super::source::Logged;

/// Listens to one topic.
trait Ear {
    fn connect(&self) -> Result<(), ReceiveError>;
    /// Takes what these processes have said since the last time, with its sequence number.
    fn hear(
        &self,
        of: &BTreeSet<u32>,
        said: &mut dyn FnMut(u64, Vec<u8>),
    ) -> Result<(), ReceiveError>;
}

impl<T: Topic> Ear for Subscriber<T> {
    fn connect(&self) -> Result<(), ReceiveError> {
        self.update_connections()
    }

    fn hear(
        &self,
        of: &BTreeSet<u32>,
        said: &mut dyn FnMut(u64, Vec<u8>),
    ) -> Result<(), ReceiveError> {
        while let Some(message) = self.receive()? {
            let stamp = message.header().stamp();
            if of.contains(&stamp.source) {
                let mut data = Vec::new();
                cdr::encode::<T>(message.header(), message.elements(), &mut data);
                said(stamp.sequence, data);
            }
        }
        Ok(())
    }
}

/// Listens to every topic of the simulated history.
pub(super) struct Ears {
    /// By the place of their topics in [`ipc_types::topics::NAMES`].
    ears: Vec<(usize, Box<dyn Ear>)>,
}

impl Ears {
    pub(super) fn open(bus: &Bus) -> Result<Self, BusError> {
        struct Open<'a>(&'a Bus, Vec<(usize, Box<dyn Ear>)>, usize);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                if T::ID.facts().simulated {
                    self.1.push((self.2, Box::new(self.0.recorder::<T>()?)));
                }
                self.2 += 1;
                Ok(())
            }
        }
        let mut open = Open(bus, Vec::new(), 0);
        for_each_topic(&mut open)?;
        Ok(Self { ears: open.1 })
    }

    /// Connects to everybody who speaks.
    pub(super) fn connect(&self) -> Result<(), ReceiveError> {
        self.ears.iter().try_for_each(|(_, ear)| ear.connect())
    }

    /// What these processes have said since the last time, in the order of the sequence numbers, as of
    /// this log time.
    pub(super) fn hear(&self, of: &BTreeSet<u32>, time: u64) -> Result<Vec<Logged>, ReceiveError> {
        let mut heard = Vec::new();
        for (rank, ear) in &self.ears {
            ear.hear(of, &mut |sequence, data| {
                let (rank, channel) = (*rank, 0);
                heard.push((
                    sequence,
                    Logged {
                        time,
                        rank,
                        channel,
                        data,
                    },
                ));
            })?;
        }
        heard.sort_by_key(|(sequence, _)| *sequence);
        Ok(heard.into_iter().map(|(_, message)| message).collect())
    }
}
