//! The recording of a run: its log and the metadata of the log.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap_log::{
    Compression, LogObserver, LogOptions, LogWriteError, LogWriter, Manifest, ManifestFile, Origin,
};
use platform::eprintln;
use platform::presence;

use super::child_process::Executable;
use super::error::MissionError;
use super::plan::Plan;
use super::report;
use crate::fields_of_view::fields_of_view;
use recorder::{DigestPrefixes, PatrolInfo, ProcessInfo, Recording, RobotInfo, RunInfo, TaskInfo};
use runtime::kind::TaskSketch;
use scenario::ResolvedScenario;
use scenario::spec::{self, Mode};
use viewer::{ViewerOptions, viewer_topics};

/// Directory of logs without a given path.
const DIRECTORY: &str = "logs";

/// File of a log.
#[derive(Debug, Clone, Copy)]
pub(super) struct LogFile<'a> {
    /// Path of the log; `None` selects a free path in `logs/`.
    pub(super) path: Option<&'a Path>,
    /// `true` if the file may be overwritten.
    pub(super) force: bool,
    /// `true` to write no note on the first log in `logs/`.
    pub(super) quiet: bool,
    /// Key and text on what the run has beside its scenario.
    pub(super) source: Option<&'a (&'static str, String)>,
}

/// Starts recording a run, into a log if requested; the observer gets each message that is written to the log.
///
/// # Errors
/// [`MissionError`] if the log cannot be created.
pub(super) fn create(
    scenario: &ResolvedScenario,
    plan: &Plan,
    log: Option<LogFile<'_>>,
    digest_prefixes: Arc<DigestPrefixes>,
    mirror: Option<Box<dyn LogObserver>>,
) -> Result<Recording, MissionError> {
    let mut run = run_info(scenario, plan);
    let recording = Recording::new(&run, digest_prefixes);
    let Some(log) = log else {
        return Ok(recording);
    };
    // Only readers of the log need them, and a decomposition takes time.
    run.fields_of_view = fields_of_view(scenario);
    run.tasks = tasks(scenario);
    let mut writer = create_log(scenario, &run, plan, log)?;
    if let Some(mirror) = mirror {
        writer.set_observer(mirror);
    }
    let viewer = ViewerOptions {
        rate_hz: scenario.log.viewer_rate_hz,
        obstacles: plan.standing.clone(),
        ..ViewerOptions::default()
    };
    Ok(recording.with_log(writer, viewer_topics(&run, &viewer))?)
}

/// Creates the log. Without a given path it takes the first free one, also if another run selects a path at the
/// same time.
fn create_log(
    scenario: &ResolvedScenario,
    run: &RunInfo,
    plan: &Plan,
    log: LogFile<'_>,
) -> Result<LogWriter, MissionError> {
    let options = LogOptions {
        compression: match scenario.log.compression {
            spec::Compression::Zstd => LogOptions::default().compression,
            spec::Compression::None => Compression::None,
        },
        force: log.force,
        ..LogOptions::default()
    };
    let mut manifest = manifest(scenario, run, plan);
    let source = log
        .source
        .map(|(key, text)| ((*key).to_owned(), text.clone()));
    manifest.entries.extend(source);
    let directory = presence::entry(Path::new(DIRECTORY)).map_err(MissionError::LogDirectory)?;
    if log.path.is_none() && !log.quiet && directory.is_none() {
        eprintln!("logs are written to ./{DIRECTORY}; --out FILE selects another place");
    }
    loop {
        let path = match log.path {
            Some(path) => path.to_owned(),
            None => {
                free_path(&scenario.name, scenario.run.seed).map_err(MissionError::LogDirectory)?
            }
        };
        match LogWriter::create(&path, &options, &manifest) {
            // Another run took the path at the same moment: try the next one.
            Err(LogWriteError::Exists { .. } | LogWriteError::InUse { .. })
                if log.path.is_none() => {}
            result => return Ok(result?),
        }
    }
}

/// Returns a free path in `logs/`: `<scenario>-<seed>.mcap`, or with a number appended.
///
/// Two runs may select the same path at the same moment. The recorder creates the file exclusively, and the other
/// run tries again.
fn free_path(scenario: &str, seed: u64) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(DIRECTORY)?;
    let stem = format!("{scenario}-{seed}");
    for n in 1..1_000_000_u32 {
        let name = if n == 1 {
            format!("{stem}.mcap")
        } else {
            format!("{stem}-{n}.mcap")
        };
        let path = Path::new(DIRECTORY).join(name);
        if presence::entry(&path)?.is_none() {
            return Ok(path);
        }
    }
    Err(std::io::ErrorKind::AlreadyExists.into())
}

/// Returns the metadata of the log.
fn manifest(scenario: &ResolvedScenario, run: &RunInfo, plan: &Plan) -> Manifest {
    let toml = scenario.to_toml();
    let entries = BTreeMap::from([
        ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("scenario".to_owned(), scenario.name.clone()),
        (
            "scenario_blake3".to_owned(),
            blake3::hash(toml.as_bytes()).to_hex().to_string(),
        ),
        ("seed".to_owned(), scenario.run.seed.to_string()),
        (
            "tick_period_ns".to_owned(),
            plan.run.tick_period_ns.to_string(),
        ),
        (
            "mode".to_owned(),
            report::mode_name(scenario.run.mode).to_owned(),
        ),
        (
            "robots".to_owned(),
            names(plan.run.robots.iter().map(|r| r.name.as_str())),
        ),
        (
            "processes".to_owned(),
            names(run.processes.iter().map(|p| p.name.as_str())),
        ),
        ("machine".to_owned(), platform::machine::machine()),
    ]);
    Manifest {
        entries,
        attachments: vec![
            ManifestFile {
                name: Origin::SCENARIO.into(),
                media_type: "application/toml".into(),
                data: toml.into_bytes(),
            },
            ManifestFile {
                name: Origin::RUN.into(),
                media_type: "application/json".into(),
                data: serde_json::to_vec(run).unwrap_or_default(),
            },
        ],
    }
}

/// Returns the description of the run, without what only readers of a log need.
pub(super) fn run_info(scenario: &ResolvedScenario, plan: &Plan) -> RunInfo {
    RunInfo {
        processes: processes(plan),
        robots: robots(plan),
        obstacles: scenario.obstacle_names(),
        tick_period_ns: plan.run.tick_period_ns,
        wall_period_ns: (scenario.run.mode == Mode::RealTime).then(|| {
            let factor = scenario.run.real_time_factor.max(1e-3);
            (plan.run.tick_period_ns as f64 / factor) as u64
        }),
        fields_of_view: Vec::new(),
        tasks: Vec::new(),
        patrols: patrols(scenario),
        links: plan
            .launches
            .iter()
            .flat_map(|l| l.config.links.clone())
            .collect(),
        seed: plan.run.seed,
    }
}

/// Returns the contours that robots patrol.
fn patrols(scenario: &ResolvedScenario) -> Vec<PatrolInfo> {
    let world = &scenario.world;
    let drivers = scenario.processes.iter();
    let patrols = drivers.flat_map(|process| {
        process.robots.iter().filter_map(|&robot| {
            let team = scenario.companions(robot);
            // Its first robot stands for all.
            let is_first = team.first() == Some(&robot);
            let kind = process.program.kind().filter(|_| is_first)?;
            let sketch = kind.sketch(world.robots.get(robot)?, &world.map);
            let is_patrol = sketch.graph.is_some() || !sketch.contour.is_empty();
            is_patrol.then(|| PatrolInfo {
                robots: team.into_iter().map(|robot| robot as u32).collect(),
                contour: sketch.contour,
                graph: sketch.graph,
            })
        })
    });
    patrols.collect()
}

/// Returns the tasks with a geometry.
fn tasks(scenario: &ResolvedScenario) -> Vec<TaskInfo> {
    let world = &scenario.world;
    let tasks = scenario.processes.iter().flat_map(|process| {
        let robots = process.robots.iter();
        robots.filter_map(|&robot| {
            let kind = process.program.kind()?;
            let sketch = kind.sketch(world.robots.get(robot)?, &world.map);
            let is_drawn = sketch != TaskSketch::default();
            is_drawn.then_some(TaskInfo {
                robot: robot as u32,
                sketch,
            })
        })
    });
    tasks.collect()
}

/// Returns all senders: the processes and the orchestrator.
fn processes(plan: &Plan) -> Vec<ProcessInfo> {
    let mut processes: Vec<ProcessInfo> = plan
        .launches
        .iter()
        .enumerate()
        .map(|(index, launch)| ProcessInfo {
            index: index as u32,
            name: launch.config.name.clone(),
            // Each external program is a kind of its own.
            kind: match launch.executable() {
                Executable::Kind(kind) => kind,
                Executable::Command { .. } => launch.config.name.clone(),
            },
            upstream: launch.config.upstream.clone(),
        })
        .collect();
    processes.push(ProcessInfo {
        index: plan.orchestrator_index(),
        name: "orchestrator".into(),
        kind: "orchestrator".into(),
        upstream: Vec::new(),
    });
    processes
}

/// Returns the robots for the recorder.
fn robots(plan: &Plan) -> Vec<RobotInfo> {
    let robots = plan.run.robots.iter().zip(0..);
    robots
        .map(|(r, index)| RobotInfo {
            name: r.name.clone(),
            team: r.team.clone(),
            radius: r.model.radius,
            visits_waypoints: plan.visits_waypoints(index),
            lap_limit_s: plan.lap_limit_s(index),
        })
        .collect()
}

fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tasks_with_a_geometry_are_described() {
        let tasks_of = |name: &str| tasks(&kinds::load(name, &[], None).unwrap());
        let [patrol] = &tasks_of("patrol_square")[..] else {
            panic!("one robot has a contour");
        };
        assert!(patrol.robot == 0 && patrol.sketch.contour.len() > 3);
        assert!(
            !tasks_of("coverage_polygons")[0]
                .sketch
                .rectangles
                .is_empty()
        );
        assert_eq!(tasks_of("chase"), []);
    }
}
