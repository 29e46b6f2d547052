//! A message in memory.

use std::sync::Arc;

use crate::topics::Topic;

/// A message that all its receivers share, and whose memory its sender reuses once they have
/// released it.
pub(in crate::bus) struct Message<T: Topic> {
    pub(in crate::bus) header: T::Header,
    payload: Payload<T>,
}

enum Payload<T: Topic> {
    Own(Vec<T::Element>),
    Shared(Arc<[T::Element]>),
}

impl<T: Topic> Default for Message<T> {
    fn default() -> Self {
        Self {
            header: T::Header::default(),
            payload: Payload::Own(Vec::new()),
        }
    }
}

impl<T: Topic> Message<T> {
    /// Writes a new message in the memory of the old one.
    pub(in crate::bus) fn fill(
        &mut self,
        header: T::Header,
        elements: impl FnOnce(&mut Vec<T::Element>),
    ) {
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
    pub(in crate::bus) fn share(&mut self, header: T::Header, elements: &Arc<[T::Element]>) {
        self.header = header;
        self.payload = Payload::Shared(Arc::clone(elements));
    }

    pub(in crate::bus) fn elements(&self) -> &[T::Element] {
        match &self.payload {
            Payload::Own(elements) => elements,
            Payload::Shared(elements) => elements,
        }
    }

    /// The elements if they were sent shared.
    pub(in crate::bus) fn shared(&self) -> Option<&Arc<[T::Element]>> {
        match &self.payload {
            Payload::Own(_) => None,
            Payload::Shared(elements) => Some(elements),
        }
    }

    /// The elements for the receiver to keep; a copy unless they were sent shared.
    pub(in crate::bus) fn shared_elements(&self) -> Arc<[T::Element]> {
        match &self.payload {
            Payload::Own(elements) => Arc::from(elements.as_slice()),
            Payload::Shared(elements) => Arc::clone(elements),
        }
    }
}
