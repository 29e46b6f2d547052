//! Sensors, trackers and messages of other crates: the program of `examples/external_sensor`.

use std::collections::BTreeMap;

use crate::support::{Sandbox, python};

/// The program with three kinds of its own.
const BEARINGS: &str = env!("CARGO_BIN_EXE_bearings_under_test");
const MISSION: &str = include_str!("../examples/external_sensor/mission.toml");

#[test]
fn a_sensor_with_a_message_of_its_own_is_read_within_the_tick_logged_and_executed_again() {
    let sandbox = Sandbox::new();
    sandbox.file("mission.toml", MISSION);
    let call = |words: &[&'static str]| {
        let words = words.iter().copied();
        sandbox.call(BEARINGS.as_ref()).args(words)
    };
    let read = |name: &str| std::fs::read_to_string(sandbox.path().join(name)).unwrap();
    let graph = call(&["check", "mission.toml", "--graph", "flow.mmd"]).run();
    assert_eq!(graph.code, Some(0), "{graph}");
    let graph = read("flow.mmd");
    assert!(graph.contains(r#"-- "sonar/bearing" --> "#), "{graph}");
    assert!(graph.contains(r#"-- "sonar/track" --> "#), "{graph}");

    // The file lists the planners first, the tracker next and the sensor after it.
    let run = call(&["run", "mission.toml", "--out", "mission.mcap"]).json();
    let ticks = run["ticks"].as_u64().unwrap();
    let counts = |topic: &str| run["topics"][topic]["messages"].as_u64().unwrap();
    assert_eq!(counts("sonar/bearing"), 2 * ticks, "{run}");
    assert_eq!(counts("sonar/track"), ticks, "{run}");
    let local = call(&["run", "mission.toml", "--in-process", "--out", "local.mcap"]).json();
    assert_eq!(local["digest"], run["digest"]);
    let verified = call(&["verify", "mission.mcap"]).json();
    assert_eq!(verified["same"], true, "{verified}");
    let again = call(&["replay", "mission.mcap", "--test", "bearing_tracker"]).run();
    assert!(again.stdout.contains("IDENTICAL"), "{again}");

    // A program that does not know the topics reads the log by its schemas.
    let tables = sandbox
        .protean(["export", "mission.mcap", "--out", "tables"])
        .run();
    assert_eq!(tables.code, Some(0), "{tables}");
    let tracks = read("tables/sonar.track.csv");
    assert!(tracks.contains("tracks.sigma"), "{tracks}");
    assert_eq!(tracks.lines().count() as u64, 1 + ticks);
    // It draws them, too: bearings from the robots, and circles about the tracks.
    let report = call(&["report", "mission.mcap", "--out", "report.html"]).run();
    assert_eq!(report.code, Some(0), "{report}");
    let report = read("report.html");
    assert!(report.contains(r#""marks":["sonar/bearing","sonar/track"]"#));
    let marks = call(&["cat", "mission.mcap", "/marks"]).run().stdout;
    for name in [r#""ns":"sonar/bearing""#, r#""ns":"sonar/track""#] {
        assert!(marks.contains(name), "{marks:.400}");
    }
    let found: Option<BTreeMap<String, BTreeMap<String, u64>>> =
        python::call("read_rosbag.py", sandbox.path());
    if let Some(read) = found {
        assert_eq!(read["mission"]["sonar/track"], ticks);
        assert_eq!(read["mission"]["sonar/bearing"], 2 * ticks);
    }
}

#[test]
fn a_planner_without_its_tracker_is_refused_before_anything_starts() {
    let sandbox = Sandbox::new();
    let tracker = "[[processes]]\nkind = \"bearing_tracker\"\n";
    sandbox.file("mission.toml", MISSION.replace(tracker, ""));
    let refused = sandbox
        .call(BEARINGS.as_ref())
        .args(["check", "mission.toml"])
        .run();
    let words = [
        "process `bearing_chaser_north` reads sonar/track, but no process writes it",
        "kind = \"bearing_tracker\"",
    ];
    refused.refused(2, &words);
}
