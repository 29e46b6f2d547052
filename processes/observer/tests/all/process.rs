//! The observer process on a bus in memory.

use geometry::pose::Pose2;
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber};
use ipc_types::messages::observer::Prediction;
use ipc_types::messages::world::{MapCell, MapHeader, RobotState, WorldHeader};
use ipc_types::topics::{Predictions, WorldMap, WorldState};
use observer::ObserverParams;
use observer::process::ObserverProcess;
use robot::spec::RobotModel;
use robot::team::Role;
use runtime::kind::open;
use runtime::{Clock, ProcessConfig, ProcessError, RobotInfo, RunConfig};
use runtime::{Process as _, ProcessKind as _};
use serde_json::json;
use std::collections::BTreeMap;

const CELLS: u32 = 60;

fn config() -> ProcessConfig {
    let robot = |name: &str, x: f64| RobotInfo {
        name: name.into(),
        team: "neutral".into(),
        role: Role::Neutral,
        opponents: Vec::new(),
        companions: Vec::new(),
        model: RobotModel::turtlebot3_burger(),
        beams: 0,
        start: Pose2::new(x, 1.0, 0.0),
        goal: None,
    };
    ProcessConfig {
        run: RunConfig {
            root: std::path::PathBuf::new(),
            prefix: String::new(),
            seed: 1,
            tick_period_ns: 50_000_000,
            clock: Clock::LockStep,
            processor: None,
            processes: 2,
            events: 0,
            recorder_ticks: 8,
            topics: Vec::new(),
            capacities: BTreeMap::from([
                ("world/map".to_owned(), CELLS * CELLS),
                ("world/shapes".to_owned(), 0),
                ("perception/belief".to_owned(), 100),
            ]),
            robots: vec![robot("patrol", 1.0), robot("spy", 5.0)],
            exits: Vec::new(),
            capture_radius: 0.0,
            log_level: "warn".into(),
        },
        name: "observer".into(),
        kind: "observer".into(),
        index: 1,
        robots: Vec::new(),
        upstream: Vec::new(),
        period: 1,
        links: Vec::new(),
    }
}

fn params_of(json: serde_json::Value) -> ObserverParams {
    serde_json::from_value(json).unwrap()
}

/// A world of 6 m × 6 m with a wall from x = 2.9 to 3.1 below y = 3.
struct World {
    bus: Bus,
    state: Publisher<WorldState>,
    predictions: Subscriber<Predictions>,
    observer: ObserverProcess,
}

impl World {
    fn new(params: serde_json::Value) -> Self {
        let config = config();
        let params = params_of(params);
        let bus = Bus::local(config.run.bus_options());
        let predictions = bus.recorder().unwrap();
        let state = bus.publisher(PublisherOptions::new(0, 2)).unwrap();
        let map: Publisher<WorldMap> = bus
            .publisher(PublisherOptions::new(0, (CELLS * CELLS) as usize))
            .unwrap();
        let mut observer = ObserverProcess::open(&config, &params, &bus).unwrap();
        observer.connect().unwrap();
        let header = MapHeader {
            resolution: 0.1,
            width: CELLS,
            height: CELLS,
            revision: 1,
            ..MapHeader::default()
        };
        let cells: Vec<MapCell> = (0..CELLS * CELLS)
            .map(|i| {
                let (col, row) = (i % CELLS, i / CELLS);
                let wall = (29..31).contains(&col) && row < 30;
                MapCell {
                    clearance: if wall { 0.0 } else { 1.0 },
                    blurred: if wall { 0.0 } else { 1.0 },
                    occupied: u8::from(wall),
                    ..MapCell::default()
                }
            })
            .collect();
        map.send(header, &cells).unwrap();
        observer.prepare().unwrap();
        Self {
            bus,
            state,
            predictions,
            observer,
        }
    }

    /// Runs one tick with the watched robot at a place; returns the published predictions.
    fn tick(&mut self, tick: u64, x: f64, y: f64) -> Vec<Prediction> {
        let mut header = WorldHeader::default();
        header.stamp.tick = tick;
        header.stamp.time_ns = tick * 50_000_000;
        let robots = [(x, y), (5.0, 1.0)].map(|(x, y)| RobotState {
            x,
            y,
            ..RobotState::default()
        });
        let robots: Vec<RobotState> = (0..)
            .zip(robots)
            .map(|(robot, state)| RobotState { robot, ..state })
            .collect();
        self.state.send(header, &robots).unwrap();
        self.observer.step(tick).unwrap();
        let mut found = Vec::new();
        while let Some(message) = self.predictions.receive().unwrap() {
            assert_eq!(message.header().stamp.tick, tick);
            found.extend_from_slice(message.elements());
        }
        found
    }
}

#[test]
fn predictions_are_published_with_their_errors_when_due() {
    let mut world = World::new(json!({
        "watch": ["patrol"],
        "viewpoint": { "noise": 0.0, "heading_noise": 0.0 },
        "period_s": 0.25,
        "horizons_s": [0.5, 1.0],
    }));
    assert!(world.bus.is_local());
    let mut reports = Vec::new();
    for tick in 0..=60 {
        let found = world.tick(tick, 1.0 + 0.01 * tick as f64, 4.0);
        assert_eq!(found.is_empty(), tick % 5 != 0, "tick {tick}");
        reports.push(found);
    }
    let first = &reports[0];
    // Five methods for two horizons.
    assert_eq!(first.len(), 10);
    assert!(
        first
            .iter()
            .all(|p| p.robot == 0 && p.due == 0 && p.visible == 1)
    );
    let kalman = |tick: usize, horizon: f64| {
        *reports[tick]
            .iter()
            .find(|p| p.method == Prediction::KALMAN && p.horizon_s == horizon)
            .unwrap()
    };
    // Predictions of tick 0 are due at ticks 10 and 20.
    assert_eq!([kalman(5, 0.5).due, kalman(10, 0.5).due], [0, 1]);
    assert_eq!([kalman(15, 1.0).due, kalman(20, 1.0).due], [0, 1]);
    assert!(
        (kalman(10, 0.5).error - 0.1).abs() < 1e-9,
        "no speed was known then"
    );
    let last = kalman(60, 1.0);
    assert!(last.error < 1e-6 && (last.x - 1.8).abs() < 1e-6, "{last:?}");
    // A robot without goals has no next goal.
    let goal = reports[60]
        .iter()
        .find(|p| p.method == Prediction::SIMILAR_GOAL)
        .unwrap();
    assert!(goal.x.is_infinite() && goal.error.is_infinite() && goal.due == 1);
}

#[test]
fn behind_a_wall_nothing_is_seen_and_predictions_go_on() {
    let mut world = World::new(json!({
        "from_robots": ["spy"],
        "methods": ["kalman", "particles"],
        "horizons_s": [1.0],
    }));
    // The spy at (5, 1) sees past the wall's end only.
    let open = world.tick(0, 4.0, 5.0);
    assert_eq!(open.len(), 2, "the spy does not watch itself");
    assert!(open.iter().all(|p| p.visible == 1));
    let mut last = Vec::new();
    for tick in 1..=40 {
        let found = world.tick(tick, 1.0, 1.0);
        if !found.is_empty() {
            last = found;
        }
    }
    assert!(
        last.iter()
            .all(|p| p.visible == 0 && p.x.is_finite() && p.error > 1.0)
    );
}

#[test]
fn names_that_are_unknown_and_numbers_out_of_range_are_refused() {
    for (params, part) in [
        (json!({ "watch": ["missing"] }), "`watch` names `missing`"),
        (json!({ "period_s": 0.0 }), "`period_s` is 0"),
        (json!({ "filter": { "particles": 0 } }), "filter.particles"),
        (json!({ "cat": {} }), "cat.contour"),
        (
            json!({ "cat": { "contour": [[0.0, 0.0], [1.0, 0.0]], "t_max": -1.0 } }),
            "cat.t_max",
        ),
        (
            json!({ "cat": { "contour": [[0.0, 0.0], [0.0, 0.0]] } }),
            "cat.contour",
        ),
        (
            json!({ "chebyshev": { "rectangle": [1.0, 0.0, 0.0, 1.0] } }),
            "chebyshev.rectangle",
        ),
        (json!({ "methods": [] }), "methods"),
        (json!({ "horizon": 1.0 }), "unknown field"),
    ] {
        let config = config();
        let bus = Bus::local(config.run.bus_options());
        let reason = match serde_json::from_value(params) {
            Err(error) => error.to_string(),
            Ok(params) => match open::<ObserverProcess>(&config, &params, &bus).map(|_| ()) {
                Err(ProcessError::Params { reason, .. }) => reason,
                other => panic!("{part}: {other:?}"),
            },
        };
        assert!(reason.contains(part), "{reason}");
    }
}
