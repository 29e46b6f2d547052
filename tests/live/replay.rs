//! Replays that are watched.

use std::collections::BTreeMap;

use serde_json::json;
use tungstenite::Message;
use tungstenite::http::StatusCode;

use super::{Heard, Log, Messages, NOW, SECOND, Viewer, Watched, subscription};
use crate::support::Sandbox;

/// A short chase in `run.mcap`.
fn recorded(sandbox: &Sandbox) -> Log {
    sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=3")
        .json();
    Log::read(&sandbox.path().join("run.mcap"))
}

#[test]
fn a_replay_shows_all_that_the_log_holds_when_it_is_let_go() {
    let sandbox = Sandbox::new();
    let log = recorded(&sandbox);
    let mut replay = Watched::replay(&sandbox, "run.mcap", &["--paused", "--rate", "4"]);
    let open = format!("ws://{}/", replay.address());
    assert_eq!(
        Viewer::connect(&open, None, NOW).err(),
        Some(StatusCode::FORBIDDEN),
        "no token"
    );
    let evil = Viewer::connect(replay.url(), Some("https://evil.example"), NOW).err();
    assert_eq!(evil, Some(StatusCode::FORBIDDEN));
    let mut viewer = Viewer::connect(replay.url(), None, NOW).unwrap();
    let (info, channels) = viewer.greeted();
    assert_eq!(info["capabilities"], json!(["time"]));
    let topics: Vec<&str> = log.messages.keys().map(String::as_str).collect();
    assert!(topics.contains(&"/viewer/visibility") && topics.contains(&"perception/belief"));
    for topic in &topics {
        log.is_announced(topic, &channels[*topic]);
    }
    viewer.subscribe(&channels, &topics);
    // Answered in order: when this comes, the subscriptions stand.
    viewer
        .0
        .send(Message::Ping(b"there?".as_slice().into()))
        .unwrap();
    loop {
        match viewer.0.read().unwrap() {
            Message::Pong(_) => break,
            Message::Text(_) => {}
            // The clock, which is set when the replay is ready.
            Message::Binary(bytes) if bytes[0] == 2 => {}
            other => panic!("the replay stands, but says {other:?}"),
        }
    }
    replay.press(" ");
    let mut heard: BTreeMap<u32, Messages> = BTreeMap::new();
    let mut now = 0;
    while let Some(message) = viewer.hear() {
        match message {
            Heard::Text(_) => {}
            Heard::Time(time_ns) => {
                assert!(time_ns >= now);
                now = time_ns;
            }
            Heard::Message {
                subscription,
                time_ns,
                data,
            } => heard.entry(subscription).or_default().push((time_ns, data)),
        }
    }
    let (code, said) = replay.finish();
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("live: 1 viewers, "), "{said}");
    assert!(said.contains(", 0 left out for those who"), "{said}");
    assert_eq!(now, 3_000_000_000);
    for topic in topics {
        let heard = &heard[&subscription(&channels[topic])];
        assert!(*heard == log.messages[topic], "{topic}: {}", heard.len());
    }
    sandbox.assert_nothing_left();
}

#[test]
fn a_replay_from_the_middle_shows_what_holds_there_steps_and_begins_again() {
    let sandbox = Sandbox::new();
    let log = recorded(&sandbox);
    let words = [
        "--start", "1", "--end", "2", "--paused", "--loop", "--rate", "16",
    ];
    let mut replay = Watched::replay(&sandbox, "run.mcap", &words);
    let mut viewer = Viewer::connect(replay.url(), None, NOW).unwrap();
    let (_, channels) = viewer.greeted();
    let topics = ["world/map", "/viewer/map", "world/state", "/viewer/scene"];
    viewer.subscribe(&channels, &topics);
    let [map, picture, state, scene] = topics.map(|topic| subscription(&channels[topic]));
    let mut next = |wanted: &[u32]| {
        loop {
            match viewer.hear().expect("the replay goes on") {
                Heard::Message {
                    subscription,
                    time_ns,
                    data,
                } if wanted.contains(&subscription) => break (subscription, time_ns, data),
                _ => {}
            }
        }
    };
    // What was said before the start and holds there, though the replay stands.
    let before = |topic: &str| {
        log.messages[topic]
            .iter()
            .rfind(|(time, _)| *time < SECOND)
            .unwrap()
    };
    let mut held = BTreeMap::new();
    while held.len() < 4 {
        let (subscription, time_ns, data) = next(&[map, picture, state, scene]);
        held.insert(subscription, (time_ns, data));
    }
    for topic in topics {
        let held = &held[&subscription(&channels[topic])];
        assert!(held == before(topic), "{topic} at {}", held.0);
    }
    // One tick, and another.
    for step in [20, 21] {
        replay.press("s");
        let (_, time_ns, data) = next(&[state]);
        assert_eq!(time_ns, step * SECOND / 20);
        let logged = log.messages["world/state"]
            .iter()
            .find(|(time, _)| *time == time_ns);
        assert!(logged.unwrap().1 == data);
    }
    // To the end, and from the start again: the map of before is there once more, and the first state.
    replay.press(" ");
    // (It is drawn again on the way to the end.)
    let mut pictures = std::iter::repeat_with(|| next(&[picture]));
    let (_, time_ns, data) = pictures.find(|(_, time, _)| *time < SECOND).unwrap();
    assert!((time_ns, data) == *before("/viewer/map"));
    let again = std::iter::repeat_with(|| next(&[state]).1).find(|time| *time >= SECOND);
    assert_eq!(again, Some(SECOND));
    replay.press("q");
    let (code, said) = replay.finish();
    assert_eq!(code, Some(3), "{said}");
    sandbox.assert_nothing_left();
}
