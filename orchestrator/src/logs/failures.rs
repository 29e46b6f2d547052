//! The first process that failed in the run of a log.
//!
//! What came of a failure depends on when it happened within its tick, which no log says: what the log
//! holds from that tick on is not compared.

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

/// The earliest failure of a process whose name is `of_interest`.
///
/// # Errors
/// [`LogsError`]: the log cannot be read.
pub(super) fn first_failure(
    log: &Path,
    of_interest: impl Fn(&str) -> bool,
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
                let earlier = first.as_ref().is_none_or(|first| event.tick < first.tick);
                if event.kind != ProcessEvent::LEFT || !earlier {
                    continue;
                }
                let name = names.get(event.process as usize).cloned();
                let process = name.unwrap_or_else(|| format!("process {}", event.process));
                if of_interest(&process) {
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
