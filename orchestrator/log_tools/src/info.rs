//! Contents and condition of a log.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mcap_log::Condition;
use mcap_log::LogReadError;
use mcap_log::MessageHeader;
use mcap_log::ReadProgress;
use mcap_log::known;
use mcap_log::output::{MANIFEST, RECOVERED, RESULT, RUN_DIGEST};
use mcap_log::reader::{Channel, Item, Reader};
use serde::Serialize;

use recorder::{MessageCounts, RobotOutcome};

/// Maximum number of senders of a topic whose sequence numbers are checked.
const MAX_SOURCES: usize = 4096;

/// Contents and condition of a log.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogInfo {
    /// Path of the file.
    pub log: PathBuf,
    /// `true` if it is a Protean log.
    pub ours: bool,
    /// Library that wrote it, as stated in the file.
    pub library: String,
    /// MCAP profile.
    pub profile: String,
    /// Name of the scenario; absent in other logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
    /// Seed of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// `lock_step` or `real_time`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mode: Option<String>,
    /// Version that recorded it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Machine that recorded it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<String>,
    /// Branches of the run: parent, moment and change of each; empty for a run without.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub branches: Vec<serde_json::Value>,
    /// Digest of the simulated history in this log; absent if the run was killed or the log does not contain the whole
    /// history.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Digest of the run, if messages of it were lost before a repair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_digest: Option<String>,
    /// Last tick of the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ticks: Option<u64>,
    /// Outcomes of the robots; empty if the log does not contain them.
    pub robots: Vec<RobotOutcome>,
    /// Record of the repair; empty if the log was not repaired.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub recovered: BTreeMap<String, String>,
    /// Minimum log time (s): simulated time in Protean logs, else usually since 1970.
    pub start_s: f64,
    /// Maximum log time (s).
    pub end_s: f64,
    /// Time between them (s).
    pub duration_s: f64,
    /// Number of messages.
    pub messages: u64,
    /// Number of messages of the simulated history; absent in other logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated_messages: Option<u64>,
    /// Number of messages that follow one with a later log time in the same channel.
    pub unsorted: u64,
    /// The topics, by name.
    pub topics: BTreeMap<String, TopicInfo>,
    /// Names and sizes of the attachments (bytes).
    pub attachments: Vec<(String, u64)>,
    /// Names of the metadata records.
    pub metadata: Vec<String>,
    /// Condition of the file.
    pub condition: Condition,
}

/// Contents of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicInfo {
    /// Id of its channel.
    #[serde(skip)]
    pub channel: u16,
    /// Name of its schema; empty without a schema.
    pub schema: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Number of messages.
    pub messages: u64,
    /// Size of the messages (bytes).
    pub bytes: u64,
    /// First log time (s); absent without messages, as are the next three fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_s: Option<f64>,
    /// Last log time (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_s: Option<f64>,
    /// Messages per second between these times; absent if they are equal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Maximum time between two messages (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_pause_s: Option<f64>,
    /// Number of messages missing by their sequence numbers; absent if they have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<u64>,
    /// Missing messages by sender, for senders that miss some.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub gaps_by_source: BTreeMap<u32, u64>,
}

/// Statistics of a channel so far.
#[derive(Debug, Default)]
struct ChannelStats {
    info: TopicInfo,
    stamped: bool,
    first: u64,
    last: u64,
    pause: u64,
    unsorted: u64,
    /// Next expected sequence number of each sender.
    next: BTreeMap<u32, u64>,
    /// First sequence number of each sender, if it is not 0.
    begins: BTreeMap<u32, u64>,
    /// `true` if some sequence number is not 0.
    numbered: bool,
}

impl ChannelStats {
    fn take(&mut self, header: &MessageHeader, data: &[u8]) {
        let info = &mut self.info;
        let time = header.log_time;
        if info.messages == 0 {
            (self.first, self.last) = (time, time);
        }
        if time < self.last {
            self.unsorted += 1;
        }
        self.pause = self.pause.max(time.saturating_sub(self.last));
        (self.first, self.last) = (self.first.min(time), self.last.max(time));
        info.messages += 1;
        info.bytes += data.len() as u64;
        let (source, sequence) = match known::stamp(data).filter(|_| self.stamped) {
            Some(stamp) => (stamp.source, stamp.sequence),
            None => (0, u64::from(header.sequence)),
        };
        self.numbered |= sequence != 0 || self.stamped;
        let full = self.next.len() >= MAX_SOURCES;
        // Another program's log, or a part of a log, may begin with any number.
        let next = match self.next.get_mut(&source) {
            Some(next) => next,
            None if full => return,
            None => {
                if sequence > 0 {
                    self.begins.insert(source, sequence);
                }
                self.next.entry(source).or_insert(sequence)
            }
        };
        let missing = sequence.saturating_sub(*next);
        *next = sequence.saturating_add(1);
        if missing > 0 {
            let of_source = info.gaps_by_source.entry(source).or_insert(0);
            *of_source = of_source.saturating_add(missing);
        }
    }

    /// Completes the statistics; `from_the_beginning` is `true` for a log that starts with its run.
    fn finish(mut self, from_the_beginning: bool) -> TopicInfo {
        let info = &mut self.info;
        if from_the_beginning && self.stamped {
            for (source, missing) in self.begins {
                let of_source = info.gaps_by_source.entry(source).or_insert(0);
                *of_source = of_source.saturating_add(missing);
            }
        }
        let span = mcap_log::seconds(self.last - self.first);
        if info.messages > 0 {
            info.first_s = Some(mcap_log::seconds(self.first));
            info.last_s = Some(mcap_log::seconds(self.last));
            info.longest_pause_s = Some(mcap_log::seconds(self.pause));
        }
        if span > 0.0 {
            info.rate_hz = Some((info.messages - 1) as f64 / span);
        }
        if self.numbered {
            let sum = info.gaps_by_source.values();
            info.gaps = Some(sum.fold(0, |sum: u64, gaps| sum.saturating_add(*gaps)));
        } else {
            info.gaps_by_source.clear();
        }
        self.info
    }
}

impl LogInfo {
    /// Reads a log to its end and verifies every checksum.
    ///
    /// # Errors
    /// [`LogReadError`] if it is unreadable or not an MCAP file. All other faults are in [`LogInfo::condition`].
    pub fn read(path: &Path, watch: &mut ReadProgress) -> Result<Self, LogReadError> {
        let mut reader = Reader::open(path, Some(watch))?;
        let Contents {
            profile,
            library,
            mut tallies,
            mut records,
            metadata,
            attachments,
        } = Contents::read(&mut reader)?;
        reader.check_all()?;
        let channels: Vec<(u16, String)> = reader
            .channels()
            .map(|channel| (channel.id, channel.topic.clone()))
            .collect();
        let condition = reader.condition().clone();
        let with = tallies.values().filter(|tally| tally.info.messages > 0);
        let first = with.clone().map(|t| t.first).min().unwrap_or(0);
        let last = with.map(|t| t.last).max().unwrap_or(0);
        let messages = tallies.values().map(|t| t.info.messages).sum();
        let unsorted = tallies.values().map(|t| t.unsorted).sum();
        let mut topics: BTreeMap<String, TopicInfo> = BTreeMap::new();
        for (id, topic) in channels {
            if let Some(tally) = tallies.remove(&id) {
                // Other programs write several channels with one topic.
                let name = if topics.contains_key(&topic) {
                    format!("{topic} (channel {id})")
                } else {
                    topic
                };
                topics.insert(name, tally.finish(first == 0));
            }
        }
        let mut record = |name: &str| records.remove(name).unwrap_or_default();
        let (mut manifest, mut result) = (record(MANIFEST), record(RESULT));
        let robots = result.remove("robots");
        let counts = MessageCounts::from_topics(&topics, |topic| topic.messages);
        Ok(Self {
            log: path.to_owned(),
            simulated_messages: (!manifest.is_empty()).then_some(counts.simulated),
            ours: !manifest.is_empty(),
            library,
            profile,
            scenario: manifest.remove("scenario"),
            seed: manifest.remove("seed").and_then(|seed| seed.parse().ok()),
            branches: manifest
                .remove(mcap_log::Origin::BRANCHES)
                .and_then(|text| serde_json::from_str(&text).ok())
                .unwrap_or_default(),
            mode: manifest.remove("mode"),
            version: manifest.remove("version"),
            machine: manifest.remove("machine"),
            digest: result.remove("digest"),
            run_digest: result.remove(RUN_DIGEST),
            ticks: result.remove("ticks").and_then(|ticks| ticks.parse().ok()),
            robots: robots
                .and_then(|text| serde_json::from_str(&text).ok())
                .unwrap_or_default(),
            recovered: record(RECOVERED),
            start_s: mcap_log::seconds(first),
            end_s: mcap_log::seconds(last),
            duration_s: mcap_log::seconds(last - first),
            messages,
            unsorted,
            topics,
            attachments,
            metadata,
            condition,
        })
    }
}

/// Contents of the records of a log, in the order of the log.
#[derive(Default)]
struct Contents {
    profile: String,
    library: String,
    tallies: BTreeMap<u16, ChannelStats>,
    /// Protean's metadata records, by name.
    records: BTreeMap<String, BTreeMap<String, String>>,
    /// Names of all metadata.
    metadata: Vec<String>,
    /// Names of the attachments, and their sizes (bytes).
    attachments: Vec<(String, u64)>,
}

impl Contents {
    fn read(reader: &mut Reader<'_>) -> Result<Self, LogReadError> {
        let mut contents = Self::default();
        while let Some(item) = reader.next()? {
            match item {
                Item::Header { profile, library } => {
                    (contents.profile, contents.library) = (profile, library);
                }
                Item::Message(header, data) => {
                    if let Some(tally) = contents.tallies.get_mut(&header.channel_id) {
                        tally.take(&header, data);
                    }
                }
                Item::Attachment(header, data) => {
                    contents.attachments.push((header.name, data.len() as u64));
                }
                Item::Metadata(record) => {
                    contents.metadata.push(record.name.clone());
                    if [MANIFEST, RESULT, RECOVERED].contains(&record.name.as_str()) {
                        contents.records.insert(record.name, record.metadata);
                    }
                }
                Item::Schema(..) => {}
                Item::Channel(channel) => {
                    let schema = reader.schema(channel.schema_id);
                    let schema = schema.map(|s| s.name.clone()).unwrap_or_default();
                    let tally = new_stats(&channel, schema);
                    contents.tallies.insert(channel.id, tally);
                }
            }
        }
        Ok(contents)
    }
}

fn new_stats(channel: &Channel, schema: String) -> ChannelStats {
    ChannelStats {
        stamped: known::topic_of(channel).is_some(),
        info: TopicInfo {
            channel: channel.id,
            schema,
            encoding: channel.message_encoding.clone(),
            ..TopicInfo::default()
        },
        ..ChannelStats::default()
    }
}
