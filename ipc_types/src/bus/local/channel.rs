//! One topic: its publishers' histories and its subscribers' queues.

use core::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use super::Message;
use crate::bus::{BusError, BusOptions, buffer};
use crate::topics::{Qos, TopicFacts};

/// The unread messages of one subscriber, oldest first.
pub struct Queue<H, E> {
    pub(super) messages: RefCell<VecDeque<Rc<Message<H, E>>>>,
    capacity: usize,
}

/// Messages of one publisher that late joiners get, oldest first.
type History<H, E> = VecDeque<Rc<Message<H, E>>>;

/// A topic in memory.
pub(in crate::bus) struct Channel<H, E> {
    topic: &'static str,
    qos: Qos,
    overflow: bool,
    queues: RefCell<Vec<Rc<Queue<H, E>>>>,
    /// Per live publisher, its number and the messages for late joiners.
    histories: RefCell<Vec<(usize, History<H, E>)>>,
    /// Number of the next publisher.
    next: Cell<usize>,
}

impl<H, E> Channel<H, E> {
    pub(super) fn new(facts: &TopicFacts, options: &BusOptions) -> Self {
        Self {
            topic: facts.name,
            qos: (facts.qos)(&options.size),
            overflow: options.overflow,
            queues: RefCell::default(),
            histories: RefCell::default(),
            next: Cell::new(0),
        }
    }

    /// Adds a publisher; returns its number.
    pub(super) fn add_publisher(&self) -> Result<usize, BusError> {
        let mut histories = self.histories.borrow_mut();
        self.check_capacity("publisher", histories.len(), self.qos.publishers)?;
        let number = self.next.replace(self.next.get() + 1);
        histories.push((number, VecDeque::with_capacity(self.qos.history + 1)));
        Ok(number)
    }

    /// Removes a publisher; receivers keep its messages.
    pub(super) fn remove_publisher(&self, number: usize) {
        self.histories.borrow_mut().retain(|(n, _)| *n != number);
    }

    /// Creates a queue that holds `ticks` ticks of every publisher, with their histories in it.
    pub(super) fn add_subscriber(&self, ticks: usize) -> Result<Rc<Queue<H, E>>, BusError> {
        let mut queues = self.queues.borrow_mut();
        self.check_capacity("subscriber", queues.len(), self.qos.subscribers)?;
        let per_publisher = buffer(&self.qos, ticks);
        let histories = self.histories.borrow();
        let messages = histories.iter().flat_map(|(_, sent)| sent).cloned();
        let queue = Rc::new(Queue {
            messages: RefCell::new(messages.collect()),
            // iceoryx2 has a buffer per publisher; one for all of them keeps the order.
            capacity: per_publisher.saturating_mul(self.qos.publishers),
        });
        queues.push(Rc::clone(&queue));
        Ok(queue)
    }

    pub(super) fn remove_subscriber(&self, queue: &Rc<Queue<H, E>>) {
        self.queues
            .borrow_mut()
            .retain(|other| !Rc::ptr_eq(other, queue));
    }

    /// Returns `true` if a message has no receiver, now or later.
    pub(super) fn is_unheard(&self) -> bool {
        self.qos.history == 0 && self.queues.borrow().is_empty()
    }

    /// Delivers a message of a publisher to all subscribers; returns their number, `None` if one of
    /// them has no room for it (then none gets it).
    pub(super) fn deliver(&self, publisher: usize, message: &Rc<Message<H, E>>) -> Option<usize> {
        let queues = self.queues.borrow();
        let is_full = |queue: &Rc<Queue<H, E>>| queue.messages.borrow().len() >= queue.capacity;
        if !self.overflow && queues.iter().any(is_full) {
            return None;
        }
        for queue in queues.iter() {
            let mut messages = queue.messages.borrow_mut();
            if messages.len() >= queue.capacity {
                messages.pop_front();
            }
            messages.push_back(Rc::clone(message));
        }
        if self.qos.history > 0 {
            let mut histories = self.histories.borrow_mut();
            if let Some((_, sent)) = histories.iter_mut().find(|(n, _)| *n == publisher) {
                sent.push_back(Rc::clone(message));
                if sent.len() > self.qos.history {
                    sent.pop_front();
                }
            }
        }
        Some(queues.len())
    }

    fn check_capacity(
        &self,
        port: &'static str,
        taken: usize,
        capacity: usize,
    ) -> Result<(), BusError> {
        if taken < capacity {
            return Ok(());
        }
        Err(BusError::Port {
            topic: self.topic,
            port,
            reason: format!("all {capacity} are taken"),
        })
    }
}
