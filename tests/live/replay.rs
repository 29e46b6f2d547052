//! Replays that are watched.

use std::collections::BTreeMap;

use serde_json::json;
use tungstenite::http::StatusCode;

use super::{Log, Messages, NOW, Received, SECOND, Viewer, Watched, subscription};
use crate::support::Sandbox;

/// A short chase in `run.mcap`.
fn recorded(sandbox: &Sandbox) -> Log {
    sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=3")
        .json();
    Log::read(&sandbox.path().join("run.mcap"))
}

/// Messages received until the replay begins again, by subscription.
fn pass(viewer: &mut Viewer) -> BTreeMap<u32, Messages> {
    let (mut heard, mut now): (BTreeMap<u32, Messages>, _) = (BTreeMap::new(), 0);
    loop {
        match viewer.receive().expect("the replay goes on") {
            Received::Text(_) => {}
            Received::Time(time_ns) if time_ns < now => return heard,
            Received::Time(time_ns) => now = time_ns,
            Received::Message {
                subscription,
                time_ns,
                data,
            } => heard.entry(subscription).or_default().push((time_ns, data)),
        }
    }
}

#[test]
fn a_replay_shows_all_that_the_log_holds() {
    let sandbox = Sandbox::new();
    let log = recorded(&sandbox);
    let replay = Watched::replay(&sandbox, "run.mcap", &["--loop", "--pace", "4"]);
    let open = format!("ws://{}/", replay.address());
    assert_eq!(
        Viewer::connect(&open, None, NOW).err(),
        Some(StatusCode::FORBIDDEN),
        "no token"
    );
    let evil = Viewer::connect(replay.url(), Some("https://evil.example"), NOW).err();
    assert_eq!(evil, Some(StatusCode::FORBIDDEN));
    let mut viewer = Viewer::connect(replay.url(), None, NOW).unwrap();
    let topics: Vec<&str> = log.messages.keys().map(String::as_str).collect();
    let (info, channels) = viewer.greeted_with(&topics);
    assert_eq!(info["capabilities"], json!(["time"]));
    assert!(topics.contains(&"/fields_of_view") && topics.contains(&"perception/belief"));
    for topic in &topics {
        log.is_announced(topic, &channels[*topic]);
    }
    viewer.subscribe(&channels, &topics);
    // What is left of the pass in which it came, and a whole one.
    pass(&mut viewer);
    let heard = pass(&mut viewer);
    replay.interrupt();
    while viewer.receive().is_some() {}
    let (code, output) = replay.finish();
    assert_eq!(code, Some(3), "{output}");
    assert!(output.contains("live: 1 viewers, "), "{output}");
    assert!(output.contains(", 0 dropped for slow viewers"), "{output}");
    for topic in topics {
        let heard = &heard[&subscription(&channels[topic])];
        assert!(*heard == log.messages[topic], "{topic}: {}", heard.len());
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_from_the_middle_sends_latched_messages_and_begins_again() {
    let sandbox = Sandbox::new();
    let log = recorded(&sandbox);
    let words = ["--start", "1", "--end", "2", "--loop", "--pace", "4"];
    let replay = Watched::replay(&sandbox, "run.mcap", &words);
    let mut viewer = Viewer::connect(replay.url(), None, NOW).unwrap();
    let (_, channels) = viewer.greeted();
    let topics = ["world/map", "/map", "world/state", "/obstacles"];
    viewer.subscribe(&channels, &topics);
    pass(&mut viewer);
    for _ in 0..2 {
        let heard = pass(&mut viewer);
        for topic in topics {
            let all = &log.messages[topic];
            // What was output before the start and holds there, then what was output from there on.
            let start = all.partition_point(|(time, _)| *time < SECOND);
            let end = all.partition_point(|(time, _)| *time <= 2 * SECOND);
            let heard = &heard[&subscription(&channels[topic])];
            assert!(*heard == all[start - 1..end], "{topic}: {}", heard.len());
        }
    }
    replay.interrupt();
    while viewer.receive().is_some() {}
    let (code, output) = replay.finish();
    assert_eq!(code, Some(3), "{output}");
    sandbox.assert_nothing_left();
}
