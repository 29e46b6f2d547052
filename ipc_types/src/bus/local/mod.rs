//! The bus of a run in one thread of one process: typed queues in ordinary memory.
//!
//! It has the observable properties of iceoryx2: the order of every publisher, histories for late
//! joiners, the capacity of a publisher, the depth of a subscriber's buffer, the number of ports.
//! Two properties differ in one thread. No receiver can make room while a sender waits, so a full
//! buffer fails at once; and no clock is read, so the clocks of the stamps stay 0.

mod channel;
mod endpoint;
mod message;
mod ports;

use core::any::Any;
use core::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;

use channel::Channel;
pub(super) use endpoint::Endpoint;
pub(super) use message::Message;
pub(super) use ports::{Receiver, Sender};

use super::{BusError, BusOptions};
use crate::schema;
use crate::topics::{Service, TopicFacts};

/// The number of messages of a sender, which its publishers count together: one may continue for another.
type Sequence = Rc<Cell<u64>>;

/// The topics of one run in memory.
#[derive(Default)]
pub struct LocalTopics {
    /// Every topic's [`Channel`], by its name.
    channels: RefCell<BTreeMap<&'static str, Rc<dyn Any>>>,
    /// Every service's [`Endpoint`], by its name.
    endpoints: RefCell<BTreeMap<&'static str, Rc<dyn Any>>>,
    /// Number of messages so far, by topic and sender.
    sequences: RefCell<BTreeMap<(&'static str, u32), Sequence>>,
}

impl LocalTopics {
    /// The channel of a topic with these headers and elements, created on the first request.
    pub(super) fn channel<H: 'static, E: 'static>(
        &self,
        facts: &'static TopicFacts,
        options: &BusOptions,
    ) -> Result<Rc<Channel<H, E>>, BusError> {
        let channel = Rc::clone(
            self.channels
                .borrow_mut()
                .entry(facts.name)
                .or_insert_with(|| Rc::new(Channel::<H, E>::new(facts, options))),
        );
        channel.downcast().map_err(|_| BusError::Mismatch {
            topic: facts.name,
            ours: format!("schema {}", schema::fingerprint(facts)),
            theirs: "another type of the same name".into(),
        })
    }

    /// Returns the counter of a topic and a sender.
    pub(super) fn sequence(&self, topic: &'static str, source: u32) -> Sequence {
        let mut sequences = self.sequences.borrow_mut();
        Rc::clone(sequences.entry((topic, source)).or_default())
    }

    /// The endpoint of a service, created on the first request.
    pub(super) fn endpoint<S: Service>(&self) -> Result<Rc<Endpoint<S>>, BusError> {
        let endpoint = Rc::clone(
            self.endpoints
                .borrow_mut()
                .entry(S::NAME)
                .or_insert_with(|| Rc::new(Endpoint::<S>::default())),
        );
        endpoint.downcast().map_err(|_| BusError::Mismatch {
            topic: S::NAME,
            ours: "this service's messages".into(),
            theirs: "another type of the same name".into(),
        })
    }
}

crate::transport::debug_with! { [] LocalTopics, own => own.channels.borrow().len() }
