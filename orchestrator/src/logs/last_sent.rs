//! How far a log reaches on the clock of the machine that wrote it.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::LogsError;
use super::known;
use super::reader::{Item, Reader};
use super::watch::Watch;

/// When the last message of a log was sent, by the monotonic clock of its machine [ns]; `None` if
/// nothing in it says so.
///
/// # Errors
/// [`LogsError`] if the log cannot be read at all; damaged ones are read as far as they go.
pub fn last_sent(log: &Path, watch: &mut Watch) -> Result<Option<u64>, LogsError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let mut stamped: BTreeMap<u16, bool> = BTreeMap::new();
    let mut last = None;
    while let Some(item) = reader.next()? {
        match item {
            Item::Channel(channel) => {
                stamped.insert(channel.id, known::is_stamped(&channel));
            }
            Item::Message(header, data) if stamped.get(&header.channel_id) == Some(&true) => {
                last = last.max(known::stamp(data).map(|stamp| stamp.sent_ns));
            }
            _ => {}
        }
    }
    Ok(last)
}
