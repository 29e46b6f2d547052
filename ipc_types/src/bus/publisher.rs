//! The sending side of a topic.

use core::cell::Cell;
use std::time::Duration;

use iceoryx2::port::LoanError;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::{AllocationStrategy, BackpressureStrategy, Node, ipc};

use super::{BusError, BusOptions, SendError, service};
use crate::clock;
use crate::stamp::Header;
use crate::topics::Topic;

/// How a publisher is opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PublisherOptions {
    /// Index of the sending process, stamped into every message.
    pub source: u32,
    /// Most elements of one message, ≥ 1; the shared memory is sized by it.
    pub capacity: usize,
    /// How long to wait for a receiver whose buffer is full before giving up.
    pub patience: Duration,
}

impl PublisherOptions {
    /// A publisher of messages with up to `capacity` elements that waits up to 10 s.
    pub fn new(source: u32, capacity: usize) -> Self {
        Self {
            source,
            capacity,
            patience: Duration::from_secs(10),
        }
    }
}

/// Sends messages of one topic.
pub struct Publisher<T: Topic> {
    port: iceoryx2::port::publisher::Publisher<ipc::Service, [T::Element], T::Header>,
    options: PublisherOptions,
    sequence: Cell<u64>,
}

impl<T: Topic> Publisher<T> {
    pub(super) fn open(
        node: &Node<ipc::Service>,
        bus: &BusOptions,
        options: PublisherOptions,
    ) -> Result<Self, BusError> {
        use iceoryx2::port::BackpressureAction;

        let patience = options.patience;
        let factory = service::open::<T>(node)?;
        let builder = factory
            .publisher_builder()
            .initial_max_slice_len(options.capacity.max(1))
            .allocation_strategy(AllocationStrategy::Static)
            .max_loaned_samples(1);
        let builder = if bus.overflow {
            builder
        } else {
            builder
                .backpressure_strategy(BackpressureStrategy::RetryUntilDelivered)
                // A receiver that is stopped or dead must not hang its sender for ever.
                .set_backpressure_handler(move |info| {
                    if info.elapsed_time < patience {
                        BackpressureAction::Retry
                    } else {
                        BackpressureAction::DiscardDataAndFail
                    }
                })
        };
        let port = builder.create().map_err(|e| BusError::Port {
            topic: T::NAME,
            port: "publisher",
            reason: format!("{e:?}"),
        })?;
        Ok(Self {
            port,
            options,
            sequence: Cell::new(0),
        })
    }

    /// Most elements of one message.
    pub fn capacity(&self) -> usize {
        self.options.capacity
    }

    /// Connects to subscribers that came since the last call or sending, and hands them the
    /// topic's history.
    ///
    /// # Errors
    /// [`SendError::Transport`] if iceoryx2 cannot connect.
    pub fn update_connections(&self) -> Result<(), SendError> {
        self.port
            .update_connections()
            .map_err(|e| SendError::Transport {
                topic: T::NAME,
                reason: format!("{e:?}"),
            })
    }

    /// Sends a message whose elements are copied into shared memory; returns how many subscribers
    /// got it. The stamp's sequence, source and sending clock are filled in.
    ///
    /// # Errors
    /// [`SendError::Capacity`] if it has too many elements, [`SendError::Blocked`] if a receiver
    /// did not make room within the publisher's patience, [`SendError::Transport`] otherwise.
    pub fn send(&self, header: T::Header, elements: &[T::Element]) -> Result<usize, SendError> {
        let sample = self.loan(header, elements.len())?;
        self.finish(sample.write_from_slice(elements))
    }

    /// Sends a message whose elements are made in place, in shared memory.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn send_with(
        &self,
        header: T::Header,
        count: usize,
        element: impl FnMut(usize) -> T::Element,
    ) -> Result<usize, SendError> {
        let sample = self.loan(header, count)?;
        self.finish(sample.write_from_fn(element))
    }

    /// Memory for a message, its header filled in.
    fn loan(&self, mut header: T::Header, count: usize) -> Result<Loan<T>, SendError> {
        if count > self.options.capacity {
            return Err(SendError::Capacity {
                topic: T::NAME,
                elements: count,
                capacity: self.options.capacity,
            });
        }
        let mut sample =
            self.port
                .loan_slice_uninit(count)
                .map_err(|e: LoanError| SendError::Transport {
                    topic: T::NAME,
                    reason: format!("cannot loan memory: {e:?}"),
                })?;
        let stamp = header.stamp_mut();
        stamp.sequence = self.sequence.get();
        stamp.source = self.options.source;
        stamp.reserved = 0;
        stamp.sent_ns = clock::monotonic_ns();
        *sample.user_header_mut() = header;
        Ok(sample)
    }

    fn finish(&self, sample: Filled<T>) -> Result<usize, SendError> {
        let sent = sample.send().map_err(|e| match e {
            iceoryx2::port::SendError::UnableToDeliver => SendError::Blocked {
                topic: T::NAME,
                waited: self.options.patience,
            },
            other => SendError::Transport {
                topic: T::NAME,
                reason: format!("{other:?}"),
            },
        })?;
        self.sequence.set(self.sequence.get() + 1);
        Ok(sent)
    }
}

/// Shared memory that has not been written yet.
type Loan<T> = iceoryx2::sample_mut_uninit::SampleMutUninit<
    ipc::Service,
    [core::mem::MaybeUninit<<T as Topic>::Element>],
    <T as Topic>::Header,
>;

/// Shared memory that holds a message.
type Filled<T> =
    iceoryx2::sample_mut::SampleMut<ipc::Service, [<T as Topic>::Element], <T as Topic>::Header>;

impl<T: Topic> core::fmt::Debug for Publisher<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Publisher")
            .field("topic", &T::NAME)
            .field("options", &self.options)
            .field("sequence", &self.sequence)
            .finish_non_exhaustive()
    }
}
