//! Server side of a service.

use std::rc::Rc;

use super::layout;
use crate::bus::local::Endpoint;
use crate::bus::{BusError, ReceiveError, SendError, agreed};
use crate::stamp::Header;
use crate::topics::Service;
use crate::transport::{self, Home};

type Port<S> = dyn transport::Server<
        <S as Service>::RequestHeader,
        <S as Service>::RequestElement,
        <S as Service>::ResponseHeader,
        <S as Service>::ResponseElement,
    >;
type Active<S> = dyn transport::Active<
        <S as Service>::RequestHeader,
        <S as Service>::RequestElement,
        <S as Service>::ResponseHeader,
        <S as Service>::ResponseElement,
    >;

/// Server side between processes.
pub struct Server<S: Service> {
    port: Box<Port<S>>,
    source: u32,
    capacity: usize,
}

impl<S: Service> Server<S> {
    pub(in crate::bus) fn open(
        node: &dyn Home,
        source: u32,
        capacity: usize,
    ) -> Result<Self, BusError> {
        let capacity = capacity.max(1);
        let layout = layout::<S>();
        let port = (S::ports().server)(node.node(), &agreed(S::NAME, &layout), capacity)?;
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
        let request = self.port.receive()?;
        Ok(request.map(|request| ActiveRequest {
            request,
            source: self.source,
            capacity: self.capacity,
        }))
    }
}

crate::transport::debug_with! { [S: Service] Server<S>, _ => S::NAME }

/// A request in progress; dropping it ends the exchange.
pub struct ActiveRequest<S: Service> {
    request: Box<Active<S>>,
    source: u32,
    capacity: usize,
}

impl<S: Service> ActiveRequest<S> {
    /// The request's header.
    pub fn header(&self) -> &S::RequestHeader {
        self.request.header()
    }

    /// The request's elements.
    pub fn elements(&self) -> &[S::RequestElement] {
        self.request.elements()
    }

    /// Returns `true` if the client still waits.
    pub fn is_wanted(&self) -> bool {
        self.request.is_wanted()
    }

    /// Sends the answer. The stamp's source and sending clock are filled in.
    ///
    /// # Errors
    /// [`SendError::Capacity`] if it has more elements than the capacity of the server,
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
        let stamp = header.stamp_mut();
        stamp.source = self.source;
        stamp.reserved = 0;
        self.request.answer(header, elements)
    }
}

crate::transport::debug_with! { [S: Service] ActiveRequest<S>, _ => S::NAME }

/// Server side on a bus in memory: answers until it is dropped.
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

crate::transport::debug_with! { [S: Service] Attendant<S>, _ => S::NAME }
