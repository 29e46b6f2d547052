//! Messages and ports of any topic, without its types.

use core::any::Any;
use std::sync::Arc;

use zerocopy::IntoBytes as _;

use super::{Bus, BusError, ReceiveError, SendError};
use crate::cdr::{self, SequenceHead};
use crate::message::Message;
use crate::stamp::{Header as _, Stamp};
use crate::topics::{Topic, TopicId};
use crate::transport::TopicHolder;

/// Operations of a topic.
pub trait AnyPorts: Sync {
    /// As [`Bus::create`].
    fn create(&self, bus: &Bus) -> Result<TopicHolder, BusError>;
    /// Opens it for reading with a buffer for this many ticks.
    fn subscriber(&self, bus: &Bus, ticks: usize) -> Result<Box<dyn AnySubscriber>, BusError>;
    /// Opens it for repeating the messages of a process.
    fn repeater(&self, bus: &Bus, source: u32) -> Result<Box<dyn AnyPublisher>, BusError>;
}

/// A message of any topic, as bytes.
#[derive(Clone, Copy)]
pub struct AnyMessage<'a> {
    /// The topic.
    pub topic: TopicId,
    /// The stamp.
    pub stamp: &'a Stamp,
    /// The user header.
    pub header: &'a [u8],
    /// The elements.
    pub elements: &'a [u8],
    /// Number of elements.
    pub count: usize,
    /// The elements that a sender in the same process shares.
    pub shared: Option<&'a dyn SharedElements>,
}

impl<'a> AnyMessage<'a> {
    /// A message of a topic.
    pub fn new<T: Topic>(header: &'a T::Header, elements: &'a [T::Element]) -> Self {
        Self {
            topic: T::id(),
            stamp: header.stamp(),
            header: header.as_bytes(),
            elements: elements.as_bytes(),
            count: elements.len(),
            shared: None,
        }
    }

    /// The bytes between header and elements in the CDR form.
    pub fn head(&self) -> SequenceHead {
        SequenceHead::for_topic(self.topic.facts(), self.count)
    }

    /// Appends its CDR form.
    pub fn encode(&self, out: &mut Vec<u8>) {
        cdr::encode_bytes(self.header, &self.head(), self.elements, out);
    }
}

crate::transport::debug_with! { [] AnyMessage<'_>, own => (own.topic.name(), own.stamp, own.count) }

/// Elements that several messages share.
pub trait SharedElements {
    /// Address of the elements: equal for the same elements while they exist.
    fn address(&self) -> usize;
    /// Keeps the elements in existence.
    fn keep(&self) -> Box<dyn Any + Send + Sync>;
}

impl<E: Message> SharedElements for Arc<[E]> {
    fn address(&self) -> usize {
        Self::as_ptr(self).cast::<()>() as usize
    }

    fn keep(&self) -> Box<dyn Any + Send + Sync> {
        Box::new(Self::clone(self))
    }
}

/// A subscriber of any topic.
pub trait AnySubscriber {
    /// As [`Subscriber::update_connections`](super::Subscriber::update_connections).
    ///
    /// # Errors
    /// As [`Subscriber::update_connections`](super::Subscriber::update_connections).
    fn update_connections(&self) -> Result<(), ReceiveError>;

    /// Takes at most `most` unread messages; returns `false` if there may be more.
    ///
    /// # Errors
    /// As [`Subscriber::receive`](super::Subscriber::receive).
    fn drain(
        &self,
        most: usize,
        take: &mut dyn FnMut(&AnyMessage<'_>),
    ) -> Result<bool, ReceiveError>;
}

/// A publisher of any topic.
pub trait AnyPublisher {
    /// Sends a message again, byte for byte, from its CDR form. Returns `false` if it is not a message of the topic.
    ///
    /// # Errors
    /// As [`Publisher::repeat`](super::Publisher::repeat).
    fn repeat(&mut self, cdr: &[u8]) -> Result<bool, SendError>;

    /// As [`Publisher::update_connections`](super::Publisher::update_connections).
    ///
    /// # Errors
    /// As [`Publisher::update_connections`](super::Publisher::update_connections).
    fn update_connections(&self) -> Result<(), SendError>;
}
