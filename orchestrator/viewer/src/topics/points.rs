//! Beliefs and range scans.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::perception::Particle;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::{Belief, Scan, TopicId};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{cloud, header};
use crate::ros::messages::{Header, LaserScan, PointCloud2};

/// Fields of a particle in the cloud; `robot` is the index of the robot that the belief is about.
const FIELDS: [&str; 6] = ["x", "y", "z", "theta", "weight", "robot"];

/// `/beliefs`: the particles of all beliefs of a tick.
pub(super) struct BeliefsTopic {
    channel: ViewerChannel<PointCloud2>,
    /// Points of the beliefs of the current tick.
    points: Vec<u8>,
}

impl BeliefsTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/beliefs"),
            points: Vec::new(),
        }
    }
}

impl Consumer<Picture> for BeliefsTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Belief]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if picture.is_drawing(message.time_ns)
            && let Some((header, particles)) = message.view::<Belief>()
        {
            for Particle {
                x,
                y,
                theta,
                weight,
            } in particles
            {
                for value in [x, y, 0.0, theta, weight, header.robot as f32] {
                    self.points.extend(value.to_le_bytes());
                }
            }
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        if !self.points.is_empty() {
            let time_ns = picture.now_ns();
            let points = core::mem::take(&mut self.points);
            let cloud = cloud(time_ns, &FIELDS, points);
            self.channel.write(&mut picture.ready, time_ns, &cloud);
            self.points = cloud.data;
            self.points.clear();
        }
    }
}

/// `/ROBOT/scan`.
pub(super) struct ScansTopic(Vec<ViewerChannel<LaserScan>>);

impl ScansTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_robot_channels("scan"))
    }
}

impl Consumer<Picture> for ScansTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Scan]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        let time_ns = message.time_ns;
        if picture.is_drawing(time_ns)
            && let Some((header, ranges)) = message.view::<Scan>()
            && let Some(channel) = self.0.get(header.robot as usize)
            && let Some(robot) = picture.robots.get(header.robot as usize)
        {
            let scan = scan(&header, time_ns, &robot.name, ranges);
            channel.write(&mut picture.ready, time_ns, &scan);
        }
    }
}

/// Returns a range scan in the frame of its robot.
fn scan(
    of: &ScanHeader,
    time_ns: u64,
    robot: &str,
    ranges: impl ExactSizeIterator<Item = f32>,
) -> LaserScan {
    let beams = ranges.len().saturating_sub(1) as f64;
    LaserScan {
        header: Header {
            frame_id: robot.to_owned(),
            ..header(time_ns)
        },
        angle_min: of.angle_min as f32,
        angle_max: (of.angle_min + beams * of.angle_increment) as f32,
        angle_increment: of.angle_increment as f32,
        time_increment: 0.0,
        scan_time: 0.0,
        range_min: 0.0,
        range_max: of.range_max as f32,
        ranges: ranges.collect(),
        intensities: Vec::new(),
    }
}
