//! The inputs of a process with an inbox, for topics without their types.

use std::rc::Rc;

use super::ReceiveError;
use super::any_message::{AnyMessage, AnySubscriber};
use super::inbox::{Inbox, Queue, Source};
use crate::stamp::Stamp;
use crate::topics::TopicId;

/// A message as bytes.
struct OwnedMessage {
    stamp: Stamp,
    header: Vec<u8>,
    elements: Vec<u8>,
    count: usize,
}

/// A subscriber as the source of a queue.
struct Port(Box<dyn AnySubscriber>);

impl Source<OwnedMessage> for Port {
    fn next(&self) -> Result<Option<(Stamp, OwnedMessage)>, ReceiveError> {
        let mut next = None;
        self.0.drain(1, &mut |message| {
            let owned = OwnedMessage {
                stamp: *message.stamp,
                header: message.header.to_vec(),
                elements: message.elements.to_vec(),
                count: message.count,
            };
            next = Some((owned.stamp, owned));
        })?;
        Ok(next)
    }

    fn update_connections(&self) -> Result<(), ReceiveError> {
        self.0.update_connections()
    }
}

/// A subscriber whose messages arrive as the inbox of its process says.
pub struct AnyQueue {
    topic: TopicId,
    queue: Rc<Queue<OwnedMessage>>,
}

impl AnyQueue {
    pub(super) fn open(
        topic: TopicId,
        subscriber: Box<dyn AnySubscriber>,
        inbox: &Rc<Inbox>,
    ) -> Self {
        let queue = Queue::open(topic.name(), Box::new(Port(subscriber)), inbox);
        Self { topic, queue }
    }
}

impl AnySubscriber for AnyQueue {
    fn update_connections(&self) -> Result<(), ReceiveError> {
        self.queue.update_connections()
    }

    fn drain(
        &self,
        most: usize,
        take: &mut dyn FnMut(&AnyMessage<'_>),
    ) -> Result<bool, ReceiveError> {
        for _ in 0..most {
            let Some(message) = self.queue.receive()? else {
                return Ok(true);
            };
            take(&AnyMessage {
                topic: self.topic,
                stamp: &message.stamp,
                header: &message.header,
                elements: &message.elements,
                count: message.count,
                shared: None,
            });
        }
        Ok(false)
    }
}
