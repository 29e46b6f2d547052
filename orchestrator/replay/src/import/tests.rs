use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use geometry::pose::Pose2;
use mcap_log::{ChannelSpec, LogOptions, LogWriter, Manifest, ReadProgress};
use mission::in_process::Track;
use robot::spec::RobotSpec;
use ros_messages::messages::{
    Header, LaserScan, OccupancyGrid, Odometry, PoseWithCovariance, Quaternion, TFMessage,
    TransformStamped, Vector3,
};
use ros_messages::{RosType, definition, encode, pose, time, yaw};

use super::bag::{Bag, MessageType, Samples, namespace};
use super::frames::Frames;
use super::{Following, Recorded, cells};

fn header(frame: &str) -> Header {
    Header {
        stamp: time(7),
        frame_id: frame.to_owned(),
    }
}

/// Reads a bag with these messages of one type in `/topic`, as one of `wanted`.
fn read<M: RosType>(messages: &[M], wanted: MessageType) -> Result<Bag, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bag.mcap");
    let mut log = LogWriter::create(&path, &LogOptions::default(), &Manifest::default()).unwrap();
    let (name, schema) = definition::<M>();
    let is_frames = name.starts_with("tf2");
    let channel = log.add_channel(&ChannelSpec {
        topic: if is_frames { "/guard/tf" } else { "/topic" },
        schema_name: &name,
        schema_encoding: "ros2msg",
        schema: schema.as_bytes(),
        message_encoding: "cdr",
        metadata: &BTreeMap::new(),
    });
    let channel = channel.unwrap();
    for message in messages {
        let mut data = Vec::new();
        encode(message, &mut data);
        log.write(channel, 0, 0, 0, &data).unwrap();
    }
    log.finish().unwrap();
    let wanted = BTreeMap::from([("/topic".to_owned(), ("name".to_owned(), wanted))]);
    let bag = Bag::read(
        folder.path(),
        &wanted,
        &mut ReadProgress::new(Arc::default(), true),
    );
    bag.map_err(|error| {
        error
            .to_string()
            .replace(folder.path().to_str().unwrap(), "BAG")
    })
}

fn odometry() -> Odometry {
    Odometry {
        header: header("odom"),
        pose: PoseWithCovariance {
            pose: pose(1.0, 2.0, 0.0, 0.5),
            ..PoseWithCovariance::default()
        },
        ..Odometry::default()
    }
}

/// Lets a robot follow messages in an odometry frame that is the map.
fn follow(odometry: Odometry, scans: Vec<LaserScan>) -> Result<Track, String> {
    let samples = Samples {
        topic: "/odom".to_owned(),
        list: vec![(7, odometry)],
    };
    let list = (7..).zip(scans);
    let scans = Samples {
        topic: "/scan".to_owned(),
        list: list.collect(),
    };
    let frames = Frames::default();
    let mut following = Following {
        frames: &frames,
        map: "odom",
        ticks: (7..=8).step_by(1),
        max_age_s: 1.0,
        remarks: Vec::new(),
    };
    let recorded = Recorded {
        robot: 3,
        odometry: &samples,
        scans: Some(&scans),
    };
    let mut spec = RobotSpec::new("guard", robot::team::Role::Neutral, Pose2::default());
    let track = following.follow(&recorded, &mut spec);
    track.map_err(|fault| fault.to_string())
}

#[test]
fn messages_that_no_run_takes_are_named_with_time_and_expectation() {
    let track = follow(odometry(), Vec::new()).unwrap();
    assert_eq!(
        (track.robot, track.poses.len(), track.scans.len()),
        (3, 2, 0)
    );
    for broken in [
        |odometry: &mut Odometry| odometry.pose.pose.position.x = f64::NAN,
        |odometry: &mut Odometry| odometry.twist.twist.angular.z = f64::INFINITY,
        |odometry: &mut Odometry| odometry.pose.pose.orientation = Quaternion::default(),
        |odometry: &mut Odometry| odometry.pose.pose.orientation.x = 1.0,
    ] {
        let mut odometry = odometry();
        broken(&mut odometry);
        assert_eq!(
            follow(odometry, Vec::new()).unwrap_err(),
            "/odom: the message of 0.000 s is not usable: expected finite numbers, and a rotation about the vertical axis"
        );
    }
    let scan = |beams: usize| LaserScan {
        header: header("laser"),
        ranges: vec![1.0; beams],
        range_max: 2.0,
        ..LaserScan::default()
    };
    let track = follow(odometry(), vec![scan(3), scan(3)]).unwrap();
    assert_eq!(track.scans[1].as_ref(), [1.0; 3]);
    assert_eq!(
        follow(odometry(), vec![scan(3), scan(2)]).unwrap_err(),
        "/scan: the message of 0.000 s is not usable: expected the beams of the first message"
    );
    let refused = read(&[odometry()], MessageType::Scan).unwrap_err();
    assert_eq!(
        refused,
        "BAG/bag.mcap: /topic is nav_msgs/msg/Odometry in cdr: expected sensor_msgs/msg/LaserScan in cdr; --topic NAME=TOPIC \
         names another topic"
    );
}

#[test]
fn cells_of_maps_are_obstacles_from_50_on_or_unknown() {
    let mut map = OccupancyGrid {
        header: header("map"),
        data: vec![-1, 0, 49, 50, 100, 0],
        ..OccupancyGrid::default()
    };
    (map.info.width, map.info.height, map.info.resolution) = (3, 2, 0.05);
    map.info.origin = pose(1.0, 2.0, 0.0, 0.0);
    let found = cells(&map).unwrap();
    assert_eq!((found.resolution, found.origin), (0.05, [1.0, 2.0]));
    assert_eq!(found.runs, [0, 1, 2, 2, 1]);
    let mut turned = map.clone();
    turned.info.origin = pose(0.0, 0.0, 0.0, FRAC_PI_2);
    map.data.pop();
    assert_eq!((cells(&turned), cells(&map)), (None, None));
}

#[test]
fn frames_are_placed_through_others_by_the_newest_transform() {
    let link =
        |parent: &str, child: &str, at_ns: u64, x: f64, rotation: Quaternion| TransformStamped {
            header: Header {
                stamp: time(at_ns),
                frame_id: parent.to_owned(),
            },
            child_frame_id: child.to_owned(),
            transform: ros_messages::messages::Transform {
                translation: Vector3 { x, y: 0.0, z: 3.0 },
                rotation,
            },
        };
    let message = TFMessage {
        transforms: vec![
            link("base", "laser", 0, 0.0, Quaternion { x: 1.0, ..yaw(0.0) }),
            link("/odom", "base", 0, 1.0, yaw(0.0)),
            link("map", "odom", 20, 10.0, yaw(PI)),
            link("map", "odom", 10, 5.0, yaw(FRAC_PI_2)),
        ],
    };
    let frames = read(&[message], MessageType::Map).unwrap().frames;
    let place = |frame, within, at| frames.place("/guard", frame, within, at);
    let near = |found: Option<Pose2>, x: f64, y: f64| {
        let found = found.unwrap();
        assert!(
            (found.x - x).abs() < 1e-12 && (found.y - y).abs() < 1e-12,
            "{found:?}"
        );
    };
    near(place("base", "map", 19), 5.0, 1.0);
    near(place("base", "map", 0), 5.0, 1.0);
    near(place("base", "map", 20), 9.0, 0.0);
    assert_eq!(place("map", "base", 0), None);
    assert_eq!(frames.place("", "base", "map", 0), None);
    assert_eq!(place("laser", "base", 0), None);
    let topics = ["/tf", "/guard/tf", "/a/b/odom", "odom", ""];
    assert_eq!(topics.map(namespace), ["", "/guard", "/a", "", ""]);
}

#[test]
fn the_nearest_message_of_each_tick_is_taken_and_gaps_are_named() {
    let samples = Samples {
        topic: "/odom".to_owned(),
        list: vec![(100, 'a'), (149, 'b'), (1_000_000_300, 'c')],
    };
    let letter = |time| samples.nearest(time, 1.0).unwrap().1;
    assert_eq!(
        [0, 100, 120, 130, 200, 1_000_000_301].map(letter),
        ['a', 'a', 'a', 'b', 'b', 'c']
    );
    assert_eq!(
        samples.nearest(500_000_000, 0.4).unwrap_err().to_string(),
        "/odom: no message from 0.000 s to 1.000 s: expected one within 0.4 s of each tick; --max-age S permits more"
    );
    assert_eq!(samples.span(), (100, 1_000_000_300));
}
