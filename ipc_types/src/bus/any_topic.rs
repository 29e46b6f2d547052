//! Topics without their types, for the parts of a run that handle all topics alike: recorder, replay, resources.

use core::marker::PhantomData;
use std::sync::{PoisonError, RwLock};

use super::any_message::{AnyMessage, AnyPorts, AnyPublisher, AnySubscriber, SharedElements};
use super::any_queue::AnyQueue;
use super::raw::RawTopic;
use super::{
    Bus, BusError, LOOP_TICKS, Publisher, PublisherOptions, ReceiveError, SendError, Subscriber,
};
use crate::cdr;
use crate::topics::{Topic, TopicFacts, TopicId, TopicVisitor, for_each_topic};
use crate::transport::TopicHolder;

/// Operations of the topics that are not built in.
static OTHERS: RwLock<Vec<AnyTopic>> = RwLock::new(Vec::new());

/// A topic with its operations.
#[derive(Clone, Copy)]
pub struct AnyTopic {
    /// The topic.
    pub id: TopicId,
    ports: &'static dyn AnyPorts,
}

/// A topic with its types.
struct TypedTopic<T>(PhantomData<fn(T)>);

impl<T: Topic> AnyPorts for TypedTopic<T> {
    fn create(&self, bus: &Bus) -> Result<TopicHolder, BusError> {
        bus.create::<T>()
    }

    fn subscriber(&self, bus: &Bus, ticks: usize) -> Result<Box<dyn AnySubscriber>, BusError> {
        Ok(Box::new(bus.subscribe::<T>(ticks)?))
    }

    fn repeater(&self, bus: &Bus, source: u32) -> Result<Box<dyn AnyPublisher>, BusError> {
        Ok(Box::new(Repeater::<T> {
            port: bus.publisher(PublisherOptions::growing(source))?,
            elements: Vec::new(),
        }))
    }
}

impl AnyTopic {
    fn for_topic<T: Topic>() -> Self {
        Self {
            id: T::id(),
            ports: &TypedTopic::<T>(PhantomData),
        }
    }

    /// Registers a topic that is not built in.
    pub fn register<T: Topic>() {
        if !T::id().is_built_in() {
            Self::for_topic::<T>().add();
        }
    }

    /// Registers a topic that a program declares while it runs.
    pub(crate) fn register_raw(facts: &'static TopicFacts, id: TopicId) {
        let ports = Box::leak(Box::new(RawTopic::new(facts)));
        Self { id, ports }.add();
    }

    fn add(self) {
        let is_known = |others: &[Self]| others.iter().any(|other| other.id == self.id);
        if is_known(&OTHERS.read().unwrap_or_else(PoisonError::into_inner)) {
            return;
        }
        let mut others = OTHERS.write().unwrap_or_else(PoisonError::into_inner);
        if !is_known(&others) {
            others.push(self);
        }
    }

    /// Returns the operations of a registered topic.
    pub fn find(id: TopicId) -> Option<Self> {
        Self::all().into_iter().find(|topic| topic.id == id)
    }

    /// Returns all registered topics: the built-in ones, then the others.
    pub fn all() -> Vec<Self> {
        struct Collect(Vec<AnyTopic>);
        impl TopicVisitor for Collect {
            type Error = core::convert::Infallible;
            fn visit<T: Topic>(&mut self) -> Result<(), Self::Error> {
                self.0.push(AnyTopic::for_topic::<T>());
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
        self.ports.create(bus)
    }

    /// Opens it for reading with the buffer of the recorder; see [`Bus::recorder`].
    ///
    /// # Errors
    /// As [`Bus::recorder`].
    pub fn recorder(&self, bus: &Bus) -> Result<Box<dyn AnySubscriber>, BusError> {
        self.ports.subscriber(bus, bus.options().recorder_ticks)
    }

    /// Opens it for reading with the buffer of a process in the loop; see [`Bus::subscriber`].
    ///
    /// # Errors
    /// As [`Bus::subscriber`].
    pub fn subscriber(&self, bus: &Bus) -> Result<Box<dyn AnySubscriber>, BusError> {
        let subscriber = self.ports.subscriber(bus, LOOP_TICKS)?;
        Ok(match &*bus.inbox.borrow() {
            Some(inbox) => Box::new(AnyQueue::open(self.id, subscriber, inbox)),
            None => subscriber,
        })
    }

    /// Opens it for repeating the logged messages of a process.
    ///
    /// # Errors
    /// As [`Bus::publisher`].
    pub fn repeater(&self, bus: &Bus, source: u32) -> Result<Box<dyn AnyPublisher>, BusError> {
        self.ports.repeater(bus, source)
    }
}

crate::transport::debug_with! { [] AnyTopic, own => own.id.name() }

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
