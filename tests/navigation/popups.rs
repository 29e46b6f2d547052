//! Random pop-ups before robots with and without inertia: no robot touches an obstacle for which it could
//! have stopped.

use std::path::Path;

use crate::support::geometry::between;
use crate::support::history::History;
use mission::in_process::{InProcessOptions, run};
use proptest::prelude::*;

/// Radius of the robot (m), and its speed (m/s).
const RADIUS: f64 = 0.105;
const SPEED: f64 = 0.4;

#[derive(Debug, Clone)]
struct Popup {
    /// Way that the robot has made when it comes (m).
    travelled: f64,
    /// Centre (m) and radius (m).
    at: [f64; 2],
    radius: f64,
}

fn popup() -> impl Strategy<Value = Popup> {
    (0.05..3.5f64, 0.6..3.4f64, 0.4..2.6f64, 0.05..0.4f64).prop_map(|(travelled, x, y, radius)| {
        Popup {
            travelled,
            at: [x, y],
            radius,
        }
    })
}

fn scenario_text(popups: &[Popup], limits: &str, params: &str) -> String {
    let events = popups.iter().enumerate().map(|(i, popup)| {
        let Popup {
            travelled,
            at,
            radius,
        } = popup;
        format!(
            r#"
[[events]]
when = {{ robot = "scout", travelled = {travelled} }}
action = "appear"
obstacle = "popup_{i}"
shape.circle = {{ center = {at:?}, radius = {radius} }}
"#
        )
    });
    let head = format!(
        r#"
[world.map.vector]
bounds = {{ min = [0.0, 0.0], max = [4.0, 3.0] }}
[[world.map.vector.obstacles]]
shape.rectangle = {{ center = [2.0, 1.2], half_extents = [0.3, 0.2], angle = 0.4 }}
[rules]
time_limit = 25.0
[[robots]]
name = "scout"
team = "neutral"
start = {{ x = 0.4, y = 0.4, theta = 0.5 }}
limits = {{ v_max = {SPEED}{limits} }}
goal = {{ circle = {{ center = [3.6, 2.6], radius = 0.05 }} }}
[[processes]]
kind = "optimiser"
[[processes]]
kind = "navigator"
robots = ["scout"]
params = {{ {params} }}
"#
    );
    events.fold(head, |text, event| text + &event)
}

/// Code of the event that a robot stood where an obstacle came.
const PUSHED: u32 = 10;

/// Returns `true` if the robot could stop before every obstacle that appeared.
fn could_stop(history: &History, popups: &[Popup], acceleration: f64) -> bool {
    if history.events.iter().any(|event| event.kind == PUSHED) {
        return false;
    }
    history.obstacles.iter().all(|change| {
        let state = history.states.iter().find(|s| s.tick == change.tick);
        let robot = &state.expect("a state at every tick").robots[0];
        let popup = popups
            .iter()
            .find(|p| p.at == [change.x, change.y])
            .expect("one of these");
        let gap = between([robot.x, robot.y], popup.at) - popup.radius - RADIUS;
        gap > robot.v * robot.v / (2.0 * acceleration)
    })
}

fn fly(directory: &Path, text: &str) -> (History, u32, String) {
    let file = directory.join("popups.toml");
    std::fs::write(&file, text).unwrap();
    let scenario = kinds::load(file.to_str().unwrap(), &[], None)
        .unwrap_or_else(|problems| panic!("{problems}\n{text}"));
    let log = directory.join("popups.mcap");
    let options = InProcessOptions {
        out: Some(log.clone()),
        force: true,
        ..InProcessOptions::default()
    };
    let report = run(&scenario, &options).unwrap();
    let robot = &report.summary.robots[0];
    (History::read(&log), robot.contacts, robot.outcome.clone())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 40,
        max_shrink_iters: 60,
        ..ProptestConfig::default()
    })]

    #[test]
    fn nothing_is_touched_that_could_have_been_stopped_before(
        popups in proptest::collection::vec(popup(), 1..5),
        acceleration in proptest::option::of(0.1..2.0f64),
        stop in any::<bool>(),
        planning_time in prop_oneof![Just(0.05), Just(0.2), Just(0.5)],
        method in prop_oneof![Just("bspline"), Just("lp"), Just("tangent")],
    ) {
        let limits = acceleration.map_or_else(String::new, |a| {
            format!(", acceleration = {a}, angular_acceleration = {}", 10.0 * a)
        });
        let at_popup = if stop { "stop" } else { "follow" };
        let params = format!(
            r#"at_popup = "{at_popup}", planning_time_s = {planning_time}, plan = {{ method = "{method}" }}"#
        );
        let directory = tempfile::tempdir().unwrap();
        let text = scenario_text(&popups, &limits, &params);
        let (history, contacts, _) = fly(directory.path(), &text);
        if could_stop(&history, &popups, acceleration.unwrap_or(f64::INFINITY)) {
            prop_assert_eq!(contacts, 0, "{}", text);
        }
    }
}

/// An obstacle comes where the robot is, and pushes it out to where it touches.
#[test]
fn a_robot_that_is_pushed_out_leaves_the_obstacle_at_once() {
    let directory = tempfile::tempdir().unwrap();
    for (dx, dy, radius) in [
        (0.0, 0.12, 0.1),
        (0.1, -0.1, 0.2),
        (-0.15, 0.02, 0.15),
        (0.2, 0.02, 0.25),
        (0.02, 0.3, 0.4),
    ] {
        for limits in ["", ", acceleration = 0.5, angular_acceleration = 6.0"] {
            let text = scenario_text(&[], limits, "");
            // It has driven about 0.8 m towards its goal.
            let at = [1.06 + dx, 0.86 + dy];
            let text = format!(
                "{text}\n[[events]]\nwhen = {{ robot = \"scout\", travelled = 0.8 }}\naction = \"appear\"\n\
                 obstacle = \"popup\"\nshape.circle = {{ center = {at:?}, radius = {radius} }}\n"
            );
            let (history, contacts, outcome) = fly(directory.path(), &text);
            let pushed = history.events.iter().filter(|e| e.kind == PUSHED);
            assert_eq!(pushed.count(), 1, "{text}");
            assert!(contacts <= 1, "{contacts} contacts: {text}");
            assert_eq!(outcome, "goal_reached", "{text}");
        }
    }
}

/// Without pop-ups on the goal there is a way around, and it is taken.
#[test]
fn the_goal_is_reached_around_what_pops_up() {
    let directory = tempfile::tempdir().unwrap();
    let popups = [
        Popup {
            travelled: 0.6,
            at: [1.4, 1.6],
            radius: 0.3,
        },
        Popup {
            travelled: 1.4,
            at: [2.9, 2.0],
            radius: 0.25,
        },
    ];
    for limits in ["", ", acceleration = 0.5, angular_acceleration = 6.0"] {
        for at_popup in ["follow", "stop"] {
            let params = format!("at_popup = \"{at_popup}\"");
            let text = scenario_text(&popups, limits, &params);
            let (history, contacts, outcome) = fly(directory.path(), &text);
            let found = (contacts, outcome.as_str(), history.obstacles.len());
            assert_eq!(found, (0, "goal_reached", 2), "{limits} {at_popup}");
        }
    }
}
