//! Reads what a picture shows from a log.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use ipc_types::cdr;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::world::{RobotState, WorldEvent};
use ipc_types::topics::{
    Belief, Dominance, ObstacleEvents, Plan, TopicId, Tree, WorldEvents, WorldMap, WorldState,
};
use sim_backend::map::ObstacleChange;
use sim_backend::pose::Pose2;

use super::layers::Layers;
use super::log_facts::LogFacts;
use super::trace::{BeliefTrace, Mark, MarkKind, RobotTrace, RunTrace};
use super::trail::{Trail, TrailPoint};
use crate::logs::known;
use crate::logs::reader::{Channel, Item, Reader};
use crate::logs::{Condition, LogsError, Watch};
use crate::scenario::spec::{MAX_EVENTS, MAX_ROBOTS};

/// Maximum number of events that are marked.
const MOST_MARKS: usize = 64;
/// Maximum number of particles that are kept of a belief.
const MOST_PARTICLES: usize = 1000;
/// Largest coordinate of a world [m]; what lies beyond is not drawn.
const FARTHEST: f64 = 1e6;

impl RunTrace {
    /// Reads what a picture of the run at simulated time `at` [s] needs, or of its end if `at` is `None`.
    ///
    /// The log is read as far as it goes, in memory that does not grow with its length.
    ///
    /// # Errors
    /// [`LogsError`]: the file is missing, not a log of Protean or of another version, or does not
    /// reach to `at`.
    pub fn read(
        log: &Path,
        at: Option<f64>,
        watch: &mut Watch,
    ) -> Result<(Self, Condition), LogsError> {
        let mut reader = Reader::open(log, Some(watch))?;
        let mut reading = Reading::new(log, at);
        while let Some(item) = reader.next()? {
            match item {
                Item::Metadata(record) => reading.facts.metadata(record),
                Item::Attachment(header, data) => {
                    reading.facts.attachment(log, &header, data)?;
                }
                Item::Channel(channel) => reading.channel(&channel)?,
                Item::Message(header, data) => {
                    if let Some(&topic) = reading.topics.get(&header.channel_id) {
                        reading.message(topic, header.log_time, data).map_err(|e| {
                            LogsError::NotRepeatable {
                                path: log.to_owned(),
                                reason: format!("a message is damaged: {e}"),
                            }
                        })?;
                    }
                }
                Item::Header { .. } | Item::Schema(..) => {}
            }
        }
        reader.check_all()?;
        let condition = reader.condition().clone();
        Ok((reading.finish(at)?, condition))
    }
}

/// What is known of a log so far.
struct Reading<'a> {
    log: &'a Path,
    /// Messages after this time [ns] only tell when the run ended.
    until_ns: u64,
    /// Whether it is of a moment: with what was believed, planned and judged then.
    of_a_moment: bool,
    facts: LogFacts,
    topics: BTreeMap<u16, TopicId>,
    /// Time of the last state that is drawn [ns], and the time between two states [ns].
    now_ns: Option<u64>,
    period_ns: u64,
    end_ns: u64,
    robots: Vec<Seen>,
    beliefs: BTreeMap<usize, (u64, BeliefTrace)>,
    layers: Layers,
    marks: Vec<Mark>,
    /// The last change of every obstacle that changed.
    changes: BTreeMap<u32, ObstacleChange>,
}

/// What is known of a robot.
#[derive(Debug, Clone, Default)]
struct Seen {
    trail: Trail,
    pose: Pose2,
    active: bool,
    present: bool,
}

impl<'a> Reading<'a> {
    fn new(log: &'a Path, at: Option<f64>) -> Self {
        Self {
            log,
            // A tick's time is rounded to a nanosecond: half a microsecond more reaches it.
            until_ns: at.map_or(u64::MAX, |at| (at * 1e9 + 500.0) as u64),
            of_a_moment: at.is_some(),
            facts: LogFacts::default(),
            topics: BTreeMap::new(),
            now_ns: None,
            period_ns: 0,
            end_ns: 0,
            robots: Vec::new(),
            beliefs: BTreeMap::new(),
            layers: Layers::default(),
            marks: Vec::new(),
            changes: BTreeMap::new(),
        }
    }

    fn channel(&mut self, channel: &Rc<Channel>) -> Result<(), LogsError> {
        let Some(topic) = TopicId::from_name(&channel.topic) else {
            return Ok(());
        };
        let is_shown = match topic {
            TopicId::WorldState
            | TopicId::WorldMap
            | TopicId::WorldEvents
            | TopicId::ObstacleEvents => true,
            // Only a picture of a moment shows these.
            TopicId::Belief | TopicId::Plan | TopicId::Tree | TopicId::Dominance => {
                self.of_a_moment
            }
            _ => false,
        };
        if !is_shown {
            return Ok(());
        }
        known::check_layout(self.log, channel, self.facts.version())?;
        self.topics.insert(channel.id, topic);
        Ok(())
    }

    fn message(
        &mut self,
        topic: TopicId,
        time_ns: u64,
        data: &[u8],
    ) -> Result<(), cdr::DecodeError> {
        if topic == TopicId::WorldState {
            self.end_ns = self.end_ns.max(time_ns);
        }
        if time_ns > self.until_ns {
            return Ok(());
        }
        match topic {
            TopicId::WorldState => {
                let (header, robots) = cdr::decode::<WorldState>(data)?;
                self.now_ns = Some(time_ns);
                self.period_ns = header.tick_period_ns;
                for state in &robots {
                    self.state(time_ns, state);
                }
            }
            TopicId::WorldMap => {
                let (header, cells) = cdr::decode::<WorldMap>(data)?;
                self.facts.map(&header, &cells);
            }
            TopicId::WorldEvents => {
                let (_, events) = cdr::decode::<WorldEvents>(data)?;
                for event in &events {
                    self.event(time_ns, event);
                }
            }
            TopicId::ObstacleEvents => {
                let (header, events) = cdr::decode::<ObstacleEvents>(data)?;
                if header.stamp.time_ns > time_ns {
                    // Announced for a time that the run did not reach.
                    return Ok(());
                }
                // A message that makes no change was refused by the world as well.
                for change in events
                    .iter()
                    .filter_map(|e| runtime::obstacle::from_message(e).ok())
                {
                    let id = change.id().0;
                    if self.changes.contains_key(&id) || self.changes.len() < MAX_EVENTS {
                        self.changes.insert(id, change);
                    }
                }
            }
            TopicId::Belief => {
                let (header, particles) = cdr::decode::<Belief>(data)?;
                self.belief(time_ns, &header, &particles);
            }
            TopicId::Plan => {
                let (header, points) = cdr::decode::<Plan>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.plan(header.robot as usize, &points);
                }
            }
            TopicId::Tree => {
                let (header, edges) = cdr::decode::<Tree>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.tree(header.robot as usize, &edges);
                }
            }
            TopicId::Dominance => {
                let (header, cells) = cdr::decode::<Dominance>(data)?;
                self.layers.dominance(&header, &cells);
            }
            _ => {}
        }
        Ok(())
    }

    fn state(&mut self, time_ns: u64, state: &RobotState) {
        let robot = state.robot as usize;
        if robot >= MAX_ROBOTS || !near([state.x, state.y]) || !state.theta.is_finite() {
            return;
        }
        if robot >= self.robots.len() {
            self.robots.resize_with(robot + 1, Seen::default);
        }
        let Some(seen) = self.robots.get_mut(robot) else {
            return;
        };
        seen.present = true;
        seen.active = state.status == 0;
        seen.pose = Pose2::new(state.x, state.y, state.theta);
        seen.trail.push(TrailPoint {
            x: state.x,
            y: state.y,
            time_s: seconds(time_ns),
        });
    }

    fn event(&mut self, time_ns: u64, event: &WorldEvent) {
        let kind = match WorldEvent::name_of(event.kind) {
            "captured" => MarkKind::Captured,
            "escaped" => MarkKind::Escaped,
            "goal_reached" => MarkKind::GoalReached,
            _ => return,
        };
        if self.marks.len() < MOST_MARKS && near([event.x, event.y]) {
            self.marks.push(Mark {
                kind,
                robot: event.robot as usize,
                at: [event.x, event.y],
                time_s: seconds(time_ns),
            });
        }
    }

    fn belief(&mut self, time_ns: u64, header: &BeliefHeader, particles: &[Particle]) {
        let robot = header.robot as usize;
        if robot >= MAX_ROBOTS || !near([header.mean_x, header.mean_y]) {
            return;
        }
        let step = particles.len().div_ceil(MOST_PARTICLES).max(1);
        let belief = BeliefTrace {
            robot,
            mean: [header.mean_x, header.mean_y],
            particles: particles
                .iter()
                .step_by(step)
                .map(|p| [p.x, p.y])
                .filter(|p| near(p.map(f64::from)))
                .collect(),
        };
        self.beliefs.insert(robot, (time_ns, belief));
    }

    fn finish(mut self, at: Option<f64>) -> Result<RunTrace, LogsError> {
        let scenario = self.facts.take_scenario(self.log)?;
        let end_s = seconds(self.end_ns);
        if let Some(at) = at
            && !(0.0..=end_s + 1e-6).contains(&at)
        {
            return Err(LogsError::Argument(format!(
                "--at {at}: expected a time from 0 to the end of the run, {end_s} s"
            )));
        }
        let now_ns = self.now_ns.ok_or_else(|| LogsError::Foreign {
            path: self.log.to_owned(),
            missing: "message of world/state",
        })?;
        let mut ground = self.facts.take_ground(&scenario);
        self.changes
            .into_values()
            .for_each(|change| ground.apply(change));

        let robots: Vec<RobotTrace> = scenario
            .robots
            .into_iter()
            .zip(
                self.robots
                    .into_iter()
                    .chain(std::iter::repeat_with(Seen::default)),
            )
            .map(|(spec, seen)| RobotTrace {
                radius: spec.model().radius,
                name: spec.name,
                team: spec.team,
                pose: if seen.present { seen.pose } else { spec.start },
                active: seen.active || !seen.present,
                trail: seen.trail,
            })
            .collect();
        let plays = |robot: usize| robots.get(robot).is_some_and(|r| r.active);
        let (plans, trees, dominance) = self.layers.finish(plays);
        let entry = |key| self.facts.manifest.get(key).cloned().unwrap_or_default();
        Ok(RunTrace {
            title: scenario.title,
            description: scenario.description,
            scenario: entry("scenario"),
            seed: entry("seed"),
            time_s: at.unwrap_or_else(|| seconds(now_ns)),
            end_s,
            ground,
            robots,
            // Of a robot that is out of the game the last belief is an old one.
            beliefs: self
                .beliefs
                .into_values()
                .filter(|(time, _)| time + 2 * self.period_ns >= now_ns)
                .map(|(_, belief)| belief)
                .collect(),
            plans,
            trees,
            dominance,
            marks: self.marks,
        })
    }
}

fn near(p: [f64; 2]) -> bool {
    p.iter().all(|c| c.abs() <= FARTHEST)
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
