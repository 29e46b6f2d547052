//! Hears what the processes under test say.

use std::collections::BTreeSet;

use ipc_types::bus::{Bus, BusError, ReceiveError, Subscriber};
use ipc_types::cdr;
use ipc_types::schema;
use ipc_types::stamp::{Header as _, Stamp};
use ipc_types::topics::{Topic, TopicVisitor, for_each_topic};

use super::super::ros2::Schema;
use super::deviation::Numbers;

/// What a process said.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Said {
    pub(super) stamp: Stamp,
    /// Its CDR form.
    pub(super) data: Vec<u8>,
}

/// One topic of the simulated history.
pub(super) struct Ear {
    pub(super) topic: &'static str,
    /// Place of the topic in [`ipc_types::topics::NAMES`].
    pub(super) rank: usize,
    pub(super) numbers: Numbers,
    pub(super) schema: Option<Schema>,
    tap: Box<dyn Tap>,
}

impl Ear {
    /// Listens to every topic of the simulated history.
    pub(super) fn all(bus: &Bus) -> Result<Vec<Self>, BusError> {
        struct Open<'a>(&'a Bus, Vec<Ear>, usize);
        impl TopicVisitor for Open<'_> {
            type Error = BusError;
            fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
                let rank = self.2;
                self.2 += 1;
                if T::SIMULATED {
                    self.1.push(Ear {
                        topic: T::NAME,
                        rank,
                        numbers: Numbers::of::<T>(),
                        schema: Schema::parse(schema::ros2msg::<T>().as_bytes()).ok(),
                        tap: Box::new(self.0.recorder::<T>()?),
                    });
                }
                Ok(())
            }
        }
        let mut open = Open(bus, Vec::new(), 0);
        for_each_topic(&mut open)?;
        Ok(open.1)
    }

    /// Connects to everybody who speaks.
    pub(super) fn connect(&self) -> Result<(), ReceiveError> {
        self.tap.connect()
    }

    /// What these have said since the last time, by sender, in the order in which they did.
    pub(super) fn hear(&self, speakers: &BTreeSet<u32>) -> Result<Vec<Said>, ReceiveError> {
        let mut said = Vec::new();
        self.tap.drain(speakers, &mut said)?;
        said.sort_by_key(|said| (said.stamp.source, said.stamp.sequence));
        Ok(said)
    }
}

/// A subscriber without its type.
trait Tap {
    fn connect(&self) -> Result<(), ReceiveError>;
    fn drain(&self, speakers: &BTreeSet<u32>, said: &mut Vec<Said>) -> Result<(), ReceiveError>;
}

impl<T: Topic> Tap for Subscriber<T> {
    fn connect(&self) -> Result<(), ReceiveError> {
        self.update_connections()
    }

    fn drain(&self, speakers: &BTreeSet<u32>, said: &mut Vec<Said>) -> Result<(), ReceiveError> {
        while let Some(message) = self.receive()? {
            let stamp = *message.header().stamp();
            if speakers.contains(&stamp.source) {
                let mut data = Vec::new();
                cdr::encode::<T>(message.header(), message.elements(), &mut data);
                said.push(Said { stamp, data });
            }
        }
        Ok(())
    }
}
