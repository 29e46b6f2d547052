//! Odometry, scans, maps and frames in a bag of ROS 2.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use geometry::grid::{Grid, GridFrame};
use geometry::map::CellMap;
use geometry::pose::{Pose2, Twist2};
use mcap_log::ReadProgress;
use mcap_log::reader::{Item, Reader};
use nalgebra::Point2;
use robot::spec::ScanSpec;
use ros_messages::messages::{LaserScan, OccupancyGrid, Odometry, TFMessage};
use ros_messages::{decode, is_upright, pose2};

use super::frames::{Frames, name};
use super::samples::{Samples, nanoseconds};
use super::{ImportError, MessageFault};

/// Least value of an occupied cell of a map; a negative value is an unknown cell.
const OCCUPIED: i8 = 50;

/// Types of the messages that are imported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MessageType {
    Odometry,
    Scan,
    Map,
    Transforms,
}

impl MessageType {
    const ALL: [Self; 4] = [Self::Odometry, Self::Scan, Self::Map, Self::Transforms];

    fn name(self) -> &'static str {
        match self {
            Self::Odometry => "nav_msgs/msg/Odometry",
            Self::Scan => "sensor_msgs/msg/LaserScan",
            Self::Map => "nav_msgs/msg/OccupancyGrid",
            Self::Transforms => "tf2_msgs/msg/TFMessage",
        }
    }
}

/// The messages of a bag, by topic.
#[derive(Debug, Default)]
pub struct Bag {
    pub odometry: BTreeMap<String, Samples<(Pose2, Twist2)>>,
    pub scans: BTreeMap<String, Samples<Arc<[f32]>>>,
    /// The last map of each topic, with its frame.
    pub maps: BTreeMap<String, (String, CellMap)>,
    pub frames: Frames,
    /// Topics of these types.
    topics: BTreeMap<String, &'static str>,
    pub faults: Vec<String>,
}

/// Returns the namespace of a topic: its first part, if it has more than one.
pub fn namespace(topic: &str) -> &str {
    let end = topic.get(1..).and_then(|rest| rest.find('/'));
    end.and_then(|end| topic.get(..=end)).unwrap_or_default()
}

/// Returns the files of a bag: itself, or those in its folder.
fn files(bag: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let failed = |source| ImportError::Folder {
        bag: bag.to_owned(),
        source,
    };
    if !bag.metadata().map_err(failed)?.is_dir() {
        return Ok(vec![bag.to_owned()]);
    }
    let entries = fs::read_dir(bag).map_err(failed)?;
    let entries = entries.map(|entry| entry.map(|entry| entry.path()));
    let mut entries: Vec<PathBuf> = entries.collect::<Result<_, _>>().map_err(failed)?;
    entries.sort();
    // A reader names the remedy for a bag in a database.
    let with = |end: &str| {
        entries
            .iter()
            .filter(|path| path.extension().is_some_and(|own| own == end))
            .cloned()
            .collect()
    };
    let found: [Vec<PathBuf>; 2] = ["mcap", "db3"].map(with);
    found
        .into_iter()
        .find(|files| !files.is_empty())
        .ok_or_else(|| ImportError::Empty {
            bag: bag.to_owned(),
        })
}

impl Bag {
    /// Reads the wanted topics of a bag, and its frames.
    ///
    /// # Errors
    /// [`ImportError`]: a file is unreadable, or a message or the type of a topic is not as expected.
    pub fn read(
        path: &Path,
        wanted: &BTreeMap<String, MessageType>,
        watch: &mut ReadProgress,
    ) -> Result<Self, ImportError> {
        let mut bag = Self::default();
        for file in files(path)? {
            let mut reader = Reader::open(&file, Some(watch))?;
            let (mut schemas, mut channels) = (BTreeMap::new(), BTreeMap::new());
            while let Some(item) = reader.next()? {
                match item {
                    Item::Schema(id, schema) => {
                        schemas.insert(id, schema.name.clone());
                    }
                    Item::Channel(channel) => {
                        let found = schemas.get(&channel.schema_id).map_or("", String::as_str);
                        let known = MessageType::ALL
                            .into_iter()
                            .find(|known| known.name() == found);
                        let expected = wanted.get(&channel.topic).copied();
                        let expected =
                            expected.or(known.filter(|known| *known == MessageType::Transforms));
                        if let Some(expected) = expected {
                            if known != Some(expected) || channel.message_encoding != "cdr" {
                                return Err(ImportError::Type {
                                    bag: file,
                                    topic: channel.topic.clone(),
                                    found: format!("{found} in {}", channel.message_encoding),
                                    expected: expected.name(),
                                });
                            }
                            channels.insert(channel.id, (channel.topic.clone(), expected, 0));
                        }
                        bag.topics
                            .extend(known.map(|known| (channel.topic.clone(), known.name())));
                    }
                    Item::Message(header, data) => {
                        if let Some((topic, of, number)) = channels.get_mut(&header.channel_id) {
                            *number += 1;
                            bag.add(topic, *of, data)
                                .map_err(|fault| ImportError::Message {
                                    bag: file.clone(),
                                    topic: topic.clone(),
                                    number: *number,
                                    fault,
                                })?;
                        }
                    }
                    _ => {}
                }
            }
            bag.faults.extend(reader.condition().lines());
        }
        bag.frames.sort();
        bag.odometry
            .values_mut()
            .for_each(|samples| samples.list.sort_by_key(|(at, _)| *at));
        bag.scans
            .values_mut()
            .for_each(|samples| samples.list.sort_by_key(|(at, _)| *at));
        Ok(bag)
    }

    fn add(&mut self, topic: &str, of: MessageType, data: &[u8]) -> Result<(), MessageFault> {
        match of {
            MessageType::Odometry => self.add_odometry(topic, &decode(data)?),
            MessageType::Scan => self.add_scan(topic, &decode(data)?),
            MessageType::Map => self.add_map(topic, &decode(data)?),
            MessageType::Transforms => {
                let is_static = topic.ends_with("_static");
                let message: TFMessage = decode(data)?;
                for found in &message.transforms {
                    self.frames.add(namespace(topic), is_static, found);
                }
                Ok(())
            }
        }
    }

    fn add_odometry(&mut self, topic: &str, message: &Odometry) -> Result<(), MessageFault> {
        let (pose, twist) = (&message.pose.pose, &message.twist.twist);
        let upright = is_upright(&pose.orientation);
        let pose = pose2(pose.position.x, pose.position.y, &pose.orientation);
        let twist = Twist2::new(twist.linear.x, twist.angular.z);
        if !upright || !pose.is_finite() || !twist.is_finite() {
            return Err(MessageFault::Pose);
        }
        let samples = self
            .odometry
            .entry(topic.to_owned())
            .or_insert_with(|| Samples {
                frame: name(&message.header.frame_id).to_owned(),
                child: name(&message.child_frame_id).to_owned(),
                scanner: None,
                list: Vec::new(),
            });
        samples
            .list
            .push((nanoseconds(&message.header.stamp), (pose, twist)));
        Ok(())
    }

    fn add_scan(&mut self, topic: &str, message: &LaserScan) -> Result<(), MessageFault> {
        let samples = self
            .scans
            .entry(topic.to_owned())
            .or_insert_with(|| Samples {
                frame: name(&message.header.frame_id).to_owned(),
                child: String::new(),
                scanner: Some(ScanSpec {
                    beams: message.ranges.len(),
                    angle_min: f64::from(message.angle_min),
                    angle_increment: f64::from(message.angle_increment),
                    range_min: f64::from(message.range_min),
                    range_max: f64::from(message.range_max),
                    noise: 0.0,
                }),
                list: Vec::new(),
            });
        if let Some(first) = samples.scanner
            && (first.beams != message.ranges.len() || first.angle_min as f32 != message.angle_min)
        {
            return Err(MessageFault::Beams {
                found: message.ranges.len(),
                angle: message.angle_min,
                beams: first.beams,
                first: first.angle_min as f32,
            });
        }
        // As REP-117 has it; older drivers send 0 or NaN for beams that hit nothing.
        let range = |range: &f32| match *range {
            0.0 => f32::INFINITY,
            range if range < message.range_min => f32::NEG_INFINITY,
            range if range <= message.range_max => range,
            _ => f32::INFINITY,
        };
        let ranges = message.ranges.iter().map(range).collect();
        samples
            .list
            .push((nanoseconds(&message.header.stamp), ranges));
        Ok(())
    }

    fn add_map(&mut self, topic: &str, message: &OccupancyGrid) -> Result<(), MessageFault> {
        let (info, found) = (&message.info, message.data.len());
        let origin = pose2(
            info.origin.position.x,
            info.origin.position.y,
            &info.origin.orientation,
        );
        if origin.theta.abs() > 1e-6 {
            return Err(MessageFault::Turned(origin.theta));
        }
        let (width, height) = (info.width, info.height);
        if u64::from(width) * u64::from(height) != found as u64 {
            return Err(MessageFault::Cells {
                found,
                width,
                height,
            });
        }
        let grid = Grid {
            frame: GridFrame {
                width: width as usize,
                height: height as usize,
                // The number that the map file had, such as 0.05.
                resolution: info.resolution.to_string().parse().unwrap_or_default(),
                origin: Point2::new(origin.x, origin.y),
            },
            cells: message
                .data
                .iter()
                .map(|cell| !(0..OCCUPIED).contains(cell))
                .collect(),
        };
        let map = (
            name(&message.header.frame_id).to_owned(),
            CellMap::from_grid(&grid),
        );
        self.maps.insert(topic.to_owned(), map);
        Ok(())
    }

    /// Returns `true` if messages of a topic were read.
    pub fn has_messages(&self, topic: &str) -> bool {
        self.odometry.contains_key(topic)
            || self.scans.contains_key(topic)
            || self.maps.contains_key(topic)
    }

    /// Returns the topics that can be imported, with their types.
    pub fn known(&self) -> String {
        let topics = self
            .topics
            .iter()
            .map(|(topic, of)| format!("{topic} ({of})"));
        let topics: Vec<String> = topics.collect();
        if topics.is_empty() {
            "none".to_owned()
        } else {
            topics.join(", ")
        }
    }
}
