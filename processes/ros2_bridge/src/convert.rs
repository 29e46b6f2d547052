//! Messages of a run as those of ROS 2: frames by REP-105, times as ROS 2 nodes read them.
//!
//! A run begins at 0 s, which a ROS 2 node takes for *no time yet*. Times of ROS 2 are therefore one tick ahead of
//! those of the log.

use ipc_types::messages::perception::Particle;
use ipc_types::messages::robot::PlanPoint;
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, WorldHeader};

use ipc_types::topics::Scan;
use ros_messages::messages::{
    Header, LaserScan, MapMetaData, OccupancyGrid, Odometry, Path, PoseArray, PoseStamped,
    PoseWithCovariance, TFMessage, Time, Transform, TransformStamped, Twist, TwistWithCovariance,
    Vector3,
};
use ros_messages::{pose, yaw};
use runtime::inputs::Latest;

use crate::names::Namespace;

/// Frame of the world.
pub const MAP: &str = "map";

/// The time of ROS 2 for a state of the world.
pub fn time(state: &WorldHeader) -> Time {
    ros_messages::time(state.stamp.time_ns.saturating_add(state.tick_period_ns))
}

/// Odometry of a robot, which has no error: its frame `odom` is that of the map.
pub fn odometry(namespace: &Namespace, robot: &RobotState, stamp: Time) -> Odometry {
    Odometry {
        header: header(stamp, namespace.frame("odom")),
        child_frame_id: namespace.frame("base_link"),
        pose: PoseWithCovariance {
            pose: pose(robot.x, robot.y, 0.0, robot.theta),
            ..PoseWithCovariance::default()
        },
        twist: TwistWithCovariance {
            twist: twist(robot.v, robot.omega),
            ..TwistWithCovariance::default()
        },
    }
}

/// Velocities: forward (m/s), turning (rad/s).
pub fn twist(v: f64, omega: f64) -> Twist {
    Twist {
        linear: Vector3 {
            x: v,
            ..Vector3::default()
        },
        angular: Vector3 {
            z: omega,
            ..Vector3::default()
        },
    }
}

/// The same pose as a transform from `odom` to `base_link`.
pub fn transform(namespace: &Namespace, robot: &RobotState, stamp: Time) -> TransformStamped {
    TransformStamped {
        header: header(stamp, namespace.frame("odom")),
        child_frame_id: namespace.frame("base_link"),
        transform: Transform {
            translation: Vector3 {
                x: robot.x,
                y: robot.y,
                z: 0.0,
            },
            rotation: yaw(robot.theta),
        },
    }
}

/// Transforms that never change: from the map to `odom` of each robot, from `base_link` to its scanner.
pub fn static_transforms<'a>(namespaces: impl Iterator<Item = &'a Namespace>) -> TFMessage {
    let fixed = |parent: String, child: String| TransformStamped {
        header: header(Time::default(), parent),
        child_frame_id: child,
        transform: Transform {
            rotation: yaw(0.0),
            ..Transform::default()
        },
    };
    let of_robot = |namespace: &Namespace| {
        [
            fixed(MAP.to_owned(), namespace.frame("odom")),
            fixed(namespace.frame("base_link"), namespace.frame("scan")),
        ]
    };
    TFMessage {
        transforms: namespaces.flat_map(of_robot).collect(),
    }
}

/// A range scan.
pub fn scan(frame: String, scan: &Latest<Scan>, stamp: Time, period_s: f64) -> LaserScan {
    let (ranges, scan) = (&scan.elements, &scan.header);
    let last = ranges.len().saturating_sub(1) as f64;
    LaserScan {
        header: header(stamp, frame),
        angle_min: scan.angle_min as f32,
        angle_max: (scan.angle_min + scan.angle_increment * last) as f32,
        angle_increment: scan.angle_increment as f32,
        time_increment: 0.0,
        scan_time: period_s as f32,
        range_min: scan.range_min as f32,
        range_max: scan.range_max as f32,
        ranges: ranges.clone(),
        intensities: Vec::new(),
    }
}

/// A map.
pub fn grid(map: &MapHeader, cells: &[MapCell], stamp: Time) -> OccupancyGrid {
    OccupancyGrid {
        header: header(stamp.clone(), MAP.to_owned()),
        info: MapMetaData {
            map_load_time: stamp,
            resolution: map.resolution as f32,
            width: map.width,
            height: map.height,
            origin: pose(map.origin_x, map.origin_y, 0.0, 0.0),
        },
        data: cells
            .iter()
            .map(|cell| if cell.occupied != 0 { 100 } else { 0 })
            .collect(),
    }
}

/// A belief: the poses of its particles.
pub fn belief(particles: &[Particle], stamp: Time) -> PoseArray {
    let particle = |p: &Particle| pose(f64::from(p.x), f64::from(p.y), 0.0, f64::from(p.theta));
    PoseArray {
        header: header(stamp, MAP.to_owned()),
        poses: particles.iter().map(particle).collect(),
    }
}

/// A plan: its points with their headings.
pub fn plan(points: impl Iterator<Item = PlanPoint>, stamp: Time) -> Path {
    let header = header(stamp, MAP.to_owned());
    let poses = points.map(|point| PoseStamped {
        header: header.clone(),
        pose: pose(point.x, point.y, 0.0, point.theta),
    });
    Path {
        poses: poses.collect(),
        header,
    }
}

fn header(stamp: Time, frame_id: String) -> Header {
    Header { stamp, frame_id }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_one_tick_ahead_so_that_the_first_is_not_no_time_yet() {
        let mut state = WorldHeader {
            tick_period_ns: 50_000_000,
            ..WorldHeader::default()
        };
        assert_eq!(time(&state), ros_messages::time(50_000_000));
        state.stamp.time_ns = 1_950_000_000;
        let whole = Time { sec: 2, nanosec: 0 };
        assert_eq!(time(&state), whole);
    }

    #[test]
    fn frames_are_those_of_the_robot_and_poses_turn_about_z() {
        let robot = RobotState {
            x: 1.0,
            y: -2.0,
            theta: core::f64::consts::PI,
            v: 0.5,
            omega: -0.25,
            ..RobotState::default()
        };
        let guard = Namespace::new("guard", "").unwrap();
        let odometry = odometry(&guard, &robot, Time::default());
        let transform = transform(&guard, &robot, Time::default());
        assert_eq!(odometry.header.frame_id, "guard/odom");
        assert_eq!(odometry.child_frame_id, "guard/base_link");
        assert_eq!(
            (&odometry.header, &odometry.child_frame_id),
            (&transform.header, &transform.child_frame_id)
        );
        let (position, turn) = (
            &odometry.pose.pose.position,
            &odometry.pose.pose.orientation,
        );
        assert_eq!((position.x, position.y, position.z), (1.0, -2.0, 0.0));
        assert!((turn.z - 1.0).abs() < 1e-12 && turn.w.abs() < 1e-12);
        assert_eq!(&transform.transform.rotation, turn);
        let twist = &odometry.twist.twist;
        assert_eq!((twist.linear.x, twist.angular.z), (0.5, -0.25));
    }
}
