//! The receiving end of a topic.

use core::mem::ManuallyDrop;

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::{Node, ipc};

use super::degradation::Failures;
use super::service::{self, TopicIdentity};
use crate::error::{BusError, ReceiveError};
use crate::message::Message;
use crate::stamp::Header;

/// A receiving end.
pub trait Receiver<H: Header, E: Message> {
    /// Connects to new senders.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    fn update_connections(&self) -> Result<(), ReceiveError>;

    /// The next unread message, if any.
    ///
    /// # Errors
    /// [`ReceiveError`] if iceoryx2 fails.
    fn receive(&self) -> Result<Option<Loan<H, E>>, ReceiveError>;
}

type Sample<H, E> = iceoryx2::sample::Sample<ipc::Service, [E], H>;

/// A message in the memory where it was written (mapped read-only), freed on drop.
pub struct Loan<H: Header, E: Message> {
    sample: ManuallyDrop<Sample<H, E>>,
    /// Function of this crate that frees it.
    release: fn(Sample<H, E>),
}

impl<H: Header, E: Message> Loan<H, E> {
    /// Header of the message.
    pub fn header(&self) -> &H {
        self.sample.user_header()
    }

    /// Elements of the message.
    pub fn elements(&self) -> &[E] {
        self.sample.payload()
    }
}

impl<H: Header, E: Message> Drop for Loan<H, E> {
    fn drop(&mut self) {
        // SAFETY: it is taken only here, and not used afterwards.
        let sample = unsafe { ManuallyDrop::take(&mut self.sample) };
        (self.release)(sample);
    }
}

struct Port<H: Header, E: Message> {
    topic: &'static str,
    inner: iceoryx2::port::subscriber::Subscriber<ipc::Service, [E], H>,
}

pub fn open<H: Header, E: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    buffer: usize,
) -> Result<Box<dyn Receiver<H, E>>, BusError> {
    let topic = agreed.topic;
    let failures = Failures::default();
    let created = service::open::<H, E>(node, agreed)?
        .subscriber_builder()
        .buffer_size(buffer)
        .set_degradation_handler(failures.handler())
        .create();
    let inner = failures.checked(topic, "subscriber", created)?;
    Ok(Box::new(Port { topic, inner }))
}

impl<H: Header, E: Message> Port<H, E> {
    fn failed(&self, reason: String) -> ReceiveError {
        ReceiveError::Transport {
            topic: self.topic,
            reason,
        }
    }
}

impl<H: Header, E: Message> Receiver<H, E> for Port<H, E> {
    fn update_connections(&self) -> Result<(), ReceiveError> {
        self.inner
            .update_connections()
            .map_err(|e| self.failed(format!("{e:?}")))
    }

    fn receive(&self) -> Result<Option<Loan<H, E>>, ReceiveError> {
        let sample = self
            .inner
            .receive()
            .map_err(|e| self.failed(format!("{e:?}")))?;
        Ok(sample.map(|sample| Loan {
            sample: ManuallyDrop::new(sample),
            release: drop::<Sample<H, E>>,
        }))
    }
}
