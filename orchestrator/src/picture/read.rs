//! From a log to what a picture shows of it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::world::{RobotState, WorldEvent};
use ipc_types::topics::{
    Belief, Dominance, ObstacleEvents, Plan, Topic, Tree, WorldEvents, WorldMap, WorldState,
};
use ipc_types::{cdr, schema};
use mcap::records::{Channel, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};
use sim_backend::map::ObstacleChange;
use sim_backend::pose::Pose2;

use super::error::PictureError;
use super::ground::Ground;
use super::layers::Layers;
use super::logged::LoggedScenario;
use super::trace::{BeliefTrace, Mark, MarkKind, RobotTrace, RunTrace};
use super::trail::{Trail, TrailPoint};
use crate::logs::reader::attachment;
use crate::scenario::spec::{MAX_EVENTS, MAX_ROBOTS};

/// Longest record that is read [bytes]: the largest map that a scenario may have, and a little.
const LONGEST_RECORD: usize = 320 << 20;
/// Most events that are marked.
const MOST_MARKS: usize = 64;
/// Most particles that are kept of a belief.
const MOST_PARTICLES: usize = 1000;
/// Coordinates beyond this [m] are not those of a world of ours.
const FARTHEST: f64 = 1e6;

impl RunTrace {
    /// Reads from a log what a picture of the run at simulated time `at` [s] needs; of its end if
    /// `at` is `None`.
    ///
    /// The whole file is read and every checksum in it is checked, in memory that depends neither
    /// on the length of the file nor on what it claims.
    ///
    /// # Errors
    /// [`PictureError`]: the file is missing, not an MCAP file, cut off, damaged, not one of our
    /// logs or of another version, or does not reach to `at`.
    pub fn read(path: &Path, at: Option<f64>) -> Result<Self, PictureError> {
        let open = |source| PictureError::Open {
            path: path.to_owned(),
            source,
        };
        // Look before opening: opening a FIFO would block.
        if !path.metadata().map_err(open)?.is_file() {
            return Err(open(io::Error::other("not a regular file")));
        }
        let mut file = File::open(path).map_err(open)?;
        let mut log = Reading::new(path, at);
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_record_length_limit(LONGEST_RECORD);
        let mut reader = LinearReader::new_with_options(options);
        let mut bytes_read = 0;
        while let Some(event) = reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(bytes)) => {
                    let read = read_some(&mut file, reader.insert(bytes)).map_err(open)?;
                    reader.notify_read(read);
                    bytes_read += read;
                }
                // `parse_record` panics on one that is shorter than its fields.
                Ok(LinearReadEvent::Record {
                    opcode: op::ATTACHMENT,
                    data,
                }) => log.attachment(data)?,
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let record =
                        parse_record(opcode, data).map_err(|e| log.damaged(e, bytes_read))?;
                    log.record(record)?;
                }
                Err(error) => return Err(log.damaged(error, bytes_read)),
            }
        }
        log.finish(at)
    }
}

/// The topics that matter.
#[derive(Debug, Clone, Copy)]
enum Role {
    State,
    Map,
    Event,
    Obstacle,
    Belief,
    Plan,
    Tree,
    Dominance,
}

/// What is known of a log so far.
struct Reading<'a> {
    path: &'a Path,
    /// Whether there has been a record.
    begun: bool,
    /// Messages after this time [ns] only tell when the run ended.
    until_ns: u64,
    /// Whether it is of a moment: with what was believed, planned and judged then.
    of_a_moment: bool,
    manifest: Option<BTreeMap<String, String>>,
    scenario: Option<LoggedScenario>,
    roles: BTreeMap<u16, Role>,
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
    /// Bounds and cells as the map messages have them.
    grid: Ground,
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
    fn new(path: &'a Path, at: Option<f64>) -> Self {
        Self {
            path,
            begun: false,
            // A tick's time is rounded to a nanosecond: half a microsecond more reaches it.
            until_ns: at.map_or(u64::MAX, |at| (at * 1e9 + 500.0) as u64),
            of_a_moment: at.is_some(),
            manifest: None,
            scenario: None,
            roles: BTreeMap::new(),
            now_ns: None,
            period_ns: 0,
            end_ns: 0,
            robots: Vec::new(),
            beliefs: BTreeMap::new(),
            layers: Layers::default(),
            marks: Vec::new(),
            changes: BTreeMap::new(),
            grid: Ground::default(),
        }
    }

    /// What an error of the reader means, after this many bytes of the file.
    fn damaged(&self, source: McapError, bytes_read: usize) -> PictureError {
        let path = self.path.to_owned();
        // The reader looks at the magic number as soon as it has it.
        let has_magic = bytes_read >= mcap::MAGIC.len();
        match source {
            McapError::UnexpectedEof | McapError::UnexpectedEoc if has_magic => {
                PictureError::Truncated { path }
            }
            McapError::UnexpectedEof => PictureError::NotMcap { path },
            McapError::BadMagic if !self.begun => PictureError::NotMcap { path },
            source => PictureError::Damaged { path, source },
        }
    }

    fn record(&mut self, record: Record<'_>) -> Result<(), PictureError> {
        self.begun = true;
        match record {
            Record::Metadata(metadata) if metadata.name == "protean" => {
                self.manifest = Some(metadata.metadata);
                Ok(())
            }
            Record::Channel(channel) => self.channel(&channel),
            Record::Message { header, data } => match self.roles.get(&header.channel_id) {
                Some(&role) => self
                    .message(role, header.log_time, &data)
                    .map_err(|source| PictureError::Message {
                        path: self.path.to_owned(),
                        source,
                    }),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    fn attachment(&mut self, record: &[u8]) -> Result<(), PictureError> {
        let path = || self.path.to_owned();
        let found = attachment(record).and_then(|(header, at)| Some((header, record.get(at)?)));
        let (header, data) = found.ok_or_else(|| PictureError::Attachment { path: path() })?;
        if header.name == "scenario.toml" {
            let scenario =
                LoggedScenario::parse(data).map_err(|reason| PictureError::Scenario {
                    path: path(),
                    reason,
                })?;
            self.scenario = Some(scenario);
        }
        Ok(())
    }

    fn channel(&mut self, channel: &Channel) -> Result<(), PictureError> {
        match channel.topic.as_str() {
            WorldState::NAME => self.take::<WorldState>(channel, Role::State),
            WorldMap::NAME => self.take::<WorldMap>(channel, Role::Map),
            WorldEvents::NAME => self.take::<WorldEvents>(channel, Role::Event),
            ObstacleEvents::NAME => self.take::<ObstacleEvents>(channel, Role::Obstacle),
            // Only a picture of a moment shows these.
            Belief::NAME if self.of_a_moment => self.take::<Belief>(channel, Role::Belief),
            Plan::NAME if self.of_a_moment => self.take::<Plan>(channel, Role::Plan),
            Tree::NAME if self.of_a_moment => self.take::<Tree>(channel, Role::Tree),
            Dominance::NAME if self.of_a_moment => self.take::<Dominance>(channel, Role::Dominance),
            _ => Ok(()),
        }
    }

    /// Takes up a channel if its messages look like those of this version.
    fn take<T: Topic>(&mut self, channel: &Channel, role: Role) -> Result<(), PictureError> {
        let path = || self.path.to_owned();
        // Another version's channel says so; one that says nothing is not ours.
        let Some(found) = channel.metadata.get("schema_hash") else {
            return Err(PictureError::Foreign {
                path: path(),
                missing: "schema_hash on its channels",
            });
        };
        let expected = schema::hash::<T>();
        if *found != expected {
            return Err(PictureError::Layout {
                path: path(),
                topic: T::NAME,
                found: found.clone(),
                expected,
            });
        }
        self.roles.insert(channel.id, role);
        Ok(())
    }

    fn message(&mut self, role: Role, time_ns: u64, data: &[u8]) -> Result<(), cdr::DecodeError> {
        if let Role::State = role {
            self.end_ns = self.end_ns.max(time_ns);
        }
        if time_ns > self.until_ns {
            return Ok(());
        }
        match role {
            Role::State => {
                let (header, robots) = cdr::decode::<WorldState>(data)?;
                self.now_ns = Some(time_ns);
                self.period_ns = header.tick_period_ns;
                for state in &robots {
                    self.state(time_ns, state);
                }
            }
            Role::Map => {
                let (header, cells) = cdr::decode::<WorldMap>(data)?;
                self.grid.use_cells(&header, &cells);
            }
            Role::Event => {
                let (_, events) = cdr::decode::<WorldEvents>(data)?;
                for event in &events {
                    self.event(time_ns, event);
                }
            }
            Role::Obstacle => {
                let (header, events) = cdr::decode::<ObstacleEvents>(data)?;
                if header.stamp.time_ns > time_ns {
                    // Announced for a time that the run did not reach.
                    return Ok(());
                }
                // A message that makes no change was refused by the world as well.
                for change in events
                    .iter()
                    .filter_map(|e| kit::obstacle::from_message(e).ok())
                {
                    let id = change.id().0;
                    if self.changes.contains_key(&id) || self.changes.len() < MAX_EVENTS {
                        self.changes.insert(id, change);
                    }
                }
            }
            Role::Belief => {
                let (header, particles) = cdr::decode::<Belief>(data)?;
                self.belief(time_ns, &header, &particles);
            }
            Role::Plan => {
                let (header, points) = cdr::decode::<Plan>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.plan(header.robot as usize, &points);
                }
            }
            Role::Tree => {
                let (header, edges) = cdr::decode::<Tree>(data)?;
                if (header.robot as usize) < MAX_ROBOTS {
                    self.layers.tree(header.robot as usize, &edges);
                }
            }
            Role::Dominance => {
                let (header, cells) = cdr::decode::<Dominance>(data)?;
                self.layers.dominance(&header, &cells);
            }
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

    fn finish(self, at: Option<f64>) -> Result<RunTrace, PictureError> {
        let foreign = |missing| PictureError::Foreign {
            path: self.path.to_owned(),
            missing,
        };
        let manifest = self
            .manifest
            .ok_or_else(|| foreign("metadata record `protean`"))?;
        let scenario = self
            .scenario
            .ok_or_else(|| foreign("attachment scenario.toml"))?;
        let end_s = seconds(self.end_ns);
        if let Some(at) = at
            && !(0.0..=end_s + 1e-6).contains(&at)
        {
            return Err(PictureError::Time { at, end: end_s });
        }
        let now_ns = self
            .now_ns
            .ok_or_else(|| foreign("message of world/state"))?;

        let mut ground = Ground::of(&scenario.world.map, &scenario.rules.exits);
        if !ground.has_vectors() && self.grid.cells.is_some() {
            (ground.min, ground.max) = (self.grid.min, self.grid.max);
            ground.cells = self.grid.cells;
        }
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
        let entry = |key| manifest.get(key).cloned().unwrap_or_default();
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

/// Reads what is there; 0 bytes only at the end of the file.
fn read_some(file: &mut File, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match file.read(buffer) {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

fn near(p: [f64; 2]) -> bool {
    p.iter().all(|c| c.abs() <= FARTHEST)
}

fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
