//! The sending side of a topic.

use core::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use super::{BusError, BusOptions, Inbox, LocalTopics, SendError, agreed, local};
use crate::clock::{StepStart, monotonic_ns};
use crate::schema;
use crate::stamp::Header;
use crate::topics::Topic;
use crate::transport::{Home, Sender, SenderOptions};

/// Size of elements (bytes) up to which copying them takes no longer than reading the clock: one reading
/// then serves for the time of the content and the time of sending.
const ONE_READING: usize = 1024;

/// Options of a publisher.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PublisherOptions {
    /// Index of the sending process for the stamps of messages.
    pub source: u32,
    /// Maximum number of elements of a message, ≥ 1; it determines the size of the shared memory.
    pub capacity: usize,
    /// Maximum time to wait for a receiver whose buffer is full.
    pub patience: Duration,
    /// `true` if the shared memory grows when a message has more elements than `capacity`.
    pub grows: bool,
}

impl PublisherOptions {
    /// A publisher of messages with up to `capacity` elements that waits up to 10 s.
    pub fn new(source: u32, capacity: usize) -> Self {
        Self {
            source,
            capacity,
            patience: Duration::from_secs(10),
            grows: false,
        }
    }

    /// Options of its sending end on a bus between processes.
    pub(super) fn sender(&self, bus: &BusOptions) -> SenderOptions {
        SenderOptions {
            capacity: self.capacity,
            grows: self.grows,
            overflow: bus.overflow,
            patience: self.patience,
        }
    }

    /// A publisher of repeated messages, whose numbers of elements are not known in advance.
    pub fn growing(source: u32) -> Self {
        Self {
            grows: true,
            ..Self::new(source, 1)
        }
    }
}

/// Sends messages of one topic.
pub struct Publisher<T: Topic> {
    port: Port<T>,
    options: PublisherOptions,
    sequence: Rc<Cell<u64>>,
    turn: StepStart,
    inbox: Option<Rc<Inbox>>,
}

/// A publisher of one of the buses.
enum Port<T: Topic> {
    Ipc(Box<dyn Sender<T::Header, T::Element>>),
    Local(local::Sender<T::Header, T::Element>),
}

impl<T: Topic> Publisher<T> {
    pub(super) fn open(
        node: &dyn Home,
        bus: &BusOptions,
        options: PublisherOptions,
        turn: StepStart,
    ) -> Result<Self, BusError> {
        let sender = options.sender(bus);
        let schema = schema::hash::<T>();
        let port = (T::ports().publisher)(node.node(), &agreed(T::NAME, &schema), sender)?;
        Ok(Self {
            port: Port::Ipc(port),
            options,
            sequence: Rc::default(),
            turn,
            inbox: None,
        })
    }

    pub(super) fn open_local(
        local_topics: &LocalTopics,
        bus: &BusOptions,
        options: PublisherOptions,
        mute: Option<Rc<Cell<bool>>>,
    ) -> Result<Self, BusError> {
        Ok(Self {
            port: Port::Local(local::Sender::open(
                local_topics.channel(T::FACTS, bus)?,
                mute,
            )?),
            options,
            sequence: local_topics.sequence(T::NAME, options.source),
            turn: StepStart::default(),
            inbox: None,
        })
    }

    /// Returns the publisher of a process with an inbox, whose messages belong to the tick of the inbox.
    pub(super) fn dated_by(self, inbox: Option<Rc<Inbox>>) -> Self {
        Self { inbox, ..self }
    }

    /// Maximum number of elements of a message.
    pub fn capacity(&self) -> usize {
        self.options.capacity
    }

    /// Connects to new subscribers and delivers the topic's history to them.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 cannot connect.
    pub fn update_connections(&self) -> Result<(), SendError> {
        match &self.port {
            Port::Ipc(port) => port.update_connections(),
            // Every local port is connected when it is opened.
            Port::Local(_) => Ok(()),
        }
    }

    /// Sends a message and copies its elements; returns the number of subscribers. The stamp's sequence,
    /// source and the clocks of step, writing and sending (0 on a bus in memory) are filled in.
    ///
    /// # Errors
    /// [`SendError::Capacity`] if it has too many elements, [`SendError::Blocked`] if a receiver
    /// did not make room within the publisher's patience (on a bus in memory: had no room),
    /// [`SendError::Transport`] otherwise.
    pub fn send(&self, header: T::Header, elements: &[T::Element]) -> Result<usize, SendError> {
        let mut header = self.stamped(header, elements.len())?;
        match &self.port {
            Port::Ipc(port) => {
                if size_of_val(elements) > ONE_READING {
                    header.stamp_mut().computed_ns = monotonic_ns();
                }
                self.counted(port.send(header, elements.len(), true, &mut |memory| {
                    memory.copy_from_slice(elements);
                }))
            }
            Port::Local(port) => Self::sent(port.send(&self.sequence, |message| {
                message.fill(header, |own| own.extend_from_slice(elements));
            })),
        }
    }

    /// Sends a message whose elements are created in place, in the memory of the message.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn send_with(
        &self,
        header: T::Header,
        count: usize,
        mut element: impl FnMut(usize) -> T::Element,
    ) -> Result<usize, SendError> {
        let mut header = self.stamped(header, count)?;
        match &self.port {
            Port::Ipc(port) => {
                header.stamp_mut().computed_ns = monotonic_ns();
                self.counted(port.send(header, count, true, &mut |memory| {
                    for (i, place) in memory.iter_mut().enumerate() {
                        *place = element(i);
                    }
                }))
            }
            Port::Local(port) => Self::sent(port.send(&self.sequence, |message| {
                message.fill(header, |own| own.extend((0..count).map(element)));
            })),
        }
    }

    /// Sends a message whose elements are modified in place: `write` gets the memory with its content
    /// (zeros, or an earlier message of this publisher) and may write any part of it. The rest costs
    /// nothing, however large the message is.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn send_in_place(
        &self,
        header: T::Header,
        count: usize,
        write: impl FnOnce(&mut [T::Element]),
    ) -> Result<usize, SendError> {
        let mut header = self.stamped(header, count)?;
        match &self.port {
            Port::Ipc(port) => {
                header.stamp_mut().computed_ns = monotonic_ns();
                let mut write = Some(write);
                self.counted(port.send(header, count, true, &mut |memory| {
                    if let Some(write) = write.take() {
                        write(memory);
                    }
                }))
            }
            Port::Local(port) => Self::sent(port.send(&self.sequence, |message| {
                message.fill(header, |own| {
                    own.resize(count, T::Element::default());
                    write(own);
                });
            })),
        }
    }

    /// Sends a message whose elements are shared with receivers in the same process; for other processes
    /// they are copied.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn send_shared(
        &self,
        header: T::Header,
        elements: &Arc<[T::Element]>,
    ) -> Result<usize, SendError> {
        match &self.port {
            Port::Ipc(_) => self.send(header, elements),
            Port::Local(port) => {
                let header = self.stamped(header, elements.len())?;
                Self::sent(port.send(&self.sequence, |message| message.share(header, elements)))
            }
        }
    }

    /// Sends a message again, as [`Publisher::send`] does, but keeps its stamp. On a bus in memory, whose publishers count
    /// together and without clocks, it gets the next number and no times.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn repeat(
        &self,
        mut header: T::Header,
        elements: &[T::Element],
    ) -> Result<usize, SendError> {
        self.check(elements.len())?;
        match &self.port {
            Port::Ipc(port) => {
                self.counted(port.send(header, elements.len(), false, &mut |memory| {
                    memory.copy_from_slice(elements);
                }))
            }
            Port::Local(port) => {
                header.stamp_mut().renumber(self.sequence.get());
                Self::sent(port.send(&self.sequence, |message| {
                    message.fill(header, |own| own.extend_from_slice(elements));
                }))
            }
        }
    }

    /// Checks that the message fits.
    fn check(&self, count: usize) -> Result<(), SendError> {
        if count > self.options.capacity && !self.options.grows {
            return Err(SendError::Capacity {
                topic: T::NAME,
                elements: count,
                capacity: self.options.capacity,
            });
        }
        Ok(())
    }

    /// Returns the header with the publisher's part of the stamp, except for the clocks of writing and
    /// sending, which are 0; checks that the message fits.
    fn stamped(&self, mut header: T::Header, count: usize) -> Result<T::Header, SendError> {
        self.check(count)?;
        let stamp = header.stamp_mut();
        stamp.sequence = self.sequence.get();
        stamp.source = self.options.source;
        stamp.reserved = 0;
        if let Some(inbox) = &self.inbox {
            inbox.date(stamp);
        }
        stamp.begun_ns = self.turn.get();
        (stamp.computed_ns, stamp.sent_ns) = (0, 0);
        Ok(header)
    }

    /// Counts a sent message; returns the number of subscribers.
    fn counted(&self, sent: Result<usize, SendError>) -> Result<usize, SendError> {
        if sent.is_ok() {
            self.sequence.set(self.sequence.get() + 1);
        }
        sent
    }

    /// Returns the number of subscribers on a bus in memory; `None` means that one had no room.
    fn sent(delivered: Option<usize>) -> Result<usize, SendError> {
        delivered.ok_or(SendError::Blocked {
            topic: T::NAME,
            waited: Duration::ZERO,
        })
    }
}

crate::transport::debug_with! { [T: Topic] Publisher<T>, own => (T::NAME, &own.options, &own.sequence) }
