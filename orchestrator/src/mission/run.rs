//! Starting, supervising and ending the processes of a run.

use platform::eprintln;
use std::io::Write as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, BusError, Publisher, PublisherOptions, TopicHolder};
use ipc_types::messages::process::RunControl;
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{
    Control, ObstacleEvents, OptimiserPlan, PLAN_ANSWERED_EVENT, PLAN_ASKED_EVENT, Topic,
    TopicVisitor, for_each_topic,
};
use runtime::config::{Clock, ProcessConfig};
use runtime::lockstep::{Overseer, Phase, SlotState, TurnPage};

use super::bridge::Bridge;
use super::children::sleep_until_exit;
use super::decide::Event;
use super::error::MissionError;
use super::plan::Plan;
use super::progress::Progress;
use super::recording::{self, RecorderThread};
use super::room;
use super::spaces::{self, OwnedSpace};
use super::supervisor::Supervisor;
use crate::live::{LiveServer, LiveTotals};
use crate::recorder::Summary;
use crate::scenario::ResolvedScenario;

/// Time that processes have to end by themselves when the run stops.
const END_WITHIN: Duration = Duration::from_secs(3);
/// Beat of the supervisor: progress is shown and silence noticed this often. The end of a process
/// wakes it at once.
const BEAT: Duration = Duration::from_millis(10);
/// Its beat while somebody is awaited, at the start or after a failure.
const QUICK_BEAT: Duration = Duration::from_millis(2);

/// How a run is done.
#[derive(Debug, Clone, Default)]
pub struct MissionOptions {
    /// Where the log goes; `logs/<scenario>-<seed>.mcap` if not said.
    pub out: Option<PathBuf>,
    /// Whether an existing log may be overwritten.
    pub force: bool,
    /// Whether no log is kept: the summary is the same, but for its log.
    pub without_log: bool,
    /// Whether nothing but errors is shown.
    pub quiet: bool,
    /// Least severe level that the processes log.
    pub log_level: String,
    /// Port on which live viewers are served, if they are; 0 is any that is free. There must be a
    /// log: viewers see what goes into it.
    pub live: Option<u16>,
    /// Simulated seconds per second that a run in lock-step keeps to; as fast as it can without.
    /// Its history stays the same.
    pub pace: Option<f64>,
    /// Set from outside (Ctrl-C) to end the run in order.
    pub interrupted: Arc<AtomicBool>,
}

/// How a run went.
#[derive(Debug, Clone)]
pub struct MissionReport {
    /// What the log holds.
    pub summary: Summary,
    /// Real time from the first tick to the last [s].
    pub wall_time_s: f64,
    /// Real time from the call to the first tick [s].
    pub start_up_s: f64,
    /// Whether it was ended from outside.
    pub interrupted: bool,
    /// Whether a process failed and the run went on.
    pub has_lost: bool,
    /// What live viewers got, if they were served.
    pub live: Option<LiveTotals>,
}

/// Runs a scenario to its end.
///
/// # Errors
/// [`MissionError`]; the log holds everything up to then, and no process, shared memory or
/// directory of the run remains.
pub fn run(
    scenario: &ResolvedScenario,
    options: &MissionOptions,
) -> Result<MissionReport, MissionError> {
    let start = Instant::now();
    // What a killed orchestrator left behind goes now; a failure to do so concerns this run only
    // if it cannot have a directory of its own, which is said below.
    let _ = spaces::clean();
    room::check_start()?;
    let space = OwnedSpace::create()?;
    let log_level = if options.log_level.is_empty() {
        "warn"
    } else {
        options.log_level.as_str()
    };
    let live = options.live.map(LiveServer::start).transpose()?;
    if let Some(live) = &live {
        // Shown however quiet the run is: without it nobody can look.
        eprintln!("live: {}", live.url());
    }
    let mut plan = Plan::new(
        scenario,
        space.space().root(),
        space.space().prefix(),
        log_level,
    )?;
    if let Some(pace) = options.pace {
        plan.keep_pace(pace);
    }
    let mirror = live.as_ref().map(|live| Box::new(live.tap()) as _);
    // Maps in shared memory are never known from another run.
    let recording = recording::create(scenario, &plan, options, Arc::default(), mirror)?;

    let bus = Bus::join(space.space(), plan.run.bus_options(), "orchestrator")?;
    let services = create_services(&bus, &plan)?;
    let page = Arc::new(TurnPage::create(
        space.space().prefix(),
        plan.launches.len(),
    )?);
    let overseer = Overseer::new(Arc::clone(&page));
    for (slot, launch) in plan.launches.iter().enumerate() {
        overseer.seat(slot, slot != 0, launch.watched);
    }

    let progress = Progress::new(scenario.world.rules.time_limit, options.quiet);
    let robots = scenario
        .world
        .robots
        .iter()
        .map(|r| r.name.clone())
        .collect();
    let printer = progress.events(robots, options.quiet);
    let recorder = RecorderThread::start(&plan, &overseer, recording, printer)?;

    let bridge = Bridge::start(&plan, &bus, &page)?;

    let mut flight = Flight {
        plan: &plan,
        options,
        overseer,
        bus: &bus,
        supervisor: None,
        recorder,
        bridge,
        progress,
        // A tick that is not due is no silence.
        hang_timeout: Duration::from_secs_f64(
            scenario.run.hang_timeout_s
                + options
                    .pace
                    .map_or(0.0, |pace| 2.0 * scenario.run.dt / pace),
        ),
        start,
        first_tick: None,
        interrupted: false,
    };
    let flown = flight.fly(&space);
    let first_tick = flight.first_tick;
    let wall_time_s = first_tick.map_or(0.0, |first| first.elapsed().as_secs_f64());
    let start_up_s = first_tick.map_or(0.0, |first| (first - start).as_secs_f64());
    let interrupted = flight.interrupted;
    let (recorded, has_lost) = flight.land();
    let live = live.map(LiveServer::finish);
    drop(services);
    drop(space);
    // A failed recorder is the cause rather than the consequence of anything else.
    let mut summary = recorded?;
    if first_tick.is_none() && !options.without_log {
        // Nothing happened: a log without a tick would only look like a run.
        let _ = std::fs::remove_file(&summary.log);
        summary.log = PathBuf::new();
    }
    flown?;
    Ok(MissionReport {
        summary,
        wall_time_s,
        start_up_s,
        interrupted,
        has_lost,
        live,
    })
}

/// Creates the services of all topics, and those for plans if somebody makes them.
pub(crate) fn create_services(bus: &Bus, plan: &Plan) -> Result<Vec<TopicHolder>, BusError> {
    struct Create<'a>(&'a Bus, Vec<TopicHolder>);
    impl TopicVisitor for Create<'_> {
        type Error = BusError;
        fn visit<T: Topic>(&mut self) -> Result<(), BusError> {
            self.1.push(self.0.create::<T>()?);
            Ok(())
        }
    }
    let mut create = Create(bus, Vec::new());
    for_each_topic(&mut create)?;
    if plan.serves_plans() {
        create.1.push(bus.create_service::<OptimiserPlan>()?);
        create.1.push(bus.create_event(PLAN_ASKED_EVENT)?);
        create.1.push(bus.create_event(PLAN_ANSWERED_EVENT)?);
    }
    Ok(create.1)
}

/// A run in the air.
struct Flight<'a> {
    plan: &'a Plan,
    options: &'a MissionOptions,
    overseer: Overseer,
    bus: &'a Bus,
    supervisor: Option<Supervisor<'a>>,
    recorder: RecorderThread,
    bridge: Bridge,
    progress: Progress,
    hang_timeout: Duration,
    start: Instant,
    first_tick: Option<Instant>,
    interrupted: bool,
}

impl<'a> Flight<'a> {
    /// From the first process to the end of the game.
    fn fly(&mut self, space: &'a OwnedSpace) -> Result<(), MissionError> {
        let control: Publisher<Control> = self.bus.publisher(self.publisher(1))?;
        let obstacles: Publisher<ObstacleEvents> = self.bus.publisher(self.publisher(1))?;
        let mut supervisor = Supervisor::new(
            self.plan,
            space,
            self.bus,
            self.overseer.clone(),
            self.hang_timeout,
            Arc::clone(&self.recorder.calls),
            self.options,
        )?;
        let started = supervisor.start();
        // Whatever came of it: those who were started are ended with the run.
        let supervisor = self.supervisor.insert(supervisor);
        started?;
        let flight = (&self.overseer, self.options, &mut self.interrupted);
        let (overseer, options, interrupted) = flight;
        let mut wait = |supervisor: &mut Supervisor<'_>, state: SlotState| {
            wait_until(supervisor, state, options, interrupted)
        };
        if !wait(supervisor, SlotState::Ready)? {
            return Ok(());
        }
        overseer.set_phase(Phase::Connect);
        if !wait(supervisor, SlotState::Connected)? {
            return Ok(());
        }
        control.update_connections()?;
        obstacles.update_connections()?;
        supervisor.connect()?;
        self.recorder.connect();
        for replay in &self.plan.replays {
            let mut header = PlainHeader::default();
            header.stamp.tick = replay.tick;
            header.stamp.time_ns = replay.tick * self.plan.run.tick_period_ns;
            obstacles.send(header, &[replay.event])?;
        }
        overseer.set_phase(Phase::Prepare);
        if !wait(supervisor, SlotState::Prepared)? {
            return Ok(());
        }
        let rate = match self.plan.run.clock {
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
        overseer.set_phase(Phase::Run);
        self.supervise()
    }

    fn publisher(&self, capacity: usize) -> PublisherOptions {
        PublisherOptions::new(self.plan.orchestrator_index(), capacity)
    }

    /// Watches the run until the game is over, the run is interrupted, or something fails.
    fn supervise(&mut self) -> Result<(), MissionError> {
        let Some(supervisor) = &mut self.supervisor else {
            return Ok(());
        };
        loop {
            let page = self.overseer.page();
            let ticks = page.ticks_posted();
            let over = page.is_over();
            self.progress.at(ticks as f64 * self.plan.run.tick_period());
            if over {
                return Ok(());
            }
            if self.recorder.is_finished() {
                // Why is in the thread's result.
                return Ok(());
            }
            // First: who has died of it is not to blame.
            room::check()?;
            supervisor.attend(&self.bridge)?;
            if is_interrupted(self.options, &mut self.interrupted) {
                return Ok(());
            }
            let beat = if supervisor.is_expecting() {
                QUICK_BEAT
            } else {
                BEAT
            };
            sleep_until_exit(&supervisor.processes, Some(&self.recorder.wake), beat);
        }
    }

    /// Ends everything and collects what was recorded; whether processes were lost on the way.
    fn land(mut self) -> (Result<Summary, MissionError>, bool) {
        self.overseer.set_phase(Phase::Stop);
        if let Some(supervisor) = &mut self.supervisor {
            supervisor.end(END_WITHIN);
        }
        if let Err(error) = self.bridge.finish() {
            tracing::warn!("bridge to external processes: {error}");
        }
        self.progress.finish();
        let recorded = self.recorder.finish();
        // Kept until the recorder has taken what it said last.
        let has_lost = self.supervisor.is_some_and(|s| s.has_lost());
        (recorded, has_lost)
    }
}

fn is_interrupted(options: &MissionOptions, interrupted: &mut bool) -> bool {
    *interrupted |= options.interrupted.load(Ordering::SeqCst);
    *interrupted
}

/// Waits until every process is at least this far; false if the run is interrupted.
fn wait_until(
    supervisor: &mut Supervisor<'_>,
    wanted: SlotState,
    options: &MissionOptions,
    interrupted: &mut bool,
) -> Result<bool, MissionError> {
    let start = Instant::now();
    loop {
        let behind = supervisor.behind(wanted);
        // First: who has died of it is not to blame.
        room::check_start()?;
        supervisor.check_ends()?;
        let Some((slot, patience)) = behind else {
            return Ok(true);
        };
        if is_interrupted(options, interrupted) {
            return Ok(false);
        }
        if start.elapsed() >= patience {
            supervisor.happened(slot, Event::NotReady)?;
        }
        // Processes say how far they are on the page; a few milliseconds are nothing against
        // what starting a process takes.
        sleep_until_exit(&supervisor.processes, None, QUICK_BEAT);
    }
}

/// Where the configuration of a process lies. Process names may hold anything: the index makes the
/// file's name.
pub(crate) fn config_path(root: &Path, config: &ProcessConfig) -> PathBuf {
    root.join(format!("process-{}.json", config.index))
}

/// Writes the configuration of a process, for the current user only.
pub(crate) fn write_config(root: &Path, config: &ProcessConfig) -> Result<PathBuf, MissionError> {
    let path = config_path(root, config);
    let failed = |source| MissionError::System {
        what: format!("{}", path.display()),
        source,
    };
    let mut file = std::fs::OpenOptions::new()
        .create_new(true)
        .write(true)
        .mode(0o600)
        .open(&path)
        .map_err(failed)?;
    let text = serde_json::to_vec(config).map_err(|e| failed(e.into()))?;
    file.write_all(&text).map_err(failed)?;
    Ok(path)
}
