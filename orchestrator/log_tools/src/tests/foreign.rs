//! Files of other programs.

use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::ops::ControlFlow;

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use mcap_log::Topics;
use tables::Format;

use super::support::{file, watch};
use crate::{CatOptions, ExportOptions, LogInfo, cat, export};

const POSE_ARRAY: &str = "\
# An array of poses.
std_msgs/Header header
geometry_msgs/Point[] points  # where
string[] names
bool last
uint8 KIND=3
string FRAME = \"a # b\"
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: geometry_msgs/Point
float64 x
float32[2] size
";

/// Reads the message of the schema: (x, size) for every point.
fn encode(points: &[(f64, [f32; 2])]) -> Vec<u8> {
    let mut body = Vec::new();
    let align = |body: &mut Vec<u8>, to: usize| {
        while !body.len().is_multiple_of(to) {
            body.push(0);
        }
    };
    body.extend(5_i32.to_le_bytes());
    body.extend(6_u32.to_le_bytes());
    body.extend(4_u32.to_le_bytes());
    body.extend(b"map\0");
    body.extend((points.len() as u32).to_le_bytes());
    for (x, size) in points {
        align(&mut body, 8);
        body.extend(x.to_le_bytes());
        for s in size {
            body.extend(s.to_le_bytes());
        }
    }
    align(&mut body, 4);
    body.extend(2_u32.to_le_bytes());
    for name in ["é,\"\0", "b\0"] {
        align(&mut body, 4);
        body.extend((name.len() as u32).to_le_bytes());
        body.extend(name.as_bytes());
    }
    body.push(1);
    [&[0, 1, 0, 0], body.as_slice()].concat()
}

/// A file with ROS 2 messages that are not in order of time; one of them is broken.
fn foreign() -> Vec<u8> {
    let mut disk = std::io::Cursor::new(Vec::new());
    let mut writer = WriteOptions::new()
        .profile("ros2")
        .create(&mut disk)
        .unwrap();
    let schema = writer
        .add_schema("pkg/msg/Poses", "ros2msg", POSE_ARRAY.as_bytes())
        .unwrap();
    let none = BTreeMap::new();
    let poses = writer.add_channel(schema, "/poses", "cdr", &none).unwrap();
    let again = writer.add_channel(schema, "/poses", "cdr", &[("a".into(), "b".into())].into());
    let again = again.unwrap();
    let broken = writer
        .add_schema("pkg/msg/Broken", "ros2msg", b"nope x")
        .unwrap();
    let broken = writer.add_channel(broken, "/broken", "cdr", &none).unwrap();
    let two = encode(&[(1.5, [0.25, 2.0]), (-0.1, [f32::NAN, 3.0])]);
    for (channel_id, log_time, data) in [
        (poses, 3_000_000_000, &two),
        (poses, 1_000_000_000, &encode(&[])),
        (poses, 2_000_000_000, &two[..30].to_vec()),
        (again, 2_000_000_000, &two),
        (broken, 2_000_000_000, &two),
    ] {
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time,
            publish_time: log_time,
        };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    disk.into_inner()
}

#[test]
fn unknown_facts_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let log = file(&folder, "ros.mcap", &foreign());
    let info = LogInfo::read(&log, &mut watch()).unwrap();
    assert!(!info.ours && info.condition.is_whole());
    assert_eq!((info.profile.as_str(), info.messages), ("ros2", 5));
    assert_eq!((info.start_s, info.end_s, info.unsorted), (1.0, 3.0, 2));
    assert_eq!(info.topics["/poses"].gaps, None, "they are not numbered");
    assert!(
        info.topics.contains_key("/poses (channel 2)"),
        "{:?}",
        info.topics.keys()
    );
    let text = crate::info_text(&info);
    assert!(
        text.contains("not a Protean log (no scenario, seed or digest)"),
        "{text}"
    );
}

#[test]
fn their_messages_become_tables_by_their_own_schemas() {
    let folder = tempfile::tempdir().unwrap();
    let log = file(&folder, "ros.mcap", &foreign());
    let out = folder.path().join("tables");
    let options = ExportOptions {
        format: Format::Csv,
        topics: Topics::default(),
        force: false,
    };
    let done = export(&log, &out, &options, &mut watch()).unwrap();
    let table = &done.tables["/poses"];
    assert_eq!((table.messages, table.rows, table.undecodable), (2, 3, 1));
    assert!(
        done.skipped["/broken"].contains("`nope` is not defined"),
        "{done:?}"
    );
    let text = std::fs::read_to_string(out.join("poses.csv")).unwrap();
    assert_eq!(
        text,
        "log_time_ns,publish_time_ns,sequence,header.stamp.sec,header.stamp.nanosec,\
         header.frame_id,names,last,points.index,points.x,points.size.0,points.size.1\n\
         3000000000,3000000000,0,5,6,map,\"[\"\"é,\\\"\"\"\",\"\"b\"\"]\",true,0,1.5,0.25,2.0\n\
         3000000000,3000000000,0,5,6,map,\"[\"\"é,\\\"\"\"\",\"\"b\"\"]\",true,1,-0.1,NaN,3.0\n\
         1000000000,1000000000,0,5,6,map,\"[\"\"é,\\\"\"\"\",\"\"b\"\"]\",true,,,,\n"
    );
    assert!(out.join("poses-2.csv").exists());
}

#[test]
fn their_messages_become_lines_of_json() {
    let folder = tempfile::tempdir().unwrap();
    let log = file(&folder, "ros.mcap", &foreign());
    let lines = |options: &CatOptions| {
        let mut lines = Vec::new();
        cat(&log, options, &mut watch(), |line| {
            lines.push(serde_json::from_str::<serde_json::Value>(line).unwrap());
            ControlFlow::Continue(())
        })
        .map(|_| lines)
    };
    let all = lines(&CatOptions::default()).unwrap();
    let topics: Vec<&str> = all.iter().map(|l| l["topic"].as_str().unwrap()).collect();
    assert_eq!(topics, ["/poses", "/poses", "/poses", "/poses", "/broken"]);
    assert_eq!(all[0]["log_time_s"], 3.0);
    let message = &all[0]["message"];
    assert_eq!(message["header"]["frame_id"], "map");
    assert_eq!(message["points"][1]["size"], serde_json::json!([null, 3.0]));
    assert_eq!(message["names"], serde_json::json!(["é,\"", "b"]));
    // A truncated message, and a schema that cannot be read.
    for (line, words) in [
        (&all[2], "ends in the middle"),
        (&all[4], "`nope` is not defined"),
    ] {
        assert!(line["note"].as_str().unwrap().contains(words), "{line}");
        assert!(line["bytes"].as_u64() >= Some(30) && line["message"].is_null());
    }

    // Times count from the first message, at 1 s.
    let options = CatOptions {
        start_s: Some(0.5),
        end_s: Some(1.0),
        ..CatOptions::default()
    };
    assert_eq!(lines(&options).unwrap().len(), 3);
    let options = CatOptions {
        topics: Topics {
            only: vec!["/br*".to_owned()],
            ..Topics::default()
        },
        ..options
    };
    assert_eq!(lines(&options).unwrap().len(), 1);
    let options = CatOptions {
        limit: NonZeroU64::new(2),
        ..CatOptions::default()
    };
    assert_eq!(lines(&options).unwrap(), all[..2]);
    let options = CatOptions {
        topics: Topics {
            only: vec!["/no".to_owned()],
            ..Topics::default()
        },
        ..CatOptions::default()
    };
    assert!(lines(&options).unwrap_err().to_string().contains("/no"));

    let mut count = 0;
    cat(&log, &CatOptions::default(), &mut watch(), |_| {
        count += 1;
        ControlFlow::Break(())
    })
    .unwrap();
    assert_eq!(count, 1, "the reader has gone");
}

#[test]
fn json_messages_are_printed_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let mut disk = std::io::Cursor::new(Vec::new());
    let mut writer = WriteOptions::new().create(&mut disk).unwrap();
    let none = BTreeMap::new();
    let channel = writer.add_channel(0, "/note", "json", &none).unwrap();
    for data in ["{\n  \"b\": 1.50, \"a\": 2}", "{\"b\": "] {
        let header = MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 1_500_000_000,
            publish_time: 0,
        };
        writer
            .write_to_known_channel(&header, data.as_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    let log = file(&folder, "json.mcap", &disk.into_inner());
    let mut lines = Vec::new();
    cat(&log, &CatOptions::default(), &mut watch(), |line| {
        lines.push(line.to_owned());
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(
        lines[0],
        r#"{"topic":"/note","log_time_s":1.5,"message":{   "b": 1.50, "a": 2}}"#
    );
    assert!(
        lines[1].contains(r#""bytes":6,"note":"it is not JSON"#),
        "{lines:?}"
    );
}
