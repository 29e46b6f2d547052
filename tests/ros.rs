//! Logs in the tools of ROS 2.

use std::collections::BTreeMap;

use crate::support::{Sandbox, python};
use crate::viewers::assert_layouts_fit;

/// Messages by topic.
type Counts = BTreeMap<String, u64>;

#[test]
fn strict_ros_readers_decode_and_layouts_of_viewers_fit_the_logs_of_all_built_in_missions() {
    let sandbox = Sandbox::new();
    let listed = sandbox.protean(["list"]).json();
    let mut written: BTreeMap<String, Counts> = BTreeMap::new();
    for scenario in listed["scenarios"].as_array().unwrap() {
        let name = scenario["name"].as_str().unwrap();
        let out = format!("{name}.mcap");
        let run = sandbox.protean(["run", name, "--out", &out]);
        let summary = run.set("rules.time_limit=1").json();
        assert_layouts_fit(&sandbox.path().join(&out));
        let topics = summary["topics"].as_object().unwrap().iter();
        let counts =
            topics.map(|(topic, count)| (topic.clone(), count["messages"].as_u64().unwrap()));
        written.insert(
            name.to_owned(),
            counts.filter(|(_, count)| *count > 0).collect(),
        );
    }
    let exported = sandbox.protean(["export", "hello.mcap", "--ros2bag", "bag"]);
    let bag = exported.json();
    let of_hello = written["hello"].clone();
    assert_eq!(bag["messages"], of_hello.values().sum::<u64>());
    written.insert("bag".to_owned(), of_hello);
    let read: Option<BTreeMap<String, Counts>> = python::call("read_rosbag.py", sandbox.path());
    if let Some(read) = read {
        assert_eq!(read, written);
    }
}

#[test]
fn messages_of_random_schemas_are_read_as_by_other_readers() {
    let sandbox = Sandbox::new();
    let Some(wrong) = python::call::<u64>("random_cdr.py", sandbox.path()) else {
        return;
    };
    let printed = sandbox.protean(["cat", "random.mcap"]).run();
    assert_eq!(printed.code, Some(0), "{printed}");
    sandbox.file("cat.jsonl", &printed.stdout);
    let differences: Option<Vec<String>> = python::call("random_cdr.py", sandbox.path());
    assert_eq!(differences, Some(Vec::new()));

    let words = ["export", "random.mcap", "--out", "tables", "--json"];
    let exported = sandbox.protean(words).run();
    assert_eq!(exported.code, Some(3), "{exported}");
    let tables = exported.json()["tables"].take();
    let tables = tables.as_object().unwrap().values();
    let undecodable = tables.map(|table| table["undecodable"].as_u64().unwrap());
    assert_eq!(undecodable.sum::<u64>(), wrong);
}
