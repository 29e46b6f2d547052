//! Derived channels of a log, such as those for viewers, whose messages are made from those of the topics.

use std::ops::Range;

use ipc_types::consumer::Consumer;
use mcap_log::{ChannelId, ChannelSpec, LogWriteError, LogWriter};

/// Generator of the messages of derived channels.
///
/// It receives all logged messages that passed the checks, in the order of the log. Its output is written
/// after each of them, at the end of each tick and at the end of the run.
pub trait DerivedTopics: Consumer + Send {
    /// Returns the channels; the index in this list identifies a channel.
    fn channels(&self) -> &[DerivedChannel];

    /// Returns the messages to be written.
    fn ready(&mut self) -> &mut DerivedMessages;

    /// Ends the run: no message follows.
    fn finish(&mut self);
}

/// A derived channel.
#[derive(Debug, Clone)]
pub struct DerivedChannel {
    /// Name of the topic.
    pub topic: String,
    /// Name of the ROS 2 message, `PACKAGE/msg/NAME`.
    pub schema_name: String,
    /// Definition of the message (`ros2msg`).
    pub schema: String,
    /// `true` if late joiners get the last message.
    pub latched: bool,
}

/// Messages of derived channels, in the order in which they are written.
#[derive(Debug, Default)]
pub struct DerivedMessages {
    bytes: Vec<u8>,
    messages: Vec<DerivedMessage>,
}

#[derive(Debug)]
struct DerivedMessage {
    channel: usize,
    /// Simulated time (ns).
    time_ns: u64,
    bytes: Range<usize>,
}

impl DerivedMessages {
    /// Adds the message that `encode` appends; returns its length (bytes).
    pub fn push(
        &mut self,
        channel: usize,
        time_ns: u64,
        encode: impl FnOnce(&mut Vec<u8>),
    ) -> usize {
        let start = self.bytes.len();
        encode(&mut self.bytes);
        let bytes = start..self.bytes.len();
        let length = bytes.len();
        self.messages.push(DerivedMessage {
            channel,
            time_ns,
            bytes,
        });
        length
    }
}

/// The derived channels of a log.
pub(super) struct DerivedLog {
    derived: Box<dyn DerivedTopics>,
    channels: Vec<Channel>,
}

struct Channel {
    id: ChannelId,
    sequence: u32,
}

impl DerivedLog {
    /// Adds the channels to a log, and the messages before the first message of the run.
    pub(super) fn new(
        derived: Box<dyn DerivedTopics>,
        log: &mut LogWriter,
    ) -> Result<Self, LogWriteError> {
        let add = |channel: &DerivedChannel| {
            let latched = channel.latched.then(mcap_log::states::latched_entry);
            let id = log.add_channel(&ChannelSpec {
                topic: &channel.topic,
                schema_name: &channel.schema_name,
                schema_encoding: "ros2msg",
                schema: channel.schema.as_bytes(),
                message_encoding: "cdr",
                metadata: &latched.into_iter().collect(),
            })?;
            Ok(Channel { id, sequence: 0 })
        };
        let channels = derived.channels().iter().map(add);
        let channels = channels.collect::<Result<_, LogWriteError>>()?;
        let mut this = Self { derived, channels };
        this.write(log)?;
        Ok(this)
    }

    /// Passes an event of the run to the generator and writes its output.
    pub(super) fn update(
        &mut self,
        log: &mut LogWriter,
        update: impl FnOnce(&mut dyn DerivedTopics),
    ) -> Result<(), LogWriteError> {
        update(self.derived.as_mut());
        self.write(log)
    }

    fn write(&mut self, log: &mut LogWriter) -> Result<(), LogWriteError> {
        let ready = self.derived.ready();
        for message in ready.messages.drain(..) {
            let Some(channel) = self.channels.get_mut(message.channel) else {
                continue;
            };
            let sequence = channel.sequence;
            channel.sequence = channel.sequence.wrapping_add(1);
            let data = ready.bytes.get(message.bytes).unwrap_or_default();
            log.write(channel.id, sequence, message.time_ns, message.time_ns, data)?;
        }
        ready.bytes.clear();
        Ok(())
    }
}
