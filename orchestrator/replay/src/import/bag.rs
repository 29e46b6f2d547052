//! Odometry, scans, maps and frames in a bag of ROS 2.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mcap_log::reader::{Item, Reader};
use mcap_log::{LogReadError, ReadProgress};
use ros_messages::messages::{Header, LaserScan, OccupancyGrid, Odometry, TFMessage};
use ros_messages::{CdrError, decode};
use serde::de::DeserializeOwned;

use super::frames::{Frames, nanoseconds};
use crate::ReplayError;
use crate::bag_fault::BagFault;

/// Types of messages that are imported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageType {
    Odometry,
    Scan,
    Map,
    Frames,
}

impl MessageType {
    const ALL: [Self; 4] = [Self::Odometry, Self::Scan, Self::Map, Self::Frames];

    fn name(self) -> &'static str {
        match self {
            Self::Odometry => "nav_msgs/msg/Odometry",
            Self::Scan => "sensor_msgs/msg/LaserScan",
            Self::Map => "nav_msgs/msg/OccupancyGrid",
            Self::Frames => "tf2_msgs/msg/TFMessage",
        }
    }
}

/// Messages of a topic, by the times in their headers (ns).
#[derive(Debug)]
pub struct Samples<M> {
    /// Name of the topic.
    pub topic: String,
    /// The messages; by time after the bag was read.
    pub list: Vec<(i64, M)>,
}

/// The messages of a bag, by what they are for: `ROBOT/odom`, `ROBOT/scan`, `map`.
#[derive(Debug, Default)]
pub struct Bag {
    pub odometry: BTreeMap<String, Samples<Odometry>>,
    pub scans: BTreeMap<String, Samples<LaserScan>>,
    pub maps: BTreeMap<String, Samples<OccupancyGrid>>,
    pub frames: Frames,
    /// Topics that were read, and their numbers of messages, by what they are for.
    pub topics: BTreeMap<String, (String, usize)>,
    /// Topics that can be imported, with their types.
    pub known: Vec<String>,
    pub faults: Vec<String>,
}

/// Returns the namespace of a topic: its first part, if it has more than one.
pub fn namespace(topic: &str) -> &str {
    let end = topic.get(1..).and_then(|rest| rest.find('/'));
    end.and_then(|end| topic.get(..=end)).unwrap_or_default()
}

/// Returns the files of a bag: itself, or those in its folder.
fn files(bag: &Path) -> io::Result<Vec<PathBuf>> {
    if !bag.metadata()?.is_dir() {
        return Ok(vec![bag.to_owned()]);
    }
    let entries = bag.read_dir()?.map(|entry| Ok(entry?.path()));
    let mut entries: Vec<PathBuf> = entries.collect::<io::Result<_>>()?;
    entries.sort();
    // The reader names the remedy for a bag in a database.
    for end in ["mcap", "db3"] {
        let is_of = |path: &&PathBuf| path.extension().is_some_and(|own| own == end);
        let found: Vec<PathBuf> = entries.iter().filter(is_of).cloned().collect();
        if !found.is_empty() {
            return Ok(found);
        }
    }
    Err(io::Error::other("no FILE.mcap of a bag in this folder"))
}

impl<M> Samples<M> {
    fn sort(&mut self) {
        self.list.sort_by_key(|(at, _)| *at);
    }

    /// Returns the times of the first and last message (ns).
    pub fn span(&self) -> (i64, i64) {
        let at = |sample: Option<&(i64, M)>| sample.map_or(0, |(at, _)| *at);
        (at(self.list.first()), at(self.list.last()))
    }

    /// Returns the fault of the message of a time (ns).
    pub fn unusable(&self, at: i64, expected: &'static str) -> BagFault {
        BagFault::Value {
            topic: self.topic.clone(),
            at_s: at as f64 / 1e9,
            expected,
        }
    }

    /// Returns the message nearest to a time (ns).
    ///
    /// # Errors
    /// [`BagFault::Gap`]: it is farther than `max_age_s` (s).
    pub fn nearest(&self, time: i64, max_age_s: f64) -> Result<&(i64, M), BagFault> {
        let after = self.list.partition_point(|(at, _)| *at < time);
        let [before, after] = [after.saturating_sub(1), after].map(|at| self.list.get(at));
        let around = || before.into_iter().chain(after);
        let nearest = around().min_by_key(|(at, _)| at.abs_diff(time));
        let near = nearest.filter(|(at, _)| at.abs_diff(time) as f64 <= max_age_s * 1e9);
        let seconds = |sample: Option<&(i64, M)>| sample.map_or(0.0, |(at, _)| *at as f64 / 1e9);
        near.ok_or_else(|| BagFault::Gap {
            topic: self.topic.clone(),
            from_s: seconds(before),
            to_s: seconds(around().last()),
            max_age_s,
        })
    }
}

/// Adds a message to those of its topic.
fn add<M: DeserializeOwned>(
    all: &mut BTreeMap<String, Samples<M>>,
    (name, topic): (&str, &str),
    data: &[u8],
    header: impl Fn(&M) -> &Header,
) -> Result<(), CdrError> {
    let message: M = decode(data)?;
    let samples = all.entry(name.to_owned()).or_insert_with(|| Samples {
        topic: topic.to_owned(),
        list: Vec::new(),
    });
    let at = nanoseconds(&header(&message).stamp);
    samples.list.push((at, message));
    Ok(())
}

impl Bag {
    /// Reads a bag: its frames, and the topics in `wanted`, with what they are for and their types.
    ///
    /// # Errors
    /// [`ReplayError`]: a file is unreadable, or a message or the type of a topic is not as expected.
    pub fn read(
        path: &Path,
        wanted: &BTreeMap<String, (String, MessageType)>,
        watch: &mut ReadProgress,
    ) -> Result<Self, ReplayError> {
        let open = |source| LogReadError::Open {
            path: path.to_owned(),
            source,
        };
        let mut bag = Self::default();
        for file in files(path).map_err(open)? {
            let refuse = |fault| ReplayError::Bag {
                path: file.clone(),
                fault,
            };
            let mut reader = Reader::open(&file, Some(watch))?;
            let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
            while let Some(item) = reader.next()? {
                match item {
                    Item::Schema(id, schema) => {
                        schemas.insert(id, schema.name.clone());
                    }
                    Item::Channel(channel) => {
                        let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                        let found = schemas.get(&channel.schema_id).map_or("", String::as_str);
                        let known = MessageType::ALL
                            .into_iter()
                            .find(|known| known.name() == found);
                        let frames = known.filter(|of| *of == MessageType::Frames);
                        let frames = frames.map(|of| (String::new(), of));
                        if let Some((name, of)) = wanted.get(topic).cloned().or(frames) {
                            if known != Some(of) || encoding != "cdr" {
                                return Err(refuse(BagFault::Type {
                                    topic: topic.clone(),
                                    found: format!("{found} in {encoding}"),
                                    expected: of.name(),
                                }));
                            }
                            channels.insert(channel.id, (of, name, topic.clone(), 0));
                        }
                        bag.known
                            .extend(known.map(|_| format!("{topic} ({found})")));
                    }
                    Item::Message(header, data) => {
                        if let Some((of, name, topic, number)) =
                            channels.get_mut(&header.channel_id)
                        {
                            *number += 1;
                            if *of != MessageType::Frames {
                                let none = || (topic.clone(), 0);
                                bag.topics.entry(name.clone()).or_insert_with(none).1 += 1;
                            }
                            bag.add(*of, (name, topic), data).map_err(|source| {
                                refuse(BagFault::Message {
                                    topic: topic.clone(),
                                    number: *number,
                                    source,
                                })
                            })?;
                        }
                    }
                    _ => {}
                }
            }
            bag.faults.extend(reader.condition().lines());
        }
        bag.frames.sort();
        bag.odometry.values_mut().for_each(Samples::sort);
        bag.scans.values_mut().for_each(Samples::sort);
        Ok(bag)
    }

    fn add(&mut self, of: MessageType, to: (&str, &str), data: &[u8]) -> Result<(), CdrError> {
        match of {
            MessageType::Odometry => add(&mut self.odometry, to, data, |m| &m.header),
            MessageType::Scan => add(&mut self.scans, to, data, |m| &m.header),
            MessageType::Map => add(&mut self.maps, to, data, |m| &m.header),
            MessageType::Frames => {
                let is_static = to.1.ends_with("_static");
                let message: TFMessage = decode(data)?;
                for found in &message.transforms {
                    self.frames.add(namespace(to.1), is_static, found);
                }
                Ok(())
            }
        }
    }
}
