//! The answering side of a service.

use std::rc::Rc;

use iceoryx2::prelude::{Node, ipc};

use super::{ActivePort, ServerPort, service};
use crate::bus::local::Endpoint;
use crate::bus::{BusError, ReceiveError, SendError};
use crate::clock;
use crate::stamp::Header;
use crate::topics::Service;

/// The answering side between processes.
pub struct Server<S: Service> {
    port: ServerPort<S>,
    source: u32,
    capacity: usize,
}

impl<S: Service> Server<S> {
    pub(in crate::bus) fn open(
        node: &Node<ipc::Service>,
        source: u32,
        capacity: usize,
    ) -> Result<Self, BusError> {
        let capacity = capacity.max(1);
        let port = service::open::<S>(node)?
            .server_builder()
            .initial_max_slice_len(capacity)
            .create()
            .map_err(|e| BusError::Port {
                topic: S::NAME,
                port: "server",
                reason: format!("{e:?}"),
            })?;
        Ok(Self {
            port,
            source,
            capacity,
        })
    }

    /// The next request, if any.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn receive(&self) -> Result<Option<ActiveRequest<S>>, ReceiveError> {
        self.port
            .receive()
            .map(|request| {
                request.map(|request| ActiveRequest {
                    request,
                    source: self.source,
                    capacity: self.capacity,
                })
            })
            .map_err(|e| ReceiveError::Transport {
                topic: S::NAME,
                reason: format!("{e:?}"),
            })
    }
}

impl<S: Service> core::fmt::Debug for Server<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Server")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}

/// A request being worked on; dropping it ends the exchange.
pub struct ActiveRequest<S: Service> {
    request: ActivePort<S>,
    source: u32,
    capacity: usize,
}

impl<S: Service> ActiveRequest<S> {
    /// The request's header.
    pub fn header(&self) -> &S::RequestHeader {
        self.request.user_header()
    }

    /// The request's elements.
    pub fn elements(&self) -> &[S::RequestElement] {
        self.request.payload()
    }

    /// Whether the client still waits.
    pub fn is_wanted(&self) -> bool {
        self.request.is_connected()
    }

    /// Sends the answer. The stamp's source and sending clock are filled in.
    ///
    /// # Errors
    /// [`SendError::Capacity`] if it has more elements than the server was opened for,
    /// [`SendError::Transport`] if iceoryx2 fails.
    pub fn answer(
        &self,
        mut header: S::ResponseHeader,
        elements: &[S::ResponseElement],
    ) -> Result<(), SendError> {
        if elements.len() > self.capacity {
            return Err(SendError::Capacity {
                topic: S::NAME,
                elements: elements.len(),
                capacity: self.capacity,
            });
        }
        let failed = |reason: String| SendError::Transport {
            topic: S::NAME,
            reason,
        };
        let mut response = self
            .request
            .loan_slice_uninit(elements.len())
            .map_err(|e| failed(format!("cannot loan memory: {e:?}")))?;
        let stamp = header.stamp_mut();
        stamp.source = self.source;
        stamp.reserved = 0;
        stamp.sent_ns = clock::monotonic_ns();
        *response.user_header_mut() = header;
        response
            .write_from_slice(elements)
            .send()
            .map_err(|e| failed(format!("{e:?}")))
    }
}

impl<S: Service> core::fmt::Debug for ActiveRequest<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ActiveRequest")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}

/// The answering side on a bus in memory: answers while it lives.
pub struct Attendant<S: Service> {
    endpoint: Rc<Endpoint<S>>,
}

impl<S: Service> Attendant<S> {
    pub(in crate::bus) fn new(endpoint: Rc<Endpoint<S>>) -> Self {
        Self { endpoint }
    }
}

impl<S: Service> Drop for Attendant<S> {
    fn drop(&mut self) {
        self.endpoint.close();
    }
}

impl<S: Service> core::fmt::Debug for Attendant<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Attendant")
            .field("service", &S::NAME)
            .finish_non_exhaustive()
    }
}
