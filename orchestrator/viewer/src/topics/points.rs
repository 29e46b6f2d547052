//! Beliefs and range scans.

use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::messages::perception::Particle;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::{Belief, Scan, TopicId};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{cloud, header};
use ros_messages::messages::{Header, LaserScan, PointCloud2};

/// Fields of a particle and their offsets (bytes): the bytes are those of `perception/belief`, which lets the
/// compression of the log find them again. Its weight is also its height (m), because viewers require one.
const FIELDS: [(&str, u32); 5] = [("x", 0), ("y", 4), ("z", 12), ("theta", 8), ("weight", 12)];

/// `/beliefs`: the particles of all beliefs of a tick.
pub(super) struct BeliefsTopic {
    channel: ViewerChannel<PointCloud2>,
    /// Particles of the current tick.
    particles: Vec<u8>,
}

impl BeliefsTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self {
            channel: picture.add_channel("/beliefs"),
            particles: Vec::new(),
        }
    }
}

impl Consumer<Picture> for BeliefsTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Belief]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        if picture.is_drawing(message.time_ns)
            && let Some((_, particles)) = message.view::<Belief>()
        {
            let length = particles.len() * size_of::<Particle>();
            let start = message.bytes.len().saturating_sub(length);
            let particles = message.bytes.get(start..).unwrap_or_default();
            self.particles.extend_from_slice(particles);
        }
    }

    fn end_of_tick(&mut self, picture: &mut Picture) {
        if !self.particles.is_empty() {
            let time_ns = picture.now_ns();
            let particles = core::mem::take(&mut self.particles);
            let cloud = cloud(time_ns, &FIELDS, size_of::<Particle>(), particles);
            self.channel.write(&mut picture.ready, time_ns, &cloud);
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
