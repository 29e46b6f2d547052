//! A channel of ROS 2 messages.

use core::marker::PhantomData;

use recorder::{DerivedChannel, DerivedMessages};

use ros_messages::RosType;

/// Encoder of messages of one type for one channel of the log.
#[derive(Debug)]
pub(super) struct ViewerChannel<M> {
    place: usize,
    message: PhantomData<fn(&M)>,
}

impl<M: RosType> ViewerChannel<M> {
    /// Adds a channel to a list; `latched`: late joiners get the last message.
    pub(super) fn add(channels: &mut Vec<DerivedChannel>, topic: &str, latched: bool) -> Self {
        let (schema_name, schema) = ros_messages::definition::<M>();
        channels.push(DerivedChannel {
            topic: topic.to_owned(),
            schema_name,
            schema,
            latched,
        });
        Self {
            place: channels.len() - 1,
            message: PhantomData,
        }
    }

    /// Adds a message to the output; returns its length (bytes).
    pub(super) fn write(&self, out: &mut DerivedMessages, time_ns: u64, message: &M) -> usize {
        out.push(self.place, time_ns, |bytes| {
            ros_messages::encode(message, bytes);
        })
    }
}
