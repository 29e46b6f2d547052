//! The chase from the command to the log: what is in the log keeps the rules of the game and the
//! limits of the robots, and follows from scenario and seed alone.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::history::{History, State, manifest, scenario};
use crate::support::invariants::{Game, standing_obstacles, the_summary_says_what_the_log_holds};
use crate::support::{Sandbox, python};
use serde_json::Value as Json;

/// Path of the log that a summary names.
fn log_of(sandbox: &Sandbox, summary: &Json) -> PathBuf {
    sandbox.path().join(summary["log"].as_str().unwrap())
}

/// A finished run: what it printed and what it logged.
fn record(sandbox: &Sandbox, words: &[&str]) -> (Json, History, PathBuf) {
    let words = std::iter::once("run").chain(words.iter().copied());
    let call = sandbox.protean(words).arg("--quiet");
    let summary = call.json();
    let log = log_of(sandbox, &summary);
    let history = History::read(&log);
    (summary, history, log)
}

/// Python must read the same from the log, decoding by the schemas in it; and viewers must be
/// shown the robots where they are.
fn python_reads_the_same(log: &Path, history: &History, names: &[&str]) {
    let Some(read) = python::read(log) else {
        return;
    };
    assert_eq!(read.history.counts, history.counts);
    assert_eq!(read.history, *history);
    let at: BTreeMap<u64, _> = history
        .of("world/state")
        .map(|m| m.log_time)
        .zip(&history.states)
        .collect();
    let mut shown = BTreeSet::new();
    let (centres, robots): (Vec<_>, Vec<_>) = read
        .transforms
        .iter()
        .partition(|(_, name, ..)| name == "map/centre");
    assert!(!centres.is_empty(), "the place that viewers look at");
    for (log_time, name, x, y) in robots {
        let robot = names.iter().position(|n| n == name).unwrap();
        let robot = &at[log_time].robots[robot];
        assert_eq!((robot.x, robot.y), (*x, *y), "{name} at {log_time} ns");
        shown.insert(name.as_str());
    }
    assert_eq!(shown, names.iter().copied().collect());
}

const NAMES: [&str; 6] = [
    "police_1", "police_2", "police_3", "police_4", "evader_1", "evader_2",
];

#[test]
fn a_chase_to_its_natural_end_keeps_every_rule() {
    let sandbox = Sandbox::new();
    let (summary, history, log) = record(&sandbox, &["chase", "--seed", "1"]);
    Game::in_city(&log).holds(&history, &summary);
    assert!(history.states.last().unwrap().over);
    python_reads_the_same(&log, &history, &NAMES);
    sandbox.assert_nothing_left();
}

#[test]
fn other_seeds_keep_every_rule_up_to_their_time_limit() {
    let sandbox = Sandbox::new();
    let mut starts = Vec::new();
    for seed in ["2", "3"] {
        let words = ["chase", "--seed", seed, "--set", "rules.time_limit=5"];
        let (summary, history, log) = record(&sandbox, &words);
        Game::in_city(&log).holds(&history, &summary);
        assert_eq!(summary["ticks"], 100);
        python_reads_the_same(&log, &history, &NAMES);
        starts.push(history.states[0].clone());
    }
    assert_ne!(starts[0], starts[1], "starts vary with the seed");
    sandbox.assert_nothing_left();
}

/// A slow thief in a room with a fast policeman: it is caught, whatever the planners are tuned to.
const CORNERED: &str = r#"
[run]
seed = 3
[world]
map = "builtin:hello"
[rules]
capture = { radius = 0.3 }
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 120.0
[[robots]]
name = "cop"
team = "police"
start = { x = 0.5, y = 2.5, theta = 0.0 }
[[robots]]
name = "thief"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }
limits = { v_max = 0.02 }
[[processes]]
kind = "perception"
[[processes]]
kind = "pursuer"
team = "police"
[[processes]]
kind = "evader_potential"
team = "evader"
"#;

#[test]
fn evaders_are_caught_within_the_radius_only() {
    let sandbox = Sandbox::new();
    sandbox.file("cornered.toml", CORNERED);
    let (summary, history, log) = record(&sandbox, &["cornered.toml"]);
    Game::in_room(&log).holds(&history, &summary);
    assert_eq!(summary["robots"][1]["outcome"], "caught", "{summary}");
    sandbox.assert_nothing_left();
}

/// Runs the processor hot until dropped.
struct Load(std::sync::Arc<AtomicBool>, Vec<std::thread::JoinHandle<()>>);

impl Load {
    fn new(threads: usize) -> Self {
        let stop = std::sync::Arc::new(AtomicBool::new(false));
        let burn = |stop: std::sync::Arc<AtomicBool>| {
            move || {
                while !stop.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            }
        };
        let threads = (0..threads)
            .map(|_| std::thread::spawn(burn(std::sync::Arc::clone(&stop))))
            .collect();
        Self(stop, threads)
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        for thread in self.1.drain(..) {
            let _ = thread.join();
        }
    }
}

#[test]
fn the_digest_follows_from_scenario_and_seed_whatever_the_machine_does() {
    let sandbox = Sandbox::new();
    let call = |seed: &'static str| {
        sandbox.protean([
            "run",
            "chase",
            "--quiet",
            "--seed",
            seed,
            "--set",
            "rules.time_limit=4",
        ])
    };
    let digest = |summary: Json| {
        assert_eq!(summary["ticks"], 80);
        summary["digest"].as_str().unwrap().to_owned()
    };
    let summary = call("5").json();
    let log = log_of(&sandbox, &summary);
    let reference = digest(summary);
    assert_eq!(reference.len(), 64);
    assert_eq!(
        digest_of_log(&log),
        reference,
        "the digest of what is in the log"
    );

    let anywhere = call("5").set("run.pin=\"none\"");
    assert_eq!(digest(anywhere.json()), reference, "on any core");
    let talkative = call("5")
        .on_one_core()
        .arg("--log-level")
        .arg("debug")
        .set("log.viewer_rate_hz=0");
    assert_eq!(
        digest(talkative.json()),
        reference,
        "with one core, and watched"
    );
    {
        let _load = Load::new(4);
        let pinned = call("5").set("run.pin=\"one_core\"");
        assert_eq!(digest(pinned.json()), reference, "pinned, under load");
    }
    // Two at once, in one directory.
    let (first, second) = (
        call("5").arg("--json").start(),
        call("5").arg("--json").start(),
    );
    assert_eq!(digest(first.finish().json()), reference);
    assert_eq!(digest(second.finish().json()), reference);

    assert_ne!(digest(call("6").json()), reference, "another seed");
    sandbox.assert_nothing_left();
}

/// The digest, computed from a log: by topic and source the messages in their order, each by
/// its length, the simulated part of its stamp, and what stands behind the stamp.
fn digest_of_log(log: &Path) -> String {
    const STAMP: usize = 72;
    // The length is counted as if there were the clocks of the first version.
    const LATER_CLOCKS: u64 = 16;
    const SIMULATED: usize = 32;
    let bytes = std::fs::read(log).unwrap();
    let mut streams: BTreeMap<(String, u32), (u64, blake3::Hasher)> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        if topic.starts_with('/') || topic.starts_with("process/") {
            continue;
        }
        if ["run/control", "world/robots"].contains(&&*topic) {
            continue;
        }
        let source = u32::from_le_bytes(message.data[4 + 24..4 + 28].try_into().unwrap());
        let (count, hasher) = streams.entry((topic, source)).or_default();
        *count += 1;
        // An empty sequence counts with the gap that its first element would need.
        let facts = &message.channel.metadata;
        let head = 4 + facts["header_bytes"].parse::<usize>().unwrap() + 4;
        let is_empty = facts["element_align"] == "8" && message.data.len() == head;
        let gap: &[u8] = if is_empty { &[0; 4] } else { &[] };
        let length = (message.data.len() + gap.len()) as u64 - LATER_CLOCKS;
        hasher.update(&length.to_le_bytes());
        hasher.update(&message.data[4..4 + SIMULATED]);
        hasher.update(&message.data[4 + STAMP..]);
        hasher.update(gap);
    }
    let mut all = blake3::Hasher::new();
    for ((topic, source), (count, hasher)) in streams {
        all.update(&(topic.len() as u64).to_le_bytes());
        all.update(topic.as_bytes());
        all.update(&source.to_le_bytes());
        all.update(&count.to_le_bytes());
        all.update(hasher.finalize().as_bytes());
    }
    all.finalize().to_hex().to_string()
}

#[test]
fn every_built_in_scenario_runs_and_keeps_every_rule() {
    let sandbox = Sandbox::new();
    let listed = sandbox.protean(["list"]).json();
    let names: Vec<String> = listed["scenarios"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["name"].as_str().unwrap().to_owned())
        .collect();
    for wanted in [
        "chase",
        "chase_braitenberg",
        "chase_exact",
        "chase_popup",
        "chase_rrt_star",
        "hello",
    ] {
        assert!(
            names.iter().any(|name| name == wanted),
            "{wanted} is missing in {names:?}"
        );
    }
    for name in &names {
        let checked = sandbox.protean(["check", name]).json();
        assert_eq!(checked["ok"], true, "{checked}");
        let other = ["popup", "single_lane", "patrol_", "coverage_"];
        if checked["external_commands"] == true || other.iter().any(|o| name.starts_with(o)) {
            // What the one starts need not be on this machine; the others are no chases, and are
            // played in `navigation`, `patrol` and `coverage`.
            continue;
        }
        // The first seconds of each show every planner at work; whole games are played above. That
        // processes would play the same is another test's business (`in_process`).
        let limit = ["--set", "rules.time_limit=8"];
        let words = [name, "--in-process", "--out", "run.mcap", "--force"];
        let (summary, history, log) = record(&sandbox, &[&words[..], &limit].concat());
        the_summary_says_what_the_log_holds(&history, &summary);
        let last = history.states.last().unwrap();
        assert!(last.over, "{name}: {summary}");
        assert_eq!(summary["scenario"], name.as_str());
        let (metadata, attachments) = manifest(&log);
        assert_eq!(metadata["scenario"], *name);
        assert_eq!(metadata["seed"], summary["seed"].to_string());
        assert!(
            attachments.contains_key("scenario.toml"),
            "{name}: {attachments:?}"
        );
        let game = match name.as_str() {
            "hello" => Game::in_room(&log),
            "chase_paper" => Game::in_published_city(&log),
            _ => Game::in_city(&log),
        };
        game.holds(&history, &summary);
        if name == "chase_braitenberg" {
            let evaders = |s: &State| s.robots.iter().filter(|r| r.team == 2).count();
            let scans: usize = history.states.iter().map(evaders).sum();
            assert_eq!(
                history.of("robot/scan").count(),
                scans,
                "one per evader and state"
            );
        }
    }
}

#[test]
fn a_referee_judges_every_quarter_second_and_changes_no_game() {
    let sandbox = Sandbox::new();
    let short = ["--set", "rules.time_limit=12"];
    let (summary, history, _) = record(&sandbox, &[&["chase_referee"][..], &short].concat());
    let ticks = summary["ticks"].as_u64().unwrap();
    let active = history.states.iter().filter(|state| !state.over).count() as u64;
    assert!(active > 5 && active <= ticks + 1);
    assert_eq!(
        history.of("world/verdict").count() as u64,
        active.div_ceil(5)
    );
    assert_eq!(
        history.of("world/dominance").count() as u64,
        active.div_ceil(20)
    );
    let fraction = summary["escape_possible_fraction"].as_f64().unwrap();
    assert!((0.0..=1.0).contains(&fraction), "{summary}");
    for robot in summary["robots"].as_array().unwrap() {
        let is_evader = robot["team"] == "evader";
        assert_eq!(
            robot["escape_possible_fraction"].is_number(),
            is_evader,
            "{robot}"
        );
    }
    let again = [&["run", "chase_referee", "--in-process"][..], &short].concat();
    assert_eq!(sandbox.protean(again).json()["digest"], summary["digest"]);
    let text = scenario::builtin::scenario("chase_referee").unwrap().text;
    let (game, _) = text
        .split_once("[[processes]]\nkind = \"referee\"")
        .unwrap();
    sandbox.file("alone.toml", game.replace("maps/city.toml", "builtin:city"));
    let (alone, without, _) = record(&sandbox, &[&["alone.toml"][..], &short].concat());
    assert!(alone.get("escape_possible_fraction").is_none());
    assert_eq!(without.states, history.states, "a referee steers no robot");
}

#[test]
fn road_works_come_and_go_at_their_times_and_no_robot_drives_through_them() {
    let sandbox = Sandbox::new();
    let (summary, history, log) = record(&sandbox, &["chase_popup"]);
    let told: Vec<(u64, u8)> = history
        .obstacles
        .iter()
        .map(|c| (c.tick, c.action))
        .collect();
    let planned: Vec<(u64, u8)> = scenario(&log)["events"]
        .as_array()
        .unwrap()
        .iter()
        .map(|event| {
            let tick = (event["time_s"].as_float().unwrap() / 0.05).round() as u64;
            let actions = ["appear", "disappear", "move"];
            let action = actions
                .iter()
                .position(|a| event["action"].as_str() == Some(a));
            (tick, action.unwrap() as u8)
        })
        .collect();
    assert!(planned.is_sorted() && planned.len() >= 2);
    assert_eq!(told, planned);
    let end = summary["ticks"].as_u64().unwrap();
    let due: Vec<u64> = told
        .iter()
        .map(|t| t.0)
        .filter(|&tick| tick < end)
        .collect();
    assert!(
        due.len() >= 3,
        "the game is long enough for the road works: {end} ticks"
    );
    let revised: Vec<(u64, u32)> = history.maps.iter().map(|m| (m.tick, m.revision)).collect();
    let expected: Vec<(u64, u32)> = std::iter::once(0).chain(due.clone()).zip(1..).collect();
    assert_eq!(
        revised, expected,
        "a new map at every change and at no other time"
    );
    assert!(history.maps[1].occupied > history.maps[0].occupied);
    let reported: Vec<u64> = history
        .events
        .iter()
        .filter(|e| e.kind == 8)
        .map(|e| e.tick)
        .collect();
    assert_eq!(reported, due, "told at the tick from which on they hold");
    for state in &history.states {
        let changes = due.iter().filter(|&&tick| tick <= state.tick).count();
        assert_eq!(
            state.map_revision as usize,
            1 + changes,
            "tick {}",
            state.tick
        );
    }
    assert_eq!(standing_obstacles(&history, due[0]).len(), 1);
    let last = history.messages.iter().map(|m| m.log_time).max();
    let end_ns = history.states.last().unwrap().tick * 50_000_000;
    assert_eq!(
        last,
        Some(end_ns),
        "what was announced for later does not extend the log"
    );
    Game::in_city(&log).holds(&history, &summary);
    sandbox.assert_nothing_left();
}

/// One robot, one wall, and a gate across the only way that is shut from 2 s to 20 s.
const GATE: &str = r#"
[world]
map = "builtin:hello"
[rules]
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 60.0
[[robots]]
name = "robot"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }
[[processes]]
kind = "evader_potential"
robots = ["robot"]
[[events]]
time_s = 2.0
action = "appear"
obstacle = "gate"
shape.rectangle = { center = [2.0, 2.5], half_extents = [0.1, 0.5] }
[[events]]
time_s = 20.0
action = "disappear"
obstacle = "gate"
"#;

#[test]
fn a_shut_gate_is_waited_at_until_it_opens() {
    let sandbox = Sandbox::new();
    sandbox.file("gate.toml", GATE);
    let (summary, history, log) = record(&sandbox, &["gate.toml"]);
    Game::in_room(&log).holds(&history, &summary);
    for state in &history.states {
        let behind = state.robots[0].x < 2.0;
        assert!(
            behind || state.tick > 400,
            "tick {}: through the gate",
            state.tick
        );
    }
    assert_eq!(summary["robots"][0]["outcome"], "escaped", "{summary}");
    sandbox.assert_nothing_left();
}

#[test]
fn in_real_time_the_log_holds_every_tick_and_no_message_is_lost() {
    let sandbox = Sandbox::new();
    let words = ["hello", "--real-time", "10", "--set", "rules.time_limit=10"];
    let (summary, history, log) = record(&sandbox, &words);
    let game = Game::in_room(&log);
    the_summary_says_what_the_log_holds(&history, &summary);
    game.no_robot_is_in_a_wall(&history);
    game.no_robot_is_too_fast(&history);
    let ticks: Vec<u64> = history.states.iter().map(|s| s.tick).collect();
    assert_eq!(ticks, (0..=200).collect::<Vec<_>>());
    let wall = summary["wall_time_s"].as_f64().unwrap();
    assert!(wall >= 0.99, "10 s at ten times real time, in {wall} s");
    sandbox.assert_nothing_left();
}
