//! Inputs of a process that steps in some ticks only, or whose messages come later or not at all.

use core::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::{Rc, Weak};

use super::ReceiveError;
use crate::stamp::Stamp;

/// Arrival of the messages at the inputs of one process, as a function of their topic and stamp.
pub trait Arrivals: core::fmt::Debug {
    /// Returns the tick from which on the process sees a message; `None` for a lost one.
    fn arrival(&self, topic: &str, stamp: &Stamp) -> Option<u64>;

    /// Returns `true` if the process cannot step before the first message of a topic.
    fn is_awaited(&self, topic: &str) -> bool;
}

/// The messages that a process has not seen yet, at all inputs that it opens in [`Bus::through`](super::Bus::through).
#[derive(Debug)]
pub struct Inbox {
    arrivals: Box<dyn Arrivals>,
    tick_period_ns: u64,
    tick: Cell<u64>,
    queues: RefCell<Vec<Weak<dyn Collect>>>,
}

impl Inbox {
    /// Creates the inbox of a process, for ticks of this length (ns).
    pub fn new(arrivals: Box<dyn Arrivals>, tick_period_ns: u64) -> Rc<Self> {
        Rc::new(Self {
            arrivals,
            tick_period_ns,
            tick: Cell::new(0),
            queues: RefCell::default(),
        })
    }

    /// Begins a tick: empties the buffers of all inputs. A process must call it in every tick, since senders wait for a
    /// full buffer. Returns `false` while the first message of an awaited topic has not arrived.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn begin(&self, tick: u64) -> Result<bool, ReceiveError> {
        self.tick.set(tick);
        let mut is_ready = true;
        for queue in self.queues.borrow().iter().filter_map(Weak::upgrade) {
            is_ready &= queue.collect()?;
        }
        Ok(is_ready)
    }

    /// Dates an output: it belongs to the tick in which it is sent, not to that of a late input.
    pub(super) fn date(&self, stamp: &mut Stamp) {
        stamp.tick = self.tick.get();
        stamp.time_ns = stamp.tick.saturating_mul(self.tick_period_ns);
    }
}

/// The messages of one topic on the bus, with their stamps.
pub trait Source<M> {
    /// Returns the next message, which may be kept.
    fn next(&self) -> Result<Option<(Stamp, M)>, ReceiveError>;

    /// Connects to new publishers.
    fn update_connections(&self) -> Result<(), ReceiveError>;
}

/// A queue of any topic.
trait Collect {
    /// Moves all messages of the bus into the queue. Returns `false` while the first one is awaited.
    fn collect(&self) -> Result<bool, ReceiveError>;
}

/// The messages at one input, by arrival, then by stamp.
pub struct Queue<M> {
    topic: &'static str,
    source: Box<dyn Source<M>>,
    inbox: Rc<Inbox>,
    waiting: RefCell<VecDeque<(u64, Stamp, M)>>,
    has_begun: Cell<bool>,
}

impl<M: 'static> Queue<M> {
    pub(super) fn open(
        topic: &'static str,
        source: Box<dyn Source<M>>,
        inbox: &Rc<Inbox>,
    ) -> Rc<Self> {
        let queue = Rc::new(Self {
            topic,
            source,
            inbox: Rc::clone(inbox),
            waiting: RefCell::default(),
            has_begun: Cell::new(false),
        });
        let weak: Weak<Self> = Rc::downgrade(&queue);
        inbox.queues.borrow_mut().push(weak);
        queue
    }

    pub(super) fn update_connections(&self) -> Result<(), ReceiveError> {
        self.source.update_connections()
    }

    /// Returns the next message that has arrived.
    pub(super) fn receive(&self) -> Result<Option<M>, ReceiveError> {
        self.collect()?;
        let next = self.begins().then(|| self.waiting.borrow_mut().pop_front());
        Ok(next.flatten().map(|(_, _, message)| message))
    }
}

impl<M> Queue<M> {
    /// Returns `true` if its first message has arrived.
    fn begins(&self) -> bool {
        let waiting = self.waiting.borrow();
        let first = waiting.front();
        first.is_some_and(|(arrival, _, _)| *arrival <= self.inbox.tick.get())
    }
}

impl<M> Collect for Queue<M> {
    fn collect(&self) -> Result<bool, ReceiveError> {
        let arrivals = &self.inbox.arrivals;
        while let Some((stamp, message)) = self.source.next()? {
            if let Some(arrival) = arrivals.arrival(self.topic, &stamp) {
                let order = |arrival: u64, stamp: &Stamp| {
                    (arrival, stamp.tick, stamp.source, stamp.sequence)
                };
                let own = order(arrival, &stamp);
                let mut waiting = self.waiting.borrow_mut();
                let place = waiting.partition_point(|(at, other, _)| order(*at, other) <= own);
                waiting.insert(place, (arrival, stamp, message));
            }
        }
        let has_begun = self.has_begun.get() || self.begins();
        self.has_begun.set(has_begun);
        Ok(has_begun || !arrivals.is_awaited(self.topic))
    }
}
