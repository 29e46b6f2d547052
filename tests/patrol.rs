//! Patrols with real processes: their guarantees, checked on their logs alone.

use crate::support::Sandbox;
use crate::support::geometry::{between, to_segment};
use crate::support::history::{History, Visit};
use crate::support::ways::{Drive, EPSILON};
use plan::routes::patrol::Patrol;
use serde_json::Value as Json;

/// The octagon's corners (m).
pub const OCTAGON: [[f64; 2]; 8] = [
    [5.0, 0.0],
    [0.0, 5.0],
    [0.0, 10.0],
    [5.0, 15.0],
    [10.0, 15.0],
    [15.0, 10.0],
    [15.0, 5.0],
    [10.0, 0.0],
];

/// Distance from a point to the octagon's contour (m).
pub fn off_contour(p: [f64; 2]) -> f64 {
    let sides = (0..8).map(|i| to_segment(p, OCTAGON[i], OCTAGON[(i + 1) % 8]));
    sides.fold(f64::INFINITY, f64::min)
}

/// The octagon's patrol as an ally computes it, with a seed, and with a key if it has one.
#[track_caller]
fn ally(seed: Option<u64>, key: Option<&str>) -> Patrol {
    let scenario = kinds::load("patrol_octagon", &[], seed).unwrap();
    Patrol::from_scenario(&scenario, None, key.map(|key| key.parse().unwrap())).unwrap()
}

/// Returns `true` if a waypoint of the log equals the predicted one bit for bit.
fn is_predicted(end: &Visit, waypoint: &Json) -> bool {
    let same = |key: &str, value: f64| waypoint[key].as_f64().unwrap().to_bits() == value.to_bits();
    waypoint["number"] == end.number
        && waypoint["lap"] == end.lap
        && waypoint["kind"] == end.kind
        && same("x", end.x)
        && same("y", end.y)
}

#[test]
fn an_ally_with_the_key_predicts_the_octagon_and_no_other_key_does() {
    let sandbox = Sandbox::new();
    let drive = Drive::run(&sandbox, "patrol_octagon", &["rules.time_limit=250"]);
    let ends = &drive.history.waypoints;

    // All laps in time, at the width that the robot chose; nothing left out.
    let laps = drive.lap_times();
    assert_eq!(laps.len(), 2, "{laps:?}");
    assert!(laps.iter().all(|&time| time <= 120.0), "{laps:?}");
    let longest = laps.iter().copied().fold(0.0, f64::max);
    assert_eq!(drive.told()["laps"], laps.len());
    let told = drive.told()["longest_lap_s"].as_f64().unwrap();
    assert!((told - longest).abs() < EPSILON, "{told} {longest}");
    assert_eq!(drive.count("reached"), ends.len());

    // Nothing but the key is needed beside the scenario: not the seed that made it.
    let key = ally(None, None).key().to_string();
    let with_key = ally(Some(77), Some(&key));
    let predicted = with_key.plan_json(3).unwrap();
    let waypoints = predicted["waypoints"].as_array().unwrap();
    assert!(ends.len() > 240 && waypoints.len() > ends.len());
    for (end, waypoint) in ends.iter().zip(waypoints) {
        assert!(is_predicted(end, waypoint), "{end:?} {waypoint}");
    }
    let numbers: Vec<u64> = ends.iter().step_by(50).map(|end| end.number).collect();
    let one_by_one = with_key.prediction_json(&[], &numbers).unwrap();
    let one_by_one = one_by_one["waypoints"].as_array().unwrap();
    assert_eq!(one_by_one.len(), numbers.len());
    for (end, waypoint) in ends.iter().step_by(50).zip(one_by_one) {
        assert!(is_predicted(end, waypoint), "{end:?} {waypoint}");
    }

    // Without it, only the contour itself is known.
    let without_key = ally(Some(77), None).plan_json(3).unwrap();
    let guesses = without_key["waypoints"].as_array().unwrap();
    let (mut hits, mut inserted) = (0, 0);
    for (end, guess) in ends.iter().zip(guesses) {
        if end.kind == "route" {
            continue;
        }
        assert!(!is_predicted(end, guess), "{end:?} {guess}");
        let at = ["x", "y"].map(|axis| guess[axis].as_f64().unwrap());
        inserted += 1;
        hits += u32::from(between(at, [end.x, end.y]) < 0.05);
    }
    assert!(
        inserted > 200 && 20 * hits < inserted,
        "{hits} of {inserted}"
    );

    // The width of the plan is as far as the robot strays, and no farther but for its turns.
    let alpha = predicted["alpha"].as_f64().unwrap();
    let farthest = drive
        .track()
        .into_iter()
        .map(off_contour)
        .fold(0.0, f64::max);
    assert!(
        farthest > 0.4 * alpha && farthest < alpha + 0.3,
        "{farthest} {alpha}"
    );
}

#[test]
fn outside_the_danger_zones_a_patrol_keeps_to_its_contour() {
    const CENTER: [f64; 2] = [0.0, 7.5];
    const RADIUS: f64 = 2.0;
    let sandbox = Sandbox::new();
    let zone = "processes.patrol.params.mission.danger_zones=[{ circle = { center = [0.0, 7.5], radius = 2.0 } }]";
    let width = "processes.patrol.params.mission.alpha=1.0";
    let set = ["rules.time_limit=130", zone, width];
    let drive = Drive::run(&sandbox, "patrol_octagon", &set);
    let (mut inside, mut outside) = (0.0_f64, 0.0_f64);
    for p in drive.track() {
        // The zig-zag of the threatened stretch may stick out of the zone by its width.
        let from_zone = between(p, CENTER) - RADIUS;
        if from_zone > 1.0 {
            outside = outside.max(off_contour(p));
        } else if from_zone < 0.0 {
            inside = inside.max(off_contour(p));
        }
    }
    assert!(inside > 0.3, "{inside}");
    assert!(outside < 0.15, "{outside}");
    // Where it enters and leaves the zone are waypoints, and only between them any are put in.
    let corners = |end: &&Visit| OCTAGON.contains(&[end.x, end.y]);
    let ends = &drive.history.waypoints;
    let on_border = |end: &&Visit| (between([end.x, end.y], CENTER) - RADIUS).abs() < 1e-6;
    for end in ends.iter().filter(|end| end.kind == "route") {
        assert!(corners(&end) || on_border(&end), "{end:?}");
    }
    assert!(ends.iter().filter(on_border).count() >= 2);
    let put_in: Vec<&Visit> = ends.iter().filter(|end| end.kind == "inserted").collect();
    assert!(put_in.len() >= 3, "{}", put_in.len());
    for end in put_in {
        assert!(between([end.x, end.y], CENTER) < RADIUS + 1.0, "{end:?}");
    }
}

#[test]
fn zig_zag_fictive_obstacles_and_their_mixture_get_around_a_square_of_obstacles() {
    let sandbox = Sandbox::new();
    let run = |set: &[&str]| {
        let set = [&["rules.time_limit=230"], set].concat();
        Drive::run(&sandbox, "patrol_square", &set)
    };
    let fto = "processes.patrol.kind=patrol_fto";

    // Contacts, tolerances and counts are judged by `Drive` for each.
    let awg = run(&[]);
    let in_the_way = |drive: &Drive| {
        let ends = drive.history.waypoints.iter();
        ends.filter(|end| drive.walls.clearance([end.x, end.y]) < 0.0)
            .count()
    };
    assert!(in_the_way(&awg) >= 5 && awg.count("timed_out") >= in_the_way(&awg));
    assert_eq!(awg.count("inside_obstacle"), 0, "it knows none of them");

    let informed = run(&["processes.patrol.params.obstacles_known=true"]);
    assert!(informed.count("inside_obstacle") >= in_the_way(&informed));
    assert!(in_the_way(&informed) >= 5);

    let fictive = run(&[fto]);
    assert_eq!(in_the_way(&fictive), 0, "the contour's corners stand free");
    assert!(
        fictive
            .history
            .waypoints
            .iter()
            .all(|end| end.kind == "route")
    );
    assert_eq!(fictive.count("reached"), fictive.history.waypoints.len());

    let mixed = run(&[fto, "processes.patrol.params.protection=mixed"]);
    let put_in = |drive: &Drive| {
        let ends = drive.history.waypoints.iter();
        ends.filter(|end| end.kind == "inserted").count()
    };
    assert!(put_in(&mixed) > 0);
    for drive in [&awg, &informed, &fictive, &mixed] {
        assert!(!drive.lap_times().is_empty(), "once around");
        // The map makes no difference to predictors that do not use it.
        let corners = drive.history.waypoints.iter().filter(|e| e.kind == "route");
        assert!(corners.clone().count() >= 5 && corners.clone().all(|e| e.outcome == "reached"));
    }
    // Four ways to go that have nothing in common but the corners.
    let digests = [&awg, &informed, &fictive, &mixed].map(|d| d.summary["digest"].clone());
    for (i, digest) in digests.iter().enumerate() {
        assert!(!digests[..i].contains(digest));
    }
}

#[test]
fn a_waypoint_behind_a_wall_that_the_robot_cannot_see_is_reported_as_stuck() {
    let sandbox = Sandbox::new();
    let text = r#"
        title = "Blind"
        [run]
        dt = 0.05
        [world.map.vector]
        bounds = { min = [-1.0, -3.0], max = [9.0, 3.0] }
        [[world.map.vector.obstacles]]
        name = "wall"
        shape.rectangle = { center = [4.0, 0.0], half_extents = [0.2, 3.0] }
        [rules]
        time_limit = 60.0
        [[robots]]
        name = "guard"
        team = "neutral"
        start = { x = 0.0, y = 0.0, theta = 0.0 }
        scan = { beams = 3, angle_min = 3.0, angle_increment = 0.1 }  # backwards
        [[processes]]
        name = "patrol"
        kind = "patrol_awg"
        robots = ["guard"]
        [processes.params.mission]
        contour = [[0.0, 0.0], [8.0, 0.0]]
        closed = false
        t_max = 60.0
        alpha = 0.1
        danger_zones = [{ circle = { center = [1.0, 0.0], radius = 0.5 } }]
    "#;
    sandbox.file("blind.toml", text);
    let words = ["run", "blind.toml", "--in-process", "--out", "run.mcap"];
    let summary = sandbox.protean(words).json();
    let waypoints = &summary["robots"][0]["waypoints"];
    let history = History::read(&sandbox.path().join("run.mcap"));
    let stuck = history
        .waypoints
        .iter()
        .filter(|end| end.outcome == "stuck");
    let stuck: Vec<f64> = stuck.map(|end| end.x).collect();
    assert_eq!(waypoints["stuck"], stuck.len(), "{summary}");
    assert_eq!(waypoints["unreachable"], 0, "it has no proof");
    assert_eq!(stuck[0], 8.0, "{stuck:?}");
}

#[test]
fn a_guard_that_sights_an_intruder_catches_it_and_returns_to_the_patrol() {
    let sandbox = Sandbox::new();
    let call = sandbox.protean(["run", "patrol_chase", "--quiet", "--in-process"]);
    let summary = call.set("rules.time_limit=40").json();
    let events: Vec<(&str, &str)> = summary["events"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|event| Some((event["kind"].as_str()?, event["robot"].as_str()?)))
        .collect();
    assert_eq!(
        events,
        [
            ("sighted", "guard_2"),
            ("captured", "intruder"),
            ("returned", "guard_2")
        ]
    );
}

#[test]
fn a_team_on_a_graph_visits_all_nodes_and_says_where_it_heads_for() {
    let sandbox = Sandbox::new();
    let run = |more: &[&str]| {
        let call = sandbox.protean(["run", "patrol_graph", "--quiet", "--in-process"]);
        let call = call.set("rules.time_limit=300");
        let summary = more.iter().fold(call, |call, set| call.set(set)).json();
        let patrol = summary["patrols"][0].clone();
        (patrol, summary)
    };
    let (patrol, summary) = run(&[]);
    let nodes = patrol["nodes"].as_array().unwrap();
    assert_eq!(
        (nodes.len(), patrol["robots"].as_array().unwrap().len()),
        (25, 4)
    );
    for node in nodes {
        assert!(node["visits"].as_u64().unwrap() >= 2, "{node}");
    }
    let figure = |name: &str| patrol[name].as_f64().unwrap();
    assert!(
        figure("mean_interval_s") < figure("worst_idleness_s"),
        "{patrol}"
    );
    assert!(patrol.get("nearest_m").is_none());
    // Each robot says it in each tick.
    let messages = |topic: &str| summary["topics"][topic]["messages"].as_u64().unwrap();
    assert_eq!(messages("patrol/intention"), messages("robot/plan"));
    // The graph of the map has its nodes at the same crossings.
    let place = |node: &Json| ["x", "y"].map(|axis| node[axis].as_f64().unwrap());
    let crossings: Vec<[f64; 2]> = nodes.iter().map(place).collect();
    let (patrol, _) = run(&[
        "processes.patrol.params.graph.nodes=[]",
        "processes.patrol.params.graph.edges=[]",
        "processes.patrol.params.spacing=4",
    ]);
    let nodes = patrol["nodes"].as_array().unwrap();
    assert_eq!(nodes.len(), crossings.len());
    for [x, y] in nodes.iter().map(place) {
        let is_near = |[a, b]: &[f64; 2]| (a - x).abs().max((b - y).abs()) < 1.0;
        assert!(crossings.iter().any(is_near), "({x}, {y})");
    }
}
