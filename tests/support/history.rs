//! A log as plain values, read by the `mcap` crate with this project's message types, or by Python packages
//! with the log alone.

use std::collections::BTreeMap;
use std::path::Path;

use ipc_types::cdr;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::stamp::{Header as _, Stamp};
use ipc_types::topics::{
    Attacks, Belief, Commands, Control, Coverage, Dominance, MeasuredPoses, ObstacleEvents, Plan,
    Predictions, ProcessEvents, ProcessLog, Scan, Sightings, Status, Topic, Tree, Verdicts,
    Waypoints, WorldEvents, WorldMap, WorldShapes, WorldState,
};
use mcap::sans_io::LinearReaderOptions;
use serde::Deserialize;

/// Everything in a log that is not a clock.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct History {
    /// Every message of the lossless topics, in file order.
    pub messages: Vec<Message>,
    pub states: Vec<State>,
    pub events: Vec<Event>,
    pub commands: Vec<Order>,
    pub beliefs: Vec<Guess>,
    pub sightings: Vec<Look>,
    pub maps: Vec<Map>,
    pub obstacles: Vec<Change>,
    /// Waypoints that ended, in the order of their messages.
    #[serde(default)]
    pub waypoints: Vec<Visit>,
    /// Attacks, in the order of their messages.
    #[serde(default)]
    pub attacks: Vec<Attack>,
    /// Messages and bytes by topic, viewer topics included.
    pub counts: BTreeMap<String, (u64, u64)>,
}

/// Topic, time and source of a message.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Message {
    pub topic: String,
    pub source: u32,
    pub tick: u64,
    pub time_ns: u64,
    pub sequence: u64,
    /// Sequence number in the log's own record.
    pub logged_sequence: u64,
    pub log_time: u64,
    pub publish_time: u64,
    /// Monotonic clock of its sending (ns); differs from run to run.
    pub sent_ns: u64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct State {
    pub tick: u64,
    pub over: bool,
    pub map_revision: u32,
    pub robots: Vec<Robot>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(clippy::struct_field_names, reason = "named as in the message")]
pub struct Robot {
    pub robot: u32,
    pub x: f64,
    pub y: f64,
    pub theta: f64,
    pub v: f64,
    pub omega: f64,
    pub distance: f64,
    pub team: u8,
    pub status: u8,
    pub present: bool,
    pub fail_safe: bool,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Event {
    pub tick: u64,
    pub kind: u32,
    pub robot: u32,
    pub other: u32,
    pub value: f64,
    pub x: f64,
    pub y: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Order {
    pub tick: u64,
    pub source: u32,
    pub robot: u32,
    pub v: f64,
    pub omega: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Guess {
    pub tick: u64,
    pub robot: u32,
    pub seen: bool,
    pub mean_x: f64,
    pub mean_y: f64,
    pub particles: usize,
    /// Sums over the particles, added up in their order in double precision.
    pub weight: f64,
    pub sum_x: f64,
    pub sum_y: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Look {
    pub tick: u64,
    pub robot: u32,
    pub seen: bool,
    pub visibility: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Map {
    pub tick: u64,
    pub revision: u32,
    pub width: u32,
    pub height: u32,
    pub occupied: u32,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Change {
    pub tick: u64,
    pub id: u32,
    pub action: u8,
    pub shape: u8,
    pub x: f64,
    pub y: f64,
    pub theta: f64,
    pub half_x: f64,
    pub half_y: f64,
}

/// A waypoint that ended.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Visit {
    pub tick: u64,
    pub robot: u32,
    pub number: u64,
    pub lap: u32,
    pub kind: String,
    pub outcome: String,
    pub x: f64,
    pub y: f64,
    pub started_s: f64,
    pub ended_s: f64,
    pub closest: f64,
}

/// An attack that begins.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Attack {
    pub tick: u64,
    pub source: u32,
    pub method: String,
    pub x: f64,
    pub y: f64,
    pub duration_s: f64,
    pub distance: f64,
    pub sight: f64,
    pub guards: Vec<usize>,
}

impl History {
    /// Reads a finished log with the `mcap` crate, every checksum checked.
    #[track_caller]
    pub fn read(path: &Path) -> Self {
        Self::try_read(path).unwrap()
    }

    /// As [`History::read`]; returns an error if the log is faulty.
    pub fn try_read(path: &Path) -> Result<Self, String> {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true);
        let file = std::fs::File::open(path).map_err(|e| e.to_string())?;
        let mut history = Self::default();
        for message in mcap::io::MessageReader::new_with_options(file, options) {
            history.take(&message.map_err(|e| e.to_string())?)?;
        }
        Ok(history)
    }

    fn take(&mut self, m: &mcap::Message<'_>) -> Result<(), String> {
        let topic = m.channel.topic.as_str();
        let count = self.counts.entry(topic.to_owned()).or_default();
        *count = (count.0 + 1, count.1 + m.data.len() as u64);
        let schema = m
            .channel
            .schema
            .as_ref()
            .ok_or_else(|| format!("{topic}: no schema"))?;
        let encodings = (schema.encoding.as_str(), &*m.channel.message_encoding);
        if encodings != ("ros2msg", "cdr") {
            return Err(format!("{topic}: {encodings:?}"));
        }
        // Derived from the other messages, or from the scenario.
        if topic.starts_with('/') || topic == "world/robots" {
            return Ok(());
        }
        let bytes = &*m.data;
        let stamp = match topic {
            WorldState::NAME => self.state(bytes)?,
            WorldMap::NAME => self.map(bytes)?,
            WorldShapes::NAME => stamp::<WorldShapes>(bytes)?,
            WorldEvents::NAME => self.event(bytes)?,
            ObstacleEvents::NAME => self.obstacle(bytes)?,
            Sightings::NAME => self.sighting(bytes)?,
            Belief::NAME => self.belief(bytes)?,
            Commands::NAME => self.command(bytes)?,
            Coverage::NAME => stamp::<Coverage>(bytes)?,
            MeasuredPoses::NAME => stamp::<MeasuredPoses>(bytes)?,
            Plan::NAME => stamp::<Plan>(bytes)?,
            Scan::NAME => stamp::<Scan>(bytes)?,
            Tree::NAME => stamp::<Tree>(bytes)?,
            Verdicts::NAME => stamp::<Verdicts>(bytes)?,
            Waypoints::NAME => self.visit(bytes)?,
            Attacks::NAME => self.attack(bytes)?,
            Predictions::NAME => stamp::<Predictions>(bytes)?,
            Dominance::NAME => stamp::<Dominance>(bytes)?,
            Status::NAME => stamp::<Status>(bytes)?,
            Control::NAME => stamp::<Control>(bytes)?,
            ProcessEvents::NAME => stamp::<ProcessEvents>(bytes)?,
            ProcessLog::NAME => stamp::<ProcessLog>(bytes)?,
            other => return Err(format!("{other}: not a topic")),
        };
        self.messages.push(Message {
            topic: topic.to_owned(),
            source: stamp.source,
            tick: stamp.tick,
            time_ns: stamp.time_ns,
            sequence: stamp.sequence,
            logged_sequence: u64::from(m.sequence),
            log_time: m.log_time,
            publish_time: m.publish_time,
            sent_ns: stamp.sent_ns,
        });
        Ok(())
    }

    fn state(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, robots) = decode::<WorldState>(bytes)?;
        self.states.push(State {
            tick: header.stamp.tick,
            over: header.phase == 1,
            map_revision: header.map_revision,
            robots: robots
                .iter()
                .map(|r| Robot {
                    robot: r.robot,
                    x: r.x,
                    y: r.y,
                    theta: r.theta,
                    v: r.v,
                    omega: r.omega,
                    distance: r.distance,
                    team: r.team,
                    status: r.status,
                    present: r.present != 0,
                    fail_safe: r.fail_safe != 0,
                })
                .collect(),
        });
        Ok(header.stamp)
    }

    fn map(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, cells) = decode::<WorldMap>(bytes)?;
        self.maps.push(Map {
            tick: header.stamp.tick,
            revision: header.revision,
            width: header.width,
            height: header.height,
            occupied: cells.iter().map(|c| u32::from(c.occupied)).sum(),
        });
        Ok(header.stamp)
    }

    fn attack(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, guards) = decode::<Attacks>(bytes)?;
        self.attacks.push(Attack {
            tick: header.stamp.tick,
            source: header.stamp.source,
            method: header.method_name().to_owned(),
            x: header.x,
            y: header.y,
            duration_s: header.duration_s,
            distance: header.distance,
            sight: header.sight,
            guards: guards.iter().map(|guard| guard.robot as usize).collect(),
        });
        Ok(header.stamp)
    }

    fn event(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, events) = decode::<WorldEvents>(bytes)?;
        self.events.extend(events.iter().map(|e| Event {
            tick: header.stamp.tick,
            kind: e.kind,
            robot: e.robot,
            other: e.other,
            value: e.value,
            x: e.x,
            y: e.y,
        }));
        Ok(header.stamp)
    }

    fn obstacle(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, changes) = decode::<ObstacleEvents>(bytes)?;
        self.obstacles.extend(changes.iter().map(|c| Change {
            tick: header.stamp.tick,
            id: c.id,
            action: c.action,
            shape: c.shape,
            x: c.x,
            y: c.y,
            theta: c.theta,
            half_x: c.half_x,
            half_y: c.half_y,
        }));
        Ok(header.stamp)
    }

    fn sighting(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, looks) = decode::<Sightings>(bytes)?;
        self.sightings.extend(looks.iter().map(|l| Look {
            tick: header.stamp.tick,
            robot: l.robot,
            seen: l.seen != 0,
            visibility: l.visibility,
        }));
        Ok(header.stamp)
    }

    fn belief(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, particles) = decode::<Belief>(bytes)?;
        let sum = |part: fn(&ipc_types::messages::perception::Particle) -> f32| {
            particles.iter().fold(0.0, |s, p| s + f64::from(part(p)))
        };
        self.beliefs.push(Guess {
            tick: header.stamp.tick,
            robot: header.robot,
            seen: header.seen != 0,
            mean_x: header.mean_x,
            mean_y: header.mean_y,
            particles: particles.len(),
            weight: sum(|p| p.weight),
            sum_x: sum(|p| p.x),
            sum_y: sum(|p| p.y),
        });
        Ok(header.stamp)
    }

    fn command(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, commands) = decode::<Commands>(bytes)?;
        self.commands.extend(commands.iter().map(|c| Order {
            tick: header.stamp.tick,
            source: header.stamp.source,
            robot: c.robot,
            v: c.v,
            omega: c.omega,
        }));
        Ok(header.stamp)
    }

    fn visit(&mut self, bytes: &[u8]) -> Result<Stamp, String> {
        let (header, ended) = decode::<Waypoints>(bytes)?;
        for end in &ended {
            let name = |of: &[&str], code: u8| {
                let name = of.get(usize::from(code)).map(|&name| name.to_owned());
                name.ok_or_else(|| format!("{end:?}: no such code as {code}"))
            };
            self.waypoints.push(Visit {
                tick: header.stamp.tick,
                robot: end.robot,
                number: end.number,
                lap: end.lap,
                kind: name(&WaypointEnd::KINDS, end.kind)?,
                outcome: name(&WaypointEnd::OUTCOMES, end.outcome)?,
                x: end.x,
                y: end.y,
                started_s: end.started_s,
                ended_s: end.ended_s,
                closest: end.closest,
            });
        }
        Ok(header.stamp)
    }

    /// The messages of a topic.
    pub fn of<'a>(&'a self, topic: &'a str) -> impl Iterator<Item = &'a Message> {
        self.messages.iter().filter(move |m| m.topic == topic)
    }
}

fn decode<T: Topic>(bytes: &[u8]) -> Result<(T::Header, Vec<T::Element>), String> {
    cdr::decode::<T>(bytes).map_err(|e| e.to_string())
}

fn stamp<T: Topic>(bytes: &[u8]) -> Result<Stamp, String> {
    decode::<T>(bytes).map(|(header, _)| *header.stamp())
}

/// The rest of a log beside its messages: the metadata record, and the attachments by name.
pub fn manifest(path: &Path) -> (BTreeMap<String, String>, BTreeMap<String, String>) {
    let bytes = std::fs::read(path).unwrap();
    let (mut metadata, mut attachments) = (BTreeMap::new(), BTreeMap::new());
    for record in mcap::read::LinearReader::new(&bytes).unwrap() {
        match record.unwrap() {
            mcap::records::Record::Metadata(record) if record.name == "protean" => {
                metadata = record.metadata;
            }
            mcap::records::Record::Attachment { header, data, .. } => {
                let text = String::from_utf8_lossy(&data).into_owned();
                attachments.insert(header.name, text);
            }
            _ => {}
        }
    }
    (metadata, attachments)
}

/// The scenario that a log holds, with everything filled in.
pub fn scenario(path: &Path) -> toml::Table {
    manifest(path).1["scenario.toml"].parse().unwrap()
}
