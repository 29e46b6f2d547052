//! What a log holds and in what condition it is.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mcap_log::Condition;
use mcap_log::LogReadError;
use mcap_log::MessageHeader;
use mcap_log::ReadProgress;
use mcap_log::known;
use mcap_log::output::{FILTERED, MANIFEST, RECOVERED, RESULT, RUN_DIGEST};
use mcap_log::reader::{Channel, Item, Reader};
use serde::Serialize;

use recorder::RobotOutcome;

/// Most senders of one topic whose numbers are followed.
const MAX_SOURCES: usize = 4096;

/// What a log holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LogInfo {
    /// The file.
    pub log: PathBuf,
    /// Whether it is one of ours.
    pub ours: bool,
    /// What wrote it, as it says itself.
    pub library: String,
    /// Its profile.
    pub profile: String,
    /// The scenario; absent in logs of others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
    /// The seed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// `lock_step` or `real_time`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mode: Option<String>,
    /// The version that recorded it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// The machine that recorded it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine: Option<String>,
    /// Fingerprint of the simulated history in this log; absent if the run was killed, or the log
    /// does not hold all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Fingerprint of the run of which this log holds a part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_digest: Option<String>,
    /// Last tick of the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ticks: Option<u64>,
    /// What became of the robots; empty if the log does not say.
    pub robots: Vec<RobotOutcome>,
    /// How the log was cut from another; empty if it was not.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub filtered: BTreeMap<String, String>,
    /// How the log was repaired; empty if it was not.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub recovered: BTreeMap<String, String>,
    /// Least log time (s): simulated time in logs of ours, else usually since 1970.
    pub start_s: f64,
    /// Greatest log time (s).
    pub end_s: f64,
    /// The time between.
    pub duration_s: f64,
    /// Messages.
    pub messages: u64,
    /// Messages before which one with a later log time stands in the same channel.
    pub unsorted: u64,
    /// The topics, by name.
    pub topics: BTreeMap<String, TopicInfo>,
    /// Names and sizes (bytes) of the attachments.
    pub attachments: Vec<(String, u64)>,
    /// Names of the metadata records.
    pub metadata: Vec<String>,
    /// In what condition the file is.
    pub condition: Condition,
}

/// What a log holds of a topic.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TopicInfo {
    /// Name of its schema; empty for none.
    pub schema: String,
    /// How its messages are encoded.
    pub encoding: String,
    /// Messages.
    pub messages: u64,
    /// Their bytes.
    pub bytes: u64,
    /// First log time (s); absent without messages, as are the next three.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_s: Option<f64>,
    /// Last log time (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_s: Option<f64>,
    /// Messages per second between these; absent if they are the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Longest time between two messages (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_pause_s: Option<f64>,
    /// Messages that are missing by the numbers of their senders; absent if they are not numbered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<u64>,
    /// The same by sender; only those that miss some.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub gaps_by_source: BTreeMap<u32, u64>,
}

/// What is known of a channel so far.
#[derive(Debug, Default)]
struct ChannelStats {
    info: TopicInfo,
    stamped: bool,
    first: u64,
    last: u64,
    pause: u64,
    unsorted: u64,
    /// The next number that each sender should use.
    next: BTreeMap<u32, u64>,
    /// The first number of each sender, if it is not 0.
    begins: BTreeMap<u32, u64>,
    /// Whether any number is not 0.
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
        // A log of somebody else, or a part of one, may begin with any number.
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

    /// Of a log from the beginning of the run on, or of a part.
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
    /// Reads a log from its beginning to its end and checks every checksum in it.
    ///
    /// # Errors
    /// [`LogReadError`] if it cannot be read or is not an MCAP file. Whatever else is wrong with it is
    /// in [`LogInfo::condition`].
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
        let whole = !records.contains_key(FILTERED);
        let mut topics: BTreeMap<String, TopicInfo> = BTreeMap::new();
        for (id, topic) in channels {
            if let Some(tally) = tallies.remove(&id) {
                // Other tools write several channels with one topic.
                let name = if topics.contains_key(&topic) {
                    format!("{topic} (channel {id})")
                } else {
                    topic
                };
                topics.insert(name, tally.finish(whole));
            }
        }
        let mut record = |name: &str| records.remove(name).unwrap_or_default();
        let (mut manifest, mut result) = (record(MANIFEST), record(RESULT));
        let robots = result.remove("robots");
        Ok(Self {
            log: path.to_owned(),
            ours: !manifest.is_empty(),
            library,
            profile,
            scenario: manifest.remove("scenario"),
            seed: manifest.remove("seed").and_then(|seed| seed.parse().ok()),
            mode: manifest.remove("mode"),
            version: manifest.remove("version"),
            machine: manifest.remove("machine"),
            digest: result.remove("digest"),
            run_digest: result.remove(RUN_DIGEST),
            ticks: result.remove("ticks").and_then(|ticks| ticks.parse().ok()),
            robots: robots
                .and_then(|text| serde_json::from_str(&text).ok())
                .unwrap_or_default(),
            filtered: record(FILTERED),
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

/// What the records of a log hold, in the order of the log.
#[derive(Default)]
struct Contents {
    profile: String,
    library: String,
    tallies: BTreeMap<u16, ChannelStats>,
    /// Our metadata, by name.
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
                    if [MANIFEST, RESULT, FILTERED, RECOVERED].contains(&record.name.as_str()) {
                        contents.records.insert(record.name, record.metadata);
                    }
                }
                Item::Schema(..) => {}
                Item::Channel(channel) => {
                    let schema = reader.schema(channel.schema_id);
                    let schema = schema.map(|s| s.name.clone()).unwrap_or_default();
                    let tally = new_tally(&channel, schema);
                    contents.tallies.insert(channel.id, tally);
                }
            }
        }
        Ok(contents)
    }
}

fn new_tally(channel: &Channel, schema: String) -> ChannelStats {
    ChannelStats {
        stamped: known::topic_of(channel).is_some(),
        info: TopicInfo {
            schema,
            encoding: channel.message_encoding.clone(),
            ..TopicInfo::default()
        },
        ..ChannelStats::default()
    }
}
