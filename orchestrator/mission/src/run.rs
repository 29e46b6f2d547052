//! Starting, supervising and ending the processes of a run.

use std::os::fd::AsFd as _;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::bus::{Publisher, PublisherOptions};
use ipc_types::messages::process::RunControl;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Control, ObstacleEvents};
use runtime::config::Clock;
use runtime::lockstep::BarrierMonitor;
use viewer::{LiveOptions, LiveServer, Wish};

use super::error::MissionError;
use super::process_log::{ProcessEventLog, remark_lines};
use super::progress::Progress;
use super::recorder_thread::{DrainRequests, RecorderThread};
use super::recording::{self, LogFile};
use super::report::MissionReport;
use super::resources::RunResources;
use super::shm_usage;
use super::supervisor::Supervisor;
use super::team_colours;
use scenario::{ResolvedScenario, ScenarioRemark};

/// Options of a run.
#[derive(Debug, Clone, Default)]
pub struct MissionOptions {
    /// Path of the log; default `logs/<scenario>-<seed>.mcap`.
    pub out: Option<PathBuf>,
    /// `true` if an existing log may be overwritten.
    pub force: bool,
    /// `true` to write no log; the summary is the same except the path of the log.
    pub without_log: bool,
    /// `true` to show errors only.
    pub quiet: bool,
    /// Minimum severity of the processes' log lines.
    pub log_level: String,
    /// The live server, if requested. It needs a log, since viewers get the messages that are written to the log.
    pub live: Option<LiveOptions>,
    /// Maximum speed of a run in lock-step (simulated s/s); without it the run is as fast as possible. Its history
    /// stays the same.
    pub pace: Option<f64>,
    /// Remarks for the log ([`ResolvedScenario::remarks`]).
    pub remarks: Vec<ScenarioRemark>,
    /// Tick after which the run ends in order, if it is not over earlier; some more ticks may follow.
    pub last_tick: Option<u64>,
    /// Set by the caller (Ctrl-C) to end the run in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Runs a scenario to its end.
///
/// # Errors
/// [`MissionError`]. The log contains all messages up to the error. No process, shared memory or directory of the
/// run remains.
///
/// ```no_run
/// use mission::{MissionOptions, run};
///
/// fn main() -> Result<(), Box<dyn std::error::Error>> {
///     let scenario = scenario::Loader::new(kinds::KINDS).load("hello", &[], None)?;
///     let report = run(&scenario, &MissionOptions::default())?;
///     println!("{} ticks", report.summary.ticks);
///     Ok(())
/// }
/// ```
pub fn run(
    scenario: &ResolvedScenario,
    options: &MissionOptions,
) -> Result<MissionReport, MissionError> {
    let start = Instant::now();
    let log_level = if options.log_level.is_empty() {
        "warn"
    } else {
        options.log_level.as_str()
    };
    let live = options.live.map(LiveServer::start).transpose()?;
    let resources = Rc::new(RunResources::create(scenario, log_level, |bus| bus)?);
    let monitor = BarrierMonitor::new(Arc::clone(&resources.barrier));
    monitor.pace(options.pace.unwrap_or(f64::INFINITY), false, 0);
    let mirror = live.as_ref().map(|live| Box::new(live.tap()) as _);
    // A map in shared memory never has digest prefixes of another run.
    let log = (!options.without_log).then_some(LogFile {
        path: options.out.as_deref(),
        force: options.force,
        quiet: options.quiet,
        source: None,
    });
    let recording = recording::create(scenario, &resources.plan, log, Arc::default(), mirror)?;
    if let (Some(live), Some(path)) = (&live, recording.log_path()) {
        live.show(path, false);
    }
    let progress = Progress::new(scenario.world.rules.time_limit, options.quiet);
    let names = recording::run_info(scenario, &resources.plan).event_names();
    let printer = progress.events(names, team_colours(scenario), options.quiet);

    let requests = Arc::<DrainRequests>::default();
    let hang_timeout = Duration::from_secs_f64(scenario.run.hang_timeout_s);
    let launches = resources.plan.launches.clone();
    let event_log = ProcessEventLog::open(&resources, Arc::clone(&requests))?;
    for line in remark_lines(&resources.plan, &options.remarks) {
        // Without room a remark is missing in the log, as a line of a process is.
        let _ = event_log.line_sender().try_send(line);
    }
    let mut supervisor = Supervisor::new(
        Rc::clone(&resources),
        launches,
        hang_timeout,
        !options.quiet,
    )
    .with_log(event_log);
    let recorder = RecorderThread::start(&resources, requests, recording, printer)?;
    let mut active = ActiveRun {
        resources: &resources,
        interrupted: &options.interrupted,
        last_tick: options.last_tick,
        recorder: &recorder,
        live: live.as_ref(),
        monitor,
        wish: None,
        progress,
        start,
        first_tick: None,
    };
    let ended = active.execute(&mut supervisor);
    let first_tick = active.first_tick;
    let wall_time_s = first_tick.map_or(0.0, |first| first.elapsed().as_secs_f64());
    let start_up_s = first_tick.map_or(0.0, |first| (first - start).as_secs_f64());
    supervisor.stop();
    active.progress.finish();
    let recorded = recorder.finish();
    let has_failures = supervisor.has_failures();
    // Dropped only after the recorder has received its last messages.
    drop(supervisor);
    drop(resources);
    // A failure of the recorder is the cause of other failures, not their consequence.
    let mut summary = recorded?;
    if first_tick.is_none() && !options.without_log {
        // No tick has happened: remove the empty log.
        let _ = std::fs::remove_file(&summary.log);
        summary.log = PathBuf::new();
    }
    let interrupted = ended? == EndCause::Interrupted;
    let live = live.map(|live| live.finish(&options.interrupted));
    Ok(MissionReport {
        summary,
        wall_time_s,
        start_up_s,
        interrupted,
        has_failures,
        live,
    })
}

/// Cause of the end of a run without failures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EndCause {
    /// The game is over, its last tick is done, or the recorder has ended; its result contains the cause.
    Over,
    /// The caller interrupted the run.
    Interrupted,
}

/// A run in progress.
struct ActiveRun<'a> {
    resources: &'a RunResources,
    interrupted: &'a AtomicBool,
    last_tick: Option<u64>,
    recorder: &'a RecorderThread,
    live: Option<&'a LiveServer>,
    monitor: BarrierMonitor,
    /// The last wish of pages.
    wish: Option<Wish>,
    progress: Progress,
    start: Instant,
    first_tick: Option<Instant>,
}

impl ActiveRun<'_> {
    /// Executes the run from the start of its processes to the end of the game.
    fn execute(&mut self, supervisor: &mut Supervisor) -> Result<EndCause, MissionError> {
        let (bus, plan) = (&self.resources.bus, &self.resources.plan);
        let options = PublisherOptions::new(plan.orchestrator_index(), 1);
        let control: Publisher<Control> = bus.publisher(options)?;
        let obstacles: Publisher<ObstacleEvents> = bus.publisher(options)?;
        supervisor.start()?;
        if !supervisor.open(self.interrupted)? || !supervisor.connect(self.interrupted)? {
            return Ok(EndCause::Interrupted);
        }
        control.update_connections()?;
        obstacles.update_connections()?;
        self.recorder.connect();
        plan.send_obstacle_changes(&obstacles)?;
        if !supervisor.prepare(self.interrupted)? {
            return Ok(EndCause::Interrupted);
        }
        let rate = match plan.run.clock {
            Clock::LockStep => 0.0,
            Clock::RealTime { factor, .. } => factor,
        };
        let order = RunControl {
            rate,
            command: RunControl::START,
            ..RunControl::default()
        };
        control.send(PlainHeader::default(), &[order])?;
        tracing::info!(
            "first tick {:.3} s after the start",
            self.start.elapsed().as_secs_f64()
        );
        self.first_tick = Some(Instant::now());
        supervisor.begin();
        self.supervise(supervisor)
    }

    /// Supervises the run until the game is over, the run is interrupted, or a process fails.
    fn supervise(&mut self, supervisor: &mut Supervisor) -> Result<EndCause, MissionError> {
        let barrier = &self.resources.barrier;
        loop {
            let wish = self
                .live
                .and_then(LiveServer::control)
                .map(viewer::Control::wish);
            if let Some(wish) = wish.filter(|_| wish != self.wish) {
                self.monitor.pace(wish.pace, wish.is_paused, wish.steps);
                self.wish = Some(wish);
            }
            let ticks = barrier.ticks_posted();
            let over = barrier.is_over();
            let tick_period = self.resources.plan.run.tick_period();
            self.progress.at(ticks as f64 * tick_period);
            // The last tick is done when another one is posted.
            let is_enough = self
                .last_tick
                .is_some_and(|last| ticks > last.saturating_add(1));
            if over || is_enough || self.recorder.is_finished() {
                return Ok(EndCause::Over);
            }
            // Checked first: full shared memory is then the cause of a process's end.
            shm_usage::check()?;
            supervisor.handle_events()?;
            if self.interrupted.load(Ordering::SeqCst) {
                return Ok(EndCause::Interrupted);
            }
            supervisor.sleep(self.recorder.wake.as_fd());
        }
    }
}
