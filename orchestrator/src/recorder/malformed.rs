//! Messages that cannot stand in their topic's channel because no reader could decode them.

use std::collections::BTreeMap;

use super::error::LogError;
use super::log_writer::{ChannelId, ChannelSpec, LogWriter};

/// Their topic.
const TOPIC: &str = "recorder/malformed";

/// The message definition.
const SCHEMA: &str = "string topic  # where the message was sent\n\
    uint8[] message  # its bytes: encapsulation header, user header, elements\n";

/// The channel of malformed messages; comes into being with the first.
#[derive(Debug, Default)]
pub(super) struct Malformed {
    channel: Option<(ChannelId, u32)>,
}

impl Malformed {
    /// Writes one.
    pub(super) fn write(
        &mut self,
        log: &mut LogWriter,
        topic: &str,
        log_time: u64,
        publish_time: u64,
        message: &[u8],
    ) -> Result<(), LogError> {
        let (id, sequence) = match self.channel {
            Some(channel) => channel,
            None => (add(log)?, 0),
        };
        self.channel = Some((id, sequence.wrapping_add(1)));
        log.write(
            id,
            sequence,
            log_time,
            publish_time,
            &encode(topic, message),
        )
    }
}

fn add(log: &mut LogWriter) -> Result<ChannelId, LogError> {
    log.add_channel(&ChannelSpec {
        topic: TOPIC,
        schema_name: "protean/msg/Malformed",
        schema_encoding: "ros2msg",
        schema: SCHEMA.as_bytes(),
        message_encoding: "cdr",
        metadata: &BTreeMap::new(),
    })
}

/// Little-endian CDR: a string with its final zero, then a sequence aligned to its count.
fn encode(topic: &str, message: &[u8]) -> Vec<u8> {
    let mut out = vec![0, 1, 0, 0];
    // Names of topics and messages in shared memory are far below 2^32 bytes.
    out.extend_from_slice(&(topic.len() as u32 + 1).to_le_bytes());
    out.extend_from_slice(topic.as_bytes());
    out.push(0);
    out.resize(out.len().next_multiple_of(4), 0);
    out.extend_from_slice(&(message.len() as u32).to_le_bytes());
    out.extend_from_slice(message);
    out
}
