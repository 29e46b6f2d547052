//! Inputs of a process that steps in some ticks only, or whose messages come later or not at all.

use core::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::{Rc, Weak};

use super::{ReceiveError, Received, Subscriber};
use crate::stamp::{Header as _, Stamp};
use crate::topics::Topic;

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

/// A queue of any topic.
trait Collect {
    /// Moves all messages of the bus into the queue. Returns `false` while the first one is awaited.
    fn collect(&self) -> Result<bool, ReceiveError>;
}

/// The messages at one input, by arrival, then by stamp.
pub(super) struct Queue<T: Topic> {
    from: Subscriber<T>,
    inbox: Rc<Inbox>,
    waiting: RefCell<VecDeque<(u64, Received<T>)>>,
    has_begun: Cell<bool>,
}

impl<T: Topic> Queue<T> {
    pub(super) fn open(from: Subscriber<T>, inbox: &Rc<Inbox>) -> Rc<Self> {
        let queue = Rc::new(Self {
            from,
            inbox: Rc::clone(inbox),
            waiting: RefCell::default(),
            has_begun: Cell::new(false),
        });
        let weak: Weak<Self> = Rc::downgrade(&queue);
        inbox.queues.borrow_mut().push(weak);
        queue
    }

    pub(super) fn update_connections(&self) -> Result<(), ReceiveError> {
        self.from.update_connections()
    }

    /// Returns the next message that has arrived.
    pub(super) fn receive(&self) -> Result<Option<Received<T>>, ReceiveError> {
        self.collect()?;
        let mut waiting = self.waiting.borrow_mut();
        let is_here = waiting.front().is_some_and(|next| self.is_here(next));
        Ok(is_here
            .then(|| waiting.pop_front())
            .flatten()
            .map(|next| next.1))
    }

    fn is_here(&self, (arrival, _): &(u64, Received<T>)) -> bool {
        *arrival <= self.inbox.tick.get()
    }
}

impl<T: Topic> Collect for Queue<T> {
    fn collect(&self) -> Result<bool, ReceiveError> {
        let arrivals = &self.inbox.arrivals;
        let mut waiting = self.waiting.borrow_mut();
        while let Some(message) = self.from.receive()? {
            let Some(arrival) = arrivals.arrival(T::NAME, message.header().stamp()) else {
                continue;
            };
            let order = |arrival: u64, message: &Received<T>| {
                let stamp = message.header().stamp();
                (arrival, stamp.tick, stamp.source, stamp.sequence)
            };
            let own = order(arrival, &message);
            let place = waiting.partition_point(|(at, other)| order(*at, other) <= own);
            waiting.insert(place, (arrival, message.kept()));
        }
        let begins = waiting.front().is_some_and(|next| self.is_here(next));
        let has_begun = self.has_begun.get() || begins;
        self.has_begun.set(has_begun);
        Ok(has_begun || !arrivals.is_awaited(T::NAME))
    }
}
