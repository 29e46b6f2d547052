//! Events of a run, from its log.

use std::path::Path;

use ipc_types::consumer::{EVENTS, LoggedMessage};
use ipc_types::event_names::EventNames;
use ipc_types::topics::TopicId;
use mcap_log::known;
use mcap_log::reader::{Item, Reader};
use mcap_log::{LogReadError, Origin, ReadProgress};
use recorder::{EventEntry, RunInfo};

use super::topic_table::RobotNames;

/// Returns the events of a run in the order of its log. A truncated or damaged log is read as far as possible. Obstacles
/// have names if the log describes its run.
///
/// # Errors
/// [`LogReadError`]: the log cannot be read, or its events have the layout of another version.
pub fn events(log: &Path, watch: &mut ReadProgress) -> Result<Vec<EventEntry>, LogReadError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let mut robots = RobotNames::default();
    let mut origin = Origin::default();
    let mut channels: Vec<(u16, TopicId)> = Vec::new();
    let mut found = Vec::new();
    while let Some(item) = reader.next()? {
        match item {
            Item::Channel(next) => {
                robots.channel(&next, reader.schema(next.schema_id).as_deref());
                let topic = EVENTS.into_iter().find(|topic| next.topic == topic.name());
                if let Some(topic) = topic {
                    known::check_layout(log, &next, origin.version())?;
                    channels.push((next.id, topic));
                }
            }
            Item::Message(header, data) => {
                robots.message(&header, data);
                let known = channels.iter().find(|(id, _)| *id == header.channel_id);
                if let Some((_, topic)) = known
                    && let Some(message) = LoggedMessage::new(*topic, header.log_time, data)
                {
                    let events = message.events();
                    found.extend(events.map(|event| (message.time_s(), event)));
                }
            }
            other => origin.add(&other),
        }
    }
    let names = EventNames {
        robots: robots.names,
        obstacles: RunInfo::from_log(&origin).unwrap_or_default().obstacles,
    };
    let entries = found
        .iter()
        .map(|(time_s, event)| EventEntry::new(*time_s, event, &names));
    Ok(entries.collect())
}
