//! Both ends of a topic in memory.

use core::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use super::Message;
use super::channel::{Channel, Queue};
use crate::bus::{BusError, LOOP_TICKS};

/// The sending end.
pub(in crate::bus) struct Sender<H, E> {
    channel: Rc<Channel<H, E>>,
    number: usize,
    /// Set while its messages reach no subscriber.
    mute: Option<Rc<Cell<bool>>>,
    /// Messages sent before, the oldest first; the memory of an unreferenced one is reused.
    sent: RefCell<VecDeque<Rc<Message<H, E>>>>,
}

impl<H: Default, E: Copy> Sender<H, E> {
    pub(in crate::bus) fn open(
        channel: Rc<Channel<H, E>>,
        mute: Option<Rc<Cell<bool>>>,
    ) -> Result<Self, BusError> {
        let number = channel.add_publisher()?;
        Ok(Self {
            channel,
            number,
            mute,
            sent: RefCell::new(VecDeque::with_capacity(LOOP_TICKS)),
        })
    }

    /// Sends the message that `write` fills, and counts it in `sequence` unless it is mute; returns the number of
    /// receivers, `None` if one of them had no room.
    pub(in crate::bus) fn send(
        &self,
        sequence: &Cell<u64>,
        write: impl FnOnce(&mut Message<H, E>),
    ) -> Option<usize> {
        let is_mute = self.mute.as_ref().is_some_and(|mute| mute.get());
        if !is_mute && self.channel.is_unheard() {
            sequence.set(sequence.get() + 1);
            return Some(0);
        }
        let mut sent = self.sent.borrow_mut();
        let free = sent.iter().position(|old| Rc::strong_count(old) == 1);
        let mut message = free.and_then(|at| sent.remove(at)).unwrap_or_default();
        if let Some(unshared) = Rc::get_mut(&mut message) {
            write(unshared);
        }
        let delivered = if is_mute {
            Some(0)
        } else {
            self.channel.deliver(self.number, &message)
        };
        sent.push_back(message);
        if delivered.is_some() && !is_mute {
            sequence.set(sequence.get() + 1);
        }
        delivered
    }
}

impl<H, E> Drop for Sender<H, E> {
    fn drop(&mut self) {
        self.channel.remove_publisher(self.number);
    }
}

/// The receiving end.
pub(in crate::bus) struct Receiver<H, E> {
    channel: Rc<Channel<H, E>>,
    queue: Rc<Queue<H, E>>,
}

impl<H, E> Receiver<H, E> {
    pub(in crate::bus) fn open(channel: Rc<Channel<H, E>>, ticks: usize) -> Result<Self, BusError> {
        let queue = channel.add_subscriber(ticks)?;
        Ok(Self { channel, queue })
    }

    pub(in crate::bus) fn receive(&self) -> Option<Rc<Message<H, E>>> {
        self.queue.messages.borrow_mut().pop_front()
    }
}

impl<H, E> Drop for Receiver<H, E> {
    fn drop(&mut self) {
        self.channel.remove_subscriber(&self.queue);
    }
}
