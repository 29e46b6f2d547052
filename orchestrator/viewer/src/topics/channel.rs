//! A channel of messages in a schema of the viewers.

use core::marker::PhantomData;

use foxglove::Encode;
use recorder::{DerivedChannel, DerivedMessages};

/// Encoder of messages of one type for one channel of the log.
#[derive(Debug)]
pub(super) struct ViewerChannel<M> {
    place: usize,
    message: PhantomData<fn(&M)>,
}

impl<M: Encode> ViewerChannel<M> {
    /// Adds a channel to a list.
    pub(super) fn add(channels: &mut Vec<DerivedChannel>, topic: &str) -> Self {
        let (name, encoding, data) = M::get_schema().map_or_else(Default::default, |schema| {
            (schema.name, schema.encoding, schema.data.to_vec())
        });
        channels.push(DerivedChannel {
            topic: topic.to_owned(),
            schema_name: name,
            schema_encoding: encoding,
            schema: data,
            message_encoding: M::get_message_encoding(),
        });
        Self {
            place: channels.len() - 1,
            message: PhantomData,
        }
    }

    /// Adds a message to the output; returns its length (bytes).
    pub(super) fn write(&self, out: &mut DerivedMessages, time_ns: u64, message: &M) -> usize {
        out.push(self.place, time_ns, |bytes| message.encode(bytes))
    }
}
