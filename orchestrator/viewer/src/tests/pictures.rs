//! Tests of times and schemas of viewer messages.

use std::collections::BTreeMap;
use std::path::Path;

use super::made_up::{PERIOD_NS, run};
use super::{options, record};
use crate::ViewerOptions;

/// A message read from a log: topic, sequence, log time, bytes.
type Read = (String, u32, u64, Vec<u8>);

/// Returns the messages of the viewer topics in a log, in file order.
fn read(path: &Path) -> Vec<Read> {
    let bytes = std::fs::read(path).unwrap();
    let messages = mcap::MessageStream::new(&bytes).unwrap();
    let messages = messages.map(|message| {
        let m = message.unwrap();
        (
            m.channel.topic.clone(),
            m.sequence,
            m.log_time,
            m.data.to_vec(),
        )
    });
    messages.filter(|m| m.0.starts_with('/')).collect()
}

#[test]
fn topics_have_the_schemas_of_the_viewers() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    record(&path, &options(), &run(4, 1), 100);
    let bytes = std::fs::read(&path).unwrap();
    let index = mcap::Summary::read(&bytes).unwrap().unwrap();
    for (topic, schema) in [
        ("/robots", "visualization_msgs/msg/MarkerArray"),
        ("/map", "nav_msgs/msg/OccupancyGrid"),
        ("/tf", "tf2_msgs/msg/TFMessage"),
        ("/tf_static", "tf2_msgs/msg/TFMessage"),
        ("/beliefs", "sensor_msgs/msg/PointCloud2"),
        ("/plans", "visualization_msgs/msg/MarkerArray"),
        ("/police_1/plan", "nav_msgs/msg/Path"),
        ("/police_1/odom", "nav_msgs/msg/Odometry"),
        ("/trees", "visualization_msgs/msg/MarkerArray"),
        ("/fields_of_view", "visualization_msgs/msg/MarkerArray"),
        ("/police_1/scan", "sensor_msgs/msg/LaserScan"),
        ("/rosout", "rcl_interfaces/msg/Log"),
        ("/clock", "rosgraph_msgs/msg/Clock"),
    ] {
        let channel = index.channels.values().find(|c| c.topic == topic).unwrap();
        assert_eq!(channel.schema.as_ref().unwrap().name, schema, "{topic}");
    }
}

#[test]
fn pictures_keep_their_rate_and_include_the_first_the_last_and_every_event() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    // 20 ticks per second, 10 pictures: even ticks, and 5 for the event, and 11 for the end.
    record(&path, &options(), &run(12, 1), 5);
    let times = |topic: &str| -> Vec<u64> {
        read(&path)
            .iter()
            .filter(|m| m.0 == topic)
            .map(|m| m.2 / PERIOD_NS)
            .collect()
    };
    assert_eq!(times("/robots"), [0, 2, 4, 5, 6, 8, 10, 11]);
    assert_eq!(times("/tf"), times("/robots"));
    assert_eq!(times("/beliefs"), times("/robots"));
    // At most five per second, except for the event and the end.
    assert_eq!(times("/fields_of_view"), [0, 4, 5, 8, 11]);
    assert_eq!(times("/map"), [0]);
    assert_eq!(times("/obstacles"), [0, 3]);
    assert_eq!(times("/rosout"), [5]);

    // Latched topics are repeated after two seconds, with the next picture.
    let path = directory.path().join("long.mcap");
    record(&path, &options(), &run(100, 1), 5);
    let times = |topic: &str| -> Vec<u64> {
        let all = read(&path).into_iter().filter(|m| m.0 == topic);
        all.map(|m| m.2 / PERIOD_NS).collect()
    };
    assert_eq!(times("/map"), [0, 40, 80]);
    assert_eq!(times("/obstacles"), [0, 3, 44, 84]);

    let path = directory.path().join("plain.mcap");
    let off = ViewerOptions {
        rate_hz: 0.0,
        ..options()
    };
    let summary = record(&path, &off, &run(12, 1), 5);
    assert!(summary.topics.keys().all(|topic| !topic.starts_with('/')));
}

#[test]
fn messages_are_numbered_and_counted_and_do_not_depend_on_batches() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let sent = run(12, 1);
    let summary = record(&path, &options(), &sent, sent.len());
    let whole = read(&path);
    let mut counted: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    for (topic, sequence, _, bytes) in &whole {
        let count = counted.entry(topic).or_default();
        assert_eq!(u64::from(*sequence), count.0, "{topic}");
        *count = (count.0 + 1, count.1 + bytes.len() as u64);
    }
    let in_summary = summary.topics.iter();
    let in_summary = in_summary.filter(|(topic, _)| topic.starts_with('/'));
    let in_summary: BTreeMap<&str, (u64, u64)> = in_summary
        .map(|(topic, count)| (topic.as_str(), (count.messages, count.bytes)))
        .collect();
    assert_eq!(in_summary, counted);
    for batch in [1, 7, 60] {
        let path = directory.path().join(format!("{batch}.mcap"));
        record(&path, &options(), &sent, batch);
        // Not `assert_eq`: it would print both logs.
        assert!(read(&path) == whole, "{batch}");
    }
}
