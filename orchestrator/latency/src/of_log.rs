//! Latencies from the stamps in a log.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ipc_types::consumer::{Consumer as _, LoggedMessage};
use ipc_types::topics::{Commands, Status, Topic as _, TopicId, WorldState};
use mcap_log::Origin;
use mcap_log::reader::{Channel, Item, Reader};
use mcap_log::{Condition, LogReadError, ReadProgress, known};
use statistics::Distributions;

use super::error::LatencyError;
use recorder::RunInfo;
use recorder::chain::{Answers, Chain, Passage};

/// Number and size of the messages of one topic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Number of messages.
    pub messages: u64,
    /// Total size with headers (bytes).
    pub bytes: u64,
}

impl Sizes {
    /// Returns the mean size (bytes).
    pub fn mean(self) -> u64 {
        self.bytes / self.messages.max(1)
    }
}

/// Latencies of one run.
#[derive(Debug, Clone)]
pub struct RunLatencies {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: u64,
    /// Version of Protean that recorded it.
    pub version: String,
    /// Machine on which it ran.
    pub machine: String,
    /// `real_time` or `lock_step`.
    pub mode: String,
    /// Ticks per second of the scenario (Hz).
    pub rate_hz: f64,
    /// Wall-clock time between two ticks (ns); `None` in lock-step.
    pub period_ns: Option<u64>,
    /// Hops and steps by name.
    pub hops: Distributions,
    /// Parts of the steps of every kind of process, by name.
    pub turns: Distributions,
    /// Stages of sense-to-act by name, and their sum.
    pub stages: Distributions,
    /// Deviations of ticks from their times.
    pub period: Distributions,
    /// Counts of answered and missed ticks.
    pub answers: Answers,
    /// All ticks with complete stamps.
    pub passages: Vec<Passage>,
    /// Overruns by name of the process, of processes that report them.
    pub overruns: BTreeMap<String, u64>,
    /// Sizes of messages by topic.
    pub sizes: BTreeMap<String, Sizes>,
    /// Condition of the log.
    pub condition: Condition,
}

/// Reads a log.
///
/// # Errors
/// [`LatencyError`]: the log cannot be read, is not a Protean log of this version, or contains no
/// stamped or answered message.
pub fn of_log(log: &Path, watch: &mut ReadProgress) -> Result<RunLatencies, LatencyError> {
    let mut reader = Reader::open(log, Some(watch))?;
    let mut reading = Reading::default();
    while let Some(item) = reader.next()? {
        reading.item(log, item)?;
    }
    reader.check_all()?;
    let condition = reader.condition().clone();
    reading.finish(log, condition)
}

/// State of reading a log.
#[derive(Default)]
struct Reading {
    origin: Origin,
    run: Option<RunInfo>,
    chain: Option<Chain>,
    channels: BTreeMap<u16, TopicId>,
    topics: BTreeMap<u16, String>,
    sizes: BTreeMap<u16, Sizes>,
    overruns: BTreeMap<u32, u64>,
    stamped: u64,
}

impl Reading {
    fn item(&mut self, log: &Path, item: Item<'_>) -> Result<(), LatencyError> {
        match item {
            Item::Channel(channel) => self.channel(log, &channel)?,
            Item::Message(header, data) => {
                if self.chain.is_none() {
                    self.origin.check(log)?;
                    let lacks = || LatencyError::Lacks {
                        path: log.to_owned(),
                        what: "readable description of its run (run.json)",
                    };
                    let run = RunInfo::from_log(&self.origin).ok_or_else(lacks)?;
                    let chain = Chain::new(&run.processes).with_detail(run.wall_period_ns);
                    self.chain = Some(chain);
                    self.run = Some(run);
                }
                self.message(header.channel_id, header.log_time, data);
            }
            other => self.origin.add(&other),
        }
        Ok(())
    }

    fn channel(&mut self, log: &Path, channel: &Arc<Channel>) -> Result<(), LogReadError> {
        // A topic that a program has declared becomes known by its layout in the log.
        if let Some(topic) = known::topic_of(channel) {
            self.channels.insert(channel.id, topic);
        } else if TopicId::from_name(&channel.topic).is_none() {
            return Ok(());
        }
        self.origin.check_layout(log, channel)?;
        self.topics.insert(channel.id, channel.topic.clone());
        Ok(())
    }

    fn message(&mut self, channel: u16, time_ns: u64, data: &[u8]) {
        let Some(&topic) = self.channels.get(&channel) else {
            return;
        };
        let sizes = self.sizes.entry(channel).or_default();
        sizes.messages += 1;
        sizes.bytes += data.len().saturating_sub(known::ENCAPSULATION) as u64;
        let message = LoggedMessage::new(topic, time_ns, data);
        let (Some(chain), Some(message)) = (&mut self.chain, message) else {
            return;
        };
        if let Ok(Some((_, status))) = message.decode::<Status>()
            && let Some(status) = status.first()
        {
            let overruns = self.overruns.entry(status.process).or_default();
            *overruns = status.overruns.max(*overruns);
        }
        if message.stamp.sent_ns != 0 {
            self.stamped += u64::from(matches!(topic, TopicId::WorldState | TopicId::Commands));
        }
        if topic.facts().timed {
            chain.message(&message, &mut ());
        }
    }

    fn finish(mut self, log: &Path, condition: Condition) -> Result<RunLatencies, LatencyError> {
        self.origin.check(log)?;
        let of_topic = |name: &str| {
            let channels = self.topics.iter().filter(|(_, topic)| *topic == name);
            channels
                .filter_map(|(id, _)| self.sizes.get(id))
                .map(|sizes| sizes.messages)
                .sum::<u64>()
        };
        let lacks = |what: &'static str| LatencyError::Lacks {
            path: log.to_owned(),
            what,
        };
        if of_topic(WorldState::NAME) == 0 {
            return Err(lacks("states of the world (world/state)"));
        }
        if of_topic(Commands::NAME) == 0 {
            return Err(lacks("commands (robot/command)"));
        }
        let (Some(mut chain), Some(run)) = (self.chain.take(), &self.run) else {
            return Err(lacks(
                "description of its run before its messages (run.json)",
            ));
        };
        if self.stamped == 0 {
            return Err(lacks(
                "clock times in its stamps: runs in one process do not record them",
            ));
        }
        chain.settle();
        let detail = chain.detail.take().unwrap_or_default();
        let text = |key: &str| self.origin.manifest.get(key).cloned().unwrap_or_default();
        Ok(RunLatencies {
            scenario: text("scenario"),
            seed: text("seed").parse().unwrap_or_default(),
            version: text("version"),
            machine: text("machine"),
            mode: text("mode"),
            rate_hz: 1e9 / run.tick_period_ns as f64,
            period_ns: run.wall_period_ns,
            overruns: self
                .overruns
                .iter()
                .map(|(index, overruns)| (run.process_name(*index), *overruns))
                .collect(),
            sizes: self
                .topics
                .iter()
                .filter_map(|(id, topic)| Some((topic.clone(), *self.sizes.get(id)?)))
                .collect(),
            hops: chain.hops,
            stages: chain.stages,
            turns: detail.turns,
            period: detail.period,
            answers: detail.answers,
            passages: detail.passages,
            condition,
        })
    }
}
