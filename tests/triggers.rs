//! Obstacles that wait for robots: they come at the tick at which the robot has come so far, in
//! every mode the same, and the log shows them from then on.

use crate::support::Sandbox;
use crate::support::history::{History, Robot};
use crate::support::invariants::{Game, the_summary_says_what_the_log_holds};
use geometry::math;
use serde_json::Value as Json;

/// A robot that drives around a wall to the exit. A gate shuts in front of it once it has driven
/// 0.4 m and opens at 8 s; on the second half of its way a crate comes, elsewhere than it was to
/// stand at first, and goes when the robot is near the exit.
const ROOM: &str = r#"
[world]
map = "builtin:hello"
[rules]
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
time_limit = 60.0
[[robots]]
name = "robot"
team = "evader"
start = { x = 0.5, y = 0.5, theta = 0.0 }
goal = { circle = { center = [3.5, 0.5], radius = 0.2 } }
[[processes]]
kind = "evader_potential"
robots = ["robot"]
[[events]]
when = { robot = "robot", travelled = 0.4 }
action = "appear"
obstacle = "gate"
shape.rectangle = { center = [2.0, 2.5], half_extents = [0.1, 0.5] }
[[events]]
when = { robot = "robot", progress = 0.36 }
action = "appear"
obstacle = "crate"
shape.rectangle = { center = [3.7, 2.7], half_extents = [0.1, 0.1] }
[[events]]
when = { robot = "robot", travelled = 1.0 }
action = "move"
obstacle = "crate"
shape.rectangle = { center = [3.6, 2.6], half_extents = [0.1, 0.1] }
[[events]]
when = { robot = "robot", within = 0.8, of = [3.5, 0.5] }
after_s = 0.12
action = "disappear"
obstacle = "crate"
[[events]]
time_s = 8.0
action = "disappear"
obstacle = "gate"
"#;

/// Ticks of the scenario per second.
const RATE: u64 = 20;
const GATE: u32 = 1;
const CRATE: u32 = 2;
const APPEAR: u8 = 0;
const DISAPPEAR: u8 = 1;
const MOVE: u8 = 2;

/// The first tick whose state fulfils a condition on the robot.
#[track_caller]
fn first(history: &History, holds: impl Fn(&Robot) -> bool) -> u64 {
    let found = history.states.iter().find(|s| holds(&s.robots[0]));
    found.expect("it comes so far").tick
}

fn far_from_exit(robot: &Robot) -> f64 {
    math::hypot(robot.x - 3.5, robot.y - 0.5)
}

/// Fraction of its path that it has driven.
fn progress(robot: &Robot) -> f64 {
    1.0 - far_from_exit(robot) / 3.0
}

/// Tick, obstacle and action of the changes that must come of the states in a log.
fn expected(history: &History) -> Vec<(u64, u32, u8)> {
    let shut = first(history, |r| r.distance >= 0.4);
    let half_way = first(history, |r| progress(r) >= 0.36);
    let near = first(history, |r| far_from_exit(r) <= 0.8);
    let moved = first(history, |r| r.distance >= 1.0);
    assert!(
        0 < shut && shut < 8 * RATE && moved < half_way && 8 * RATE < half_way && half_way < near,
        "{shut} {moved} {half_way} {near}: the scenario shows what it shall"
    );
    vec![
        (shut, GATE, APPEAR),
        (8 * RATE, GATE, DISAPPEAR),
        (half_way, CRATE, APPEAR),
        // It was due long before, when there was nothing to move.
        (half_way, CRATE, MOVE),
        // 0.12 s are two ticks and a half.
        (near + 3, CRATE, DISAPPEAR),
    ]
}

/// Asserts that the changes in the log agree with its states, in all topics.
#[track_caller]
fn shows_every_change_at_its_tick(history: &History) {
    let told: Vec<(u64, u32, u8)> = history
        .obstacles
        .iter()
        .map(|c| (c.tick, c.id, c.action))
        .collect();
    assert_eq!(told, expected(history));
    let reported: Vec<(u64, u32, u8)> = history
        .events
        .iter()
        .filter(|e| e.kind == 8)
        .map(|e| (e.tick, e.other, e.value as u8))
        .collect();
    // Codes of actions there: appeared, disappeared, moved.
    assert_eq!(reported, told, "told at the tick from which on they hold");
    let mut ticks: Vec<u64> = std::iter::once(0).chain(told.iter().map(|t| t.0)).collect();
    ticks.dedup();
    let maps: Vec<u64> = history.maps.iter().map(|m| m.tick).collect();
    assert_eq!(maps, ticks, "a new map at every change");
    for message in history.of("world/obstacle_event") {
        assert_eq!(message.source, 0, "the simulator tells when they come");
    }
    // The wall at the start, and every change; and what stands, again every two seconds at most.
    let (drawn, _) = history.counts["/obstacles"];
    let seconds = history.states.last().unwrap().tick / RATE;
    let fewest = 1 + told.len() as u64;
    assert!(
        (fewest..=fewest + seconds / 2).contains(&drawn),
        "{drawn} in {seconds} s"
    );
}

fn record(sandbox: &Sandbox, words: &[&str]) -> (Json, History) {
    let mut call = sandbox.protean(["run", "room.toml", "--quiet"]);
    for word in words {
        call = call.arg(word);
    }
    let summary = call.json();
    let log = sandbox.path().join(summary["log"].as_str().unwrap());
    (summary, History::read(&log))
}

#[test]
fn obstacles_come_when_the_robot_has_come_so_far_in_every_mode() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    let (summary, history) = record(&sandbox, &["--out", "many.mcap"]);
    shows_every_change_at_its_tick(&history);
    the_summary_says_what_the_log_holds(&history, &summary);
    Game::in_room(&sandbox.path().join("many.mcap")).holds(&history, &summary);
    assert_eq!(summary["robots"][0]["outcome"], "escaped", "{summary}");

    let (again, _) = record(&sandbox, &["--out", "again.mcap"]);
    assert_eq!(again["digest"], summary["digest"]);
    let (one, in_process) = record(&sandbox, &["--in-process", "--out", "one.mcap"]);
    assert_eq!(one["digest"], summary["digest"]);
    assert_eq!(one["events"], summary["events"]);
    assert_eq!(in_process.obstacles, history.obstacles);
    assert_eq!(in_process.states, history.states);

    let words = ["--real-time", "20", "--out", "clock.mcap"];
    let (_, real_time) = record(&sandbox, &words);
    // In real time the number of ticks depends on the machine, the reactions to events do not.
    let first = |holds: &dyn Fn(&Robot) -> bool| {
        let mut states = real_time.states.iter();
        states.find(|s| holds(&s.robots[0])).map(|s| s.tick)
    };
    let came = |id: u32| {
        let mut changes = real_time.obstacles.iter();
        let change = changes.find(|c| (c.id, c.action) == (id, APPEAR));
        change.map(|c| c.tick)
    };
    assert_eq!(came(GATE), first(&|r| r.distance >= 0.4));
    assert_eq!(came(CRATE), first(&|r| progress(r) >= 0.36));
    sandbox.assert_nothing_left();
}

#[test]
fn an_obstacle_that_comes_on_top_of_its_robot_pushes_it_out_at_that_tick() {
    let sandbox = Sandbox::new();
    let event = r#"
[[events]]
when = { robot = "robot", within = 0.01, of = [0.5, 0.5] }
action = "appear"
obstacle = "trap"
shape.rectangle = { center = [0.45, 0.5], half_extents = [0.05, 0.05] }
"#;
    sandbox.file("room.toml", format!("{ROOM}{event}"));
    let (summary, history) = record(&sandbox, &["--in-process", "--out", "trap.mcap"]);
    assert_eq!(
        (history.obstacles[0].tick, history.obstacles[0].action),
        (0, APPEAR)
    );
    let at_once: Vec<&str> = summary["events"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|event| event["time_s"] == 0.0)
        .map(|event| event["kind"].as_str().unwrap())
        .collect();
    assert_eq!(at_once, ["obstacle", "pushed_out"]);
    let start = &history.states[0].robots[0];
    assert!(
        math::hypot(start.x - 0.5, start.y - 0.5) > 0.05,
        "{start:?}"
    );
}

#[test]
fn a_change_that_must_wait_for_another_is_named() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    let words = "obstacle `crate` waits to move: an earlier event has not happened yet";
    let outcome = sandbox.protean(["run", "room.toml"]).run();
    assert_eq!(outcome.code, Some(0), "{outcome}");
    assert_eq!(outcome.stderr.matches(words).count(), 1, "{outcome}");
}

#[test]
fn the_log_alone_has_all_that_the_run_follows_from() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    let check = sandbox.protean(["check", "room.toml", "--print"]).run();
    assert_eq!(check.code, Some(0), "{check}");
    sandbox.file("printed.toml", &check.stdout);
    let digest = |name: &str| {
        let summary = sandbox.protean(["run", name, "--in-process"]).json();
        summary["digest"].clone()
    };
    assert_eq!(digest("printed.toml"), digest("room.toml"));
}

#[test]
fn pictures_show_an_obstacle_from_the_tick_at_which_it_came() {
    let sandbox = Sandbox::new();
    sandbox.file("room.toml", ROOM);
    let (_, history) = record(&sandbox, &["--out", "run.mcap"]);
    let came = history.obstacles[0].tick;
    let shows = |tick: u64| {
        let time = format!("{}", tick as f64 / RATE as f64);
        let words = [
            "picture", "run.mcap", "--at", &time, "--out", "p.svg", "--force",
        ];
        let outcome = sandbox.protean(words).run();
        assert_eq!(outcome.code, Some(0), "{outcome}");
        let picture = std::fs::read_to_string(sandbox.path().join("p.svg")).unwrap();
        picture.contains("changed during the run")
    };
    assert!(!shows(came - 1) && shows(came));
    assert!(!shows(8 * RATE), "gone");
}
