//! A channel of messages in a viewers' schema.

use core::marker::PhantomData;
use std::collections::BTreeMap;

use foxglove::Encode;

use super::super::error::LogError;
use super::super::log_writer::{ChannelId, ChannelSpec, LogWriter};

/// Encodes messages of one type into one channel of the log.
pub(super) struct ViewerChannel<M> {
    id: ChannelId,
    topic: String,
    sequence: u32,
    message: PhantomData<fn(&M)>,
}

impl<M: Encode> ViewerChannel<M> {
    pub(super) fn add(log: &mut LogWriter, topic: &str) -> Result<Self, LogError> {
        let schema = M::get_schema();
        let id = log.add_channel(&ChannelSpec {
            topic,
            schema_name: schema.as_ref().map_or("", |s| &s.name),
            schema_encoding: schema.as_ref().map_or("", |s| &s.encoding),
            schema: schema.as_ref().map_or(&[], |s| &s.data),
            message_encoding: &M::get_message_encoding(),
            metadata: &BTreeMap::new(),
        })?;
        Ok(Self {
            id,
            topic: topic.to_owned(),
            sequence: 0,
            message: PhantomData,
        })
    }

    /// Writes a message; `buffer` is scratch.
    pub(super) fn write(
        &mut self,
        log: &mut LogWriter,
        time_ns: u64,
        message: &M,
        buffer: &mut Vec<u8>,
    ) -> Result<(), LogError> {
        buffer.clear();
        message.encode(buffer).map_err(|e| LogError::Encode {
            path: log.path().to_owned(),
            topic: self.topic.clone(),
            reason: e.to_string(),
        })?;
        let sequence = self.sequence;
        self.sequence = self.sequence.wrapping_add(1);
        log.write(self.id, sequence, time_ns, time_ns, buffer)
    }
}
