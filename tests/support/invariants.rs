//! Invariants of every log of a chase, for all seeds.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ipc_types::messages::world::WorldEvent;
use serde_json::Value as Json;

use super::geometry::{Obstacle, Walls, between};
use super::history::{Event, History, Message, Robot, State, scenario};

/// Slack of comparisons of lengths and speeds, far below anything that is driven.
const EPSILON: f64 = 1e-9;
/// Depth in a wall that counts as rounding (m).
const PENETRATION: f64 = 1e-6;

const POLICE: u8 = 1;
const EVADER: u8 = 2;
const ACTIVE: u8 = 0;
const CAUGHT: u8 = 1;
const ESCAPED: u8 = 2;
const TIMED_OUT: u8 = 3;

/// Names of statuses in summaries, by their code.
const STATUS: [&str; 6] = [
    "active",
    "caught",
    "escaped",
    "timed_out",
    "goal_reached",
    "disabled",
];

/// The game: the map as this test reads it, and from the scenario in the log the numbers that may
/// be tuned.
pub struct Game {
    pub period_ns: u64,
    pub walls: Walls,
    pub radius: f64,
    /// Largest speed of every robot (m/s).
    pub v_max: Vec<f64>,
    pub omega_max: f64,
    /// Centre-to-centre distance below which Police catch (m); 0 if they do not.
    pub capture: f64,
    pub exits: Vec<Exit>,
    pub time_limit_s: f64,
    /// `true` if a perception process tracks the evaders.
    pub perception: bool,
}

/// An exit: centre, and radius or half the sides (m).
pub enum Exit {
    Disc([f64; 2], f64),
    Rectangle([f64; 2], [f64; 2]),
}

impl Game {
    /// The game of a log that plays in the city.
    pub fn in_city(log: &Path) -> Self {
        // The gap, from the middle of the wall to the border of the map.
        let gap = Exit::Rectangle([9.0, 0.0], [0.5, 1.25]);
        Self::new(log, Walls::city(), vec![gap])
    }

    /// The game of a log of `chase_paper`.
    pub fn in_published_city(log: &Path) -> Self {
        Self::new(log, Walls::city(), vec![Exit::Disc([9.0, 0.0], 0.5)])
    }

    /// The game of a log that plays in the room of `hello.toml`.
    pub fn in_room(log: &Path) -> Self {
        Self::new(log, Walls::hello(), vec![Exit::Disc([3.5, 0.5], 0.2)])
    }

    fn new(log: &Path, walls: Walls, exits: Vec<Exit>) -> Self {
        let scenario = scenario(log);
        let number = |value: Option<&toml::Value>, or: f64| {
            value.map_or(or, |v| {
                v.as_float()
                    .unwrap_or_else(|| v.as_integer().unwrap() as f64)
            })
        };
        let robots = scenario["robots"].as_array().unwrap();
        for robot in robots {
            assert_eq!(robot["preset"].as_str(), Some("turtlebot3_burger"));
        }
        let rules = &scenario["rules"];
        let dt = number(scenario["run"].get("dt"), 0.0);
        Self {
            period_ns: (dt * 1e9).round() as u64,
            walls,
            radius: 0.105,
            v_max: robots
                .iter()
                .map(|r| number(r["limits"].get("v_max"), 0.22))
                .collect(),
            omega_max: 2.84,
            capture: number(rules.get("capture").and_then(|c| c.get("radius")), 0.0),
            exits,
            time_limit_s: number(rules.get("time_limit"), f64::INFINITY),
            perception: scenario["processes"]
                .as_array()
                .unwrap()
                .iter()
                .any(|p| p["kind"].as_str() == Some("perception")),
        }
    }

    fn dt(&self) -> f64 {
        self.period_ns as f64 * 1e-9
    }

    fn v_max_of(&self, robot: &Robot) -> f64 {
        self.v_max[robot.robot as usize]
    }

    fn in_exit(&self, p: [f64; 2]) -> bool {
        self.exits.iter().any(|exit| match *exit {
            Exit::Disc(center, radius) => between(center, p) <= radius + 1e-12,
            Exit::Rectangle(center, half) => {
                (0..2).all(|i| (p[i] - center[i]).abs() <= half[i] + 1e-12)
            }
        })
    }

    /// Everything below, on the log of a finished lock-step run and the summary it printed.
    #[track_caller]
    pub fn holds(&self, history: &History, summary: &Json) {
        self.every_message_is_there_once(history);
        self.every_tick_is_complete(history);
        self.no_robot_is_in_a_wall(history);
        self.no_robot_is_too_fast(history);
        self.the_rules_are_kept(history);
        the_summary_says_what_the_log_holds(history, summary);
    }

    /// Sequence numbers without gap or repetition by topic and source, monotone stamps, logged at
    /// their simulated time.
    #[track_caller]
    pub fn every_message_is_there_once(&self, history: &History) {
        let mut last: BTreeMap<(&str, u32), &Message> = BTreeMap::new();
        let mut log_time = 0;
        let end_ns = history.states.last().unwrap().tick * self.period_ns;
        for m in &history.messages {
            let before = last.insert((&m.topic, m.source), m);
            assert_eq!(
                m.sequence,
                before.map_or(0, |b| b.sequence + 1),
                "{m:?} after {before:?}"
            );
            assert_eq!(m.logged_sequence, m.sequence, "{m:?}");
            assert_eq!(m.time_ns, m.tick * self.period_ns, "{m:?}");
            // What was announced for a time after the end is logged at the end.
            let announced = m.topic == "world/obstacle_event";
            let logged = if announced {
                m.time_ns.min(end_ns)
            } else {
                m.time_ns
            };
            assert_eq!((m.log_time, m.publish_time), (logged, m.time_ns), "{m:?}");
            assert!(
                m.log_time >= log_time,
                "not in order of simulated time: {m:?}"
            );
            log_time = m.log_time;
            if let Some(b) = before {
                assert!(
                    b.tick <= m.tick && b.sent_ns <= m.sent_ns,
                    "{m:?} after {b:?}"
                );
            }
        }
    }

    /// One state per tick, one command per active robot and tick, one belief and one look per
    /// active evader and tick.
    #[track_caller]
    pub fn every_tick_is_complete(&self, history: &History) {
        let mut commands: BTreeMap<(u64, u32), Vec<u32>> = BTreeMap::new();
        for c in &history.commands {
            commands
                .entry((c.tick, c.robot))
                .or_default()
                .push(c.source);
        }
        let mut beliefs: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        for b in &history.beliefs {
            beliefs.entry(b.tick).or_default().push(b.robot);
        }
        let mut looks: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        for l in &history.sightings {
            looks.entry(l.tick).or_default().push(l.robot);
        }
        let mut driver: BTreeMap<u32, u32> = BTreeMap::new();
        let last = history.states.len() - 1;
        for (tick, state) in history.states.iter().enumerate() {
            assert_eq!(state.tick, tick as u64, "one state per tick");
            assert_eq!(state.over, tick == last, "tick {tick}");
            for (i, robot) in state.robots.iter().enumerate() {
                assert_eq!(robot.robot as usize, i, "tick {tick}");
                assert!(!robot.fail_safe, "tick {tick}: robot {i} without a command");
                let sources = commands
                    .remove(&(state.tick, robot.robot))
                    .unwrap_or_default();
                if tick == last {
                    assert_eq!(sources, [] as [u32; 0], "nothing follows the last state");
                } else if robot.status == ACTIVE {
                    assert_eq!(sources.len(), 1, "tick {tick}, robot {i}");
                }
                assert!(sources.len() <= 1, "tick {tick}, robot {i}: {sources:?}");
                for source in sources {
                    assert_eq!(*driver.entry(robot.robot).or_insert(source), source);
                }
            }
            let hunted: Vec<u32> = state
                .robots
                .iter()
                .filter(|r| {
                    self.perception && tick < last && r.team == EVADER && r.status == ACTIVE
                })
                .map(|r| r.robot)
                .collect();
            assert_eq!(
                beliefs.remove(&state.tick).unwrap_or_default(),
                hunted,
                "tick {tick}"
            );
            assert_eq!(
                looks.remove(&state.tick).unwrap_or_default(),
                hunted,
                "tick {tick}"
            );
        }
        assert!(commands.is_empty() && beliefs.is_empty() && looks.is_empty());
        for b in &history.beliefs {
            assert!(b.particles > 0 && (b.weight - 1.0).abs() < 1e-3, "{b:?}");
        }
    }

    /// Bodies keep out of the walls of the map, of the obstacles that stand, and of each other.
    #[track_caller]
    pub fn no_robot_is_in_a_wall(&self, history: &History) {
        for state in &history.states {
            let standing = standing_obstacles(history, state.tick);
            let present: Vec<&Robot> = state.robots.iter().filter(|r| r.present).collect();
            for (i, a) in present.iter().enumerate() {
                let p = [a.x, a.y];
                let clearance = standing
                    .values()
                    .map(|o| o.distance(p))
                    .fold(self.walls.clearance(p), f64::min);
                assert!(
                    clearance >= self.radius - PENETRATION,
                    "tick {}: {clearance} m from a wall: {a:?}",
                    state.tick
                );
                for b in &present[..i] {
                    assert!(
                        between(p, [b.x, b.y]) >= 2.0 * self.radius - PENETRATION,
                        "tick {}: {a:?} in {b:?}",
                        state.tick
                    );
                }
            }
        }
    }

    /// Speeds as reported, as commanded, and as driven from pose to pose.
    #[track_caller]
    pub fn no_robot_is_too_fast(&self, history: &History) {
        let within = |value: f64, most: f64| value.is_finite() && value.abs() <= most + EPSILON;
        let mut before: Option<&State> = None;
        for state in &history.states {
            for (i, r) in state.robots.iter().enumerate() {
                let tick = state.tick;
                assert!(within(r.v, self.v_max_of(r)), "tick {tick}: {r:?}");
                assert!(within(r.omega, self.omega_max), "tick {tick}: {r:?}");
                let Some(b) = before.map(|state| &state.robots[i]) else {
                    continue;
                };
                let driven = between([r.x, r.y], [b.x, b.y]) / self.dt();
                assert!(
                    within(driven, self.v_max_of(r)),
                    "tick {tick}: {driven} m/s: {r:?}"
                );
                let path = (r.distance - b.distance) / self.dt();
                assert!(
                    path >= 0.0 && within(path, self.v_max_of(r)),
                    "tick {tick}: {r:?}"
                );
                assert!(
                    driven <= path + EPSILON,
                    "tick {tick}: path {path}, {driven}: {r:?}"
                );
                let turn = (r.theta - b.theta).abs();
                let turned = turn.min(std::f64::consts::TAU - turn) / self.dt();
                assert!(
                    within(turned, self.omega_max),
                    "tick {tick}: {turned} rad/s: {r:?}"
                );
            }
            before = Some(state);
        }
        for c in &history.commands {
            assert!(
                within(c.v, self.v_max[c.robot as usize]) && within(c.omega, self.omega_max),
                "{c:?}"
            );
        }
    }

    /// Captures within the radius and only there, escapes in the exit and only there, the end when
    /// all is decided or the time is up.
    #[track_caller]
    pub fn the_rules_are_kept(&self, history: &History) {
        let decided: BTreeMap<(u64, u32), &Event> = history
            .events
            .iter()
            .filter(|e| ["captured", "escaped", "timed_out"].contains(&name(e)))
            .map(|e| ((e.tick, e.robot), e))
            .collect();
        let mut seen = BTreeSet::new();
        for (at, state) in history.states.iter().enumerate() {
            for (i, robot) in state.robots.iter().enumerate() {
                let p = [robot.x, robot.y];
                let old = at.checked_sub(1).map(|b| &history.states[b].robots[i]);
                let was = old.map_or(ACTIVE, |r| r.status);
                let nearest = state
                    .robots
                    .iter()
                    .filter(|r| r.team == POLICE)
                    .map(|r| (between(p, [r.x, r.y]), r.robot))
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                let reached = nearest.is_some_and(|(d, _)| d < self.capture);
                if robot.team == EVADER && robot.status == ACTIVE {
                    assert!(!reached, "tick {}: {robot:?} is not caught", state.tick);
                    assert!(
                        !self.in_exit(p),
                        "tick {}: {robot:?} is not gone",
                        state.tick
                    );
                }
                if robot.status == was {
                    if let Some(old) = old.filter(|_| was != ACTIVE) {
                        assert_eq!(
                            (old.x, old.y),
                            (robot.x, robot.y),
                            "who is out stands still"
                        );
                    }
                    continue;
                }
                assert_eq!(
                    (was, robot.team),
                    (ACTIVE, EVADER),
                    "tick {}: {robot:?}",
                    state.tick
                );
                let event = decided[&(state.tick, robot.robot)];
                seen.insert((state.tick, robot.robot));
                assert_eq!([event.x, event.y], p, "{event:?}");
                match robot.status {
                    CAUGHT => {
                        let (distance, by) = nearest.unwrap();
                        assert!(reached, "tick {}: caught from {distance} m", state.tick);
                        assert_eq!((name(event), event.other), ("captured", by));
                        assert!((event.value - distance).abs() < EPSILON, "{event:?}");
                    }
                    ESCAPED => {
                        assert!(self.in_exit(p), "tick {}: gone from {p:?}", state.tick);
                        assert_eq!((name(event), robot.present), ("escaped", false));
                    }
                    TIMED_OUT => {
                        assert_eq!(name(event), "timed_out");
                        assert_eq!(self.seconds(state.tick), self.time_limit_s);
                    }
                    other => panic!("tick {}: status {other}", state.tick),
                }
            }
        }
        assert_eq!(
            seen,
            decided.keys().copied().collect(),
            "events without their state"
        );
        let last = history.states.last().unwrap();
        let open = |r: &&Robot| r.team == EVADER && r.status == ACTIVE;
        assert_eq!(
            last.robots.iter().filter(open).count(),
            0,
            "over, but undecided"
        );
        let overs: Vec<_> = history
            .events
            .iter()
            .filter(|e| name(e) == "game_over")
            .collect();
        assert_eq!(
            overs.iter().map(|e| e.tick).collect::<Vec<_>>(),
            [last.tick]
        );
        assert!(self.seconds(last.tick) <= self.time_limit_s);
    }

    fn seconds(&self, tick: u64) -> f64 {
        (tick * self.period_ns) as f64 / 1e9
    }
}

fn name(event: &Event) -> &'static str {
    WorldEvent::name_of(event.kind)
}

/// The rectangles that events have put up, as of a tick.
pub fn standing_obstacles(history: &History, tick: u64) -> BTreeMap<u32, Obstacle> {
    let mut standing = BTreeMap::new();
    for change in history.obstacles.iter().filter(|c| c.tick <= tick) {
        if change.action == 1 {
            standing.remove(&change.id);
        } else {
            assert_eq!(change.shape, 1, "a rectangle");
            let rectangle = Obstacle::Rectangle {
                center: [change.x, change.y],
                half: [change.half_x, change.half_y],
                angle: change.theta,
            };
            standing.insert(change.id, rectangle);
        }
    }
    standing
}

/// `--json` against the log.
#[track_caller]
pub fn the_summary_says_what_the_log_holds(history: &History, summary: &Json) {
    let last = history.states.last().unwrap();
    assert_eq!(summary["ticks"], last.tick);
    let robots = summary["robots"].as_array().unwrap();
    assert_eq!(robots.len(), last.robots.len());
    for (told, robot) in robots.iter().zip(&last.robots) {
        assert_eq!(told["outcome"], STATUS[usize::from(robot.status)], "{told}");
        assert_eq!(told["distance_m"], robot.distance, "{told}");
    }
    let events = summary["events"].as_array().unwrap();
    let told: Vec<&str> = events.iter().map(|e| e["kind"].as_str().unwrap()).collect();
    let logged: Vec<&str> = history.events.iter().map(name).collect();
    assert_eq!(told, logged);
    let topics = summary["topics"].as_object().unwrap();
    let told: BTreeMap<String, (u64, u64)> = topics
        .iter()
        .map(|(topic, t)| {
            assert_eq!(t["gaps"], 0, "{topic}: {t}");
            assert_eq!(t.get("rejected"), None, "{topic}: {t}");
            let number = |key: &str| t[key].as_u64().unwrap();
            (topic.clone(), (number("messages"), number("bytes")))
        })
        .collect();
    assert_eq!(told, history.counts);
}
