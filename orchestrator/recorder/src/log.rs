//! Log of a run: topics and derived channels.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use ipc_types::consumer::LoggedMessage;
use ipc_types::layout::TopicLayout;
use ipc_types::schema;
use ipc_types::topics::TopicId;
use mcap_log::{ChannelId, ChannelSpec, LogWriteError, LogWriter};

use super::derived::{DerivedLog, DerivedTopics};
use super::robot_names;
use super::run_info::RobotInfo;
use super::summary::{Summary, TopicCount};

/// Writer of messages in the order of arrival.
pub(super) struct Log {
    writer: LogWriter,
    /// Channels by rank of their topic.
    channels: Vec<ChannelId>,
    derived: Option<DerivedLog>,
    /// Time of the current tick (simulated ns).
    time_ns: u64,
}

impl Log {
    /// Adds all channels to an empty log.
    pub(super) fn new(
        mut writer: LogWriter,
        robots: &[RobotInfo],
        derived: Option<Box<dyn DerivedTopics>>,
    ) -> Result<Self, LogWriteError> {
        let channel = |topic: TopicId| {
            writer.add_channel(&ChannelSpec {
                topic: topic.name(),
                schema_name: &schema::message_name(topic),
                schema_encoding: "ros2msg",
                schema: schema::ros2msg(topic).as_bytes(),
                message_encoding: "cdr",
                metadata: &metadata(topic),
            })
        };
        let channels = TopicId::all().map(channel).collect::<Result<_, _>>()?;
        robot_names::write(robots, &mut writer)?;
        let derived = derived
            .map(|derived| DerivedLog::new(derived, &mut writer))
            .transpose()?;
        // No flush here: a chunk with only schemas and channels has no message index, and Foxglove Studio
        // does not open files with such a chunk.
        Ok(Self {
            writer,
            channels,
            derived,
            time_ns: 0,
        })
    }

    /// Writes a message, and the messages derived from it if it passed the checks.
    pub(super) fn message(
        &mut self,
        message: &LoggedMessage<'_>,
        rejected: bool,
    ) -> Result<(), LogWriteError> {
        if message.time_ns != self.time_ns {
            self.end_of_tick()?;
            self.time_ns = message.time_ns;
        }
        let Some(channel) = self.channels.get(message.topic.rank()) else {
            return Ok(());
        };
        let stamp = &message.stamp;
        // MCAP sequence numbers have 32 bits; the stamp contains all 64.
        let sequence = stamp.sequence as u32;
        self.writer.write(
            *channel,
            sequence,
            message.time_ns,
            stamp.time_ns,
            message.bytes,
        )?;
        match &mut self.derived {
            Some(derived) if !rejected => derived.update(&mut self.writer, |derived| {
                if derived.topics().contains(&message.topic) {
                    derived.message(message, &mut ());
                }
            }),
            _ => Ok(()),
        }
    }

    /// Ends the current tick after its last message.
    pub(super) fn end_of_tick(&mut self) -> Result<(), LogWriteError> {
        match &mut self.derived {
            Some(derived) => derived.update(&mut self.writer, |d| d.end_of_tick(&mut ())),
            None => Ok(()),
        }
    }

    /// Returns the maximum age of messages that are not written.
    pub(super) fn flush_every(&self) -> Duration {
        self.writer.flush_every()
    }

    pub(super) fn flush_if_due(&mut self) -> Result<(), LogWriteError> {
        self.writer.flush_if_due()
    }

    /// Returns the path of the file.
    pub(super) fn path(&self) -> &Path {
        self.writer.path()
    }

    /// Writes the result of the run, closes the file, and enters its totals into the summary.
    pub(super) fn finish(mut self, summary: &mut Summary) -> Result<(), LogWriteError> {
        self.end_of_tick()?;
        if let Some(derived) = &mut self.derived {
            derived.update(&mut self.writer, |derived| derived.finish())?;
        }
        self.writer
            .metadata("protean.result", result_entries(summary))?;
        self.writer.path().clone_into(&mut summary.log);
        let totals = self.writer.finish()?;
        summary.log_bytes = totals.file_bytes;
        for channel in totals.channels.into_iter().skip(self.channels.len()) {
            if channel.messages > 0 {
                let count = TopicCount {
                    messages: channel.messages,
                    bytes: channel.bytes,
                    ..TopicCount::default()
                };
                summary.topics.insert(channel.topic, count);
            }
        }
        Ok(())
    }
}

/// Returns size, alignment and layout hash of a topic's messages, so that a replay can refuse a mismatch.
fn metadata(topic: TopicId) -> BTreeMap<String, String> {
    let facts = topic.facts();
    let (header, element) = (&facts.header, &facts.element);
    [
        ("schema_hash", schema::hash_of(topic)),
        ("header_type", header.name.to_owned()),
        ("header_bytes", header.size.to_string()),
        ("element_type", element.name.to_owned()),
        ("element_bytes", element.size.to_string()),
        ("element_align", element.align.to_string()),
        ("simulated", facts.simulated.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into_iter()
    .chain(facts.latched.then(mcap_log::states::latched_entry))
    // Programs that do not know the topic learn it from the log.
    .chain(
        (!topic.is_built_in())
            .then(|| TopicLayout::for_topic(topic).entries())
            .into_iter()
            .flatten(),
    )
    .collect()
}

/// Returns the result of a run for the last metadata record of its log.
fn result_entries(summary: &Summary) -> BTreeMap<String, String> {
    // These structures have string keys and finite numbers only; an encoding error would omit the entry and
    // keep the log.
    let json = |result: serde_json::Result<String>| result.unwrap_or_default();
    let coverage = summary
        .coverage
        .as_ref()
        .map(|c| ("coverage", json(serde_json::to_string(c))));
    let predictions = summary
        .predictions
        .as_ref()
        .map(|p| ("predictions", json(serde_json::to_string(p))));
    let attacks = (!summary.attacks.is_empty())
        .then(|| ("attacks", json(serde_json::to_string(&summary.attacks))));
    let failed = (!summary.processes.is_empty())
        .then(|| ("processes", json(serde_json::to_string(&summary.processes))));
    let links =
        (!summary.links.is_empty()).then(|| ("links", json(serde_json::to_string(&summary.links))));
    [
        ("digest", summary.digest.clone()),
        ("ticks", summary.ticks.to_string()),
        ("sim_time_s", summary.sim_time_s.to_string()),
        ("robots", json(serde_json::to_string(&summary.robots))),
        (
            "latency_us",
            json(serde_json::to_string(&summary.latency_us)),
        ),
    ]
    .into_iter()
    .chain(coverage)
    .chain(predictions)
    .chain(attacks)
    .chain(failed)
    .chain(links)
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}
