//! The processes that failed in the run of a log.

use std::collections::BTreeSet;
use std::path::Path;

use ipc_types::messages::process::ProcessEvent;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{ProcessEvents, Topic};
use serde::Serialize;
use zerocopy::FromBytes as _;

use super::error::LogsError;
use super::known::{self, ENCAPSULATION};
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

/// A failure of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Failure {
    pub(super) left: Left,
    /// Index of the process in the run.
    pub(super) index: u32,
    /// Whether the log says what was done about it: the process came back, failed again or was given
    /// up.
    pub(super) is_settled: bool,
    /// The first tick that it did again, if the log says that it came back.
    pub(super) back: Option<u64>,
    /// Whether it had said something in the tick that it did not do to its end.
    pub(super) had_spoken: bool,
}

/// Every failure, by tick.
///
/// # Errors
/// [`LogsError`]: the log cannot be read.
pub(super) fn failures(log: &Path, watch: &mut Watch) -> Result<Vec<Failure>, LogsError> {
    let mut found = events(log, watch)?;
    if !found.is_empty() {
        let spoken = speakers(log, &found, watch)?;
        for failure in &mut found {
            failure.had_spoken = spoken.contains(&(failure.index, failure.left.tick));
        }
        found.sort_by_key(|failure| failure.left.tick);
    }
    Ok(found)
}

fn events(log: &Path, watch: &mut Watch) -> Result<Vec<Failure>, LogsError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let (mut names, mut channel_id) = (Vec::new(), None);
    let mut found: Vec<Failure> = Vec::new();
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
                let mut before = found.iter_mut().filter(|f| f.index == event.process);
                if let Some(last) = before.next_back() {
                    last.is_settled = true;
                    if event.kind == ProcessEvent::BACK {
                        last.back = Some(event.tick);
                    }
                }
                if event.kind != ProcessEvent::LEFT {
                    continue;
                }
                let name = names.get(event.process as usize).cloned();
                found.push(Failure {
                    left: Left {
                        process: name.unwrap_or_else(|| format!("process {}", event.process)),
                        tick: event.tick,
                        reason: event.reason_text(),
                    },
                    index: event.process,
                    is_settled: false,
                    back: None,
                    had_spoken: false,
                });
            }
            _ => {}
        }
    }
    Ok(found)
}

/// Which of those who failed said something in the tick at which they did, by index and tick.
fn speakers(
    log: &Path,
    failures: &[Failure],
    watch: &mut Watch,
) -> Result<BTreeSet<(u32, u64)>, LogsError> {
    let wanted: BTreeSet<(u32, u64)> = failures.iter().map(|f| (f.index, f.left.tick)).collect();
    let mut reader = Reader::open(log, Some(watch))?;
    let (mut channels, mut spoken) = (BTreeSet::new(), BTreeSet::new());
    while let Some(item) = reader.next()? {
        match item {
            Item::Channel(channel) => {
                let is_history = known::find(&channel.topic).is_some_and(|known| known.simulated);
                if is_history && known::is_stamped(&channel) {
                    channels.insert(channel.id);
                }
            }
            Item::Message(header, data) if channels.contains(&header.channel_id) => {
                if let Some(stamp) = known::stamp(data) {
                    let said = (stamp.source, stamp.tick);
                    if wanted.contains(&said) {
                        spoken.insert(said);
                    }
                }
            }
            _ => {}
        }
    }
    Ok(spoken)
}
