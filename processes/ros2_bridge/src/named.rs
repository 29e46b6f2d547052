//! Topics of a run that are published as they are in its log.

use ipc_types::cdr::ENCAPSULATION;
use ipc_types::schema;
use ipc_types::topics::TopicId;
use serde::ser::SerializeTuple as _;
use serde::{Serialize, Serializer};

use crate::error::BridgeError;
use crate::session::{Kept, RosPublisher, Session};

/// A message in its CDR form, without the encapsulation, which DDS writes itself.
#[derive(Debug)]
struct Cdr(Vec<u8>);

impl Serialize for Cdr {
    /// The bytes one by one: a tuple has neither length nor gaps.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

/// Publisher of a topic of the run.
pub struct NamedTopic {
    /// The topic.
    pub topic: TopicId,
    publisher: RosPublisher<Cdr>,
}

impl NamedTopic {
    /// Opens `/NAME`, of the type of the topic in logs.
    ///
    /// # Errors
    /// [`BridgeError::Create`].
    pub fn open(session: &mut Session, topic: TopicId) -> Result<Self, BridgeError> {
        let type_name = schema::message_name(topic).replace("/msg/", "/");
        let name = format!("/{}", topic.name());
        let publisher = session.publisher_of_type(&name, &type_name, Kept::Nothing)?;
        Ok(Self { topic, publisher })
    }

    /// Sends a message in its CDR form.
    ///
    /// # Errors
    /// [`BridgeError::Transfer`].
    pub fn send(&self, message: &[u8]) -> Result<(), BridgeError> {
        let body = message.get(ENCAPSULATION.len()..).unwrap_or_default();
        self.publisher.send(Cdr(body.to_vec()))
    }
}
