//! One request–response service, with its server.

use core::cell::RefCell;

use crate::bus::{Answer, BusError};
use crate::topics::Service;

/// Function that answers a request.
pub(in crate::bus) type Handler<S> =
    Box<dyn FnMut(&<S as Service>::RequestHeader, &[<S as Service>::RequestElement]) -> Answer<S>>;

/// A service in memory: the client calls the server.
pub(in crate::bus) struct Endpoint<S: Service> {
    handler: RefCell<Option<Handler<S>>>,
}

impl<S: Service> Default for Endpoint<S> {
    fn default() -> Self {
        Self {
            handler: RefCell::default(),
        }
    }
}

impl<S: Service> Endpoint<S> {
    /// Registers the only server.
    pub(in crate::bus) fn serve(&self, handler: Handler<S>) -> Result<(), BusError> {
        let mut installed = self.handler.borrow_mut();
        if installed.is_some() {
            return Err(BusError::Port {
                topic: S::NAME,
                port: "server",
                reason: "all 1 are taken".to_owned(),
            });
        }
        *installed = Some(handler);
        Ok(())
    }

    /// Removes the server.
    pub(in crate::bus) fn close(&self) {
        if let Ok(mut installed) = self.handler.try_borrow_mut() {
            *installed = None;
        }
    }

    /// The answer; `None` without a server, or if the server itself calls the service.
    pub(in crate::bus) fn call(
        &self,
        header: &S::RequestHeader,
        elements: &[S::RequestElement],
    ) -> Option<Answer<S>> {
        let mut installed = self.handler.try_borrow_mut().ok()?;
        installed.as_mut().map(|handler| handler(header, elements))
    }
}
