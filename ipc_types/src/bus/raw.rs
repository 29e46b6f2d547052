//! Topics whose messages a program knows as bytes alone, by their layout.

use core::cell::Cell;
use std::rc::Rc;

use zerocopy::{FromBytes as _, IntoBytes as _};

use super::any_message::{AnyPorts, AnyPublisher, AnySubscriber};
use super::inbox::Inbox;
use super::publisher::PublisherOptions;
use super::{AnyMessage, Backend, Bus, BusError, ReceiveError, SendError, agreed, buffer, local};
use crate::cdr;
use crate::clock::StepStart;
use crate::schema;
use crate::stamp::{PlainHeader, Stamp};
use crate::topics::{TopicFacts, TopicId};
use crate::transport::raw::RawFormat;
use crate::transport::{TopicHolder, raw};

/// Header and elements of a message in memory.
type Sender = local::Sender<Vec<u8>, u8>;
type Receiver = local::Receiver<Vec<u8>, u8>;

/// Returns name and messages of a topic.
fn format(facts: &'static TopicFacts) -> RawFormat {
    RawFormat {
        name: facts.name,
        header: &facts.header,
        element: &facts.element,
    }
}

/// A topic that is declared while the program runs.
pub struct RawTopic {
    facts: &'static TopicFacts,
    schema: String,
}

impl RawTopic {
    pub(super) fn new(facts: &'static TopicFacts) -> Self {
        Self {
            facts,
            schema: schema::fingerprint(facts),
        }
    }

    fn sender(&self, bus: &Bus, options: PublisherOptions) -> Result<RawPublisher, BusError> {
        let agreed = agreed(self.facts.name, &self.schema);
        let port = match &bus.backend {
            Backend::Ipc { node, .. } => SendPort::Ipc(raw::Sender::open(
                node.node(),
                format(self.facts),
                &agreed,
                &options.sender(&bus.options),
            )?),
            Backend::Local(topics) => SendPort::Local(local::Sender::open(
                topics.channel(self.facts, &bus.options)?,
                bus.mute.borrow().clone(),
            )?),
        };
        let sequence = match &bus.backend {
            Backend::Ipc { .. } => Rc::default(),
            Backend::Local(topics) => topics.sequence(self.facts.name, options.source),
        };
        Ok(RawPublisher {
            facts: self.facts,
            port,
            options,
            sequence,
            turn: bus.turn.clone(),
            inbox: bus.inbox.borrow().clone(),
        })
    }
}

impl AnyPorts for RawTopic {
    fn create(&self, bus: &Bus) -> Result<TopicHolder, BusError> {
        let name = self.facts.name;
        match &bus.backend {
            Backend::Ipc { node, .. } => raw::create(
                node.node(),
                format(self.facts),
                &agreed(name, &self.schema),
                &bus.limits(self.facts),
            ),
            Backend::Local(topics) => {
                topics.channel::<Vec<u8>, u8>(self.facts, &bus.options)?;
                Ok(TopicHolder::new(name, ()))
            }
        }
    }

    fn subscriber(&self, bus: &Bus, ticks: usize) -> Result<Box<dyn AnySubscriber>, BusError> {
        let port = match &bus.backend {
            Backend::Ipc { node, .. } => ReceivePort::Ipc(raw::Receiver::open(
                node.node(),
                format(self.facts),
                &agreed(self.facts.name, &self.schema),
                buffer(&(self.facts.qos)(&bus.options.size), ticks),
            )?),
            Backend::Local(topics) => ReceivePort::Local(local::Receiver::open(
                topics.channel(self.facts, &bus.options)?,
                ticks,
            )?),
        };
        let topic = TopicId::intern(self.facts);
        Ok(Box::new(RawSubscriber { topic, port }))
    }

    fn repeater(&self, bus: &Bus, source: u32) -> Result<Box<dyn AnyPublisher>, BusError> {
        Ok(Box::new(
            self.sender(bus, PublisherOptions::growing(source))?,
        ))
    }
}

/// Sends messages of a topic that is declared while the program runs.
pub struct RawPublisher {
    facts: &'static TopicFacts,
    port: SendPort,
    options: PublisherOptions,
    sequence: Rc<Cell<u64>>,
    turn: StepStart,
    /// That of the process; its messages belong to the tick of the inbox.
    inbox: Option<Rc<Inbox>>,
}

enum SendPort {
    Ipc(raw::Sender),
    Local(Sender),
}

impl RawPublisher {
    /// Opens a topic for publishing; its messages have a [`PlainHeader`].
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn open(bus: &Bus, topic: TopicId, options: PublisherOptions) -> Result<Self, BusError> {
        RawTopic::new(topic.facts()).sender(bus, options)
    }

    /// Connects to new subscribers.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 cannot connect.
    pub fn update_connections(&self) -> Result<(), SendError> {
        match &self.port {
            SendPort::Ipc(port) => port.update_connections(),
            SendPort::Local(_) => Ok(()),
        }
    }

    /// Sends the bytes of elements, with the publisher's part of the stamp filled in.
    ///
    /// # Errors
    /// As [`Publisher::send`](super::Publisher::send).
    pub fn send(&self, stamp: Stamp, elements: &[u8]) -> Result<(), SendError> {
        let mut header = PlainHeader {
            stamp: Stamp {
                sequence: self.sequence.get(),
                source: self.options.source,
                reserved: 0,
                begun_ns: self.turn.get(),
                computed_ns: 0,
                sent_ns: 0,
                ..stamp
            },
        };
        if let Some(inbox) = &self.inbox {
            inbox.date(&mut header.stamp);
        }
        let count = elements.len() / self.facts.element.size.max(1);
        if count > self.options.capacity {
            return Err(SendError::Capacity {
                topic: self.facts.name,
                elements: count,
                capacity: self.options.capacity,
            });
        }
        self.put(header.as_bytes(), elements, count, true)
    }

    fn put(
        &self,
        header: &[u8],
        elements: &[u8],
        count: usize,
        timed: bool,
    ) -> Result<(), SendError> {
        match &self.port {
            SendPort::Ipc(port) => {
                port.send(header, elements, count, timed)?;
                self.sequence.set(self.sequence.get() + 1);
                Ok(())
            }
            SendPort::Local(port) => {
                let sent = port.send(&self.sequence, |message| {
                    message.fill(header.to_vec(), |own| own.extend_from_slice(elements));
                });
                sent.map(|_| ()).ok_or(SendError::Blocked {
                    topic: self.facts.name,
                    waited: core::time::Duration::ZERO,
                })
            }
        }
    }
}

impl AnyPublisher for RawPublisher {
    fn repeat(&mut self, bytes: &[u8]) -> Result<bool, SendError> {
        let Some((header, elements, count)) = cdr::split(self.facts, bytes) else {
            return Ok(false);
        };
        let mut header = header.to_vec();
        if matches!(self.port, SendPort::Local(_))
            && let Ok((stamp, _)) = Stamp::mut_from_prefix(&mut header)
        {
            stamp.renumber(self.sequence.get());
        }
        self.put(&header, elements, count, false)?;
        Ok(true)
    }

    fn update_connections(&self) -> Result<(), SendError> {
        Self::update_connections(self)
    }
}

crate::transport::debug_with! { [] RawPublisher, own => (own.facts.name, &own.options) }

struct RawSubscriber {
    topic: TopicId,
    port: ReceivePort,
}

enum ReceivePort {
    Ipc(raw::Receiver),
    Local(Receiver),
}

impl AnySubscriber for RawSubscriber {
    fn update_connections(&self) -> Result<(), ReceiveError> {
        match &self.port {
            ReceivePort::Ipc(port) => port.update_connections(),
            ReceivePort::Local(_) => Ok(()),
        }
    }

    fn drain(
        &self,
        most: usize,
        take: &mut dyn FnMut(&AnyMessage<'_>),
    ) -> Result<bool, ReceiveError> {
        let element_bytes = self.topic.facts().element.size.max(1);
        let mut give = |header: &[u8], elements: &[u8]| {
            // The stamp is first in every header.
            let Ok((stamp, _)) = Stamp::read_from_prefix(header) else {
                return;
            };
            take(&AnyMessage {
                topic: self.topic,
                stamp: &stamp,
                header,
                elements,
                count: elements.len() / element_bytes,
                shared: None,
            });
        };
        for _ in 0..most {
            let is_there = match &self.port {
                ReceivePort::Ipc(port) => port.receive(&mut give)?,
                ReceivePort::Local(port) => port
                    .receive()
                    .map(|message| give(&message.header, message.elements()))
                    .is_some(),
            };
            if !is_there {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
