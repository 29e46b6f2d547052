//! Parts of logs.

use std::collections::BTreeMap;

use mcap::WriteOptions;
use mcap_log::{DerivedError, LogReadError, Topics};

use super::record_run;
use super::support::{file, ours, small, theirs, watch};
use crate::{FilterOptions, LogInfo, filter};

#[test]
fn a_part_begins_with_the_last_states_from_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    let summary = record_run(&log, 12);
    let out = folder.path().join("part.mcap");
    let options = FilterOptions {
        start_s: Some(0.22),
        end_s: Some(0.4),
        ..FilterOptions::default()
    };
    let done = filter(&log, &out, &options, &mut watch()).unwrap();
    let all = theirs(&log);
    let read = theirs(&out);
    assert_eq!(read.len() as u64, done.messages);
    let (from, to) = (220_000_000, 400_000_000);
    assert!(read.iter().all(|m| (from..=to).contains(&m.2)));
    let inside: Vec<_> = all.iter().filter(|m| (from..=to).contains(&m.2)).collect();
    let restored = done.restored as usize;
    assert_eq!(read[restored..].iter().collect::<Vec<_>>(), inside);
    // Each with the bytes and the number of the last message before the start.
    let mut last: BTreeMap<&str, &super::support::Read> = BTreeMap::new();
    for message in all.iter().filter(|m| m.2 < from) {
        last.insert(&message.0, message);
    }
    let topics: Vec<&str> = read[..restored].iter().map(|m| m.0.as_str()).collect();
    for topic in [
        "world/map",
        "world/shapes",
        "world/state",
        "/map",
        "/obstacles",
    ] {
        assert!(topics.contains(&topic), "{topic}: {topics:?}");
    }
    for topic in ["robot/command", "world/event", "/rosout", "robot/scan"] {
        assert!(!topics.contains(&topic), "{topic}: {topics:?}");
    }
    for message in &read[..restored] {
        let known = last[message.0.as_str()];
        assert_eq!(
            (message.1, &message.3),
            (known.1, &known.3),
            "{}",
            message.0
        );
    }
    let info = LogInfo::read(&out, &mut watch()).unwrap();
    assert_eq!(info.digest, None, "not the digest of this file");
    assert_eq!(info.run_digest.as_deref(), Some(&*summary.digest));
    assert_eq!(info.filtered["start_s"], "0.22");
    assert_eq!(info.attachments[0].0, "scenario.toml");
    assert_eq!(info.seed, Some(7));
    assert!(info.condition.is_whole() && info.condition.index);
    assert!(
        info.topics
            .values()
            .all(|topic| topic.gaps.unwrap_or(0) == 0),
        "{info:?}"
    );
}

#[test]
fn topics_are_chosen_by_name_and_a_wrong_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    record_run(&log, 6);
    let out = folder.path().join("part.mcap");
    let topics = |only: &[&str], without: &[&str]| FilterOptions {
        topics: Topics {
            only: only.iter().map(|&t| t.to_owned()).collect(),
            without: without.iter().map(|&t| t.to_owned()).collect(),
        },
        force: true,
        ..FilterOptions::default()
    };
    filter(
        &log,
        &out,
        &topics(&["world/*"], &["world/map"]),
        &mut watch(),
    )
    .unwrap();
    let expected: Vec<_> = theirs(&log)
        .into_iter()
        .filter(|m| m.0.starts_with("world/") && m.0 != "world/map")
        .collect();
    assert_eq!(theirs(&out), expected);
    for options in [topics(&["world/stat"], &[]), topics(&[], &["nope*"])] {
        let error = filter(&log, &out, &options, &mut watch()).unwrap_err();
        let text = error.to_string();
        assert!(
            matches!(error, DerivedError::Log(LogReadError::Topic { .. }))
                && text.contains("world/state"),
            "{text}"
        );
    }
    assert_eq!(
        theirs(&out),
        expected,
        "a refused one leaves the file as it was"
    );
    for (start, end) in [
        (Some(2.0), Some(1.0)),
        (Some(-1.0), None),
        (None, Some(f64::NAN)),
    ] {
        let options = FilterOptions {
            start_s: start,
            end_s: end,
            ..FilterOptions::default()
        };
        let error = filter(&log, &out, &options, &mut watch()).unwrap_err();
        assert!(
            matches!(error, DerivedError::Log(LogReadError::Argument(_))),
            "{error}"
        );
    }
}

#[test]
fn times_in_other_files_begin_with_their_first_message() {
    let folder = tempfile::tempdir().unwrap();
    let log = file(&folder, "a.mcap", &small(WriteOptions::new(), 3, 4));
    let out = folder.path().join("part.mcap");
    let options = FilterOptions {
        start_s: Some(2e-9),
        end_s: Some(5e-9),
        ..FilterOptions::default()
    };
    let done = filter(&log, &out, &options, &mut watch()).unwrap();
    let times: Vec<u64> = theirs(&out).iter().map(|m| m.2).collect();
    assert_eq!(times, [1002, 1003, 1004, 1005]);
    assert_eq!(done.restored, 0);
    assert!(ours(&out).1.is_whole());
}
