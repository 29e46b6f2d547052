//! What lasts: the last message of every topic that describes a state, before some time.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::topics::TopicId;
use mcap::records::MessageHeader;

use crate::LogReadError;

/// Most states that are kept.
const MAX_STATES: usize = 4096;
/// Most bytes that they may take.
const STATES_LIMIT: usize = 512 << 20;

/// The newest state of every channel and sender.
#[derive(Default)]
pub struct States {
    last: BTreeMap<(u16, u32), (MessageHeader, Vec<u8>)>,
    bytes: usize,
}

impl States {
    /// Keeps a message in place of the one before it.
    ///
    /// # Errors
    /// What is kept exceeds the memory that a log may take: [`LogReadError`].
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
        if self.bytes > STATES_LIMIT {
            return Err(LogReadError::TooLarge {
                path: path.to_owned(),
                what: "the states at the start",
                limit: STATES_LIMIT,
            });
        }
        Ok(())
    }

    /// Adds those of `older` whose channel and sender have none here.
    ///
    /// # Errors
    /// What is kept exceeds the memory that a log may take: [`LogReadError`].
    pub fn fill_from(&mut self, path: &Path, older: Self) -> Result<(), LogReadError> {
        for ((channel, source), (header, data)) in older.last {
            if !self.last.contains_key(&(channel, source)) {
                self.keep(path, source, header, &data)?;
            }
        }
        Ok(())
    }

    /// The channels that have a state.
    pub fn channels(&self) -> impl Iterator<Item = u16> + '_ {
        self.last.keys().map(|(channel, _)| *channel)
    }

    /// Hands out all of them, in the order in which they were; none are left.
    pub fn take(&mut self) -> Vec<(MessageHeader, Vec<u8>)> {
        self.bytes = 0;
        let mut last: Vec<_> = core::mem::take(&mut self.last).into_values().collect();
        last.sort_by_key(|(header, _)| (header.log_time, header.channel_id));
        last
    }
}

/// Whether the last message of a channel still holds until the next: our topics that late joiners
/// get, what our viewers are shown, and what ROS 2 calls transient local.
pub fn is_latched(topic: &str, metadata: &BTreeMap<String, String>) -> bool {
    if let Some(topic) = TopicId::from_name(topic) {
        return topic.facts().latched;
    }
    if let Some(view) = topic.strip_prefix("/viewer/") {
        // Every message but a line of the log is a whole picture.
        return view != "log";
    }
    let qos = metadata.get("offered_qos_profiles");
    qos.is_some_and(|qos| qos.contains("durability: 1") || qos.contains("transient_local"))
}
