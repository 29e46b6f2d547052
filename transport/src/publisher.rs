//! The sending end of a topic.

use std::time::Duration;

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::port::{BackpressureAction, LoanError};
use iceoryx2::prelude::{AllocationStrategy, BackpressureStrategy, Node, ZeroCopySend, ipc};
use iceoryx2::service::port_factory::publisher::PortFactoryPublisher;

use super::degradation::Failures;
use super::service::{self, TopicIdentity};
use crate::clock::monotonic_ns;
use crate::error::{BusError, SendError};
use crate::message::Message;
use crate::stamp::Header;

/// Options of a sending end.
#[derive(Debug, Clone, Copy)]
pub struct SenderOptions {
    /// Maximum number of elements of a message; it determines the size of the shared memory.
    pub capacity: usize,
    /// `true` if the shared memory grows when a message has more.
    pub grows: bool,
    /// `true` if a full buffer drops its oldest message instead of blocking the sender.
    pub overflow: bool,
    /// Maximum time to wait for a receiver whose buffer is full.
    pub patience: Duration,
}

/// A sending end.
pub trait Sender<H, E> {
    /// Connects to new receivers.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    fn update_connections(&self) -> Result<(), SendError>;

    /// Sends a message with this number of elements; returns the number of receivers. `write` gets
    /// the elements with the content of the memory: zeros, or an earlier message. With `timed`, the
    /// stamp gets the time of sending, and that of writing unless it is set.
    ///
    /// # Errors
    /// [`SendError`] if iceoryx2 fails.
    fn send(
        &self,
        header: H,
        count: usize,
        timed: bool,
        write: &mut dyn FnMut(&mut [E]),
    ) -> Result<usize, SendError>;
}

struct Port<H: Header, E: Message> {
    topic: &'static str,
    inner: iceoryx2::port::publisher::Publisher<ipc::Service, [E], H>,
    patience: Duration,
}

pub fn open<H: Header, E: Message>(
    node: &Node<ipc::Service>,
    agreed: &TopicIdentity<'_>,
    options: SenderOptions,
) -> Result<Box<dyn Sender<H, E>>, BusError> {
    let factory = service::open::<H, E>(node, agreed)?;
    let failures = Failures::default();
    let builder = configured(factory.publisher_builder(), &options, &failures);
    let inner = failures.checked(agreed.topic, "publisher", builder.create())?;
    Ok(Box::new(Port {
        topic: agreed.topic,
        inner,
        patience: options.patience,
    }))
}

/// Applies options to a publisher to be created.
pub fn configured<'f, P, H>(
    builder: PortFactoryPublisher<'f, ipc::Service, [P], H>,
    options: &SenderOptions,
    failures: &Failures,
) -> PortFactoryPublisher<'f, ipc::Service, [P], H>
where
    P: core::fmt::Debug + ZeroCopySend,
    H: core::fmt::Debug + ZeroCopySend,
{
    let builder = builder
        .initial_max_slice_len(options.capacity.max(1))
        .allocation_strategy(if options.grows {
            AllocationStrategy::PowerOfTwo
        } else {
            AllocationStrategy::Static
        })
        .max_loaned_samples(1)
        .set_degradation_handler(failures.handler());
    let patience = options.patience;
    if options.overflow {
        return builder;
    }
    builder
        .backpressure_strategy(BackpressureStrategy::RetryUntilDelivered)
        // A stopped or dead receiver must not block its sender forever.
        .set_backpressure_handler(move |info| {
            if info.elapsed_time < patience {
                BackpressureAction::Retry
            } else {
                BackpressureAction::DiscardDataAndFail
            }
        })
}

impl<H: Header, E: Message> Port<H, E> {
    fn failed(&self, reason: String) -> SendError {
        SendError::Transport {
            topic: self.topic,
            reason,
        }
    }
}

impl<H: Header, E: Message> Sender<H, E> for Port<H, E> {
    fn update_connections(&self) -> Result<(), SendError> {
        self.inner
            .update_connections()
            .map_err(|e| self.failed(format!("{e:?}")))
    }

    fn send(
        &self,
        header: H,
        count: usize,
        timed: bool,
        write: &mut dyn FnMut(&mut [E]),
    ) -> Result<usize, SendError> {
        let mut sample = self
            .inner
            .loan_slice_uninit(count)
            .map_err(|e: LoanError| self.failed(format!("cannot loan memory: {e:?}")))?;
        *sample.user_header_mut() = header;
        // SAFETY: the memory is a shared file mapping, which the kernel initialises with zeros; it
        // holds those or an earlier message. Elements are `FromBytes` (a supertrait of `Message`):
        // all bytes are a valid value.
        let mut sample = unsafe { sample.assume_init() };
        write(sample.payload_mut());
        if timed {
            let stamp = sample.user_header_mut().stamp_mut();
            stamp.sent_ns = monotonic_ns();
            // If the clock was not read before the message was written, this reading serves for
            // both.
            if stamp.computed_ns == 0 {
                stamp.computed_ns = stamp.sent_ns;
            }
        }
        let sent = sample.send();
        sent.map_err(|e| undelivered(self.topic, self.patience, e))
    }
}

/// Converts the error of a message that was not sent.
pub fn undelivered(
    topic: &'static str,
    waited: Duration,
    error: iceoryx2::port::SendError,
) -> SendError {
    match error {
        iceoryx2::port::SendError::UnableToDeliver => SendError::Blocked { topic, waited },
        other => SendError::Transport {
            topic,
            reason: format!("{other:?}"),
        },
    }
}
