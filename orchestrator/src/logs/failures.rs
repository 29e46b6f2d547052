//! The processes that failed in the run of a log.

use std::path::Path;

use ipc_types::messages::process::ProcessEvent;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{ProcessEvents, Topic};
use serde::Serialize;
use zerocopy::FromBytes as _;

use super::error::LogsError;
use super::known::ENCAPSULATION;
use super::output::MANIFEST;
use super::reader::{Item, Reader};
use super::watch::Watch;

/// A process that left its run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Left {
    /// Its name.
    pub process: String,
    /// The first tick that it did not do.
    pub tick: u64,
    /// Why.
    pub reason: String,
}

/// Who of those with these names left the run first.
///
/// # Errors
/// [`LogsError`]: the log cannot be read.
pub(super) fn first_to_leave(
    log: &Path,
    concerns: impl Fn(&str) -> bool,
    watch: &mut Watch,
) -> Result<Option<Left>, LogsError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let (mut names, mut channel_id) = (Vec::new(), None);
    let mut first: Option<Left> = None;
    while let Some(item) = reader.next()? {
        match item {
            Item::Metadata(record) if record.name == MANIFEST => {
                let list = record.metadata.get("processes");
                names = list.map_or_else(Vec::new, |list| {
                    list.split(',').map(str::to_owned).collect()
                });
            }
            Item::Channel(channel) if channel.topic == ProcessEvents::NAME => {
                channel_id = Some(channel.id);
            }
            Item::Message(header, data) if Some(header.channel_id) == channel_id => {
                let body = data.get(ENCAPSULATION + size_of::<PlainHeader>()..);
                let Ok((event, _)) = ProcessEvent::read_from_prefix(body.unwrap_or_default())
                else {
                    continue;
                };
                let name = names.get(event.process as usize).cloned();
                let process = name.unwrap_or_else(|| format!("process {}", event.process));
                let is_first = first.as_ref().is_none_or(|first| event.tick < first.tick);
                if event.kind == ProcessEvent::LEFT && is_first && concerns(&process) {
                    first = Some(Left {
                        process,
                        tick: event.tick,
                        reason: event.reason_text(),
                    });
                }
            }
            _ => {}
        }
    }
    Ok(first)
}
