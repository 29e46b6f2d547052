//! Primitives shared by several topics.

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    PackedElementField, Pose, Quaternion, SceneEntity, SceneEntityDeletion, Timestamp, Vector3,
    scene_entity_deletion,
};
use geometry::math::sincos;

/// Frame of all entities.
pub(super) const MAP_FRAME: &str = "map";

/// Converts simulated time (ns) to the timestamp of viewers.
pub(super) fn timestamp(time_ns: u64) -> Timestamp {
    // A run of more than 136 years ends at the largest time.
    let seconds = u32::try_from(time_ns / 1_000_000_000).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (time_ns % 1_000_000_000) as u32)
}

/// Returns a rotation about the vertical axis (rad).
pub(super) fn yaw(theta: f64) -> Quaternion {
    let (sin, cos) = sincos(theta / 2.0);
    Quaternion {
        x: 0.0,
        y: 0.0,
        z: sin,
        w: cos,
    }
}

/// Returns a pose in the plane at height `z` (m).
pub(super) fn pose(x: f64, y: f64, z: f64, theta: f64) -> Pose {
    Pose {
        position: Some(Vector3 { x, y, z }),
        orientation: Some(yaw(theta)),
    }
}

/// Returns an empty entity in the map frame.
pub(super) fn entity(id: String, time_ns: u64) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(time_ns)),
        frame_id: MAP_FRAME.to_owned(),
        id,
        ..SceneEntity::default()
    }
}

/// Returns the deletion of an entity.
pub(super) fn deletion(id: String, time_ns: u64) -> SceneEntityDeletion {
    SceneEntityDeletion {
        timestamp: Some(timestamp(time_ns)),
        r#type: scene_entity_deletion::Type::MatchingId as i32,
        id,
    }
}

/// Returns the fields of packed elements, each with name and offset (bytes), all of one type.
pub(super) fn packed_fields(kind: NumericType, fields: &[(&str, u32)]) -> Vec<PackedElementField> {
    let field = |&(name, offset): &(&str, u32)| PackedElementField {
        name: name.to_owned(),
        offset,
        r#type: kind as i32,
    };
    fields.iter().map(field).collect()
}
