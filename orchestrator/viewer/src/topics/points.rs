//! Particles and range scans.

use foxglove::messages::{
    LaserScan, PackedElementField, PointCloud, packed_element_field::NumericType,
};
use ipc_types::consumer::{Consumer, LoggedMessage};
use ipc_types::message::Message;
use ipc_types::messages::perception::Particle;
use ipc_types::messages::robot::ScanHeader;
use ipc_types::topics::{Belief, Scan, TopicId};

use super::channel::ViewerChannel;
use super::picture::Picture;
use super::primitives::{MAP_FRAME, pose, timestamp};

/// `/viewer/particles/ROBOT`: the belief about a robot.
pub(super) struct ParticlesTopic(Vec<ViewerChannel<PointCloud>>);

impl ParticlesTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_channels("particles"))
    }
}

impl Consumer<Picture> for ParticlesTopic {
    fn topics(&self) -> &[TopicId] {
        &[TopicId::Belief]
    }

    fn message(&mut self, message: &LoggedMessage<'_>, picture: &mut Picture) {
        let time_ns = message.time_ns;
        if picture.is_drawing(time_ns)
            && let Some((header, particles)) = message.view::<Belief>()
            && let Some(channel) = self.0.get(header.robot as usize)
        {
            let length = particles.len() * size_of::<Particle>();
            let start = message.bytes.len().saturating_sub(length);
            let particles = message.bytes.get(start..).unwrap_or_default();
            channel.write(&mut picture.ready, time_ns, &cloud(time_ns, particles));
        }
    }
}

/// `/viewer/scan/ROBOT`.
pub(super) struct ScansTopic(Vec<ViewerChannel<LaserScan>>);

impl ScansTopic {
    pub(super) fn new(picture: &mut Picture) -> Self {
        Self(picture.add_channels("scan"))
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

/// Returns a belief as a point cloud with the unchanged bytes of the particles; all fields can be used for
/// colouring.
fn cloud(time_ns: u64, particles: &[u8]) -> PointCloud {
    const { assert!(size_of::<Particle>() == 16) };
    let descriptor = Particle::DESCRIPTOR;
    let fields = descriptor
        .fields
        .iter()
        .map(|field| PackedElementField {
            name: field.name.to_owned(),
            offset: field.offset as u32,
            r#type: NumericType::Float32 as i32,
        })
        .collect();
    PointCloud {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP_FRAME.to_owned(),
        pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
        point_stride: descriptor.size as u32,
        fields,
        data: particles.to_vec().into(),
    }
}

/// Returns a range scan in the frame of its robot.
fn scan(
    header: &ScanHeader,
    time_ns: u64,
    robot: &str,
    ranges: impl ExactSizeIterator<Item = f32>,
) -> LaserScan {
    let beams = ranges.len().saturating_sub(1) as f64;
    LaserScan {
        timestamp: Some(timestamp(time_ns)),
        frame_id: robot.to_owned(),
        pose: Some(pose(0.0, 0.0, 0.0, 0.0)),
        start_angle: header.angle_min,
        end_angle: header.angle_min + beams * header.angle_increment,
        ranges: ranges.map(f64::from).collect(),
        intensities: Vec::new(),
    }
}
