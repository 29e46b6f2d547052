//! Client side of a service.

use core::cell::{Cell, RefCell};
use std::rc::Rc;

use super::layout;
use crate::bus::inbox::Inbox;
use crate::bus::local::Endpoint;
use crate::bus::{Answer, BusError, ReceiveError, SendError, agreed};
use crate::clock::StampClock;
use crate::stamp::Header;
use crate::topics::Service;
use crate::transport::{self, Home};

/// Client side.
pub struct Client<S: Service> {
    port: Port<S>,
    source: u32,
    capacity: usize,
    sequence: Cell<u64>,
    inbox: Option<Rc<Inbox>>,
}

/// A client of one of the buses.
enum Port<S: Service> {
    #[allow(clippy::type_complexity)]
    Ipc(
        Box<
            dyn transport::Client<
                    S::RequestHeader,
                    S::RequestElement,
                    S::ResponseHeader,
                    S::ResponseElement,
                >,
        >,
    ),
    Local(Rc<Endpoint<S>>),
}

impl<S: Service> Client<S> {
    pub(in crate::bus) fn open(
        node: &dyn Home,
        source: u32,
        capacity: usize,
    ) -> Result<Self, BusError> {
        let capacity = capacity.max(1);
        let layout = layout::<S>();
        let port = (S::ports().client)(node.node(), &agreed(S::NAME, &layout), capacity)?;
        Ok(Self {
            port: Port::Ipc(port),
            source,
            capacity,
            sequence: Cell::new(0),
            inbox: None,
        })
    }

    pub(in crate::bus) fn open_local(
        endpoint: Rc<Endpoint<S>>,
        source: u32,
        capacity: usize,
    ) -> Self {
        Self {
            port: Port::Local(endpoint),
            source,
            capacity: capacity.max(1),
            sequence: Cell::new(0),
            inbox: None,
        }
    }

    /// Returns the client of a process with an inbox, whose requests belong to the tick of the inbox.
    pub(in crate::bus) fn dated_by(self, inbox: Option<Rc<Inbox>>) -> Self {
        Self { inbox, ..self }
    }

    /// Sends a request; the returned handle polls the answer. The stamp's sequence, source and sending clock
    /// are filled in (0 on a bus in memory, where the answer is computed at once).
    ///
    /// # Errors
    /// [`SendError::Capacity`] if it has more elements than the capacity of the client,
    /// [`SendError::Transport`] if iceoryx2 fails, e.g. with too many open requests.
    pub fn ask(
        &self,
        mut header: S::RequestHeader,
        elements: &[S::RequestElement],
    ) -> Result<PendingResponse<S>, SendError> {
        if elements.len() > self.capacity {
            return Err(SendError::Capacity {
                topic: S::NAME,
                elements: elements.len(),
                capacity: self.capacity,
            });
        }
        let stamp = header.stamp_mut();
        stamp.sequence = self.sequence.replace(self.sequence.get() + 1);
        stamp.source = self.source;
        stamp.reserved = 0;
        if let Some(inbox) = &self.inbox {
            inbox.date(stamp);
        }
        let pending = match &self.port {
            Port::Ipc(port) => {
                stamp.sent_ns = StampClock::MONOTONIC.now_ns();
                BusRequest::Ipc(port.ask(header, elements)?)
            }
            Port::Local(endpoint) => {
                stamp.sent_ns = StampClock::STANDING.now_ns();
                BusRequest::Local(RefCell::new(endpoint.call(&header, elements)))
            }
        };
        Ok(PendingResponse { pending })
    }
}

crate::transport::debug_with! { [S: Service] Client<S>, own => (S::NAME, own.source) }

/// A request that waits for its answer; dropping it cancels the request.
pub struct PendingResponse<S: Service> {
    pending: BusRequest<S>,
}

/// A request on one of the buses.
enum BusRequest<S: Service> {
    Ipc(Box<dyn transport::PendingRequest<S::ResponseHeader, S::ResponseElement>>),
    /// The answer, until it is taken.
    Local(RefCell<Option<Answer<S>>>),
}

impl<S: Service> PendingResponse<S> {
    /// The answer, if it has arrived.
    ///
    /// # Errors
    /// [`ReceiveError::Transport`] if iceoryx2 fails.
    pub fn poll(&self) -> Result<Option<Answer<S>>, ReceiveError> {
        match &self.pending {
            BusRequest::Ipc(pending) => pending.poll(),
            BusRequest::Local(answer) => Ok(answer.take()),
        }
    }

    /// Returns `true` if a server still works on it, or its answer waits on a bus in memory. It stays `true`
    /// after the death of a server until the clean-up, so a client needs its own deadline.
    pub fn is_open(&self) -> bool {
        match &self.pending {
            BusRequest::Ipc(pending) => pending.is_open(),
            BusRequest::Local(answer) => answer.borrow().is_some(),
        }
    }
}

crate::transport::debug_with! { [S: Service] PendingResponse<S>, _ => S::NAME }
