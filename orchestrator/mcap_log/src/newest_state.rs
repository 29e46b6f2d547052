//! Newest world state of a log.

use std::collections::BTreeSet;
use std::path::Path;

use ipc_types::topics::TopicId;

use super::known;
use super::reader::{Item, Reader};
use crate::LogReadError;
use crate::ReadProgress;

/// Returns the tick of the newest world state in a log; `None` if there is none.
///
/// # Errors
/// [`LogReadError`] if the log cannot be read at all; a damaged log is read as far as possible.
pub fn newest_state(
    log: &Path,
    read_progress: &mut ReadProgress,
) -> Result<Option<u64>, LogReadError> {
    let mut reader = Reader::open(log, Some(read_progress))?;
    let mut states: BTreeSet<u16> = BTreeSet::new();
    let mut newest = None;
    while let Some(item) = reader.next()? {
        match item {
            Item::Channel(channel) if known::topic_of(&channel) == Some(TopicId::WorldState) => {
                states.insert(channel.id);
            }
            Item::Message(header, data) if states.contains(&header.channel_id) => {
                newest = newest.max(known::stamp(data).map(|stamp| stamp.tick));
            }
            _ => {}
        }
    }
    Ok(newest)
}
