//! The log of a run and the thread that writes it.

use std::collections::BTreeMap;
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::JoinHandle;

use ipc_types::bus::Bus;
use runtime::lockstep::Overseer;

use super::error::MissionError;
use super::gate::{Calls, PageGate};
use super::plan::Plan;
use super::progress::EventPrinter;
use super::resources::RunResources;
use super::run::MissionOptions;
use super::{log_path, report};
use crate::eyes;
use crate::recorder::{
    Beginnings, Compression, LogError, LogOptions, Manifest, ManifestFile, Mirror, ProcessInfo,
    Recorder, RecorderError, RecorderOptions, Recording, RobotInfo, Summary, ViewerOptions,
};
use crate::scenario::ResolvedScenario;
use crate::scenario::spec;

/// Begins to record a run, into a log if one is wanted.
///
/// # Errors
/// As [`create_log`].
pub(crate) fn create(
    scenario: &ResolvedScenario,
    plan: &Plan,
    options: &MissionOptions,
    beginnings: Arc<Beginnings>,
    mirror: Option<Box<dyn Mirror>>,
) -> Result<Recording, MissionError> {
    if options.without_log {
        let period = plan.run.tick_period_ns;
        let (processes, robots) = (processes(plan), robots(plan));
        return Ok(Recording::without_log(
            &processes, &robots, period, beginnings,
        ));
    }
    create_log(scenario, plan, options, mirror)
}

/// Creates the log. Without a name of its own it takes the first free one, also when another run
/// takes names at the same time.
fn create_log(
    scenario: &ResolvedScenario,
    plan: &Plan,
    options: &MissionOptions,
    mut mirror: Option<Box<dyn Mirror>>,
) -> Result<Recording, MissionError> {
    let mut recorder = recorder_options(scenario, plan, options);
    loop {
        recorder.path = match &options.out {
            Some(path) => path.clone(),
            None => log_path::free_path(&scenario.name, scenario.run.seed).map_err(|source| {
                MissionError::System {
                    what: "cannot make the directory logs".into(),
                    source,
                }
            })?,
        };
        match Recording::create_mirrored(&recorder, &mut mirror) {
            // Another run took the name at the same moment: take the next.
            Err(LogError::Exists { .. } | LogError::InUse { .. }) if options.out.is_none() => {}
            result => return Ok(result?),
        }
    }
}

fn recorder_options(
    scenario: &ResolvedScenario,
    plan: &Plan,
    options: &MissionOptions,
) -> RecorderOptions {
    let toml = scenario.to_toml();
    let processes = processes(plan);
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
            names(processes.iter().map(|p| p.name.as_str())),
        ),
        ("machine".to_owned(), report::machine()),
    ]);
    RecorderOptions {
        path: PathBuf::new(),
        log: LogOptions {
            compression: match scenario.log.compression {
                spec::Compression::Zstd => LogOptions::default().compression,
                spec::Compression::None => Compression::None,
            },
            force: options.force,
            ..LogOptions::default()
        },
        manifest: Manifest {
            entries,
            attachments: vec![ManifestFile {
                name: "scenario.toml".into(),
                media_type: "application/toml".into(),
                data: toml.into_bytes(),
            }],
        },
        processes,
        robots: robots(plan),
        tick_period_ns: plan.run.tick_period_ns,
        viewer: ViewerOptions {
            rate_hz: scenario.log.viewer_rate_hz,
            ..ViewerOptions::default()
        },
        obstacles: plan.standing.clone(),
        eyes: eyes::of_scenario(scenario),
    }
}

/// Everybody who sends: the processes and the orchestrator.
pub(crate) fn processes(plan: &Plan) -> Vec<ProcessInfo> {
    let mut processes: Vec<ProcessInfo> = plan
        .launches
        .iter()
        .enumerate()
        .map(|(index, launch)| ProcessInfo {
            index: index as u32,
            name: launch.config.name.clone(),
            kind: launch.config.kind.clone(),
            reads_beliefs: plan.reads_beliefs(index),
        })
        .collect();
    processes.push(ProcessInfo {
        index: plan.orchestrator_index(),
        name: "orchestrator".into(),
        kind: "orchestrator".into(),
        reads_beliefs: false,
    });
    processes
}

/// The robots as the recorder knows them.
pub(crate) fn robots(plan: &Plan) -> Vec<RobotInfo> {
    let robots = plan.run.robots.iter().zip(0..);
    robots
        .map(|(r, index)| RobotInfo {
            name: r.name.clone(),
            radius: r.model.radius,
            visits_waypoints: plan.visits_waypoints(index),
        })
        .collect()
}

fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(",")
}

/// The recorder and its thread.
pub(super) struct RecorderThread {
    thread: JoinHandle<Result<Summary, RecorderError>>,
    connect: mpsc::Sender<()>,
    connected: mpsc::Receiver<()>,
    /// Set once nobody sends any more.
    ended: Arc<AtomicBool>,
    /// Readable when the thread has ended.
    pub(super) wake: OwnedFd,
}

impl RecorderThread {
    /// Starts the thread, which answers `calls`; returns once its subscriptions stand.
    ///
    /// # Errors
    /// [`MissionError`] if the system refuses.
    pub(super) fn start(
        resources: &RunResources,
        calls: Arc<Calls>,
        recording: Recording,
        mut printer: EventPrinter,
    ) -> Result<Self, MissionError> {
        let run = &resources.plan.run;
        let system = |what: &str| {
            let what = what.to_owned();
            move |source: std::io::Error| MissionError::System { what, source }
        };
        let (wake, ended_end) = rustix::pipe::pipe_with(rustix::pipe::PipeFlags::CLOEXEC)
            .map_err(|e| system("cannot make a pipe")(e.into()))?;
        let (connect, do_connect) = mpsc::channel();
        let (tell, connected) = mpsc::channel();
        let ended = Arc::new(AtomicBool::new(false));
        let gate = PageGate::new(
            Overseer::new(Arc::clone(&resources.page)),
            run.clock,
            Arc::clone(&ended),
            Arc::clone(&calls),
        );
        let (space, bus_options) = (run.space()?, run.bus_options());
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                // Closed when the thread ends, however it ends: that wakes the supervisor.
                let _wake = ended_end;
                // The ports of the bus belong to the thread that opened them.
                let bus =
                    Bus::join(&space, bus_options, "recorder").map_err(RecorderError::Subscribe)?;
                let recorder = Recorder::open(&bus, recording)?;
                let _ = tell.send(());
                // Both channels end when the run ends before it began.
                if do_connect.recv().is_ok() {
                    recorder.update_connections()?;
                }
                let _ = tell.send(());
                calls.open(true);
                let recorded = recorder.run(&gate, &mut printer);
                calls.open(false);
                recorded
            })
            .map_err(system("cannot start the recorder's thread"))?;
        let recorder = Self {
            thread,
            connect,
            connected,
            ended,
            wake,
        };
        // Its subscriptions must stand before anybody sends.
        let _ = recorder.connected.recv();
        Ok(recorder)
    }

    /// Whether the thread has ended; why is in its result.
    pub(super) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Connects to all publishers, which exist by now.
    pub(super) fn connect(&self) {
        let _ = self.connect.send(());
        let _ = self.connected.recv();
    }

    /// Says that nobody sends any more, and waits for the summary.
    ///
    /// # Errors
    /// What the recorder failed with.
    pub(super) fn finish(self) -> Result<Summary, MissionError> {
        self.ended.store(true, Ordering::SeqCst);
        drop(self.connect);
        match self.thread.join() {
            Ok(result) => Ok(result?),
            Err(_) => Err(MissionError::RecorderLost),
        }
    }
}
