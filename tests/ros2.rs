//! Nodes of ROS 2 as planners: unmodified nodes of `rclpy`, each in a process of its own, with Fast DDS.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use rustix::process::{Pid, PidfdFlags, Signal};
use serde_json::Value as Json;

use crate::support::call::{Call, wait};
use crate::support::history::{History, Order};
use crate::support::sandbox::signal;
use crate::support::{SOON, Sandbox, python, skipped, until};

/// ROS 2 Kilted in wheels: `rclpy` with Fast DDS, and its messages.
const KILTED: &[&str] = &[
    "python-ros2",
    "ros-kilted-rclpy[fastrtps]==9.1.2",
    "ros-kilted-geometry-msgs==5.5.1",
    "ros-kilted-nav-msgs==5.5.1",
    "ros-kilted-rosgraph-msgs==2.3.0",
    "ros-kilted-sensor-msgs==5.5.1",
];

const SCENARIO: &str = r#"
title = "Robots that nodes of ROS 2 steer"
description = "Three robots."
[world.map.vector]
bounds = { min = [-20.0, -20.0], max = [20.0, 20.0] }
[rules]
time_limit = 10.0
[[robots]]
name = "robot"
team = "neutral"
count = 3
random_start = {}
radius = 0.2
limits = { v_max = 1.0, omega_max = 40.0 }
[[processes]]
name = "bridge"
kind = "ros2_bridge"
team = "neutral"
grouping = "together"
[processes.params]
answer_timeout_s = 8.0
start_timeout_s = 50.0
"#;

/// Time for a node to end.
const NODE_END: Duration = Duration::from_secs(5);

/// A node that is ended with its test.
struct RosNode(Child);

impl Drop for RosNode {
    /// Fast DDS removes its shared memory at an orderly end alone, and can lock itself there.
    fn drop(&mut self) {
        let pid = Pid::from_child(&self.0);
        let open = rustix::process::pidfd_open(pid, PidfdFlags::empty());
        // It may have ended by itself.
        signal(self.0.id(), Signal::TERM);
        if !open.is_ok_and(|node| wait(&node, Instant::now() + NODE_END)) {
            let _ = self.0.kill();
        }
        self.0.wait().unwrap();
    }
}

/// Files in shared memory of `LTTng`, to which the packages are linked: it creates and leaves them.
fn lttng_files() -> Vec<PathBuf> {
    let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
    let of_lttng = |path: &PathBuf| path.to_string_lossy().contains("/lttng-ust-wait-");
    entries.map(|entry| entry.path()).filter(of_lttng).collect()
}

/// Those of other programs.
static LTTNG_FILES_BEFORE: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// A domain for one test, with the interpreter for its nodes.
struct Domain {
    sandbox: Sandbox,
    python: PathBuf,
    id: String,
}

impl Drop for Domain {
    fn drop(&mut self) {
        let before = LTTNG_FILES_BEFORE.get_or_init(Vec::new);
        for file in lttng_files() {
            if !before.contains(&file) {
                // Another test may have removed it.
                let _ = std::fs::remove_file(file);
            }
        }
    }
}

impl Domain {
    /// `place` tells the tests of this file apart; `None`, with a note, without the packages.
    fn new(place: u32) -> Option<Self> {
        let python = match python::prepare(KILTED) {
            Ok(python) => python,
            Err(reason) => {
                skipped("nodes of ROS 2", &reason);
                return None;
            }
        };
        LTTNG_FILES_BEFORE.get_or_init(lttng_files);
        let sandbox = Sandbox::new();
        sandbox.file("robots.toml", SCENARIO);
        Some(Self {
            sandbox,
            python,
            id: (1 + (std::process::id() * 10 + place) % 100).to_string(),
        })
    }

    /// A script of `tests/python`, in the domain.
    fn script(&self, name: &str) -> Command {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/python");
        let mut script = Command::new(&self.python);
        script
            .arg(PathBuf::from(folder).join(name))
            .env("ROS_DOMAIN_ID", &self.id)
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("HOME", self.sandbox.path())
            .stderr(Stdio::null());
        script
    }

    fn node(&self, mode: &str) -> RosNode {
        let mut script = self.script("ros2_planner.py");
        script.args([mode, "robot_1", "robot_2", "robot_3"]);
        RosNode(script.spawn().unwrap())
    }

    fn run<'a>(&'a self, log: &'a str) -> Call<'a> {
        let run = self.sandbox.protean(["run", "robots.toml", "--out", log]);
        run.set(&format!("processes.bridge.params.domain={}", self.id))
    }

    /// The run with a node, and the share of its commands that were computed from the state of their tick.
    fn steered(&self, mode: &str, log: &str, change: &str) -> (Json, f64) {
        let _node = self.node(mode);
        let summary = self.run(log).set(change).json();
        let history = History::read(&self.sandbox.path().join(log));
        (summary, fresh(&history))
    }
}

/// Share of the commands whose turning rate is the x of the state of their tick.
fn fresh(history: &History) -> f64 {
    let used = |order: &Order| {
        let state = history.states.iter().find(|state| state.tick == order.tick);
        state.unwrap().robots[order.robot as usize].x.to_bits() == order.omega.to_bits()
    };
    let all = history.commands.len();
    assert!(all > 500, "{all} commands");
    let fresh = history.commands.iter().filter(|order| used(order)).count();
    fresh as f64 / all as f64
}

/// Longer than 10 s: nodes of ROS 2 take seconds to start, and there are six runs.
#[test]
fn nodes_of_ros_2_have_one_history_and_the_data_of_their_tick() {
    let Some(domain) = Domain::new(0) else { return };
    let (timer, share) = domain.steered("timer", "timer.mcap", "run.seed=1");
    assert_eq!(share, 1.0);
    for (mode, change) in [
        ("timer", "run.seed=1"),
        ("event", "run.seed=1"),
        (
            "stamped",
            r#"processes.bridge.params.commands="twist_stamped""#,
        ),
    ] {
        let (summary, share) = domain.steered(mode, "again.mcap", change);
        assert_eq!(share, 1.0, "{mode}");
        assert_eq!(summary["digest"], timer["digest"], "{mode}");
        std::fs::remove_file(domain.sandbox.path().join("again.mcap")).unwrap();
    }
    // Peers that send anything at all, and a second run with the same namespaces, change nothing.
    let hostile = domain.script("ros2_hostile.py").spawn().unwrap();
    let hostile = RosNode(hostile);
    let node = domain.node("event");
    let first = domain
        .run("first.mcap")
        .args(["--json", "--pace", "1"])
        .start();
    until("ticks of the first run", SOON, || {
        let words = ["cat", "first.mcap", "--topics", "world/state"];
        let states = domain.sandbox.protean(words).run();
        states.stdout.contains("\"tick\":5").then_some(())
    });
    let second = domain.run("second.mcap").run();
    second.refused(1, &["another node writes /clock in ROS 2 domain"]);
    let first = first.finish();
    assert_eq!(
        (first.code, &first.json()["digest"]),
        (Some(0), &timer["digest"]),
        "{first}"
    );
    let history = History::read(&domain.sandbox.path().join("first.mcap"));
    assert_eq!(fresh(&history), 1.0);
    drop((node, hostile));
    // The check above can fail: a clock before the data lets timers use older data.
    let (_, share) = domain.steered(
        "timer",
        "clock.mcap",
        r#"processes.bridge.params.order="clock_first""#,
    );
    assert!(share < 0.9, "{share}");
}

#[test]
fn nodes_that_are_missing_end_or_answer_twice_are_named() {
    let Some(domain) = Domain::new(1) else { return };
    let refused = |mode: Option<&str>, log: &str, words: &[&str]| {
        let _node = mode.map(|mode| domain.node(mode));
        // Nodes take seconds to start on a machine with other work.
        let timeout_s = if mode.is_some() { 50 } else { 5 };
        let timeout = format!("processes.bridge.params.start_timeout_s={timeout_s}");
        domain.run(log).set(&timeout).run().refused(1, words);
    };
    refused(
        Some("twice"),
        "twice.mcap",
        &[
            "a second command in /robot_",
            "expected one command for each state",
        ],
    );
    refused(
        Some("ends"),
        "ends.mcap",
        &["no command in /robot_", "its node has gone"],
    );
    refused(
        None,
        "none.mcap",
        &[
            "no node writes /robot_1/cmd_vel",
            "expected a node that reads /robot_1/odom and writes /robot_1/cmd_vel of type geometry_msgs/Twist",
        ],
    );
    let node = domain.node("event");
    let apart = domain
        .run("apart.mcap")
        .set(r#"processes.bridge.grouping="one_per_robot""#);
    apart.run().refused(1, &["another node writes /clock"]);
    drop(node);
    let run = domain.run("stamped.mcap");
    let _node = domain.node("stamped");
    run.run().refused(
        1,
        &[
            "writes /robot_1/cmd_vel as geometry_msgs::msg::dds_::TwistStamped_",
            "expected geometry_msgs/Twist",
        ],
    );
}

/// A process that lets nodes watch a run, with the evader in place of Nav2's one robot.
const WATCHED: &str = r#"
[[processes]]
name = "watched"
kind = "ros2_bridge"
[processes.params]
commands = "none"
root = "evader_1"
topics = ["world/event"]
"#;

/// Longer than 10 s: the watched run is in real time.
#[test]
fn nodes_that_watch_a_run_see_all_of_it_and_change_nothing() {
    let Some(domain) = Domain::new(2) else { return };
    let sandbox = &domain.sandbox;
    let new = sandbox.protean(["new", "chase.toml", "--from", "chase"]);
    assert_eq!(new.run().code, Some(0));
    let path = sandbox.path().join("chase.toml");
    let text = std::fs::read_to_string(&path).unwrap() + WATCHED;
    std::fs::write(&path, text).unwrap();
    let run = |words: [&'static str; 4]| {
        let call = sandbox.protean(words).args(["--seed", "1"]);
        call.set("rules.time_limit=9")
    };
    let domain_key = format!("processes.watched.params.domain={}", domain.id);
    let alone = run(["run", "chase", "--out", "alone.mcap"]).json();
    let watched = run(["run", "chase.toml", "--out", "watched.mcap"]);
    let watched = watched.set(&domain_key).json();
    assert_eq!(alone["digest"], watched["digest"]);
    let mut script = domain.script("ros2_watcher.py");
    let script = script.args(["evader_1", "police_1", "the game is over"]);
    let watcher = script.stdout(Stdio::piped()).spawn().unwrap();
    let real = run(["run", "chase.toml", "--out", "real.mcap"]).set(&domain_key);
    let real = real.args(["--real-time", "--quiet"]).run();
    // Whether a message is lost depends on the machine.
    assert!(
        real.code.is_some_and(|code| code != 1 && code != 2),
        "{real}"
    );
    let output = watcher.wait_with_output().unwrap();
    let seen: Json = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(seen["frames"], serde_json::json!([["odom", "base_link"]]));
    assert_eq!(seen["others"], serde_json::json!(["police_1/base_link"]));
    let lines = seen["lines"].as_array().unwrap();
    assert!(
        lines.iter().any(|line| line == "evader_1 ran out of time"),
        "{seen}"
    );
    assert_eq!(seen["maps"].as_array().unwrap().len(), 1, "{seen}");
    assert!(seen["plans"].as_u64().unwrap() > 1, "{seen}");
    assert_eq!(seen["beliefs"], 400, "{seen}");
}

/// A process that takes the robot out of the simulation.
const OUTSIDE: &str = r#"
[[processes]]
name = "outside"
kind = "ros2_bridge"
[processes.params]
commands = "none"
source = ["robot"]
start_timeout_s = 50.0
"#;

/// Longer than 10 s: the runs are in real time.
#[test]
fn a_robot_of_ros_2_is_steered_and_stops_without_odometry() {
    let Some(domain) = Domain::new(3) else { return };
    let sandbox = &domain.sandbox;
    let new = sandbox.protean(["new", "hello.toml", "--from", "hello"]);
    assert_eq!(new.run().code, Some(0));
    let path = sandbox.path().join("hello.toml");
    let text = std::fs::read_to_string(&path).unwrap() + OUTSIDE;
    std::fs::write(&path, text).unwrap();
    let run = |words: &[&'static str]| {
        let call = sandbox.protean(["run", "hello.toml"]);
        let call = call.args(words.iter().copied());
        call.set(&format!("processes.outside.params.domain={}", domain.id))
    };
    let refused = run(&["--out", "lock_step.mcap"]);
    refused
        .run()
        .refused(1, &["expected a run with --real-time"]);
    let refused = run(&["--out", "alone.mcap", "--real-time"]);
    let refused = refused.set("processes.outside.params.start_timeout_s=1");
    refused
        .run()
        .refused(1, &["no message in /robot/odom within 1 s"]);

    let mut script = domain.script("ros2_robot.py");
    let robot = RosNode(script.arg("100").spawn().unwrap());
    let out = run(&["--out", "out.mcap", "--real-time", "--json"]).run();
    // Whether a message is lost depends on the machine.
    assert!(out.code.is_some_and(|code| code != 1 && code != 2), "{out}");
    assert_eq!(out.json()["robots"][0]["outcome"], "escaped", "{out}");
    drop(robot);

    let mut script = domain.script("ros2_robot.py");
    let robot = script.arg("1").stdout(Stdio::piped()).spawn().unwrap();
    let stopped = run(&["--out", "stopped.mcap", "--real-time"]).set("rules.time_limit=25");
    let stopped = stopped.run();
    let robot = robot.wait_with_output().unwrap();
    let robot: Json = serde_json::from_slice(&robot.stdout).unwrap();
    assert_eq!(robot["stopped"], true, "{robot} {stopped}");
    let history = History::read(&sandbox.path().join("stopped.mcap"));
    let states = history.states.iter().map(|state| &state.robots[0]);
    assert!(states.clone().all(|state| state.x < 1.7));
    assert!(states.clone().any(|state| state.fail_safe));
}
