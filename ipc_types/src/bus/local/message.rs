//! A message in memory.

use std::sync::Arc;

/// A message that all its receivers share, and whose memory its sender reuses once they have
/// released it.
pub(in crate::bus) struct Message<H, E> {
    pub(in crate::bus) header: H,
    payload: Payload<E>,
}

enum Payload<E> {
    Own(Vec<E>),
    Shared(Arc<[E]>),
}

impl<H: Default, E> Default for Message<H, E> {
    fn default() -> Self {
        Self {
            header: H::default(),
            payload: Payload::Own(Vec::new()),
        }
    }
}

impl<H, E: Copy> Message<H, E> {
    /// Writes a new message in the memory of the old one.
    pub(in crate::bus) fn fill(&mut self, header: H, elements: impl FnOnce(&mut Vec<E>)) {
        self.header = header;
        if let Payload::Shared(_) = self.payload {
            self.payload = Payload::Own(Vec::new());
        }
        if let Payload::Own(own) = &mut self.payload {
            own.clear();
            elements(own);
        }
    }

    /// As [`Message::fill`], with elements that are not copied.
    pub(in crate::bus) fn share(&mut self, header: H, elements: &Arc<[E]>) {
        self.header = header;
        self.payload = Payload::Shared(Arc::clone(elements));
    }

    pub(in crate::bus) fn elements(&self) -> &[E] {
        match &self.payload {
            Payload::Own(elements) => elements,
            Payload::Shared(elements) => elements,
        }
    }

    /// The elements if they were sent shared.
    pub(in crate::bus) fn shared(&self) -> Option<&Arc<[E]>> {
        match &self.payload {
            Payload::Own(_) => None,
            Payload::Shared(elements) => Some(elements),
        }
    }

    /// The elements for the receiver to keep; a copy unless they were sent shared.
    pub(in crate::bus) fn shared_elements(&self) -> Arc<[E]> {
        match &self.payload {
            Payload::Own(elements) => Arc::from(elements.as_slice()),
            Payload::Shared(elements) => Arc::clone(elements),
        }
    }
}
