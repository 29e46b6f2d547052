//! Texts and single numbers of the page.

use draw::palette;
use geometry::map::ObstacleChange;
use geometry::region::Region;
use geometry::shape::Shape;
use ipc_types::event_names::EventNames;
use ipc_types::messages::observer::Prediction;
use ipc_types::messages::robot::WaypointEnd;
use ipc_types::messages::world::WorldEvent;
use mcap_log::Origin;
use mcap_log::output::RUN_DIGEST;
use serde_json::{Value as Json, json};
use statistics::Percentiles;

use super::content::PageContent;
use super::timing::PER_DECADE;
use crate::picture::trace::pursuers;
use crate::run_model::TaskTrace;
use crate::run_model::corners;
use recorder::{CoverageOutcome, MessageCounts, RobotOutcome, outcome_words, status_name};
use robot::team::Role;

/// Outcomes of the robots: from the result of the run, else from the last state in the log.
pub fn outcome(content: &PageContent) -> Vec<RobotOutcome> {
    let recorded = content.facts.origin.result.get("robots");
    if let Some(robots) = recorded.and_then(|text| serde_json::from_str(text).ok()) {
        return robots;
    }
    let Some(last) = content.frames.last() else {
        return Vec::new();
    };
    let states = last.item.robots.iter();
    states
        .map(|state| {
            // Time since which the robot has had its last status.
            let robot = state.robot;
            let same = content.frames.iter().rev().take_while(|frame| {
                let then = frame.item.robots.iter().find(|s| s.robot == robot);
                then.is_some_and(|s| s.status == state.status)
            });
            let since = same.last().map_or(last.time_ns, |frame| frame.time_ns);
            let time_ns = if state.status == 0 {
                last.time_ns
            } else {
                since
            };
            let spec = content.scenario.robots.get(robot as usize);
            RobotOutcome {
                name: content.name(robot),
                team: spec.map(|spec| spec.team.clone()).unwrap_or_default(),
                role: recorder::role_name(state.team).to_owned(),
                outcome: status_name(state.status).to_owned(),
                time_s: time_ns as f64 / 1e9,
                distance_m: state.distance,
                contacts: state.contacts,
                fail_safe_stops: 0,
                fail_safe_ticks: 0,
                standstills: 0,
                escape_possible_fraction: None,
                escape_impossible_from_s: None,
                waypoints: None,
            }
        })
        .collect()
}

/// The parts of the run or of the log that are missing, a sentence each.
pub fn missing(content: &PageContent) -> Vec<String> {
    let mut missing = Vec::new();
    let count = |topic: &str| content.counts.get(topic).copied().unwrap_or(0);
    if !content.condition.is_whole() {
        missing.extend(content.condition.lines());
    }
    if content.facts.is_recovered {
        missing.push("the log was recovered from a damaged one".to_owned());
    }
    if count("world/state") == 0 {
        missing.push("no world/state: robots are shown at their start poses".to_owned());
    } else if !content.over {
        missing
            .push("the log ends before the run: outcomes are those of its last state".to_owned());
    }
    if !content.facts.origin.result.contains_key("robots") {
        missing.push(
            "no result of the run: the run was killed, or its end is not in the log".to_owned(),
        );
    }
    for topic in ["world/event", "world/map"] {
        if !content.counts.contains_key(topic) {
            missing.push(format!("no {topic}"));
        }
    }
    let event_lists = &content.event_lists;
    for (omitted, what) in [
        (event_lists.events_omitted, "events"),
        (event_lists.waypoints_omitted, "waypoints"),
    ] {
        if omitted > 0 {
            missing.push(format!(
                "{omitted} {what} omitted: the page has a maximum number"
            ));
        }
    }
    missing.extend(content.notes.iter().cloned());
    missing
}

fn shape(shape: &Shape) -> Json {
    match shape {
        Shape::Circle { center, radius } => json!({ "circle": [center[0], center[1], radius] }),
        other => json!({ "corners": corners(other) }),
    }
}

fn region(region: &Region) -> Json {
    match *region {
        Region::Circle { center, radius } => json!({ "circle": [center[0], center[1], radius] }),
        Region::Rectangle {
            center,
            half_extents,
            angle,
        } => shape(&Shape::Rectangle {
            center,
            half_extents,
            angle,
        }),
    }
}

fn with(mut object: Json, key: &str, value: Json) -> Json {
    if let Some(map) = object.as_object_mut() {
        map.insert(key.to_owned(), value);
    }
    object
}

fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

/// The static scene and its changes.
fn static_scene(content: &PageContent) -> Json {
    let static_scene = &content.static_scene;
    let obstacles: Vec<Json> = static_scene
        .obstacles
        .iter()
        .map(|(id, standing)| with(shape(&standing.shape), "id", json!(id)))
        .collect();
    let changes: Vec<Json> = content
        .changes
        .iter()
        .map(|(time_ns, change)| {
            let object = match change {
                ObstacleChange::Appear { shape: s, .. } | ObstacleChange::Move { shape: s, .. } => {
                    shape(s)
                }
                ObstacleChange::Disappear { .. } => json!({}),
            };
            with(
                with(object, "id", json!(change.id().0)),
                "time",
                json!(seconds(*time_ns)),
            )
        })
        .collect();
    json!({
        "min": static_scene.min,
        "max": static_scene.max,
        "exits": static_scene.exits.iter().map(region).collect::<Vec<_>>(),
        "obstacles": obstacles,
        "changes": changes,
    })
}

/// Geometry of the robots' tasks.
fn task(task: &TaskTrace) -> Json {
    json!({
        "goals": task.goals.iter().map(region).collect::<Vec<_>>(),
        "contours": task.contours,
        "danger_zones": task.danger_zones.iter().map(shape).collect::<Vec<_>>(),
        "rectangles": task.rectangles,
    })
}

/// Names of robots and obstacles. Without a description of the run in the log, obstacles have none.
fn names(content: &PageContent) -> EventNames {
    let robots = content.scenario.robots.iter();
    let run = content.facts.run.as_ref();
    EventNames {
        robots: robots.map(|robot| robot.name.clone()).collect(),
        obstacles: run.map_or_else(Default::default, |run| run.obstacles.clone()),
    }
}

fn events(content: &PageContent, names: &EventNames) -> Json {
    let name = |robot: u32| (robot != WorldEvent::NONE).then_some(robot);
    content
        .event_lists
        .events
        .iter()
        .map(|(time_ns, e)| {
            json!([
                seconds(*time_ns),
                e.kind,
                name(e.robot),
                name(e.other),
                e.x,
                e.y,
                e.value,
                names.words(e)
            ])
        })
        .collect()
}

/// Latencies; without a list of processes in the log, the percentiles that the log stores.
fn latency(content: &mut PageContent) -> Json {
    let measured = content.timing.finish();
    if !measured.is_empty() {
        return measured
            .into_iter()
            .map(|(name, (percentiles, histogram))| {
                json!({ "name": name, "us": percentiles, "histogram": histogram })
            })
            .collect();
    }
    let recorded = content.facts.origin.result.get("latency_us");
    let recorded: Option<std::collections::BTreeMap<String, Percentiles>> =
        recorded.and_then(|text| serde_json::from_str(text).ok());
    recorded
        .unwrap_or_default()
        .into_iter()
        .map(|(name, percentiles)| json!({ "name": name, "us": percentiles }))
        .collect()
}

/// All content of the page except lists and plots.
pub fn facts(content: &mut PageContent) -> Json {
    let latency = latency(content);
    let described = content.facts.run.as_ref();
    let tasks = described.map_or(&[][..], |run| &run.tasks);
    let fields_of_view = described.map_or(&[][..], |run| &run.fields_of_view);
    let manifest = |key: &str| content.facts.origin.manifest.get(key).cloned();
    let result = |key: &str| content.facts.origin.result.get(key).cloned();
    let parsed = |key: &str| -> Option<Json> {
        let text = content.facts.origin.result.get(key)?;
        serde_json::from_str(text).ok()
    };
    let robots: Vec<Json> = content
        .scenario
        .robots
        .iter()
        .enumerate()
        .map(|(index, r)| {
            let sweeps = content.scenario.sweeps(index, tasks);
            json!({
                "name": r.name, "team": r.team, "role": r.role(),
                "radius": r.model().radius, "sweeps": sweeps,
            })
        })
        .collect();
    let specs = content.scenario.robots.iter();
    let named = specs.map(|spec| (spec.team.as_str(), spec.role()));
    let pursuers = pursuers(named);
    let robots_outcome = outcome(content);
    let coverage = content.facts.origin.result.get("coverage");
    let coverage: Option<CoverageOutcome> =
        coverage.and_then(|text| serde_json::from_str(text).ok());
    let bounds = palette::idleness_bounds(seconds(content.end_ns)).map(Some);
    let idleness: Vec<Option<f64>> = bounds.into_iter().chain([None]).collect();
    let scenario_text = content.facts.origin.scenario.as_deref();
    let scenario_text = scenario_text.map(String::from_utf8_lossy);
    json!({
        "title": content.scenario.title,
        "description": content.scenario.description,
        "scenario": manifest("scenario"),
        "seed": manifest("seed"),
        "mode": manifest("mode"),
        "branches": manifest(Origin::BRANCHES)
            .and_then(|text| serde_json::from_str::<Json>(&text).ok()),
        "version": manifest("version"),
        "machine": manifest("machine"),
        "digest": result("digest").filter(|_| content.over && content.condition.data),
        "run_digest": result(RUN_DIGEST),
        "over": content.over,
        "end_s": seconds(content.end_ns),
        "tick_period_s": seconds(content.tick_period_ns),
        "robots": robots,
        "pursuers": pursuers,
        "eyes": fields_of_view,
        "capture_m": content.scenario.rules.capture.map(|capture| capture.radius),
        "task": task(&content.scenario.task(tasks)),
        "result": outcome_words(&robots_outcome, coverage.as_ref()),
        "outcome": robots_outcome,
        "idleness": idleness,
        "patrols": content.patrols.iter().map(|p| p.places().of_each().count()).collect::<Vec<_>>(),
        "marks": content.marks.names(),
        "dominance": content.layers.regions.grid(),
        "coverage": coverage,
        "predictions": parsed("predictions"),
        "attacks": parsed("attacks"),
        "missing": missing(content),
        "messages": MessageCounts::from_topics(&content.counts, |messages| *messages).to_string(),
        "ground": static_scene(content),
        "events": events(content, &names(content)),
        "event_kinds": WorldEvent::NAMES,
        "methods": Prediction::METHODS,
        "horizons_s": content.layers.horizons_s,
        "waypoint_outcomes": WaypointEnd::OUTCOMES,
        "latency": latency,
        "per_decade": PER_DECADE,
        "text": scenario_text,
    })
}

/// The colours of `protean picture`, as variables of a style sheet.
pub fn colours() -> String {
    let mut all = [
        ("paper", palette::PAPER),
        ("wall", palette::WALL),
        ("edge", palette::EDGE),
        ("ink", palette::INK),
        ("faint", palette::FAINT_INK),
        ("obstacle", palette::OBSTACLE),
        ("exit", palette::EXIT),
        ("belief", palette::BELIEF),
        ("belief-ink", palette::BELIEF_INK),
    ]
    .map(|(name, colour)| format!("--{name}:{colour};"))
    .concat();
    let numbered = [
        ("pursuer", palette::shades(Role::Pursuer)),
        ("evader", palette::shades(Role::Evader)),
        ("neutral", palette::shades(Role::Neutral)),
        ("idleness", palette::IDLENESS),
    ];
    for (name, colours) in numbered {
        for (i, colour) in colours.iter().enumerate() {
            all += &format!("--{name}-{i}:{colour};");
        }
    }
    all
}
