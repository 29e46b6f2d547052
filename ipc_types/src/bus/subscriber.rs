//! The receiving side of a topic.

use std::rc::Rc;
use std::sync::Arc;

use super::inbox::{Inbox, Queue, Source};
use super::{BusError, BusOptions, LocalTopics, ReceiveError, agreed, buffer, local};
use crate::schema;
use crate::stamp::{Header as _, Stamp};
use crate::topics::Topic;
use crate::transport::{Home, Loan, Receiver};

/// Receives messages of one topic, oldest first per publisher.
pub struct Subscriber<T: Topic> {
    port: Port<T>,
}

/// A subscriber of one of the buses.
enum Port<T: Topic> {
    Ipc(Box<dyn Receiver<T::Header, T::Element>>),
    Local(local::Receiver<T::Header, T::Element>),
    /// That of a process with an inbox.
    Inbox(Rc<Queue<ReceivedMessage<T>>>),
}

impl<T: Topic> Subscriber<T> {
    pub(super) fn open(
        node: &dyn Home,
        options: &BusOptions,
        ticks: usize,
    ) -> Result<Self, BusError> {
        let buffer = buffer(&(T::FACTS.qos)(&options.size), ticks);
        let schema = schema::hash::<T>();
        let port = (T::ports().subscriber)(node.node(), &agreed(T::NAME, &schema), buffer)?;
        Ok(Self {
            port: Port::Ipc(port),
        })
    }

    pub(super) fn open_local(
        local_topics: &LocalTopics,
        options: &BusOptions,
        ticks: usize,
    ) -> Result<Self, BusError> {
        let receiver = local::Receiver::open(local_topics.channel(T::FACTS, options)?, ticks)?;
        Ok(Self {
            port: Port::Local(receiver),
        })
    }

    /// Returns the subscriber of a process with an inbox.
    pub(super) fn through(self, inbox: &Rc<Inbox>) -> Self {
        Self {
            port: Port::Inbox(Queue::open(T::NAME, Box::new(self), inbox)),
        }
    }

    /// Returns `true` if the newest message may be older than that of the tick.
    pub fn may_be_late(&self) -> bool {
        matches!(self.port, Port::Inbox(_))
    }

    /// Connects to new publishers.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 cannot connect.
    pub fn update_connections(&self) -> Result<(), ReceiveError> {
        match &self.port {
            Port::Ipc(port) => port.update_connections(),
            Port::Local(_) => Ok(()),
            Port::Inbox(queue) => queue.update_connections(),
        }
    }

    /// The next unread message, if any; its bytes are not copied (in shared memory they are mapped
    /// read-only).
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn receive(&self) -> Result<Option<ReceivedMessage<T>>, ReceiveError> {
        let held = match &self.port {
            Port::Ipc(port) => port.receive()?.map(BusMessage::Ipc),
            Port::Local(port) => port.receive().map(BusMessage::Local),
            Port::Inbox(queue) => return queue.receive(),
        };
        Ok(held.map(|held| ReceivedMessage { held }))
    }
}

impl<T: Topic> Source<ReceivedMessage<T>> for Subscriber<T> {
    fn next(&self) -> Result<Option<(Stamp, ReceivedMessage<T>)>, ReceiveError> {
        let next = self.receive()?;
        Ok(next.map(|message| (*message.header().stamp(), message.kept())))
    }

    fn update_connections(&self) -> Result<(), ReceiveError> {
        Self::update_connections(self)
    }
}

crate::transport::debug_with! { [T: Topic] Subscriber<T>, _ => T::NAME }

/// A message in the memory where it was written, freed on drop. Hold at most two per subscriber.
pub struct ReceivedMessage<T: Topic> {
    held: BusMessage<T>,
}

/// A message of one of the buses.
enum BusMessage<T: Topic> {
    Ipc(Loan<T::Header, T::Element>),
    Local(Rc<local::Message<T::Header, T::Element>>),
}

impl<T: Topic> ReceivedMessage<T> {
    /// The user header.
    pub fn header(&self) -> &T::Header {
        match &self.held {
            BusMessage::Ipc(loan) => loan.header(),
            BusMessage::Local(message) => &message.header,
        }
    }

    /// The elements.
    pub fn elements(&self) -> &[T::Element] {
        match &self.held {
            BusMessage::Ipc(loan) => loan.elements(),
            BusMessage::Local(message) => message.elements(),
        }
    }

    /// The same message in the memory of the receiver, which may keep any number of them.
    fn kept(self) -> Self {
        let BusMessage::Ipc(loan) = self.held else {
            return self;
        };
        let mut own = local::Message::default();
        own.fill(*loan.header(), |own| {
            own.extend_from_slice(loan.elements());
        });
        let held = BusMessage::Local(Rc::new(own));
        Self { held }
    }

    /// The elements that a sender in the same process shares; `None` if they belong to the message.
    pub fn shared(&self) -> Option<&Arc<[T::Element]>> {
        match &self.held {
            BusMessage::Ipc(_) => None,
            BusMessage::Local(message) => message.shared(),
        }
    }

    /// The elements for the receiver to keep: a copy, unless a sender in the same process shares
    /// them ([`Publisher::send_shared`](super::Publisher::send_shared)).
    pub fn shared_elements(&self) -> Arc<[T::Element]> {
        match &self.held {
            BusMessage::Ipc(loan) => Arc::from(loan.elements()),
            BusMessage::Local(message) => message.shared_elements(),
        }
    }
}

crate::transport::debug_with! { [T: Topic] ReceivedMessage<T>, own => (T::NAME, own.header(), own.elements().len()) }
