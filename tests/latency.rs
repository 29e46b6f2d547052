//! `protean latency`: its figures are consistent at any load of the machine.

use std::collections::BTreeSet;
use std::path::Path;

use ipc_types::stamp::Stamp;
use rustix::process::Signal;
use serde_json::Value as Json;
use zerocopy::FromBytes as _;

use crate::support::{Sandbox, wait_for_tick};

const STAGES: [&str; 7] = [
    "state is published",
    "way to perception",
    "perception's step",
    "way to the planner",
    "planner's step",
    "wait for the next tick",
    "way to the simulator",
];

/// Percentiles are there, in order.
#[track_caller]
fn ordered(us: &Json) {
    let of = |key: &str| us[key].as_f64().unwrap_or_else(|| panic!("{key}: {us}"));
    let all = ["p50", "p90", "p99", "p999", "max"].map(of);
    assert!(all.is_sorted() && all[0] >= 0.0, "{us}");
    assert!(of("jitter") >= 0.0 && of("jitter") <= all[4], "{us}");
    assert!(us["count"].as_u64().unwrap() > 0, "{us}");
}

/// A distribution: percentiles, and a histogram of as many measurements.
#[track_caller]
fn distributed(own: &Json) -> u64 {
    ordered(&own["us"]);
    let counts = own["histogram"]["counts"].as_array().unwrap();
    let all: u64 = counts.iter().map(|c| c.as_u64().unwrap()).sum();
    assert_eq!(all, own["us"]["count"], "{own}");
    all
}

/// Checks invariants of every measured run.
#[track_caller]
fn hangs_together(run: &Json, stages: &[&str]) {
    let rows = run["stages"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, stages);
    let followed = run["followed_ticks"].as_u64().unwrap();
    assert!(followed > 0);
    assert_eq!(
        run["largest_sum_error_ns"], 0,
        "stages add up, tick by tick"
    );
    for row in rows {
        assert!(distributed(row) <= followed, "{row}");
    }
    assert_eq!(distributed(&run["sense_to_act"]), followed);
    assert_eq!(distributed(&run["sense_to_command"]), followed);
    for part in ["p50", "p99", "max"] {
        let of = |key: &str| run[key]["us"][part].as_f64().unwrap();
        assert!(of("sense_to_command") <= of("sense_to_act"), "{part}");
    }
    for group in ["hops", "turns"] {
        for own in run[group].as_object().unwrap().values() {
            distributed(own);
        }
    }
    let deadlines = &run["deadlines"];
    let count = |key: &str| deadlines[key].as_u64().unwrap();
    let answered = count("in_time") + count("late");
    assert!(answered >= followed && answered + count("unanswered") <= count("ticks"));
}

/// The names of an object.
fn keys(object: &Json) -> BTreeSet<&str> {
    object
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

/// Stamps of the messages in a log that a process sends in its turn.
fn stamps(log: &Path) -> Vec<Stamp> {
    let bytes = std::fs::read(log).unwrap();
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    messages
        .filter(|m| {
            let topic = m.channel.topic.as_str();
            ["world/state", "perception/belief", "robot/command"].contains(&topic)
        })
        .map(|m| Stamp::read_from_prefix(&m.data[4..]).unwrap().0)
        .collect()
}

#[test]
fn a_real_time_mission_is_measured_sense_to_act() {
    let sandbox = Sandbox::new();
    let words = ["latency", "chase", "--duration", "2", "--rate", "50"];
    let outcome = sandbox
        .protean(words)
        .arg("--log=kept.mcap")
        .arg("--json")
        .run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    let json = outcome.json();
    let run = &json["runs"][0];
    assert_eq!(
        (&run["mode"], &run["seed"]),
        (&"real_time".into(), &1.into())
    );
    assert_eq!(
        (&run["rate_hz"], &run["period_us"]),
        (&50.0.into(), &20_000.0.into())
    );
    hangs_together(run, &STAGES);
    distributed(&run["tick_off_its_time"]);
    let expected = [
        "simulator to perception",
        "perception to pursuer",
        "pursuer step",
    ];
    let hops = keys(&run["hops"]);
    assert!(expected.iter().all(|hop| hops.contains(hop)), "{hops:?}");
    let turns = keys(&run["turns"]);
    for kind in ["perception", "pursuer", "evader_potential"] {
        for part in ["wakes up", "takes its input", "computes", "writes"] {
            let name = format!("{kind} {part}");
            assert!(turns.contains(name.as_str()), "{name}: {turns:?}");
        }
    }
    // The same log gives the same figures again.
    let again = sandbox
        .protean(["latency", "kept.mcap"])
        .arg("--json")
        .run();
    assert_eq!(again.json()["runs"][0]["hops"], run["hops"]);
    assert_eq!(again.json()["runs"][0]["stages"], run["stages"]);
    sandbox.assert_nothing_left();
}

#[test]
fn a_recorded_log_says_what_its_stamps_say() {
    let sandbox = Sandbox::new();
    sandbox
        .protean(["run", "chase", "--out", "run.mcap"])
        .set("rules.time_limit=3")
        .json();
    let log = sandbox.path().join("run.mcap");
    let stamps = stamps(&log);
    assert!(stamps.len() > 300);
    for stamp in &stamps {
        let clocks = stamp.clone().clocks_mut().map(|clock| *clock);
        let [origin, begun, received, computed, sent] = clocks;
        // The simulator publishes a state of its own accord: its origin is later than its inputs.
        let own = [begun, received, computed, sent];
        let first = stamp.tick == 0 && stamp.received_ns == 0;
        assert!(first || own.is_sorted() && begun > 0, "{stamp:?}");
        assert!(origin > 0 && origin <= sent, "{stamp:?}");
    }
    let of = |words: &[&str]| {
        let outcome = sandbox.protean(words.iter().copied()).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        outcome
    };
    let json = of(&["latency", "run.mcap", "--json"]).json();
    let run = &json["runs"][0];
    let lock_step: Vec<&str> = STAGES
        .into_iter()
        .filter(|s| !s.starts_with("wait"))
        .collect();
    hangs_together(run, &lock_step);
    assert_eq!(
        run["deadlines"]["in_time"], 60,
        "in lock-step no command is late"
    );
    assert_eq!(
        (&run["period_us"], &run["tick_off_its_time"]),
        (&Json::Null, &Json::Null)
    );
    assert!(run["messages"]["robot/command"]["count"].as_u64().unwrap() >= 360);
    // The total equals that of the stamps, computed independently here.
    let commands = |tick| {
        stamps
            .iter()
            .filter(move |s| s.tick == tick && s.source != 0)
    };
    let acted = stamps
        .iter()
        .filter(|s| s.source == 0 && s.tick > 0)
        .map(|act| {
            let state = commands(act.tick - 1).next().unwrap().origin_ns;
            act.received_ns - state
        });
    let longest = acted.max().unwrap() as f64 / 1e3;
    assert_eq!(run["sense_to_act"]["us"]["max"], longest);
    let text = of(&["latency", "run.mcap"]).stdout;
    for words in [
        "way to the planner",
        "jitter",
        "overruns",
        "differ by at most 0 ns",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn ctrl_c_keeps_what_was_measured() {
    let sandbox = Sandbox::new();
    let running = sandbox
        .protean(["latency", "hello", "--rate", "50", "--out", "out.json"])
        .start();
    let run = sandbox.next_run(&BTreeSet::new());
    wait_for_tick(&run, 20);
    running.signal(Signal::INT);
    let outcome = running.finish();
    assert_eq!(outcome.code, Some(3), "{outcome}");
    assert!(outcome.stdout.contains("interrupted"), "{outcome}");
    let text = std::fs::read_to_string(sandbox.path().join("out.json")).unwrap();
    let json: Json = serde_json::from_str(&text).unwrap();
    assert_eq!(json["interrupted"], true);
    assert!(json["runs"][0]["deadlines"]["ticks"].as_u64().unwrap() >= 10);
    sandbox.assert_nothing_left();
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let sandbox = Sandbox::new();
    let refused = |words: &[&str], expected: &[&str]| {
        sandbox
            .protean(words.iter().copied())
            .run()
            .refused(2, expected);
    };
    refused(&["latency", "nowhere"], &["nowhere"]);
    refused(&["latency", "--rate", "0"], &["--rate 0", "1 to 10000"]);
    refused(
        &["latency", "--rate", "20", "--rate", "20000"],
        &["--rate 20000"],
    );
    refused(&["latency", "--rate", "fast"], &["fast"]);
    refused(&["latency", "--duration", "-1"], &["-1"]);
    refused(
        &["latency", "hello", "--duration", "nan"],
        &["--duration NaN", "above 0"],
    );
    refused(&["latency", "missing.mcap"], &["missing.mcap"]);
    refused(
        &["latency", "--rate", "20", "--rate", "50", "--log", "a.mcap"],
        &["--log", "one --rate"],
    );
    let folder = sandbox.path();
    std::fs::write(folder.join("not.mcap"), "words").unwrap();
    refused(&["latency", "not.mcap"], &["not.mcap", "not an MCAP file"]);
    // A log without clocks, and one without messages.
    let silent = [
        "run",
        "hello",
        "--in-process",
        "--out",
        "silent.mcap",
        "--json",
    ];
    let outcome = sandbox.protean(silent).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    refused(
        &["latency", "silent.mcap"],
        &["silent.mcap", "clock times", "one process"],
    );
    let whole = std::fs::read(folder.join("silent.mcap")).unwrap();
    let summary = mcap::Summary::read(&whole).unwrap().unwrap();
    let chunks = summary.chunk_indexes.iter();
    let first = chunks.map(|chunk| chunk.chunk_start_offset).min().unwrap();
    std::fs::write(folder.join("cut.mcap"), &whole[..first as usize]).unwrap();
    refused(&["latency", "cut.mcap"], &["cut.mcap", "world/state"]);
    // Nothing is measured for a place that is taken.
    std::fs::write(folder.join("taken.json"), "mine").unwrap();
    refused(
        &["latency", "silent.mcap", "--out", "taken.json"],
        &["taken.json", "--force"],
    );
    assert_eq!(
        std::fs::read_to_string(folder.join("taken.json")).unwrap(),
        "mine"
    );
}
