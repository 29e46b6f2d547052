//! Drives between waypoints, from the log alone: poses of `world/state` and waypoint ends of
//! `robot/waypoint`.

use std::path::{Path, PathBuf};

use ipc_types::messages::robot::WaypointEnd;
use serde_json::Value as Json;

use super::Sandbox;
use super::geometry::{Walls, between, to_segment};
use super::history::{History, Visit, scenario};
use super::invariants::{standing_obstacles, the_summary_says_what_the_log_holds};

/// Slack for the arithmetic of lengths (m) and times (s).
pub const EPSILON: f64 = 1e-9;

/// Deviation of a robot from its arcs where it cannot turn fast enough (m).
const STRAYING: f64 = 0.1;

/// A finished run with one robot.
pub struct Drive {
    pub history: History,
    pub summary: Json,
    pub walls: Walls,
    /// Radius of the robot (m).
    pub radius: f64,
    /// Length of a tick (s).
    pub dt: f64,
    /// The scenario as it stands in the log.
    pub scenario: toml::Table,
}

impl Drive {
    /// Runs a scenario with these changes and reads its log.
    #[track_caller]
    pub fn run(sandbox: &Sandbox, scenario: &str, set: &[&str]) -> Self {
        let words = ["run", scenario, "--quiet", "--out", "drive.mcap", "--force"];
        let call = sandbox.protean(words);
        let call = set.iter().fold(call, |call, change| call.set(change));
        let summary = call.json();
        let log: PathBuf = sandbox.path().join("drive.mcap");
        Self::read(&log, summary)
    }

    #[track_caller]
    fn read(log: &Path, summary: Json) -> Self {
        let scenario = scenario(log);
        let robots = scenario["robots"].as_array().unwrap();
        assert_eq!(robots.len(), 1, "one robot");
        let drive = Self {
            history: History::read(log),
            walls: Walls::of_scenario(&scenario),
            radius: robots[0]["radius"].as_float().unwrap(),
            dt: scenario["run"]["dt"].as_float().unwrap(),
            summary,
            scenario,
        };
        the_summary_says_what_the_log_holds(&drive.history, &drive.summary);
        drive.touches_nothing();
        drive.waypoints_ended_as_the_poses_say();
        drive
    }

    /// The parameters of a process, everything filled in.
    pub fn params(&self, process: &str) -> &toml::Value {
        let all = self.scenario["processes"].as_array().unwrap();
        let named = all.iter().find(|p| p["name"].as_str() == Some(process));
        &named.unwrap()["params"]
    }

    /// Position of the robot at every tick (m).
    pub fn track(&self) -> Vec<[f64; 2]> {
        let states = &self.history.states;
        states
            .iter()
            .map(|s| [s.robots[0].x, s.robots[0].y])
            .collect()
    }

    pub fn tick(&self, time_s: f64) -> usize {
        (time_s / self.dt).round() as usize
    }

    /// The robot's waypoints in the summary.
    pub fn told(&self) -> &Json {
        &self.summary["robots"][0]["waypoints"]
    }

    /// Number of waypoints with this outcome.
    pub fn count(&self, outcome: &str) -> usize {
        let all = self.history.waypoints.iter();
        all.filter(|end| end.outcome == outcome).count()
    }

    /// Distance at which a waypoint counts as reached (m), as the scenario states it, and whether
    /// arcs pass by waypoints: then it is how far they may miss one, and the robot may stray.
    fn tolerance(&self) -> (f64, bool) {
        let processes = self.scenario["processes"].as_array().unwrap();
        let params = processes.iter().find_map(|p| {
            p.get("robots")?;
            p.get("params")
        });
        let params = params.unwrap();
        let follow = params.get("follow").unwrap_or(params);
        let is_arc = follow.get("interpolation").and_then(toml::Value::as_str) == Some("arc");
        if is_arc {
            return (STRAYING + follow["max_miss"].as_float().unwrap(), true);
        }
        (
            follow["driver"]["go_to"]["arrived"].as_float().unwrap(),
            false,
        )
    }

    /// No contact by the log's events, and none by the poses either.
    #[track_caller]
    fn touches_nothing(&self) {
        let robot = &self.summary["robots"][0];
        assert_eq!(robot["contacts"], 0, "{robot}");
        assert_eq!(robot["fail_safe_stops"], 0, "{robot}");
        for state in &self.history.states {
            let at = &state.robots[0];
            let p = [at.x, at.y];
            let clearance = standing_obstacles(&self.history, state.tick)
                .values()
                .map(|o| o.distance(p))
                .fold(self.walls.clearance(p), f64::min);
            assert!(
                clearance > self.radius,
                "tick {}: {clearance} m from a wall: {at:?}",
                state.tick
            );
        }
    }

    /// Numbers rise; a waypoint counts as reached exactly if the robot came within the tolerance
    /// while it was on the way there; and the summary counts the outcomes alike.
    #[track_caller]
    fn waypoints_ended_as_the_poses_say(&self) {
        let track = self.track();
        let (tolerance, is_arc) = self.tolerance();
        let mut before: Option<&Visit> = None;
        for end in &self.history.waypoints {
            if let Some(b) = before.replace(end) {
                assert!(
                    b.number < end.number && b.ended_s <= end.ended_s,
                    "{b:?} {end:?}"
                );
            }
            assert_eq!(end.tick as usize, self.tick(end.ended_s), "{end:?}");
            let place = [end.x, end.y];
            let ticks = self.tick(end.started_s)..=self.tick(end.ended_s);
            let poses = &track[ticks];
            let nearest = poses
                .windows(2)
                .map(|pair| to_segment(place, pair[0], pair[1]))
                .fold(between(place, poses[0]), f64::min);
            let reached = end.outcome == "reached";
            let near = nearest <= tolerance + EPSILON;
            assert!(
                if is_arc {
                    near || !reached
                } else {
                    near == reached
                },
                "{nearest} m of {tolerance} m: {end:?}"
            );
            assert!(
                end.outcome == "inside_obstacle" || (end.closest - nearest).abs() <= 1e-6,
                "{nearest} m: {end:?}"
            );
            if self.walls.clearance(place) < self.radius - tolerance {
                assert!(!reached, "inside an obstacle: {end:?}");
            }
        }
        for outcome in WaypointEnd::OUTCOMES {
            assert_eq!(
                self.told()[outcome],
                self.count(outcome),
                "{outcome}: {}",
                self.told()
            );
        }
    }

    /// Times of the laps that were completed (s): from the last waypoint of the route of one to that
    /// of the next.
    pub fn lap_times(&self) -> Vec<f64> {
        let route = |end: &&Visit| end.kind == "route";
        let ends: Vec<&Visit> = self.history.waypoints.iter().filter(route).collect();
        let Some(first) = ends.first() else {
            return Vec::new();
        };
        let closes = |end: &&&Visit| (end.x, end.y) == (first.x, first.y);
        let times: Vec<f64> = ends.iter().filter(closes).map(|end| end.ended_s).collect();
        times.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }
}
