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

#[cfg(test)]
mod tests {
    use core::time::Duration;
    use std::time::Instant;

    use async_io::Timer;
    use futures_lite::future;
    use ipc_types::cdr;
    use ipc_types::messages::world::WorldEvent;
    use ipc_types::stamp::PlainHeader;
    use ipc_types::topics::WorldEvents;
    use ros2_client::{Context, ContextOptions, MessageTypeName, Name, NodeName, NodeOptions};
    use serde::Deserialize;

    use super::*;

    /// The messages as their definition in logs has them, for another reader of CDR.
    #[derive(Debug, Deserialize)]
    struct Message {
        stamp: StampFields,
        events: Vec<EventFields>,
    }
    /// `protean/Stamp`.
    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "the fields give the bytes their places")]
    struct StampFields {
        tick: u64,
        time_ns: u64,
        sequence: u64,
        source: u32,
        reserved: u32,
        clocks: [u64; 5],
    }
    /// `protean/Event`.
    #[derive(Debug, PartialEq, Deserialize)]
    struct EventFields {
        x: f64,
        y: f64,
        value: f64,
        kind: u32,
        robot: u32,
        other: u32,
        reserved: u32,
    }

    #[test]
    fn another_reader_of_cdr_finds_the_fields_of_the_definition() {
        let domain = 60 + (std::process::id() % 40) as u16;
        let context = ContextOptions::new().domain_id(domain);
        let context = Context::with_options(context).unwrap();
        let name = NodeName::new("/", "reader").unwrap();
        let mut node = context.new_node(name, NodeOptions::new()).unwrap();
        let qos = Kept::Nothing.profile();
        let kind = MessageTypeName::new("protean", "WorldEvent");
        let topic = Name::parse("/world/event").unwrap();
        let topic = node.create_topic(&topic, kind, &qos).unwrap();
        let reader = node.create_subscription::<Message>(&topic, None).unwrap();

        let mut session = Session::join(domain, "writer", true).unwrap();
        let writer = NamedTopic::open(&mut session, TopicId::WorldEvents).unwrap();
        let header = PlainHeader {
            stamp: ipc_types::stamp::Stamp {
                tick: 7,
                ..ipc_types::stamp::Stamp::default()
            },
        };
        let event = |robot| WorldEvent {
            x: 1.5,
            value: -2.0,
            kind: 3,
            robot,
            ..WorldEvent::default()
        };
        let mut bytes = Vec::new();
        cdr::encode::<WorldEvents>(&header, &[event(4), event(5)], &mut bytes);
        let until = Instant::now() + Duration::from_secs(60);
        let message = loop {
            // The reader may not be found yet.
            writer.send(&bytes).unwrap();
            let message = async { Some(reader.async_take().await.unwrap().0) };
            let again = async {
                Timer::after(Duration::from_millis(100)).await;
                None
            };
            if let Some(message) = async_io::block_on(future::or(message, again)) {
                break message;
            }
            assert!(Instant::now() < until, "no message");
        };
        assert_eq!(message.stamp.tick, 7);
        let expected = [4, 5].map(|robot| EventFields {
            x: 1.5,
            y: 0.0,
            value: -2.0,
            kind: 3,
            robot,
            other: 0,
            reserved: 0,
        });
        assert_eq!(message.events, expected);
    }
}
