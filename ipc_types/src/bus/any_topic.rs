//! Topics without their types, for the parts of a run that handle all topics alike: recorder, replay, resources.

use core::any::Any;
use std::sync::{Arc, PoisonError, RwLock};

use zerocopy::IntoBytes as _;

use super::{Bus, BusError, Publisher, PublisherOptions, ReceiveError, SendError, Subscriber};
use crate::cdr::{self, SequenceHead};
use crate::message::Message;
use crate::stamp::{Header as _, Stamp};
use crate::topics::{Topic, TopicId, TopicVisitor, for_each_topic};
use crate::transport::TopicHolder;

/// Operations of the topics that are not built in.
static OTHERS: RwLock<Vec<AnyTopic>> = RwLock::new(Vec::new());

/// A topic with its operations.
#[derive(Debug, Clone, Copy)]
pub struct AnyTopic {
    /// The topic.
    pub id: TopicId,
    create: fn(&Bus) -> Result<TopicHolder, BusError>,
    recorder: OpenSubscriber,
    repeater: OpenPublisher,
}

type OpenSubscriber = fn(&Bus) -> Result<Box<dyn AnySubscriber>, BusError>;
type OpenPublisher = fn(&Bus, u32) -> Result<Box<dyn AnyPublisher>, BusError>;

impl AnyTopic {
    fn of<T: Topic>() -> Self {
        Self {
            id: T::id(),
            create: |bus| bus.create::<T>(),
            recorder: |bus| Ok(Box::new(bus.recorder::<T>()?)),
            repeater: |bus, source| {
                Ok(Box::new(Repeater::<T> {
                    port: bus.publisher(PublisherOptions::growing(source))?,
                    elements: Vec::new(),
                }))
            },
        }
    }

    /// Registers a topic that is not built in.
    pub fn register<T: Topic>() {
        let id = T::id();
        if id.is_built_in() {
            return;
        }
        let is_known = |others: &[Self]| others.iter().any(|other| other.id == id);
        if is_known(&OTHERS.read().unwrap_or_else(PoisonError::into_inner)) {
            return;
        }
        let mut others = OTHERS.write().unwrap_or_else(PoisonError::into_inner);
        if !is_known(&others) {
            others.push(Self::of::<T>());
        }
    }

    /// Returns all registered topics: the built-in ones, then the others.
    pub fn all() -> Vec<Self> {
        struct Collect(Vec<AnyTopic>);
        impl TopicVisitor for Collect {
            type Error = core::convert::Infallible;
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
                self.0.push(AnyTopic::of::<T>());
                Ok(())
            }
        }
        let mut all = Collect(Vec::new());
        let Ok(()) = for_each_topic(&mut all);
        all.0
            .extend(OTHERS.read().unwrap_or_else(PoisonError::into_inner).iter());
        all.0
    }

    /// Creates its service; see [`Bus::create`].
    ///
    /// # Errors
    /// As [`Bus::create`].
    pub fn create(&self, bus: &Bus) -> Result<TopicHolder, BusError> {
        (self.create)(bus)
    }

    /// Opens it for reading with the buffer of the recorder; see [`Bus::recorder`].
    ///
    /// # Errors
    /// As [`Bus::recorder`].
    pub fn recorder(&self, bus: &Bus) -> Result<Box<dyn AnySubscriber>, BusError> {
        (self.recorder)(bus)
    }

    /// Opens it for repeating the logged messages of a process.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn repeater(&self, bus: &Bus, source: u32) -> Result<Box<dyn AnyPublisher>, BusError> {
        (self.repeater)(bus, source)
    }
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
        SequenceHead::of(self.topic.facts(), self.count)
    }

    /// Appends its CDR form.
    pub fn encode(&self, out: &mut Vec<u8>) {
        cdr::encode_bytes(self.header, &self.head(), self.elements, out);
    }
}

impl core::fmt::Debug for AnyMessage<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("AnyMessage")
            .field("topic", &self.topic.name())
            .field("stamp", self.stamp)
            .field("elements", &self.count)
            .finish_non_exhaustive()
    }
}

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
    /// As [`Subscriber::update_connections`].
    ///
    /// # Errors
    /// As [`Subscriber::update_connections`].
    fn update_connections(&self) -> Result<(), ReceiveError>;

    /// Takes at most `most` unread messages; returns `false` if there may be more.
    ///
    /// # Errors
    /// As [`Subscriber::receive`].
    fn drain(
        &self,
        most: usize,
        take: &mut dyn FnMut(&AnyMessage<'_>),
    ) -> Result<bool, ReceiveError>;
}

impl<T: Topic> AnySubscriber for Subscriber<T> {
    fn update_connections(&self) -> Result<(), ReceiveError> {
        Self::update_connections(self)
    }

    fn drain(
        &self,
        most: usize,
        take: &mut dyn FnMut(&AnyMessage<'_>),
    ) -> Result<bool, ReceiveError> {
        for _ in 0..most {
            let Some(message) = self.receive()? else {
                return Ok(true);
            };
            let shared = message.shared().map(|shared| shared as &dyn SharedElements);
            take(&AnyMessage {
                shared,
                ..AnyMessage::new::<T>(message.header(), message.elements())
            });
        }
        Ok(false)
    }
}

/// A publisher of any topic.
pub trait AnyPublisher {
    /// Sends a message again, byte for byte, from its CDR form. Returns `false` if it is not a message of the topic.
    ///
    /// # Errors
    /// As [`Publisher::repeat`].
    fn repeat(&mut self, cdr: &[u8]) -> Result<bool, SendError>;

    /// As [`Publisher::update_connections`].
    ///
    /// # Errors
    /// As [`Publisher::update_connections`].
    fn update_connections(&self) -> Result<(), SendError>;
}

struct Repeater<T: Topic> {
    port: Publisher<T>,
    elements: Vec<T::Element>,
}

impl<T: Topic> AnyPublisher for Repeater<T> {
    fn repeat(&mut self, cdr: &[u8]) -> Result<bool, SendError> {
        let Ok(header) = cdr::decode_into::<T>(cdr, &mut self.elements) else {
            return Ok(false);
        };
        self.port.repeat(header, &self.elements)?;
        Ok(true)
    }

    fn update_connections(&self) -> Result<(), SendError> {
        self.port.update_connections()
    }
}
