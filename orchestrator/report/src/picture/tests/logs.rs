//! Pictures of valid and invalid logs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use geometry::shape::Shape;
use ipc_types::messages::perception::{BeliefHeader, Particle};
use ipc_types::messages::robot::{PlanHeader, PlanPoint, WaypointEnd};
use ipc_types::messages::world::{
    CoverageState, MapCell, MapHeader, ObstacleEvent, RobotState, WorldEvent, WorldHeader,
};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{
    Belief, Coverage, ObstacleEvents, Plan, Topic, Waypoints, WorldEvents, WorldMap, WorldState,
};
use ipc_types::{cdr, schema};
use mcap_log::{ChannelId, ChannelSpec, LogOptions, LogWriter, Manifest, ManifestFile};
use mcap_log::{Condition, LogReadError, Origin, ReadProgress};
use recorder::{RunInfo, TaskInfo};
use runtime::kind::TaskSketch;
use tempfile::TempDir;

use crate::picture::{MarkKind, RunTrace};

const VECTORS: &str = r#"
title = "A test"
[world.map.vector]
bounds = { min = [0.0, 0.0], max = [4.0, 3.0] }
obstacles = [{ shape = { circle = { center = [2.0, 1.0], radius = 0.5 } } }]
[rules]
exits = [{ circle = { center = [3.5, 2.5], radius = 0.3 } }]
[[robots]]
name = "cop"
team = "police"
start = { x = 0.5, y = 0.5, theta = 0.0 }
[[robots]]
name = "robber"
team = "evader"
start = { x = 1.0, y = 0.5, theta = 0.0 }
"#;

struct Log {
    folder: TempDir,
    writer: LogWriter,
}

impl Log {
    fn new(scenario: &str) -> Self {
        Self::described(scenario, &RunInfo::default())
    }

    fn described(scenario: &str, run: &RunInfo) -> Self {
        let manifest = Manifest {
            entries: [("scenario", "test"), ("seed", "7")]
                .into_iter()
                .map(|(k, v)| (k.to_owned(), v.to_owned()))
                .collect(),
            attachments: vec![
                ManifestFile {
                    name: "scenario.toml".to_owned(),
                    media_type: "application/toml".to_owned(),
                    data: scenario.as_bytes().to_vec(),
                },
                ManifestFile {
                    name: Origin::RUN.to_owned(),
                    media_type: "application/json".to_owned(),
                    data: serde_json::to_vec(run).unwrap(),
                },
            ],
        };
        Self::with(&manifest)
    }

    fn with(manifest: &Manifest) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let writer = LogWriter::create(&path, &LogOptions::default(), manifest).unwrap();
        Self { folder, writer }
    }

    fn channel<T: Topic>(&mut self, hash: &str) -> ChannelId {
        let text = schema::ros2msg(T::id());
        let metadata = BTreeMap::from([("schema_hash".to_owned(), hash.to_owned())]);
        let spec = ChannelSpec {
            topic: T::NAME,
            schema_name: &schema::message_name(T::id()),
            schema_encoding: "ros2msg",
            schema: text.as_bytes(),
            message_encoding: "cdr",
            metadata: &metadata,
        };
        self.writer.add_channel(&spec).unwrap()
    }

    fn write<T: Topic>(
        &mut self,
        to: ChannelId,
        time_s: f64,
        header: &T::Header,
        of: &[T::Element],
    ) {
        let mut bytes = Vec::new();
        cdr::encode::<T>(header, of, &mut bytes);
        let time = (time_s * 1e9) as u64;
        self.writer.write(to, 0, time, time, &bytes).unwrap();
    }

    /// Ten seconds: the cop drives along x and catches the robber after 5 s.
    fn run(mut self) -> (TempDir, PathBuf) {
        let states = self.channel::<WorldState>(&schema::hash::<WorldState>());
        let beliefs = self.channel::<Belief>(&schema::hash::<Belief>());
        let plans = self.channel::<Plan>(&schema::hash::<Plan>());
        let events = self.channel::<WorldEvents>(&schema::hash::<WorldEvents>());
        let obstacles = self.channel::<ObstacleEvents>(&schema::hash::<ObstacleEvents>());
        let appears = ObstacleEvent {
            id: 7,
            x: 1.0,
            y: 2.0,
            radius: 0.1,
            ..ObstacleEvent::default()
        };
        for tick in 0..=100_u32 {
            let time = f64::from(tick) * 0.1;
            let header = WorldHeader {
                tick_period_ns: 100_000_000,
                ..WorldHeader::default()
            };
            let cop = RobotState {
                x: 0.5 + 0.1 * time,
                y: 0.5,
                team: 1,
                ..RobotState::default()
            };
            let robber = RobotState {
                x: 1.0,
                y: 0.5,
                robot: 1,
                team: 2,
                status: u8::from(tick >= 50),
                ..RobotState::default()
            };
            self.write::<WorldState>(states, time, &header, &[cop, robber]);
            if tick < 50 {
                let about = BeliefHeader {
                    robot: 1,
                    mean_x: time,
                    ..BeliefHeader::default()
                };
                self.write::<Belief>(beliefs, time, &about, &[Particle::default(); 3]);
                let about = PlanHeader {
                    robot: 1,
                    ..PlanHeader::default()
                };
                let way = [0.0, time].map(|x| PlanPoint {
                    x,
                    ..PlanPoint::default()
                });
                self.write::<Plan>(plans, time, &about, &way);
            }
            if tick == 50 {
                let caught = WorldEvent {
                    robot: 1,
                    other: 0,
                    x: 1.0,
                    y: 0.5,
                    ..WorldEvent::default()
                };
                self.write::<WorldEvents>(events, time, &PlainHeader::default(), &[caught]);
            }
            if tick == 80 {
                self.write::<ObstacleEvents>(obstacles, time, &PlainHeader::default(), &[appears]);
            }
            if tick == 100 {
                let mut later = PlainHeader::default();
                later.stamp.time_ns = 99_000_000_000;
                let never = ObstacleEvent { id: 8, ..appears };
                self.write::<ObstacleEvents>(obstacles, time, &later, &[never]);
            }
        }
        self.finish()
    }

    fn finish(self) -> (TempDir, PathBuf) {
        let path = self.writer.path().to_owned();
        self.writer.finish().unwrap();
        (self.folder, path)
    }
}

fn read(path: &Path, at: Option<f64>) -> Result<(RunTrace, Condition), LogReadError> {
    RunTrace::read(path, at, &mut ReadProgress::default())
}

fn drawn(path: &Path, at: Option<f64>) -> RunTrace {
    let (trace, condition) = read(path, at).unwrap();
    assert!(condition.is_whole());
    trace
}

fn refused(path: &Path, at: Option<f64>) -> LogReadError {
    read(path, at).unwrap_err()
}

#[test]
fn a_picture_of_the_end_shows_all_events() {
    let (_folder, path) = Log::new(VECTORS).run();
    let trace = drawn(&path, None);
    assert_eq!(
        (trace.title.as_str(), trace.scenario.as_str()),
        ("A test", "test")
    );
    assert_eq!(
        (trace.time_s, trace.end_s, trace.seed.as_str()),
        (10.0, 10.0, "7")
    );
    let [cop, robber] = &trace.robots[..] else {
        panic!("{:?}", trace.robots)
    };
    assert!((cop.pose.x - 1.5).abs() < 1e-9 && cop.active);
    assert_eq!((cop.name.as_str(), cop.trail.points().len()), ("cop", 101));
    assert!(!robber.active);
    assert_eq!(trace.marks.len(), 1);
    assert_eq!(
        (trace.marks[0].kind, trace.marks[0].time_s),
        (MarkKind::Captured, 5.0)
    );
    assert_eq!(trace.static_scene.obstacles.len(), 2);
    assert!(trace.static_scene.obstacles[&7].came && !trace.static_scene.obstacles[&0].came);
    assert_eq!(
        (trace.static_scene.max, trace.static_scene.exits.len()),
        ([4.0, 3.0], 1)
    );
    assert!(
        trace.beliefs.is_empty(),
        "beliefs are shown of a moment only"
    );
}

#[test]
fn a_picture_of_a_moment_shows_its_belief_and_no_later_events() {
    let (_folder, path) = Log::new(VECTORS).run();
    let trace = drawn(&path, Some(3.0));
    assert_eq!((trace.time_s, trace.end_s), (3.0, 10.0));
    assert!((trace.robots[0].pose.x - 0.8).abs() < 1e-9);
    assert!(trace.marks.is_empty() && trace.robots[1].active);
    assert_eq!(trace.static_scene.obstacles.len(), 1);
    assert_eq!(trace.beliefs.len(), 1);
    assert_eq!(
        (trace.beliefs[0].robot, trace.beliefs[0].mean),
        (1, [3.0, 0.0])
    );
    assert_eq!(trace.plans.len(), 1);
    // From the robot to the next point; the last one is what it heads for.
    assert_eq!(trace.plans[0].points, [[1.0, 0.5], [0.0, 0.0]]);
    assert_eq!(trace.plans[0].aim, Some([3.0, 0.0]));
    // A captured robber has neither a belief nor a plan.
    let trace = drawn(&path, Some(7.0));
    assert!(trace.beliefs.is_empty() && trace.plans.is_empty());
}

#[test]
fn a_time_outside_the_run_is_refused() {
    let (_folder, path) = Log::new(VECTORS).run();
    for at in [-1.0, 10.1, 1e300, f64::NAN, f64::INFINITY] {
        let error = refused(&path, Some(at));
        assert!(matches!(error, LogReadError::Argument(_)), "{error}");
        assert!(error.to_string().contains("10 s"), "{error}");
    }
    assert!(read(&path, Some(10.0)).is_ok());
    assert!(read(&path, Some(0.0)).is_ok());
}

#[test]
fn a_map_without_vectors_comes_from_the_messages() {
    let scenario = VECTORS.replace(
        "obstacles = [{ shape = { circle = { center = [2.0, 1.0], radius = 0.5 } } }]",
        "",
    );
    let mut log = Log::new(&scenario);
    let maps = log.channel::<WorldMap>(&schema::hash::<WorldMap>());
    let header = MapHeader {
        resolution: 0.5,
        width: 8,
        height: 6,
        ..MapHeader::default()
    };
    let mut cells = vec![MapCell::default(); 48];
    cells[9].occupied = 1;
    log.write::<WorldMap>(maps, 0.0, &header, &cells);
    let (_folder, path) = log.run();
    let trace = drawn(&path, None);
    assert_eq!(trace.static_scene.max, [4.0, 3.0]);
    assert!(trace.static_scene.cells.unwrap().occupied[9]);
}

#[test]
fn other_files_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing.mcap");
    assert!(matches!(refused(&path, None), LogReadError::Open { .. }));
    assert!(matches!(
        refused(folder.path(), None),
        LogReadError::Open { .. }
    ));
    for bytes in [
        &b""[..],
        b"\x89MCA",
        b"not a log, but long enough to be one",
    ] {
        fs::write(&path, bytes).unwrap();
        let error = refused(&path, None);
        assert!(matches!(error, LogReadError::NotMcap { .. }), "{error}");
    }
}

#[test]
fn an_mcap_file_of_another_program_is_refused() {
    let (_folder, path) = Log::with(&Manifest::default()).finish();
    let error = refused(&path, None);
    assert!(error.to_string().contains("manifest"), "{error}");
    let (_folder, path) = Log::new(VECTORS).finish();
    let error = refused(&path, None);
    assert!(error.to_string().contains("world/state"), "{error}");
    let (_folder, path) = Log::new("title = 3").finish();
    let error = refused(&path, None);
    assert!(
        matches!(error, LogReadError::NotRepeatable { .. }),
        "{error}"
    );
}

#[test]
fn a_log_of_another_version_is_refused() {
    let mut log = Log::new(VECTORS);
    log.channel::<WorldState>("0123456789abcdef");
    let (_folder, path) = log.finish();
    let error = refused(&path, None);
    assert!(matches!(error, LogReadError::Layout { .. }), "{error}");
    assert!(error.to_string().contains("0123456789abcdef"), "{error}");
}

#[test]
fn a_log_cut_off_anywhere_is_drawn_as_far_as_it_goes() {
    let (_folder, path) = Log::new(VECTORS).run();
    let whole = fs::read(&path).unwrap();
    let cut = path.with_extension("cut");
    let mut count = 0;
    for length in (8..whole.len())
        .step_by(whole.len() / 97)
        .chain([whole.len() - 1])
    {
        fs::write(&cut, &whole[..length]).unwrap();
        match read(&cut, None) {
            Ok((trace, condition)) => {
                assert!(!condition.is_whole(), "{length}");
                assert_eq!(trace.robots.len(), 2, "{length}");
                count += 1;
            }
            // The manifest, the scenario or the first state is cut off.
            Err(error) => assert!(matches!(error, LogReadError::Foreign { .. }), "{error}"),
        }
    }
    assert!(count > 10, "{count}");
}

#[test]
fn no_flipped_byte_goes_unnoticed_or_breaks_the_reader() {
    let (_folder, path) = Log::new(VECTORS).run();
    let whole = fs::read(&path).unwrap();
    let sound = drawn(&path, None);
    let flipped = path.with_extension("flipped");
    for at in (0..whole.len()).step_by(whole.len() / 211) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        fs::write(&flipped, &bytes).unwrap();
        // The footer's own records have no checksum, so their content is not used.
        if let Ok((trace, condition)) = read(&flipped, None)
            && condition.is_whole()
        {
            assert_eq!(trace, sound, "byte {at}");
        }
    }
}

/// A coverage and a patrol.
const TASKS: &str = r#"
[world.map.vector]
bounds = { min = [0.0, 0.0], max = [10.0, 10.0] }
obstacles = [{ shape.rectangle = { center = [5.0, 5.0], half_extents = [2.5, 2.5] } }]
[rules.coverage]
robots = ["sweeper"]
[[robots]]
name = "sweeper"
team = "neutral"
start = { x = 1.0, y = 8.0, theta = 0.0 }
radius = 0.1
[[robots]]
name = "guard"
team = "neutral"
start = { x = 1.0, y = 1.0, theta = 0.0 }
"#;

#[test]
fn a_picture_shows_the_tasks_of_the_run_and_what_is_swept() {
    let rectangles = TaskSketch {
        rectangles: vec![[[0.0, 0.0], [5.0, 5.0]], [[5.0, 5.0], [10.0, 10.0]]],
        ..TaskSketch::default()
    };
    let patrol = TaskSketch {
        contour: vec![[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 1.0]],
        danger_zones: vec![Shape::Circle {
            center: [9.0, 1.0],
            radius: 1.0,
        }],
        ..TaskSketch::default()
    };
    let tasks = [(0, rectangles), (1, patrol)].map(|(robot, sketch)| TaskInfo { robot, sketch });
    let run = RunInfo {
        tasks: tasks.into(),
        ..RunInfo::default()
    };
    let mut log = Log::described(TASKS, &run);
    let states = log.channel::<WorldState>(&schema::hash::<WorldState>());
    let ends = log.channel::<Waypoints>(&schema::hash::<Waypoints>());
    let coverage = log.channel::<Coverage>(&schema::hash::<Coverage>());
    for (time, fraction) in [(0.0, 0.0), (5.0, 0.25), (10.0, 0.5)] {
        let robots = [0, 1].map(|robot| RobotState {
            robot,
            ..RobotState::default()
        });
        log.write::<WorldState>(states, time, &WorldHeader::default(), &robots);
        let end = WaypointEnd {
            x: time,
            outcome: u8::from(time == 10.0),
            ..WaypointEnd::default()
        };
        log.write::<Waypoints>(ends, time, &PlainHeader::default(), &[end]);
        let report = CoverageState {
            coverable_fraction: fraction,
            ..CoverageState::default()
        };
        log.write::<Coverage>(coverage, time, &PlainHeader::default(), &[report]);
    }
    let (_folder, path) = log.finish();
    let trace = drawn(&path, None);
    let task = &trace.task;
    assert_eq!(task.rectangles.len(), 2);
    assert_eq!(
        task.contours,
        [[[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 1.0]]]
    );
    assert_eq!(task.danger_zones.len(), 1);
    let reached: Vec<bool> = task.waypoints.iter().map(|w| w.is_reached).collect();
    assert_eq!((reached, task.swept), (vec![true, true, false], Some(0.5)));
    let sweeps: Vec<_> = trace.robots.iter().map(|robot| robot.sweeps).collect();
    assert_eq!(sweeps, [Some(0.1), None]);
    // Of a moment: what has ended and is swept by then.
    let earlier = drawn(&path, Some(7.0)).task;
    assert_eq!((earlier.waypoints.len(), earlier.swept), (2, Some(0.25)));
}
