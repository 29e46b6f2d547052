//! Latched messages: the last message of every latched topic before a time.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::topics::TopicId;
use mcap::records::MessageHeader;

use crate::LogReadError;

/// Maximum number of kept messages.
const MAX_STATES: usize = 4096;
/// Maximum size of kept messages (bytes).
const MAX_STATE_BYTES: usize = 512 << 20;

/// The last latched message of every channel and sender.
#[derive(Default)]
pub struct States {
    last: BTreeMap<(u16, u32), (MessageHeader, Vec<u8>)>,
    bytes: usize,
}

impl States {
    /// Keeps a message in place of the previous one.
    ///
    /// # Errors
    /// The kept messages exceed the limits: [`LogReadError`].
    pub fn keep(
        &mut self,
        path: &Path,
        source: u32,
        header: MessageHeader,
        data: &[u8],
    ) -> Result<(), LogReadError> {
        let key = (header.channel_id, source);
        if !self.last.contains_key(&key) && self.last.len() >= MAX_STATES {
            return Ok(());
        }
        self.bytes += data.len();
        if let Some((_, old)) = self.last.insert(key, (header, data.to_vec())) {
            self.bytes -= old.len();
        }
        if self.bytes > MAX_STATE_BYTES {
            return Err(LogReadError::TooLarge {
                path: path.to_owned(),
                what: "the states at the start",
                limit: MAX_STATE_BYTES,
            });
        }
        Ok(())
    }

    /// Adds the messages of `older` whose channel and sender have none here.
    ///
    /// # Errors
    /// The kept messages exceed the limits: [`LogReadError`].
    pub fn fill_from(&mut self, path: &Path, older: Self) -> Result<(), LogReadError> {
        for ((channel, source), (header, data)) in older.last {
            if !self.last.contains_key(&(channel, source)) {
                self.keep(path, source, header, &data)?;
            }
        }
        Ok(())
    }

    /// Removes and returns all messages, in their original order.
    pub fn take(&mut self) -> Vec<(MessageHeader, Vec<u8>)> {
        self.bytes = 0;
        let mut last: Vec<_> = core::mem::take(&mut self.last).into_values().collect();
        last.sort_by_key(|(header, _)| (header.log_time, header.channel_id));
        last
    }
}

/// Key of the quality of service in the metadata of a channel, as in ROS 2 bags.
const QOS: &str = "offered_qos_profiles";

/// Returns the metadata entry of a latched channel: the quality of service of transient-local topics.
pub fn latched_entry() -> (String, String) {
    let infinite = "{sec: 9223372036, nsec: 854775807}";
    let profile = format!(
        "- {{history: 1, depth: 1, reliability: 1, durability: 1, deadline: {infinite}, lifespan: {infinite}, \
         liveliness: 1, liveliness_lease_duration: {infinite}, avoid_ros_namespace_conventions: false}}\n"
    );
    (QOS.to_owned(), profile)
}

/// Returns `true` for a latched channel: project topics with history, and transient-local topics of ROS 2.
pub fn is_latched(topic: &str, metadata: &BTreeMap<String, String>) -> bool {
    if let Some(topic) = TopicId::from_name(topic) {
        return topic.facts().latched;
    }
    let qos = metadata.get(QOS);
    qos.is_some_and(|qos| qos.contains("durability: 1") || qos.contains("transient_local"))
}
