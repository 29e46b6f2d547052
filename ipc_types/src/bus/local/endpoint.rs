//! One request–response service: who answers it.

use core::cell::RefCell;

use crate::bus::{Answer, BusError};
use crate::topics::Service;

/// What makes an answer of a request.
pub(in crate::bus) type Handler<S> =
    Box<dyn FnMut(&<S as Service>::RequestHeader, &[<S as Service>::RequestElement]) -> Answer<S>>;

/// A service in memory: who asks calls who answers.
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
    /// Takes the one place of who answers.
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

    /// Nobody answers any more.
    pub(in crate::bus) fn close(&self) {
        if let Ok(mut installed) = self.handler.try_borrow_mut() {
            *installed = None;
        }
    }

    /// The answer; `None` if nobody answers, or who answers asks itself.
    pub(in crate::bus) fn call(
        &self,
        header: &S::RequestHeader,
        elements: &[S::RequestElement],
    ) -> Option<Answer<S>> {
        let mut installed = self.handler.try_borrow_mut().ok()?;
        installed.as_mut().map(|handler| handler(header, elements))
    }
}
