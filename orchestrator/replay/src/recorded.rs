//! What a log says of its run as a whole, for those who do it again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ipc_types::messages::process::ProcessEvent;
use ipc_types::messages::world::WorldHeader;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::TopicId;
use mcap_log::LogReadError;
use mcap_log::Origin;
use mcap_log::ReadProgress;
use mcap_log::known::ENCAPSULATION;
use mcap_log::output::{FILTERED, MANIFEST, RESULT};
use mcap_log::reader::{Item, Reader};
use serde::Serialize;
use zerocopy::FromBytes as _;

/// A process that left its run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ProcessExit {
    /// Its name.
    pub process: String,
    /// The first tick that it did not do.
    pub tick: u64,
    /// Why.
    pub reason: String,
}

/// The run in a log.
#[derive(Debug, Default)]
pub(super) struct Recorded {
    pub(super) origin: Origin,
    /// The log's own summary of it.
    pub(super) result: BTreeMap<String, String>,
    /// Whether the log was cut from another.
    pub(super) filtered: bool,
    /// Whether the last state of the world is that of its end.
    pub(super) over: bool,
    /// Whether nothing of the file's data is missing.
    pub(super) whole: bool,
    /// The first process of interest that failed. What came of it depends on when it happened within its
    /// tick, which no log says: from that tick on nothing is compared.
    pub(super) left: Option<ProcessExit>,
}

impl Recorded {
    /// Reads a log to its end; `of_interest` says whose failures count, by name.
    ///
    /// # Errors
    /// [`LogReadError`]: the log cannot be read, is none of ours, or one of another version.
    pub(super) fn read(
        log: &Path,
        of_interest: impl Fn(&str) -> bool,
        watch: &mut ReadProgress,
    ) -> Result<Self, LogReadError> {
        let mut recorded = Self::default();
        let mut reader = Reader::open(log, Some(watch))?;
        let mut topics = BTreeSet::new();
        let (mut states, mut events) = (None, None);
        while let Some(item) = reader.next()? {
            match item {
                Item::Metadata(record) => match record.name.as_str() {
                    MANIFEST => recorded.origin.manifest = record.metadata,
                    RESULT => recorded.result = record.metadata,
                    FILTERED => recorded.filtered = true,
                    _ => {}
                },
                Item::Attachment(header, data) if header.name == "scenario.toml" => {
                    recorded.origin.scenario = Some(data.to_vec());
                }
                Item::Channel(channel) => {
                    recorded.origin.check_layout(log, &channel)?;
                    match TopicId::from_name(&channel.topic) {
                        Some(TopicId::WorldState) => states = Some(channel.id),
                        Some(TopicId::ProcessEvents) => events = Some(channel.id),
                        _ => {}
                    }
                    topics.insert(channel.topic.clone());
                }
                Item::Message(header, data) => {
                    let id = Some(header.channel_id);
                    let body = data.get(ENCAPSULATION..).unwrap_or_default();
                    if id == states {
                        recorded.over = WorldHeader::read_from_prefix(body)
                            .is_ok_and(|(state, _)| state.phase == WorldHeader::OVER);
                    } else if id == events {
                        recorded.note_failure(body, &of_interest);
                    }
                }
                _ => {}
            }
        }
        recorded.whole = reader.condition().data;
        recorded.origin.check(log)?;
        // A version that knew fewer topics would have said less.
        if !recorded.filtered
            && !topics.is_empty()
            && let Some(topic) = TopicId::ALL
                .iter()
                .find(|topic| topic.facts().simulated && !topics.contains(topic.name()))
        {
            return Err(recorded.origin.layout(log, topic.name(), "none"));
        }
        Ok(recorded)
    }

    fn note_failure(&mut self, body: &[u8], of_interest: &impl Fn(&str) -> bool) {
        let event = body.get(size_of::<PlainHeader>()..).unwrap_or_default();
        let Ok((event, _)) = ProcessEvent::read_from_prefix(event) else {
            return;
        };
        let is_earlier = self.left.as_ref().is_none_or(|left| event.tick < left.tick);
        if event.kind != ProcessEvent::LEFT || !is_earlier {
            return;
        }
        let names = self.origin.manifest.get("processes");
        let mut names = names.map_or("", String::as_str).split(',');
        let name = names.nth(event.process as usize).map(str::to_owned);
        let process = name.unwrap_or_else(|| format!("process {}", event.process));
        if of_interest(&process) {
            self.left = Some(ProcessExit {
                process,
                tick: event.tick,
                reason: event.reason_text(),
            });
        }
    }

    /// Log time up to which it is compared (ns).
    pub(super) fn compared_before(&self) -> u64 {
        let period = self.origin.manifest.get("tick_period_ns");
        let period_ns: u64 = period.and_then(|text| text.parse().ok()).unwrap_or(1);
        let left = self.left.as_ref();
        left.map_or(u64::MAX, |left| left.tick.saturating_mul(period_ns))
    }

    /// The version that recorded it, if it is another than this.
    pub(super) fn other_version(&self) -> Option<String> {
        let version = self.origin.manifest.get("version");
        version
            .filter(|version| *version != env!("CARGO_PKG_VERSION"))
            .cloned()
    }
}
