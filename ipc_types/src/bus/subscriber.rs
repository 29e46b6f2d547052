//! The receiving side of a topic.

use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::prelude::{Node, ipc};
use iceoryx2::sample::Sample;

use super::{BusError, BusOptions, ReceiveError, service};
use crate::topics::Topic;

/// Receives messages of one topic, oldest first per publisher.
pub struct Subscriber<T: Topic> {
    port: iceoryx2::port::subscriber::Subscriber<ipc::Service, [T::Element], T::Header>,
}

impl<T: Topic> Subscriber<T> {
    pub(super) fn open(
        node: &Node<ipc::Service>,
        options: &BusOptions,
        ticks: usize,
    ) -> Result<Self, BusError> {
        let port = service::open::<T>(node)?
            .subscriber_builder()
            .buffer_size(service::buffer(&T::qos(&options.size), ticks))
            .create()
            .map_err(|e| BusError::Port {
                topic: T::NAME,
                port: "subscriber",
                reason: format!("{e:?}"),
            })?;
        Ok(Self { port })
    }

    /// Connects to publishers that came since the last call or reception.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 cannot connect.
    pub fn update_connections(&self) -> Result<(), ReceiveError> {
        self.port
            .update_connections()
            .map_err(|e| ReceiveError::Transport {
                topic: T::NAME,
                reason: format!("{e:?}"),
            })
    }

    /// The next unread message, if any; its bytes stay in shared memory, mapped read-only.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn receive(&self) -> Result<Option<Received<T>>, ReceiveError> {
        self.port
            .receive()
            .map(|sample| sample.map(|sample| Received { sample }))
            .map_err(|e| ReceiveError::Transport {
                topic: T::NAME,
                reason: format!("{e:?}"),
            })
    }
}

impl<T: Topic> core::fmt::Debug for Subscriber<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Subscriber")
            .field("topic", &T::NAME)
            .finish_non_exhaustive()
    }
}

/// A message in shared memory, freed on drop. Hold at most two per subscriber.
pub struct Received<T: Topic> {
    sample: Sample<ipc::Service, [T::Element], T::Header>,
}

impl<T: Topic> Received<T> {
    /// The user header.
    pub fn header(&self) -> &T::Header {
        self.sample.user_header()
    }

    /// The elements.
    pub fn elements(&self) -> &[T::Element] {
        self.sample.payload()
    }
}

impl<T: Topic> core::fmt::Debug for Received<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Received")
            .field("topic", &T::NAME)
            .field("header", self.header())
            .field("elements", &self.elements().len())
            .finish()
    }
}
