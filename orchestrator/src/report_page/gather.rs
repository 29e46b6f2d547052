//! From a log to what a page shows of it, in memory that does not grow with the log.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use ipc_types::cdr::{self, DecodeError};
use ipc_types::consumer::LoggedMessage;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::topics::{
    Belief, Coverage, ObstacleEvents, Plan, Predictions, Scan, TopicId, Tree, Verdicts, Waypoints,
    WorldEvents, WorldMap, WorldState,
};
use mcap::records::MessageHeader;
use sim_backend::map::ObstacleChange;

use super::happened::Happened;
use super::layers::Layers;
use super::measured::Measured;
use super::sampled::{Sample, Sampled};
use super::timing::Timing;
use crate::logs::known;
use crate::logs::reader::{Channel, Item, Reader};
use crate::logs::{Condition, LogsError, Watch};
use crate::picture::Ground;
use crate::picture::log_facts::LogFacts;
use crate::picture::logged::LoggedScenario;
use crate::scenario::spec::{MAX_EVENTS, MAX_ROBOTS};

/// Most states of robots that are kept.
const MOST_STATES: usize = 400_000;
/// Most notes on what is missing.
const MOST_NOTES: usize = 50;
/// Coordinates beyond this [m] are not those of a world of ours.
const FARTHEST: f64 = 1e6;

/// The state of the world at a tick.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    pub(super) tick: u64,
    pub(super) robots: Vec<RobotState>,
}

/// What a page shows of a run.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) facts: LogFacts,
    pub(super) scenario: LoggedScenario,
    pub(super) frames: Vec<Sample<Frame>>,
    /// Whether the log reaches the end of the game.
    pub(super) over: bool,
    pub(super) tick_period_ns: u64,
    /// Time of the last state, or of the last message if there is none [ns].
    pub(super) end_ns: u64,
    /// What stands from the beginning.
    pub(super) ground: Ground,
    /// How it changed, by time [ns].
    pub(super) changes: Vec<(u64, ObstacleChange)>,
    pub(super) layers: Layers,
    pub(super) happened: Happened,
    pub(super) measured: Measured,
    pub(super) timing: Timing,
    /// Messages by topic, of the lossless topics.
    pub(super) counts: BTreeMap<String, u64>,
    pub(super) notes: Vec<String>,
    pub(super) condition: Condition,
}

/// The topics that a page shows something of.
const SHOWN: [TopicId; 12] = [
    TopicId::WorldState,
    TopicId::WorldMap,
    TopicId::WorldEvents,
    TopicId::ObstacleEvents,
    TopicId::Belief,
    TopicId::Plan,
    TopicId::Tree,
    TopicId::Scan,
    TopicId::Waypoints,
    TopicId::Predictions,
    TopicId::Coverage,
    TopicId::Verdicts,
];

/// What is known of a channel.
struct Heard {
    topic: String,
    messages: u64,
    /// Its topic, if its messages are those of this version.
    known: Option<TopicId>,
}

/// What is known of a log so far.
struct Reading {
    facts: LogFacts,
    heard: BTreeMap<u16, Heard>,
    frames: Sampled<Frame>,
    over: bool,
    tick_period_ns: u64,
    end_ns: u64,
    last_ns: u64,
    changes: Vec<(u64, ObstacleChange)>,
    /// Where the robots are now; the team by its code.
    now: Vec<RobotState>,
    layers: Layers,
    happened: Happened,
    measured: Measured,
    timing: Timing,
    notes: Vec<String>,
}

impl Gathered {
    /// Reads a log as far as it goes.
    pub(super) fn read(log: &Path, watch: &mut Watch) -> Result<Self, LogsError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let mut reading = Reading::new();
        while let Some(item) = reader.next()? {
            reading.item(log, item)?;
        }
        reader.check_all()?;
        let condition = reader.condition().clone();
        reading.finish(log, condition)
    }

    /// Name of a robot.
    pub(super) fn name(&self, robot: u32) -> String {
        let robots = &self.scenario.robots;
        let name = robots.get(robot as usize).map(|r| r.name.clone());
        name.unwrap_or_else(|| format!("robot {robot}"))
    }
}

impl Reading {
    fn new() -> Self {
        Self {
            facts: LogFacts::default(),
            heard: BTreeMap::new(),
            frames: Sampled::new(0, MOST_STATES, |frame: &Frame| frame.robots.len()),
            over: false,
            tick_period_ns: 0,
            end_ns: 0,
            last_ns: 0,
            changes: Vec::new(),
            now: Vec::new(),
            layers: Layers::default(),
            happened: Happened::default(),
            measured: Measured::default(),
            timing: Timing::default(),
            notes: Vec::new(),
        }
    }

    fn note(&mut self, note: String) {
        if self.notes.len() < MOST_NOTES && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    fn item(&mut self, log: &Path, item: Item<'_>) -> Result<(), LogsError> {
        match item {
            Item::Metadata(record) => self.facts.metadata(record),
            Item::Attachment(header, data) => {
                if self.facts.attachment(log, &header, data)?
                    && let Err(reason) = self.timing.processes_of(&self.facts.scenario_text)
                {
                    self.note(format!(
                        "latency histograms: the log's processes cannot be told apart: {reason}"
                    ));
                }
            }
            Item::Channel(channel) => self.channel(log, &channel)?,
            Item::Message(header, data) => self.message(&header, data),
            Item::Header { .. } | Item::Schema(..) => {}
        }
        Ok(())
    }

    fn channel(&mut self, log: &Path, channel: &Rc<Channel>) -> Result<(), LogsError> {
        if let Some(topic) = TopicId::from_name(&channel.topic)
            && SHOWN.contains(&topic)
            && let Err(error) = known::check_layout(log, channel, self.facts.version())
        {
            if topic == TopicId::WorldState {
                return Err(error);
            }
            self.note(format!(
                "{}: its messages are not those of this version and are left out",
                channel.topic
            ));
        }
        self.heard.insert(
            channel.id,
            Heard {
                topic: channel.topic.clone(),
                messages: 0,
                known: known::topic_of(channel),
            },
        );
        Ok(())
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) {
        let Some(heard) = self.heard.get_mut(&header.channel_id) else {
            return;
        };
        heard.messages += 1;
        let time_ns = header.log_time;
        let Some(topic) = heard.known else {
            return;
        };
        self.last_ns = self.last_ns.max(time_ns);
        if let Some(message) = LoggedMessage::new(topic, time_ns, data) {
            self.timing.message(&message);
        }
        if let Err(error) = self.take(topic, time_ns, data) {
            let note = format!("a message is damaged and left out: {error}");
            self.note(note);
        }
    }

    fn take(&mut self, topic: TopicId, time_ns: u64, data: &[u8]) -> Result<(), DecodeError> {
        match topic {
            TopicId::WorldState => {
                let (header, robots) = cdr::decode::<WorldState>(data)?;
                self.state(time_ns, &header, robots);
            }
            TopicId::WorldMap => {
                if !self.facts.has_map() {
                    let (header, cells) = cdr::decode::<WorldMap>(data)?;
                    self.facts.map(&header, &cells);
                }
            }
            TopicId::WorldEvents => {
                let (_, events) = cdr::decode::<WorldEvents>(data)?;
                for event in &events {
                    self.happened.event(time_ns, event);
                }
            }
            TopicId::ObstacleEvents => {
                let (header, events) = cdr::decode::<ObstacleEvents>(data)?;
                // A message that makes no change was refused by the world as well.
                let changes = events
                    .iter()
                    .filter_map(|event| runtime::obstacle::from_message(event).ok());
                for change in changes {
                    if self.changes.len() < MAX_EVENTS {
                        self.changes.push((header.stamp.time_ns, change));
                    }
                }
            }
            TopicId::Belief => {
                let (header, particles) = cdr::decode::<Belief>(data)?;
                let robot = header.robot;
                if (robot as usize) < MAX_ROBOTS {
                    self.layers.belief(time_ns, &header, &particles);
                    let truth = self.now.iter().find(|s| s.robot == robot);
                    self.measured.belief(time_ns, &header, truth);
                }
            }
            TopicId::Plan => {
                let (header, points) = cdr::decode::<Plan>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.plan(time_ns, header.robot, &points);
                }
            }
            TopicId::Tree => {
                let (header, edges) = cdr::decode::<Tree>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.tree(time_ns, header.robot, &edges);
                }
            }
            TopicId::Scan => {
                let (header, ranges) = cdr::decode::<Scan>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.scan(time_ns, &header, &ranges);
                }
            }
            TopicId::Waypoints => {
                let (_, ends) = cdr::decode::<Waypoints>(data)?;
                let ends: Vec<WaypointEnd> = ends
                    .into_iter()
                    .filter(|end| (end.robot as usize) < MAX_ROBOTS)
                    .collect();
                for end in ends {
                    self.happened.waypoint(time_ns, end);
                }
            }
            TopicId::Predictions => {
                let (_, predictions) = cdr::decode::<Predictions>(data)?;
                self.layers.predictions(time_ns, &predictions);
                self.measured.predictions(time_ns, &predictions);
            }
            TopicId::Coverage => {
                let (_, reports) = cdr::decode::<Coverage>(data)?;
                for report in &reports {
                    self.measured.coverage(time_ns, report);
                }
            }
            TopicId::Verdicts => {
                let (_, verdicts) = cdr::decode::<Verdicts>(data)?;
                for verdict in &verdicts {
                    self.measured.verdict(time_ns, verdict);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn state(&mut self, time_ns: u64, header: &WorldHeader, mut robots: Vec<RobotState>) {
        robots.retain(|s| {
            (s.robot as usize) < MAX_ROBOTS
                && s.x.abs() <= FARTHEST
                && s.y.abs() <= FARTHEST
                && s.theta.is_finite()
        });
        self.end_ns = self.end_ns.max(time_ns);
        self.tick_period_ns = header.tick_period_ns;
        self.over = header.phase == WorldHeader::OVER;
        self.measured.state(time_ns, &robots);
        self.now.clone_from(&robots);
        let tick = header.stamp.tick;
        self.frames.push(time_ns, 0, Frame { tick, robots });
    }

    fn finish(mut self, log: &Path, condition: Condition) -> Result<Gathered, LogsError> {
        let scenario = self.facts.take_scenario(log)?;
        let ground = self.facts.take_ground(&scenario);
        if self.end_ns == 0 {
            self.end_ns = self.last_ns;
        }
        if self.tick_period_ns == 0 {
            let period = self.facts.manifest.get("tick_period_ns");
            self.tick_period_ns = period.and_then(|p| p.parse().ok()).unwrap_or(0);
        }
        let end_ns = self.end_ns;
        // What was announced for a time that the run did not reach.
        self.changes.retain(|(time_ns, _)| *time_ns <= end_ns);
        self.changes.sort_by_key(|(time_ns, _)| *time_ns);
        let mut counts: BTreeMap<String, u64> = BTreeMap::new();
        for heard in self
            .heard
            .into_values()
            .filter(|heard| heard.known.is_some())
        {
            *counts.entry(heard.topic).or_insert(0) += heard.messages;
        }
        let frames = self.frames.finish();
        // Without states there is at least where everybody was put.
        Ok(Gathered {
            facts: self.facts,
            scenario,
            frames,
            over: self.over,
            tick_period_ns: self.tick_period_ns,
            end_ns,
            ground,
            changes: self.changes,
            layers: self.layers,
            happened: self.happened,
            measured: self.measured,
            timing: self.timing,
            counts,
            notes: self.notes,
            condition,
        })
    }
}
