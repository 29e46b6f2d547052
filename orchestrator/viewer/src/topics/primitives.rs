//! Primitives shared by several topics.

use ros_messages::messages::{
    ColorRGBA, Duration, Header, Marker, MarkerArray, Point, PointCloud2, PointField, Time,
    Transform, TransformStamped, Vector3,
};
pub(super) use ros_messages::{pose, time};

/// Frame of all drawings.
pub(super) const MAP_FRAME: &str = "map";

/// Kinds of markers (`Marker::type`).
pub(super) mod kind {
    pub(crate) const ARROW: i32 = 0;
    pub(crate) const CUBE: i32 = 1;
    pub(crate) const CYLINDER: i32 = 3;
    pub(crate) const LINE_STRIP: i32 = 4;
    pub(crate) const LINE_LIST: i32 = 5;
    pub(crate) const CUBE_LIST: i32 = 6;
    pub(crate) const TEXT: i32 = 9;
    pub(crate) const TRIANGLE_LIST: i32 = 11;
}

/// Value of `Marker::action` that removes all markers of the topic.
const DELETE_ALL: i32 = 3;

/// Triangles of a marker: few enough that the last one of a field of view is not mostly empty.
const TRIANGLES: usize = 32;

/// Value of `PointField::datatype` for `f32`.
const FLOAT32: u8 = 7;

/// Converts a duration (s, not negative) to that of ROS.
pub(super) fn duration(seconds: f64) -> Duration {
    let Time { sec, nanosec } = time((seconds * 1e9) as u64);
    Duration { sec, nanosec }
}

/// Returns a header in the map frame.
pub(super) fn header(time_ns: u64) -> Header {
    Header {
        stamp: time(time_ns),
        frame_id: MAP_FRAME.to_owned(),
    }
}

/// Creates a list of markers that replaces all earlier ones of the topic.
pub(super) fn picture(time_ns: u64) -> MarkerArray {
    MarkerArray {
        markers: vec![Marker {
            header: header(time_ns),
            action: DELETE_ALL,
            pose: pose(0.0, 0.0, 0.0, 0.0),
            ..Marker::default()
        }],
    }
}

/// Creates a marker at the origin; `name` and `id` identify it.
pub(super) fn marker(name: &str, id: u32, kind: i32, color: ColorRGBA, time_ns: u64) -> Marker {
    Marker {
        header: header(time_ns),
        ns: name.to_owned(),
        id: id as i32,
        r#type: kind,
        pose: pose(0.0, 0.0, 0.0, 0.0),
        scale: Vector3 {
            x: 1.0,
            y: 1.0,
            z: 1.0,
        },
        color,
        ..Marker::default()
    }
}

/// Adds triangles, three points each, as markers of this name.
///
/// Every marker has [`TRIANGLES`] triangles, the last one some without area: Foxglove Studio draws a marker with the
/// object of a removed one, whose normals keep their number. Triangles beyond it get no light and look grey.
pub(super) fn add_triangles(
    markers: &mut Vec<Marker>,
    name: &str,
    color: &ColorRGBA,
    points: &[Point],
    time_ns: u64,
) {
    for part in points.chunks(3 * TRIANGLES) {
        let id = markers.len() as u32;
        let mut triangles = marker(name, id, kind::TRIANGLE_LIST, color.clone(), time_ns);
        triangles.points = part.to_vec();
        let last = part.last().cloned().unwrap_or_default();
        triangles.points.resize(3 * TRIANGLES, last);
        markers.push(triangles);
    }
}

/// Returns the scale of lines of this width (m).
pub(super) fn width(width: f64) -> Vector3 {
    Vector3 {
        x: width,
        y: 0.0,
        z: 0.0,
    }
}

/// Creates a cloud of points of `step` bytes from their bytes; `fields` are names and offsets of `f32` values.
pub(super) fn cloud(
    time_ns: u64,
    fields: &[(&str, u32)],
    step: usize,
    data: Vec<u8>,
) -> PointCloud2 {
    let field = |&(name, offset): &(&str, u32)| PointField {
        name: name.to_owned(),
        offset,
        datatype: FLOAT32,
        count: 1,
    };
    PointCloud2 {
        header: header(time_ns),
        height: 1,
        width: (data.len() / step) as u32,
        fields: fields.iter().map(field).collect(),
        is_bigendian: false,
        point_step: step as u32,
        row_step: data.len() as u32,
        data,
        is_dense: true,
    }
}

/// Returns a frame of the map.
pub(super) fn transform(
    child: &str,
    [x, y]: [f64; 2],
    theta: f64,
    time_ns: u64,
) -> TransformStamped {
    TransformStamped {
        header: header(time_ns),
        child_frame_id: child.to_owned(),
        transform: Transform {
            translation: Vector3 { x, y, z: 0.0 },
            rotation: ros_messages::yaw(theta),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_view_keep_their_colour_while_playing_because_all_markers_have_as_many_triangles() {
        let color = ColorRGBA::default();
        for triangles in [0, 1, TRIANGLES, TRIANGLES + 1, 100] {
            let mut markers = Vec::new();
            let points = vec![Point::default(); 3 * triangles];
            add_triangles(&mut markers, "field", &color, &points, 0);
            assert_eq!(markers.len(), triangles.div_ceil(TRIANGLES));
            assert!(markers.iter().all(|m| m.points.len() == 3 * TRIANGLES));
            assert!(markers.iter().map(|m| m.id as usize).eq(0..markers.len()));
        }
    }
}
