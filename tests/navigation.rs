//! Robots that drive to goals on the optimiser's trajectories, from the command to the log.

mod client;
mod lanes;
mod popups;
mod service;
mod work;

use crate::support::Sandbox;
use crate::support::geometry::{Walls, between};
use crate::support::history::{History, State};
use serde_json::Value as Json;

/// A finished run: what it printed and what it logged.
fn record(sandbox: &Sandbox, words: &[&str]) -> (Json, History) {
    let words = std::iter::once("run").chain(words.iter().copied());
    let summary = sandbox.protean(words).arg("--quiet").json();
    let log = sandbox.path().join(summary["log"].as_str().unwrap());
    (summary, History::read(&log))
}

fn all_robots_arrived_without_contact(summary: &Json) {
    for robot in summary["robots"].as_array().unwrap() {
        assert_eq!(robot["outcome"], "goal_reached", "{summary}");
        assert_eq!(robot["contacts"], 0, "{summary}");
    }
}

/// Discs of the board: x, y, radius (m).
const KNOWN: [[f64; 3]; 3] = [[1.5, 0.9, 0.3], [2.3, 2.4, 0.35], [3.6, 1.9, 0.3]];
const POPPED_UP: [[f64; 3]; 2] = [[2.75, 1.6, 0.25], [3.6, 2.75, 0.2]];
/// Radius of the robot there (m).
const SCOUT: f64 = 0.09;

/// Distance of the robot's body from what stands on the board (m).
fn gap(state: &State, popped_up: bool) -> f64 {
    let robot = &state.robots[0];
    let edge = [robot.x, robot.y, 4.8 - robot.x, 3.6 - robot.y];
    let more = if popped_up { &POPPED_UP[..] } else { &[] };
    let discs = KNOWN.iter().chain(more);
    discs
        .map(|[x, y, radius]| between([robot.x, robot.y], [*x, *y]) - radius)
        .chain(edge)
        .fold(f64::INFINITY, f64::min)
        - SCOUT
}

#[test]
fn the_robot_crosses_the_board_by_every_method_and_either_way_of_meeting_popups() {
    let sandbox = Sandbox::new();
    for method in ["lp", "vmc", "bspline", "tangent"] {
        for at_popup in ["follow", "stop"] {
            let set_method = format!("processes.navigator.params.plan.method={method}");
            let set_popup = format!("processes.navigator.params.at_popup={at_popup}");
            let words = [
                "popup",
                "--set",
                &set_method,
                "--set",
                &set_popup,
                "--force",
            ];
            let (summary, history) = record(&sandbox, &words);
            all_robots_arrived_without_contact(&summary);
            let popped_up = history.obstacles.iter().map(|change| change.tick).max();
            let popped_up = popped_up.expect("obstacles pop up");
            assert_eq!(history.obstacles.len(), 2);
            for state in &history.states {
                let gap = gap(state, state.tick >= popped_up);
                assert!(gap > 0.0, "{method}: {gap} m at tick {}", state.tick);
            }
            // Whether it stood between the pop-up and the goal.
            let after = history
                .states
                .iter()
                .filter(|s| s.tick > popped_up && !s.over);
            let stood = after.clone().filter(|s| s.robots[0].v == 0.0).count();
            assert_eq!(
                stood > 0,
                at_popup == "stop",
                "{method} {at_popup}: {stood}"
            );
            // Two plans at least: one before and one after; the second leads around.
            assert!(history.of("robot/plan").count() > 100);
        }
    }
    sandbox.assert_nothing_left();
}

#[test]
fn the_city_is_crossed_by_all_at_once() {
    let sandbox = Sandbox::new();
    let (summary, history) = record(&sandbox, &["popup_city"]);
    all_robots_arrived_without_contact(&summary);
    let city = Walls::city();
    for state in &history.states {
        for robot in &state.robots {
            let gap = city.clearance([robot.x, robot.y]) - 0.105;
            assert!(gap > 0.0, "{gap} m at tick {}", state.tick);
        }
        for (i, a) in state.robots.iter().enumerate() {
            for b in &state.robots[..i] {
                let gap = between([a.x, a.y], [b.x, b.y]) - 0.21;
                assert!(gap > 0.0, "{gap} m between at tick {}", state.tick);
            }
        }
    }
    // Three obstacles came, one of them went.
    assert_eq!(history.obstacles.len(), 4);
    sandbox.assert_nothing_left();
}

#[test]
fn plans_follow_from_the_scenario_alone_however_many_threads_make_them() {
    let sandbox = Sandbox::new();
    let digest = |words: &[&str]| {
        let mut all = vec!["popup_city", "--force", "--set", "rules.time_limit=20"];
        all.extend_from_slice(words);
        let (summary, _) = record(&sandbox, &all);
        summary["digest"].as_str().unwrap().to_owned()
    };
    let reference = digest(&[]);
    assert_eq!(digest(&[]), reference);
    assert_eq!(
        digest(&["--set", "processes.optimiser.params.workers=1"]),
        reference
    );
    assert_eq!(digest(&["--set", "run.pin=one_core"]), reference);
    let other = digest(&["--set", "processes.navigator.params.planning_time_s=0.2"]);
    assert_ne!(other, reference, "planning takes simulated time");
    sandbox.assert_nothing_left();
}

#[test]
fn robots_that_meet_head_on_pass_each_other() {
    let sandbox = Sandbox::new();
    sandbox.file(
        "street.toml",
        r#"
[world.map.vector]
bounds = { min = [0.0, 0.0], max = [6.0, 1.2] }
[rules]
time_limit = 120.0
[[robots]]
name = "east"
team = "neutral"
start = { x = 0.5, y = 0.6, theta = 0.0 }
goal = { circle = { center = [5.5, 0.6], radius = 0.05 } }
[[robots]]
name = "west"
team = "neutral"
start = { x = 5.5, y = 0.6, theta = 3.14159 }
goal = { circle = { center = [0.5, 0.6], radius = 0.05 } }
[[processes]]
kind = "optimiser"
[[processes]]
kind = "navigator"
team = "neutral"
"#,
    );
    for limits in ["{}", "{ acceleration = 0.3, angular_acceleration = 3.0 }"] {
        let set = format!("defaults.robot.limits={limits}");
        let (summary, _) = record(&sandbox, &["street.toml", "--force", "--set", &set]);
        all_robots_arrived_without_contact(&summary);
    }
    sandbox.assert_nothing_left();
}

#[test]
fn in_real_time_plans_take_effect_when_they_are_there() {
    let sandbox = Sandbox::new();
    let (summary, _) = record(&sandbox, &["popup", "--real-time", "4"]);
    all_robots_arrived_without_contact(&summary);
    sandbox.assert_nothing_left();
}

#[test]
fn a_navigator_without_optimiser_or_goal_is_refused_before_anything_starts() {
    let sandbox = Sandbox::new();
    let text = |goal: &str, kind: &str| {
        format!(
            r#"
[world]
map = "builtin:hello"
[[robots]]
name = "scout"
team = "neutral"
start = {{ x = 0.5, y = 0.5, theta = 0.0 }}
{goal}
[[processes]]
kind = "navigator"
robots = ["scout"]
{kind}
"#
        )
    };
    let optimiser = "[[processes]]\nkind = \"optimiser\"";
    let goal = "goal = { circle = { center = [3.5, 0.5], radius = 0.2 } }";
    for (name, text, words) in [
        ("no_optimiser.toml", text(goal, ""), "kind = \"optimiser\""),
        ("no_goal.toml", text("", optimiser), "no goal"),
        (
            "two.toml",
            text(goal, &format!("{optimiser}\n{optimiser}\nname = \"b\"")),
            "two processes write answers of optimiser/plan",
        ),
    ] {
        sandbox.file(name, &text);
        let outcome = sandbox.protean(["check", name]).run();
        assert_eq!(outcome.code, Some(2), "{outcome}");
        assert!(outcome.stderr.contains(words), "{outcome}");
    }
    sandbox.file("good.toml", text(goal, optimiser));
    assert_eq!(sandbox.protean(["check", "good.toml"]).run().code, Some(0));
}
