//! Where ordered messages go: the log, the latencies, the viewers, the outcome, the observer.

use std::collections::BTreeMap;

use ipc_types::messages::world::RobotState;
use ipc_types::topics::{
    Belief, Coverage, Dominance, ObstacleEvents, Plan, Predictions, ProcessEvents, ProcessLog,
    Scan, Sightings, Status, Tree, Verdicts, Waypoints, WorldEvents, WorldMap, WorldState,
};

use super::error::LogError;
use super::gate::Observer;
use super::intake::Entry;
use super::latency::Latency;
use super::ledger::Ledger;
use super::log_writer::{ChannelId, ChannelSpec, LogWriter};
use super::mirror::Mirror;
use super::options::RecorderOptions;
use super::summary::{Outcome, Summary, TopicCount, seconds};
use super::topic_info::{self, Role, TopicInfo, view};
use super::viewer::Viewer;

/// A topic with its channel.
#[derive(Debug)]
struct TopicChannel {
    info: &'static TopicInfo,
    channel: ChannelId,
}

/// Takes messages in the order of the log.
pub(super) struct Sink {
    log: LogWriter,
    topics: Vec<TopicChannel>,
    viewer: Option<Viewer>,
    latency: Latency,
    outcome: Outcome,
    tick: u64,
    tick_period_ns: u64,
    /// Scratch.
    robots: Vec<RobotState>,
}

impl Sink {
    pub(super) fn create(
        options: &RecorderOptions,
        mirror: &mut Option<Box<dyn Mirror>>,
    ) -> Result<Self, LogError> {
        let mut log = LogWriter::create(&options.path, &options.log, &options.manifest)?;
        if let Some(mirror) = mirror.take() {
            log.mirror_to(mirror);
        }
        let mut topics = Vec::new();
        for info in topic_info::all() {
            let channel = log.add_channel(&ChannelSpec {
                topic: info.name,
                schema_name: &info.schema_name,
                schema_encoding: "ros2msg",
                schema: info.schema.as_bytes(),
                message_encoding: "cdr",
                metadata: &info.metadata,
            })?;
            topics.push(TopicChannel { info, channel });
        }
        let viewer = Viewer::new(options, &mut log)?;
        // No flush here: a chunk that holds schemas and channels alone has no message index, and
        // Foxglove Studio opens no file with such a chunk.
        Ok(Self {
            log,
            topics,
            viewer,
            latency: Latency::new(&options.processes),
            outcome: Outcome::new(&options.robots, &options.processes, options.tick_period_ns),
            tick: 0,
            tick_period_ns: options.tick_period_ns,
            robots: Vec::new(),
        })
    }

    /// Writes a message and passes it on to whom it may concern.
    pub(super) fn write(
        &mut self,
        entry: &Entry,
        bytes: &[u8],
        observer: &mut dyn Observer,
    ) -> Result<(), LogError> {
        if entry.tick != self.tick {
            self.end_of_tick()?;
            self.tick = entry.tick;
        }
        let time_ns = entry.tick.saturating_mul(self.tick_period_ns);
        let Some(topic) = self.topics.get(entry.rank) else {
            return Ok(());
        };
        let stamp = &entry.stamp;
        // The counter of the channel has 32 bits; the stamp has all 64.
        let sequence = stamp.sequence as u32;
        self.log
            .write(topic.channel, sequence, time_ns, stamp.time_ns, bytes)?;
        // No clock runs in a run in one thread.
        if stamp.sent_ns != 0 {
            self.latency.message(topic.info.role, stamp);
        }
        if entry.rejected {
            return Ok(());
        }
        let role = topic.info.role;
        self.show(role, time_ns, bytes, observer)
    }

    fn show(
        &mut self,
        role: Role,
        time_ns: u64,
        bytes: &[u8],
        observer: &mut dyn Observer,
    ) -> Result<(), LogError> {
        let Self {
            log,
            viewer,
            outcome,
            robots,
            ..
        } = self;
        match role {
            Role::State => {
                let Some((header, states)) = view::<WorldState>(bytes) else {
                    return Ok(());
                };
                robots.clear();
                robots.extend(states);
                outcome.state(&header, robots);
                observer.on_state(&header, robots);
                if let Some(viewer) = viewer {
                    viewer.state(&header, time_ns, robots);
                }
            }
            Role::Event => {
                let Some((_, events)) = view::<WorldEvents>(bytes) else {
                    return Ok(());
                };
                let time_s = seconds(time_ns);
                for event in events {
                    outcome.event(time_s, &event);
                    observer.on_event(time_s, &event);
                    if let Some(viewer) = viewer {
                        viewer.event(&event, time_ns, log)?;
                    }
                }
            }
            Role::Coverage => {
                if let Some((_, mut reports)) = view::<Coverage>(bytes)
                    && let Some(report) = reports.next()
                {
                    outcome.coverage(&report);
                }
            }
            Role::Verdict => {
                if let Some((_, verdicts)) = view::<Verdicts>(bytes) {
                    let time_s = seconds(time_ns);
                    verdicts.for_each(|verdict| outcome.verdict(time_s, &verdict));
                }
            }
            Role::Prediction => {
                if let Some((header, predictions)) = view::<Predictions>(bytes) {
                    let (observer, time_s) = (header.stamp.source, seconds(time_ns));
                    predictions.for_each(|p| outcome.prediction(observer, time_s, &p));
                }
            }
            Role::Waypoint => {
                if let Some((_, ends)) = view::<Waypoints>(bytes) {
                    ends.for_each(|end| outcome.waypoint(&end));
                }
            }
            Role::Status => {
                if let Some((header, mut status)) = view::<Status>(bytes)
                    && let Some(status) = status.next()
                {
                    observer.on_status(&header.stamp, &status);
                }
            }
            Role::ProcessEvent => {
                if let Some((_, events)) = view::<ProcessEvents>(bytes) {
                    for event in events {
                        outcome.process_event(&event);
                        if let Some(viewer) = viewer {
                            viewer.process_event(&event, time_ns, log)?;
                        }
                    }
                }
            }
            Role::ProcessLog => {
                if let Some((header, text)) = view::<ProcessLog>(bytes)
                    && let Some(viewer) = viewer
                {
                    let text: Vec<u8> = text.collect();
                    viewer.process_log(&header, &text, time_ns, log)?;
                }
            }
            _ => {
                if let Some(viewer) = viewer {
                    draw(viewer, role, time_ns, bytes, log)?;
                }
            }
        }
        Ok(())
    }

    /// Every message of the present tick has been written.
    pub(super) fn end_of_tick(&mut self) -> Result<(), LogError> {
        match &mut self.viewer {
            Some(viewer) => viewer.end_of_tick(&mut self.log),
            None => Ok(()),
        }
    }

    pub(super) fn flush_if_due(&mut self) -> Result<(), LogError> {
        self.log.flush_if_due()
    }

    /// Ends the log and says what it holds.
    pub(super) fn finish(mut self, ledger: &mut Ledger) -> Result<Summary, LogError> {
        if let Some(viewer) = &mut self.viewer {
            viewer.finish(&mut self.log)?;
        }
        let latency = self.latency.finish();
        let path = self.log.path().to_owned();
        let mut summary = self
            .outcome
            .finish(ledger.digest(), BTreeMap::new(), latency, path, 0);
        self.log
            .metadata("protean.result", result_entries(&summary))?;
        let totals = self.log.finish()?;
        summary.log_bytes = totals.file_bytes;
        for channel in totals.channels {
            let topic = ledger.counts().find(|(name, _)| *name == channel.topic);
            let count = TopicCount {
                messages: channel.messages,
                bytes: channel.bytes,
                ..topic.map(|(_, count)| count).unwrap_or_default()
            };
            if count != TopicCount::default() {
                summary.topics.insert(channel.topic, count);
            }
        }
        Ok(summary)
    }
}

/// Draws what only viewers look at.
fn draw(
    viewer: &mut Viewer,
    role: Role,
    time_ns: u64,
    bytes: &[u8],
    log: &mut LogWriter,
) -> Result<(), LogError> {
    match role {
        Role::Map => match view::<WorldMap>(bytes) {
            Some((header, cells)) => viewer.map(&header, time_ns, cells, log),
            None => Ok(()),
        },
        Role::Dominance => match view::<Dominance>(bytes) {
            Some((header, cells)) => viewer.dominance(&header, time_ns, cells, log),
            None => Ok(()),
        },
        Role::Obstacle => {
            let event = view::<ObstacleEvents>(bytes).and_then(|(_, mut events)| events.next());
            event.map_or(Ok(()), |event| viewer.obstacle(&event, time_ns, log))
        }
        Role::Plan => {
            if let Some((header, points)) = view::<Plan>(bytes) {
                viewer.plan(header.robot, points);
            }
            Ok(())
        }
        Role::Tree => {
            if let Some((header, edges)) = view::<Tree>(bytes) {
                viewer.tree(header.robot, edges);
            }
            Ok(())
        }
        Role::Sighting => {
            if let Some((_, sightings)) = view::<Sightings>(bytes) {
                viewer.sightings(sightings);
            }
            Ok(())
        }
        Role::Belief => match view::<Belief>(bytes) {
            Some((header, particles)) => {
                let particles =
                    particles.len() * size_of::<<Belief as ipc_types::topics::Topic>::Element>();
                let start = bytes.len().saturating_sub(particles);
                viewer.belief(
                    header.robot,
                    time_ns,
                    bytes.get(start..).unwrap_or_default(),
                    log,
                )
            }
            None => Ok(()),
        },
        Role::Scan => match view::<Scan>(bytes) {
            Some((header, ranges)) => viewer.scan(&header, time_ns, ranges, log),
            None => Ok(()),
        },
        _ => Ok(()),
    }
}

/// The end of a run as the last metadata record of its log.
fn result_entries(summary: &Summary) -> BTreeMap<String, String> {
    // These structures have string keys and finite numbers only; should one ever not encode, the
    // log is worth more than the entry.
    let json = |result: serde_json::Result<String>| result.unwrap_or_default();
    let coverage = summary
        .coverage
        .as_ref()
        .map(|c| ("coverage", json(serde_json::to_string(c))));
    let predictions = summary
        .predictions
        .as_ref()
        .map(|p| ("predictions", json(serde_json::to_string(p))));
    let failed = (!summary.processes.is_empty())
        .then(|| ("processes", json(serde_json::to_string(&summary.processes))));
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
    .chain(failed)
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}
