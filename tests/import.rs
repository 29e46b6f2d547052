//! Bags of ROS 2, written by another program, as inputs of processes.

use serde_json::Value as Json;

use crate::support::history::History;
use crate::support::{Sandbox, python};

const FIELD: &str = r#"
title = "A robot in a field"
description = "Its map is that of the bag."
[world.map.vector]
bounds = { min = [0.0, 0.0], max = [9.0, 9.0] }
[rules]
exits = [{ circle = { center = [3.5, 0.5], radius = 0.2 } }]
[[robots]]
name = "robot"
team = "evader"
start = { x = 7.0, y = 7.0, theta = 0.0 }
[[processes]]
name = "driver"
kind = "evader_potential"
robots = ["robot"]
"#;

#[test]
#[expect(clippy::too_many_lines, reason = "one bag after the other")]
fn robots_of_bags_are_where_they_were_and_processes_are_tested_on_them() {
    let sandbox = Sandbox::new();
    let run = sandbox.protean(["run", "chase_exact", "--seed", "3", "--out", "run.mcap"]);
    let summary = run.set("rules.time_limit=6").json();
    let original = History::read(&sandbox.path().join("run.mcap"));
    let robots = summary["robots"].as_array().unwrap();
    let states = robots.iter().enumerate().map(|(index, robot)| {
        let states = original.states.iter().map(|state| &state.robots[index]);
        let states = states.map(|it| serde_json::json!([it.x, it.y, it.theta, it.v, it.omega]));
        let name = robot["name"].as_str().unwrap().to_owned();
        (name, states.collect::<Vec<_>>())
    });
    let states: serde_json::Map<String, Json> =
        states.map(|(name, states)| (name, states.into())).collect();
    sandbox.file("states.json", Json::Object(states).to_string());
    let poses: Option<Vec<[f64; 3]>> = python::call("write_bags.py", sandbox.path());
    let Some(poses) = poses else { return };

    // The planners answer the recorded team as they answered the run.
    let import = [
        "import",
        "team",
        "chase_exact",
        "--seed",
        "3",
        "--out",
        "team.mcap",
    ];
    let team = sandbox.protean(import).set("rules.time_limit=6").json();
    // The last tick is before the last message of the robot whose messages are the earliest.
    assert_eq!(
        (&team["ticks"], &summary["ticks"]),
        (&119.into(), &120.into())
    );
    assert_eq!(team["import"]["simulated"], serde_json::json!([]));
    assert_eq!(team["import"]["remarks"], serde_json::json!([]));
    let again = History::read(&sandbox.path().join("team.mcap"));
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert_eq!(again.states.len(), 120);
    for (a, b) in again.states.iter().zip(&original.states) {
        let mut robots = a.robots.iter().zip(&b.robots);
        assert!(
            robots.all(|(a, b)| near(a.x, b.x) && near(a.y, b.y) && near(a.theta, b.theta)),
            "tick {}: {a:?} {b:?}",
            a.tick
        );
    }
    assert!(original.commands.len() > 500);
    let mut pairs = again.commands.iter().zip(&original.commands);
    let different = pairs.find(|(a, b)| !near(a.v, b.v) || !near(a.omega, b.omega));
    assert!(different.is_none(), "{different:?}");

    // One robot without a namespace, with scans and a map; the folder of a bag is the bag.
    sandbox.file("field.toml", FIELD);
    let import = |bag: &'static str, out: &'static str| {
        sandbox.protean(["import", bag, "field.toml", "--out", out])
    };
    let field = import("field", "field.mcap").json();
    let topics = serde_json::json!({"map": ["/map", 2], "robot/odom": ["/odom", 101], "robot/scan": ["/scan", 51]});
    assert_eq!(field["import"]["topics"], topics);
    let log = History::read(&sandbox.path().join("field.mcap"));
    assert_eq!(log.states.len(), poses.len());
    for (state, [x, y, theta]) in log.states.iter().zip(&poses) {
        let robot = &state.robots[0];
        assert!(
            near(robot.x, *x) && near(robot.y, *y) && near(robot.theta, *theta),
            "{state:?}"
        );
    }
    // The last map: two edges and a wall of ten cells.
    let map = log.maps.last().unwrap();
    assert_eq!((map.width, map.height, map.occupied), (80, 60, 170));
    let scans = sandbox
        .protean(["cat", "field.mcap", "--topics", "robot/scan"])
        .run();
    let scans: Vec<Json> = scans
        .stdout
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(scans.len(), poses.len());
    let scan = scans[50].to_string();
    for part in ["-0.75", "1.5,", "2.5,1.5]"] {
        assert!(scan.contains(part), "{part}: {scan}");
    }

    // What the process answers today is compared with what it answered at the import.
    let test = |log| sandbox.protean(["replay", log, "--test", "driver", "--json"]);
    let same = test("field.mcap").run();
    assert_eq!(
        (same.code, &same.json()["identical"]),
        (Some(0), &Json::Bool(true)),
        "{same}"
    );
    let other = test("field.mcap")
        .set("robots.robot.limits.v_max=0.05")
        .run();
    assert_eq!(other.code, Some(1), "{other}");
    for command in ["verify", "branch"] {
        let refused = sandbox.protean([command, "field.mcap"]);
        let refused = if command == "branch" {
            refused.args(["--at", "1"])
        } else {
            refused
        };
        refused.run().refused(
            2,
            &[
                "field.mcap: its robots follow the recording field",
                "protean import",
            ],
        );
    }

    let refused = |bag, words: &[&str], more: &[&'static str]| {
        let call = import(bag, "refused.mcap").args(more.iter().copied());
        call.run().refused(2, words);
    };
    refused(
        "old",
        &[
            "old.db3 is not an MCAP file",
            "ROS 2 bag in SQLite",
            "rosbags-convert",
        ],
        &[],
    );
    refused(
        "none",
        &["none: cannot be read: no FILE.mcap of a bag"],
        &[],
    );
    refused("nowhere", &["nowhere: cannot be read"], &[]);
    refused(
        "cut",
        &["cut.mcap: /odom, message 3: it has not the fields of its type"],
        &[],
    );
    refused(
        "team",
        &[
            "team: no message of /odom, /robot/odom: expected",
            "--topic NAME=TOPIC",
            "/police_1/odom (nav_msgs/msg/Odometry)",
        ],
        &[],
    );
    refused(
        "field",
        &[
            "/scan: no message from 1700000000.000 s to 1700000000.100 s: expected one within 0.02 s",
        ],
        &["--max-age", "0.02"],
    );
    refused(
        "field",
        &["/map is nav_msgs/msg/OccupancyGrid in cdr: expected sensor_msgs/msg/LaserScan"],
        &["--topic", "robot/scan=/map"],
    );
    refused(
        "field",
        &["--topic odom=/x: expected NAME=TOPIC with NAME one of map, robot/odom, robot/scan"],
        &["--topic", "odom=/x"],
    );
    refused(
        "field",
        &[
            "the scenario does not fit its map, starts and scanners",
            "robot `robot` starts in a wall",
        ],
        &["--set", "robots.robot.radius=0.6"],
    );
    // One robot of the team, by its topic; the frame of its odometry is in the map, so that nothing is taken as the same.
    let named = import("team", "named.mcap")
        .args(["--topic", "robot/odom=/police_1/odom"])
        .json();
    let named = &named["import"];
    assert_eq!(
        (&named["topics"], &named["remarks"]),
        (
            &serde_json::json!({"robot/odom": ["/police_1/odom", 121]}),
            &serde_json::json!([])
        ),
        "{named}"
    );
}
