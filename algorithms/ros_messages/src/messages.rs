//! Messages of ROS 2 (Humble and later) that viewers draw and nodes read.
//!
//! Fields and their order are those of the packages `builtin_interfaces`, `std_msgs`, `geometry_msgs`, `nav_msgs`,
//! `sensor_msgs`, `tf2_msgs`, `visualization_msgs`, `rcl_interfaces` and `rosgraph_msgs`. Constants are not part of
//! the schemas.

use super::encoding::ros_messages;

ros_messages! {
    /// Time (s, ns).
    builtin_interfaces / Time { sec: i32, nanosec: u32 }
    /// Duration (s, ns).
    builtin_interfaces / Duration { sec: i32, nanosec: u32 }

    /// Time and frame of a message.
    std_msgs / Header { stamp: Time, frame_id: String }
    /// Colour, each component 0 to 1.
    std_msgs / ColorRGBA { r: f32, g: f32, b: f32, a: f32 }

    /// Point (m).
    geometry_msgs / Point { x: f64, y: f64, z: f64 }
    /// Vector.
    geometry_msgs / Vector3 { x: f64, y: f64, z: f64 }
    /// Rotation.
    geometry_msgs / Quaternion { x: f64, y: f64, z: f64, w: f64 }
    /// Position and orientation.
    geometry_msgs / Pose { position: Point, orientation: Quaternion }
    /// Pose with time and frame.
    geometry_msgs / PoseStamped { header: Header, pose: Pose }
    /// Pose with covariance.
    geometry_msgs / PoseWithCovariance { pose: Pose, covariance: [[f64; 6]; 6] }
    /// Velocity (m/s, rad/s).
    geometry_msgs / Twist { linear: Vector3, angular: Vector3 }
    /// Velocity with time and frame.
    geometry_msgs / TwistStamped { header: Header, twist: Twist }
    /// Velocity with covariance.
    geometry_msgs / TwistWithCovariance { twist: Twist, covariance: [[f64; 6]; 6] }
    /// Translation (m) and rotation.
    geometry_msgs / Transform { translation: Vector3, rotation: Quaternion }
    /// Pose of a frame in its parent.
    geometry_msgs / TransformStamped { header: Header, child_frame_id: String, transform: Transform }
    /// Poses (m).
    geometry_msgs / PoseArray { header: Header, poses: Vec<Pose> }
    /// Poses of frames.
    tf2_msgs / TFMessage { transforms: Vec<TransformStamped> }

    /// Size and place of a grid (m).
    nav_msgs / MapMetaData { map_load_time: Time, resolution: f32, width: u32, height: u32, origin: Pose }
    /// Map: 0 free, 100 occupied.
    nav_msgs / OccupancyGrid { header: Header, info: MapMetaData, data: Vec<i8> }
    /// Pose and velocity of a robot.
    nav_msgs / Odometry { header: Header, child_frame_id: String, pose: PoseWithCovariance, twist: TwistWithCovariance }
    /// Path.
    nav_msgs / Path { header: Header, poses: Vec<PoseStamped> }

    /// Range scan (m, rad, s).
    sensor_msgs / LaserScan {
        header: Header, angle_min: f32, angle_max: f32, angle_increment: f32, time_increment: f32, scan_time: f32,
        range_min: f32, range_max: f32, ranges: Vec<f32>, intensities: Vec<f32>,
    }
    /// Field of the points of a cloud.
    sensor_msgs / PointField { name: String, offset: u32, datatype: u8, count: u32 }
    /// Points.
    sensor_msgs / PointCloud2 {
        header: Header, height: u32, width: u32, fields: Vec<PointField>, is_bigendian: bool, point_step: u32,
        row_step: u32, data: Vec<u8>, is_dense: bool,
    }
    /// Image, not used here: a part of [`Marker`].
    sensor_msgs / CompressedImage { header: Header, format: String, data: Vec<u8> }

    /// Coordinates in an image, not used here: a part of [`Marker`].
    visualization_msgs / UVCoordinate { u: f32, v: f32 }
    /// File of a mesh, not used here: a part of [`Marker`].
    visualization_msgs / MeshFile { filename: String, data: Vec<u8> }
    /// Drawing.
    visualization_msgs / Marker {
        header: Header, ns: String, id: i32, r#type: i32, action: i32, pose: Pose, scale: Vector3, color: ColorRGBA,
        lifetime: Duration, frame_locked: bool, points: Vec<Point>, colors: Vec<ColorRGBA>, texture_resource: String,
        texture: CompressedImage, uv_coordinates: Vec<UVCoordinate>, text: String, mesh_resource: String,
        mesh_file: MeshFile, mesh_use_embedded_materials: bool,
    }
    /// Drawings.
    visualization_msgs / MarkerArray { markers: Vec<Marker> }

    /// Line of a log.
    rcl_interfaces / Log {
        stamp: Time, level: u8, name: String, msg: String, file: String, function: String, line: u32,
    }
    /// Simulated time.
    rosgraph_msgs / Clock { clock: Time }
}
