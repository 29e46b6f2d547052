use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;
use std::sync::Arc;

use mcap_log::{ChannelSpec, LogOptions, LogWriter, Manifest, ReadProgress};
use ros_messages::messages::{
    Header, LaserScan, OccupancyGrid, Odometry, Quaternion, TFMessage, TransformStamped, Vector3,
};
use ros_messages::{RosType, definition, encode, pose, time, yaw};

use super::bag::{Bag, MessageType, namespace};
use super::samples::Samples;

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
    let wanted = BTreeMap::from([("/topic".to_owned(), wanted)]);
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

#[test]
fn invalid_messages_are_named_with_file_topic_number_and_expectation() {
    let refused = |result: Result<Bag, String>| result.unwrap_err();
    let good = Odometry {
        header: header("odom"),
        pose: ros_messages::messages::PoseWithCovariance {
            pose: pose(1.0, 2.0, 0.0, 0.5),
            ..Default::default()
        },
        ..Odometry::default()
    };
    let mut tilted = good.clone();
    tilted.pose.pose.orientation = Quaternion { x: 1.0, ..yaw(0.0) };
    let plane = "its pose or velocity is not in the plane: expected finite numbers and a rotation about the vertical axis";
    assert_eq!(
        refused(read(&[good.clone(), tilted], MessageType::Odometry)),
        format!("BAG/bag.mcap: /topic, message 2: {plane}")
    );
    for broken in [
        |odometry: &mut Odometry| odometry.pose.pose.position.x = f64::NAN,
        |odometry: &mut Odometry| odometry.twist.twist.angular.z = f64::INFINITY,
        |odometry: &mut Odometry| odometry.pose.pose.orientation = Quaternion::default(),
    ] {
        let mut odometry = good.clone();
        broken(&mut odometry);
        assert_eq!(
            refused(read(&[odometry], MessageType::Odometry)),
            format!("BAG/bag.mcap: /topic, message 1: {plane}")
        );
    }
    assert_eq!(
        refused(read(&[good], MessageType::Scan)),
        "BAG/bag.mcap: /topic is nav_msgs/msg/Odometry in cdr: expected sensor_msgs/msg/LaserScan; --topic NAME=TOPIC names \
         another topic"
    );
    let scan = |beams: usize| LaserScan {
        header: header("laser"),
        angle_min: -1.5,
        ranges: vec![1.0; beams],
        ..LaserScan::default()
    };
    assert_eq!(
        refused(read(&[scan(3), scan(2)], MessageType::Scan)),
        "BAG/bag.mcap: /topic, message 2: its scan has 2 beams from -1.5 rad on: expected 3 from -1.5 rad on, as the first \
         message"
    );
    let mut map = OccupancyGrid {
        header: header("map"),
        data: vec![0; 5],
        ..OccupancyGrid::default()
    };
    (map.info.width, map.info.height, map.info.resolution) = (3, 2, 0.05);
    map.info.origin = pose(1.0, 2.0, 0.0, 0.0);
    assert_eq!(
        refused(read(&[map.clone()], MessageType::Map)),
        "BAG/bag.mcap: /topic, message 1: the map has 5 cells: expected 3 × 2"
    );
    map.data = vec![-1, 0, 49, 50, 100, 0];
    let (frame, cells) = &read(&[map.clone()], MessageType::Map).unwrap().maps["/topic"];
    assert_eq!(
        (frame.as_str(), cells.resolution, cells.origin),
        ("map", 0.05, [1.0, 2.0])
    );
    assert_eq!(cells.runs, [0, 1, 2, 2, 1]);
    map.info.origin = pose(0.0, 0.0, 0.0, FRAC_PI_2);
    assert!(
        refused(read(&[map], MessageType::Map)).ends_with("rad: expected 0"),
        "a turned map"
    );
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
    let near = |found: Result<Option<geometry::pose::Pose2>, String>, x: f64, y: f64| {
        let found = found.unwrap().unwrap();
        assert!(
            (found.x - x).abs() < 1e-12 && (found.y - y).abs() < 1e-12,
            "{found:?}"
        );
    };
    near(place("base", "map", 19), 5.0, 1.0);
    near(place("base", "map", 0), 5.0, 1.0);
    near(place("base", "map", 20), 9.0, 0.0);
    assert_eq!(place("map", "base", 0), Ok(None));
    assert_eq!(frames.place("", "base", "map", 0), Ok(None));
    assert_eq!(place("laser", "base", 0), Err("laser".to_owned()));
    let topics = ["/tf", "/guard/tf", "/a/b/odom", "odom", ""];
    assert_eq!(topics.map(namespace), ["", "/guard", "/a", "", ""]);
}

#[test]
fn the_nearest_message_of_each_tick_is_taken_and_gaps_are_named() {
    let samples = Samples {
        frame: String::new(),
        child: String::new(),
        scanner: None,
        list: vec![(100, 'a'), (149, 'b'), (1_000_000_300, 'c')],
    };
    let place = (Path::new("bag"), "/odom");
    let (found, imported) = samples
        .at_ticks([100, 120, 130, 200].into_iter(), 1.0, place)
        .unwrap();
    let letters: String = found.iter().map(|(_, letter)| letter).collect();
    assert_eq!(letters, "aabb");
    assert_eq!((imported.messages, imported.max_age_s), (3, 51e-9));
    let gap = samples.at_ticks([100, 500_000_000].into_iter(), 0.4, place);
    assert_eq!(
        gap.unwrap_err().to_string(),
        "bag: /odom: no message from 0.000 s to 1.000 s: expected one within 0.4 s of each tick; --max-age S permits more"
    );
    assert_eq!(samples.span(), (100, 1_000_000_300));
}
