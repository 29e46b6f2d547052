//! A synthetic run with messages of every topic, and its log. Tests of other crates include this file.

use std::path::Path;
use std::sync::Arc;

use ipc_types::messages::observer::Prediction;
use ipc_types::messages::perception::{BeliefHeader, Particle, Sighting};
use ipc_types::messages::process::{ProcessStatus, RunControl};
use ipc_types::messages::referee::{DominanceCell, DominanceHeader, Verdict};
use ipc_types::messages::robot::{
    Command, PlanHeader, PlanPoint, ScanHeader, TreeEdge, TreeHeader, WaypointEnd,
};
use ipc_types::messages::world::{
    CoverageState, MapCell, MapHeader, ObstacleEvent, RobotState, ShapePoint, ShapesHeader,
    WorldEvent, WorldHeader,
};
use ipc_types::stamp::{PlainHeader, Stamp};
use ipc_types::topics::{
    Belief, Commands, Control, Coverage, Dominance, ObstacleEvents, Plan, Predictions, Scan,
    Sightings, Status, Tree, Verdicts, Waypoints, WorldEvents, WorldMap, WorldShapes, WorldState,
};
use mcap_log::{LogOptions, LogWriter, Manifest, ManifestFile};
use recorder::{DerivedTopics, ProcessInfo, Recording, RobotInfo, RunInfo, Summary};

pub const PERIOD_NS: u64 = 50_000_000;
pub const ORCHESTRATOR: u32 = 0;
pub const SIMULATOR: u32 = 1;
pub const PERCEPTION: u32 = 2;
pub const FIRST_ROBOT: u32 = 3;
pub const ROBOTS: u32 = 3;

/// A message of any topic.
#[derive(Clone)]
pub enum Sent {
    State(WorldHeader, Vec<RobotState>),
    Map(MapHeader, Vec<MapCell>),
    Shapes(ShapesHeader, Vec<ShapePoint>),
    Event(PlainHeader, Vec<WorldEvent>),
    Coverage(PlainHeader, CoverageState),
    Obstacle(PlainHeader, ObstacleEvent),
    Scan(ScanHeader, Vec<f32>),
    Sighting(PlainHeader, Vec<Sighting>),
    Belief(BeliefHeader, Vec<Particle>),
    Command(PlainHeader, Vec<Command>),
    Plan(PlanHeader, Vec<PlanPoint>),
    Tree(TreeHeader, Vec<TreeEdge>),
    Waypoint(PlainHeader, Vec<WaypointEnd>),
    Prediction(PlainHeader, Vec<Prediction>),
    Verdict(PlainHeader, Vec<Verdict>),
    Dominance(DominanceHeader, Vec<DominanceCell>),
    Status(PlainHeader, ProcessStatus),
    Control(PlainHeader, RunControl),
}

impl Sent {
    pub fn push(&self, recording: &mut Recording) {
        match self {
            Self::State(h, e) => recording.push::<WorldState>(h, e),
            Self::Map(h, e) => recording.push::<WorldMap>(h, e),
            Self::Shapes(h, e) => recording.push::<WorldShapes>(h, e),
            Self::Event(h, e) => recording.push::<WorldEvents>(h, e),
            Self::Coverage(h, e) => recording.push::<Coverage>(h, &[*e]),
            Self::Obstacle(h, e) => recording.push::<ObstacleEvents>(h, &[*e]),
            Self::Scan(h, e) => recording.push::<Scan>(h, e),
            Self::Sighting(h, e) => recording.push::<Sightings>(h, e),
            Self::Belief(h, e) => recording.push::<Belief>(h, e),
            Self::Command(h, e) => recording.push::<Commands>(h, e),
            Self::Plan(h, e) => recording.push::<Plan>(h, e),
            Self::Tree(h, e) => recording.push::<Tree>(h, e),
            Self::Waypoint(h, e) => recording.push::<Waypoints>(h, e),
            Self::Prediction(h, e) => recording.push::<Predictions>(h, e),
            Self::Verdict(h, e) => recording.push::<Verdicts>(h, e),
            Self::Dominance(h, e) => recording.push::<Dominance>(h, e),
            Self::Status(h, e) => recording.push::<Status>(h, &[*e]),
            Self::Control(h, e) => recording.push::<Control>(h, &[*e]),
        }
    }

    pub fn stamp(&self) -> &Stamp {
        match self {
            Self::State(h, _) => &h.stamp,
            Self::Map(h, _) => &h.stamp,
            Self::Shapes(h, _) => &h.stamp,
            Self::Event(h, _)
            | Self::Coverage(h, _)
            | Self::Obstacle(h, _)
            | Self::Sighting(h, _)
            | Self::Verdict(h, _)
            | Self::Waypoint(h, _)
            | Self::Prediction(h, _)
            | Self::Command(h, _)
            | Self::Status(h, _)
            | Self::Control(h, _) => &h.stamp,
            Self::Scan(h, _) => &h.stamp,
            Self::Dominance(h, _) => &h.stamp,
            Self::Belief(h, _) => &h.stamp,
            Self::Plan(h, _) => &h.stamp,
            Self::Tree(h, _) => &h.stamp,
        }
    }
}

/// Returns the messages of a run with a few robots and every topic, in the order of the log. Clock readings
/// start at `clock` (ns).
#[expect(clippy::too_many_lines, reason = "one topic after the other")]
pub fn run(ticks: u64, clock: u64) -> Vec<Sent> {
    let mut sent = Vec::new();
    let stamp = |tick: u64, source: u32, sequence: u64| {
        let origin_ns = clock + tick * 300_000;
        let received_ns = origin_ns + u64::from(source) * 10_000;
        Stamp {
            tick,
            time_ns: tick * PERIOD_NS,
            sequence,
            source,
            reserved: 0,
            origin_ns,
            begun_ns: received_ns.saturating_sub(1_000),
            received_ns,
            computed_ns: received_ns + 4_000,
            sent_ns: received_ns + 5_000,
        }
    };
    let plain = |tick, source, sequence| PlainHeader {
        stamp: stamp(tick, source, sequence),
    };
    for tick in 0..ticks {
        let last = tick + 1 == ticks;
        let robots = (0..ROBOTS)
            .map(|robot| RobotState {
                x: tick as f64 * 0.1,
                y: f64::from(robot),
                theta: 0.1 * f64::from(robot),
                distance: tick as f64 * 0.1,
                robot,
                team: if robot < 2 { 1 } else { 2 },
                status: u8::from(robot == 2 && tick >= 5),
                present: 1,
                ..RobotState::default()
            })
            .collect();
        let mut header = WorldHeader {
            stamp: stamp(tick, SIMULATOR, tick),
            tick_period_ns: PERIOD_NS,
            map_revision: 1,
            phase: if last {
                WorldHeader::OVER
            } else {
                WorldHeader::RUNNING
            },
        };
        header.stamp.origin_ns = header.stamp.sent_ns;
        sent.push(Sent::State(header, robots));
        if tick == 0 {
            let header = MapHeader {
                stamp: stamp(tick, SIMULATOR, 0),
                resolution: 0.5,
                width: 4,
                height: 3,
                revision: 1,
                ..MapHeader::default()
            };
            sent.push(Sent::Map(
                header,
                vec![
                    MapCell {
                        blurred: 0.5,
                        ..MapCell::default()
                    };
                    12
                ],
            ));
        }
        if tick == 0 {
            let header = ShapesHeader {
                stamp: stamp(tick, SIMULATOR, 0),
                max_x: 2.0,
                max_y: 1.5,
                revision: 1,
                shapes: 1,
                complete: 1,
                ..ShapesHeader::default()
            };
            let disc = ShapePoint {
                radius: 0.3,
                ..ShapePoint::default()
            };
            sent.push(Sent::Shapes(header, vec![disc]));
        }
        if tick == 5 {
            let event = WorldEvent {
                robot: 2,
                other: 0,
                value: 0.3,
                ..WorldEvent::default()
            };
            sent.push(Sent::Event(plain(tick, SIMULATOR, 0), vec![event]));
        }
        if last {
            let report = CoverageState {
                fraction: 0.5,
                cell_area: 0.25,
                free: 8,
                visited: 4,
                ..CoverageState::default()
            };
            let place = plain(tick, SIMULATOR, 0);
            sent.push(Sent::Coverage(place, report));
        }
        if tick == 3 {
            let event = ObstacleEvent {
                id: 1,
                radius: 0.4,
                ..ObstacleEvent::default()
            };
            sent.push(Sent::Obstacle(plain(tick, ORCHESTRATOR, 0), event));
        }
        let scan = ScanHeader {
            stamp: stamp(tick, SIMULATOR, tick),
            ..ScanHeader::default()
        };
        sent.push(Sent::Scan(scan, vec![1.0, f32::INFINITY, 2.5]));
        let sighting = Sighting {
            sigma: f64::INFINITY,
            robot: 2,
            ..Sighting::default()
        };
        sent.push(Sent::Sighting(
            plain(tick, PERCEPTION, tick),
            vec![sighting],
        ));
        let belief = BeliefHeader {
            stamp: stamp(tick, PERCEPTION, tick),
            robot: 2,
            ..BeliefHeader::default()
        };
        let particles = (0..40)
            .map(|i| Particle {
                x: i as f32,
                y: tick as f32,
                theta: 0.0,
                weight: 0.025,
            })
            .collect();
        sent.push(Sent::Belief(belief, particles));
        for robot in 0..ROBOTS {
            let command = Command {
                v: 0.1,
                omega: 0.2,
                robot,
                reserved: 0,
            };
            sent.push(Sent::Command(
                plain(tick, FIRST_ROBOT + robot, tick),
                vec![command],
            ));
        }
        for robot in 0..ROBOTS {
            let header = PlanHeader {
                stamp: stamp(tick, FIRST_ROBOT + robot, tick),
                robot,
                target: 2,
            };
            sent.push(Sent::Plan(
                header,
                vec![
                    PlanPoint {
                        x: 1.0,
                        ..PlanPoint::default()
                    };
                    2
                ],
            ));
        }
        let tree = TreeHeader {
            stamp: stamp(tick, FIRST_ROBOT, tick),
            ..TreeHeader::default()
        };
        sent.push(Sent::Tree(tree, vec![TreeEdge::default(); 5]));
        let waypoint = WaypointEnd {
            closest: f64::INFINITY,
            outcome: 1,
            ..WaypointEnd::default()
        };
        let header = plain(tick, FIRST_ROBOT, tick);
        sent.push(Sent::Waypoint(header, vec![waypoint]));
        if last {
            let verdict = Verdict {
                margin: f64::NEG_INFINITY,
                time: f64::INFINITY,
                robot: 2,
                ..Verdict::default()
            };
            let header = plain(tick, PERCEPTION, 0);
            sent.push(Sent::Verdict(header, vec![verdict]));
            let prediction = Prediction {
                horizon_s: 1.0,
                error: f64::INFINITY,
                ..Prediction::default()
            };
            sent.push(Sent::Prediction(header, vec![prediction]));
            let header = DominanceHeader {
                stamp: stamp(tick, PERCEPTION, 0),
                resolution: 0.5,
                width: 2,
                height: 1,
                ..DominanceHeader::default()
            };
            let cells = [DominanceCell::default(); 2].to_vec();
            sent.push(Sent::Dominance(header, cells));
        }
        if tick % 4 == 0 {
            let mut status = ProcessStatus {
                ticks: tick,
                ..ProcessStatus::default()
            };
            status.set_error("fine");
            sent.push(Sent::Status(plain(tick, SIMULATOR, tick / 4), status));
        }
        if tick == 0 {
            sent.push(Sent::Control(
                plain(tick, ORCHESTRATOR, 0),
                RunControl::default(),
            ));
        }
    }
    sent
}

/// Returns processes and robots of the run.
pub fn run_info() -> RunInfo {
    let kinds = [
        "orchestrator",
        "simulator",
        "perception",
        "pursuer",
        "pursuer",
        "evader",
    ];
    RunInfo {
        processes: kinds
            .iter()
            .enumerate()
            .map(|(index, kind)| ProcessInfo {
                index: index as u32,
                name: format!("{kind}_{index}"),
                kind: (*kind).to_owned(),
                upstream: if *kind == "pursuer" {
                    vec![2]
                } else {
                    Vec::new()
                },
            })
            .collect(),
        robots: ["police_1", "police_2", "baddie_1"]
            .map(|name| RobotInfo {
                name: name.to_owned(),
                team: if name.starts_with("police") {
                    "police"
                } else {
                    "evader"
                }
                .to_owned(),
                radius: 0.1,
                visits_waypoints: false,
                lap_limit_s: None,
            })
            .to_vec(),
        obstacles: std::collections::BTreeMap::new(),
        tick_period_ns: PERIOD_NS,
        seed: 1,
        ..RunInfo::default()
    }
}

/// Creates a recording of the run with a new log.
pub fn recording(
    path: &Path,
    options: &LogOptions,
    derived: Option<Box<dyn DerivedTopics>>,
) -> Recording {
    let manifest = Manifest {
        entries: [("seed".to_owned(), "7".to_owned())].into(),
        attachments: vec![ManifestFile {
            name: "scenario.toml".to_owned(),
            media_type: "application/toml".to_owned(),
            data: b"name = \"made up\"\n".to_vec(),
        }],
    };
    let log = LogWriter::create(path, options, &manifest).unwrap();
    let recording = Recording::new(&run_info(), Arc::default());
    recording.with_log(log, derived).unwrap()
}

/// Records a run of this many ticks, in chunks of this size (bytes); `change` may change the messages.
pub fn record_run(
    path: &Path,
    ticks: u64,
    chunk_bytes: u64,
    derived: Option<Box<dyn DerivedTopics>>,
    change: impl Fn(&mut Command, u64),
) -> Summary {
    let options = LogOptions {
        chunk_bytes,
        ..LogOptions::default()
    };
    let mut recording = recording(path, &options, derived);
    for mut sent in run(ticks, 1) {
        if let Sent::Command(header, commands) = &mut sent {
            for command in commands {
                change(command, header.stamp.tick);
            }
        }
        sent.push(&mut recording);
    }
    for tick in 0..ticks {
        recording.advance(tick, &mut ()).unwrap();
    }
    recording.finish(&mut ()).unwrap()
}
