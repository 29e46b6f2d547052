//! Particles and range scans.

use foxglove::messages::{
    LaserScan, PackedElementField, PointCloud, packed_element_field::NumericType,
};
use ipc_types::message::Message;
use ipc_types::messages::perception::Particle;
use ipc_types::messages::robot::ScanHeader;

use super::scene::pose;
use super::{MAP_FRAME, timestamp};

/// A belief as a cloud of points; the particles' bytes are taken as they are, and all of their
/// fields can be used for colouring.
pub(super) fn cloud(time_ns: u64, particles: &[u8]) -> PointCloud {
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

/// A range scan in its robot's frame.
pub(super) fn scan(
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
