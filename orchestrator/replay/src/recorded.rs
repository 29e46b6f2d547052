//! The whole run in a log, for its repetition.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ipc_types::messages::process::ProcessEvent;
use ipc_types::messages::world::WorldHeader;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::TopicId;
use mcap_log::Condition;
use mcap_log::LogReadError;
use mcap_log::Origin;
use mcap_log::ReadProgress;
use mcap_log::known::{ENCAPSULATION, stamp};
use mcap_log::reader::{Item, Reader};
use serde::Serialize;
use zerocopy::FromBytes as _;

/// Exit of a process during its run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProcessExit {
    /// Name of the process.
    pub process: String,
    /// First tick that it did not complete.
    pub tick: u64,
    /// Reason.
    pub reason: String,
}

/// The run in a log.
#[derive(Debug, Default)]
pub(super) struct RecordedRun {
    pub(super) origin: Origin,
    /// `true` if the last state of the world is that of the end of the run.
    pub(super) over: bool,
    /// Condition of the file.
    pub(super) condition: Condition,
    /// Last tick of the log.
    pub(super) last_tick: u64,
    /// First relevant process that failed. The effects depend on the moment within its tick, which the log does not
    /// contain. A process that has done a tick may still owe an answer in it; the comparison therefore ends before
    /// the last tick that the process has done.
    pub(super) left: Option<ProcessExit>,
    /// Processes that failed, by name, with the first tick without each: the one after its last messages.
    pub(super) failures: BTreeMap<String, u64>,
}

impl RecordedRun {
    /// Reads a log to its end; `of_interest` selects the processes whose failures count, by name.
    ///
    /// # Errors
    /// [`LogReadError`] if the log is unreadable, not a Protean log, or from another version.
    pub(super) fn read(
        log: &Path,
        of_interest: impl Fn(&str) -> bool,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let mut recorded = Self::default();
        let mut reader = Reader::open(log, Some(watch))?;
        let mut topics = BTreeSet::new();
        let (mut states, mut events) = (None, None);
        // Channels with stamps, and the tick of the last message of each process.
        let (mut own, mut sent) = (BTreeSet::new(), BTreeMap::new());
        let (mut first_time_ns, mut last_time_ns) = (u64::MAX, 0);
        while let Some(item) = reader.next()? {
            match item {
                Item::Channel(channel) => {
                    recorded.origin.check_layout(log, &channel)?;
                    match TopicId::from_name(&channel.topic) {
                        Some(TopicId::WorldState) => states = Some(channel.id),
                        Some(TopicId::ProcessEvents) => events = Some(channel.id),
                        _ => {}
                    }
                    if TopicId::from_name(&channel.topic).is_some() {
                        own.insert(channel.id);
                    }
                    topics.insert(channel.topic.clone());
                }
                Item::Message(header, data) => {
                    let id = Some(header.channel_id);
                    first_time_ns = first_time_ns.min(header.log_time);
                    last_time_ns = last_time_ns.max(header.log_time);
                    let body = data.get(ENCAPSULATION..).unwrap_or_default();
                    if id == states {
                        recorded.over = WorldHeader::read_from_prefix(body)
                            .is_ok_and(|(state, _)| state.phase == WorldHeader::OVER);
                    } else if id == events {
                        recorded.note_failure(body, &of_interest);
                    }
                    if let Some(stamp) = stamp(data).filter(|_| own.contains(&header.channel_id)) {
                        sent.insert(stamp.source, stamp.tick);
                    }
                }
                other => recorded.origin.add(&other),
            }
        }
        let names = recorded.origin.manifest.get("processes");
        for (name, index) in names.map_or("", String::as_str).split(',').zip(0_u32..) {
            if let (Some(first), Some(last)) = (recorded.failures.get_mut(name), sent.get(&index)) {
                *first = (*first).max(last + 1);
            }
        }
        recorded.condition = reader.condition().clone();
        recorded.origin.check(log)?;
        recorded.last_tick = last_time_ns / recorded.tick_period_ns();
        // A version with fewer topics recorded fewer messages.
        if !topics.is_empty()
            && let Some(topic) = TopicId::all().find(|topic| {
                topic.is_built_in() && topic.facts().simulated && !topics.contains(topic.name())
            })
        {
            return Err(recorded.origin.layout(log, topic.name(), "none"));
        }
        if last_time_ns >= first_time_ns && first_time_ns > 0 {
            return Err(LogReadError::NotRepeatable {
                path: log.to_owned(),
                reason: "it does not begin with its run".to_owned(),
            });
        }
        Ok(recorded)
    }

    fn note_failure(&mut self, body: &[u8], of_interest: &impl Fn(&str) -> bool) {
        let event = body.get(size_of::<PlainHeader>()..).unwrap_or_default();
        let Ok((event, _)) = ProcessEvent::read_from_prefix(event) else {
            return;
        };
        if event.kind != ProcessEvent::LEFT {
            return;
        }
        let names = self.origin.manifest.get("processes");
        let mut names = names.map_or("", String::as_str).split(',');
        let name = names.nth(event.process as usize).map(str::to_owned);
        let process = name.unwrap_or_else(|| format!("process {}", event.process));
        self.failures.insert(process.clone(), event.tick);
        let is_earlier = self.left.as_ref().is_none_or(|left| event.tick < left.tick);
        if is_earlier && of_interest(&process) {
            self.left = Some(ProcessExit {
                process,
                tick: event.tick,
                reason: event.reason_text(),
            });
        }
    }

    /// Returns the log time up to which messages are compared (ns).
    pub(super) fn compared_before(&self) -> u64 {
        let left = self.left.as_ref();
        left.map_or(u64::MAX, |left| {
            let last_done = left.tick.saturating_sub(1);
            last_done.saturating_mul(self.tick_period_ns())
        })
    }

    /// Returns the last tick that a repetition needs.
    pub(super) fn last_needed(&self) -> u64 {
        let left = self.left.as_ref();
        left.map_or(self.last_tick, |left| left.tick.min(self.last_tick))
    }

    fn tick_period_ns(&self) -> u64 {
        let period = self.origin.manifest.get("tick_period_ns");
        let period = period.and_then(|text| text.parse().ok());
        period.filter(|period| *period > 0).unwrap_or(1)
    }

    /// Returns the version that recorded the log, if it differs from this one.
    pub(super) fn other_version(&self) -> Option<String> {
        let version = self.origin.manifest.get("version")?;
        (version != env!("CARGO_PKG_VERSION")).then(|| version.clone())
    }
}
