//! Lock-step ticks per second of eight trivial planner processes: the runtime against bare iceoryx2
//! and a bare futex barrier.
//!
//! Both exchange messages of the same size in the same way: publish the state, post the tick, wait
//! for all, receive eight commands. Both sets of processes live all the time and sleep while the
//! other set runs, so that short blocks can alternate: A B A B.

mod raw;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::link::pin;
use crate::spread::{Spread, paired_ratio};
use geometry::pose::Pose2;
use ipc_types::bus::{Bus, Publisher, PublisherOptions, Subscriber, TopicHolder};
use ipc_types::messages::robot::Command;
use ipc_types::messages::world::{RobotState, WorldHeader};
use ipc_types::stamp::PlainHeader;
use ipc_types::topics::{Commands, Status, WorldState};
use mission::child_process::Executable;
use mission::process_group::ProcessGroup;
use mission::run_directory::RunDirectory;
use robot::spec::Preset;
use robot::team::Role;
use runtime::config::{Clock, ProcessConfig, RobotInfo, RunConfig, document};
use runtime::declaration::{Declaration, Input, Output};
use runtime::inputs::{StateInput, reply_stamp};
use runtime::lockstep::{BarrierLeader, BarrierMonitor, Phase, SlotState, TickBarrier, TickEnd};
use runtime::{Process, ProcessError, ProcessKind};
use serde::Serialize;

pub use self::raw::planner as raw_planner;
use self::raw::{PLANNERS, RawConfig, RawLeader};
use super::report::{Figure, Goal};
use super::{Options, Result, say};

/// Kind of the processes over the runtime.
pub const RUNTIME_PLANNER: &str = "bench-planner";
pub const RAW_PLANNER: &str = "raw-planner";

const ITEM: &str = "ticks";
/// Minimum share of the raw exchange's speed.
const GOAL: f64 = 0.8;
/// Time limit for each step of the planners' start.
const READY_WITHIN: Duration = Duration::from_secs(10);
/// Time limit for the ticks before the measurement.
const WARM_UP_WITHIN: Duration = Duration::from_secs(10);
/// Number of ticks before the measurement.
const WARM_UP: u32 = 200;
/// Ticks between two readings of the clock.
const BATCH: u32 = 16;

/// Measures on all processors, then with everything pinned to one.
///
/// # Errors
/// The operation that failed, or the process that ended.
pub fn measure(options: Options) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (name, pinned) in [("all processors", false), ("one processor", true)] {
        say(&format!(
            "lock-step with {PLANNERS} trivial planners, {name}"
        ));
        // The processes inherit the processors of the thread that starts them.
        let joined = std::thread::scope(|scope| {
            let work = || -> Result<_> {
                if pinned {
                    pin(0)?;
                }
                alternate(options)
            };
            scope.spawn(work).join()
        });
        let (runtime, raw) = joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        let (Some(value), Some(baseline), Some(ratio)) = (
            Spread::from_values(runtime.iter().copied()),
            Spread::from_values(raw.iter().copied()),
            paired_ratio(&runtime, &raw),
        ) else {
            continue;
        };
        figures.push(
            Figure::new(
                ITEM,
                format!("{PLANNERS} planners, {name}"),
                value,
                "ticks/s",
            )
            .against("raw iceoryx2 + futex", baseline.median)
            .with_ratio(ratio.median)
            .with_goal(Goal::RatioAtLeast(GOAL)),
        );
    }
    Ok(figures)
}

/// Returns rates of the blocks of the runtime and of the raw exchange (ticks/s), pair by pair.
fn alternate(options: Options) -> Result<(Vec<f64>, Vec<f64>)> {
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    // The placement of sixteen processes by the scheduler matters a lot, and seldom changes: take
    // the median over several sets of processes.
    for set in 0..options.repeats(5, 3) {
        // Alternate the order of starting, which may be an advantage.
        alternate_set(options, set % 2 == 0, &mut ours, &mut theirs)?;
    }
    Ok((ours, theirs))
}

/// Like [`alternate`], with one set of processes each.
fn alternate_set(
    options: Options,
    ours_first: bool,
    ours: &mut Vec<f64>,
    theirs: &mut Vec<f64>,
) -> Result<()> {
    let (mut runtime, mut raw);
    if ours_first {
        runtime = RuntimeExchange::start()?;
        raw = RawExchange::start()?;
    } else {
        raw = RawExchange::start()?;
        runtime = RuntimeExchange::start()?;
    }
    let pairs = options.repeats(5, 3);
    let time = Duration::from_millis(if options.quick { 100 } else { 200 });
    let warm_up = Instant::now() + WARM_UP_WITHIN;
    for _ in 0..WARM_UP {
        runtime.tick()?;
        raw.tick()?;
        if Instant::now() > warm_up {
            break;
        }
    }
    for _ in 0..pairs {
        ours.push(rate(time, || runtime.tick())?);
        theirs.push(rate(time, || raw.tick())?);
    }
    Ok(())
}

/// Returns calls per second over at least this time.
fn rate(time: Duration, mut call: impl FnMut() -> Result<()>) -> Result<f64> {
    let start = Instant::now();
    let mut calls = 0_u32;
    loop {
        for _ in 0..BATCH {
            call()?;
        }
        calls += BATCH;
        let elapsed = start.elapsed();
        if elapsed >= time {
            return Ok(f64::from(calls) / elapsed.as_secs_f64());
        }
    }
}

/// Starts a planner of this kind for every configuration.
fn start_planners(
    space: &RunDirectory,
    kind: &str,
    configs: &[impl Serialize],
) -> Result<ProcessGroup> {
    let executable = Executable::Kind(kind.into());
    let mut planners = ProcessGroup::default();
    for (slot, config) in configs.iter().enumerate() {
        let name = format!("{kind}-{slot}");
        planners.start(space.space().root(), &name, &executable, config)?;
    }
    Ok(planners)
}

/// The exchange over the runtime.
struct RuntimeExchange {
    monitor: BarrierMonitor,
    planners: ProcessGroup,
    leader: BarrierLeader,
    state_out: Publisher<WorldState>,
    commands_in: Subscriber<Commands>,
    states: Vec<RobotState>,
    tick: u64,
    _services: Vec<TopicHolder>,
    _bus: Bus,
    _space: RunDirectory,
}

impl RuntimeExchange {
    fn start() -> Result<Self> {
        let space = RunDirectory::create()?;
        let run = run_config(space.space().root(), space.space().prefix());
        let bus = Bus::join(space.space(), run.bus_options(), "bench")?;
        let services = vec![
            bus.create::<WorldState>()?,
            bus.create::<Commands>()?,
            bus.create::<Status>()?,
        ];
        let barrier = Arc::new(TickBarrier::create(space.space().prefix(), PLANNERS + 1)?);
        let monitor = BarrierMonitor::new(Arc::clone(&barrier));
        for slot in 0..=PLANNERS {
            monitor.assign_slot(slot, slot != 0, false);
        }
        let state_out = bus.publisher(PublisherOptions::new(0, PLANNERS))?;
        let commands_in = bus.subscriber()?;
        let configs: Vec<_> = (1..=PLANNERS as u32)
            .map(|index| ProcessConfig {
                run: run.clone(),
                name: format!("bench-{index}"),
                kind: RUNTIME_PLANNER.into(),
                index,
                robots: vec![index - 1],
                upstream: Vec::new(),
                period: 1,
                links: Vec::new(),
            })
            .collect();
        let configs: Vec<_> = configs.iter().map(|c| document(c, ())).collect();
        let planners = start_planners(&space, RUNTIME_PLANNER, &configs)?;
        let mut exchange = Self {
            monitor,
            planners,
            leader: BarrierLeader::new(barrier, 0, usize::MAX),
            state_out,
            commands_in,
            states: (0..PLANNERS as u32)
                .map(|robot| RobotState {
                    robot,
                    ..RobotState::default()
                })
                .collect(),
            tick: 0,
            _services: services,
            _bus: bus,
            _space: space,
        };
        exchange.reach(SlotState::Ready)?;
        exchange.monitor.set_phase(Phase::Connect);
        exchange.state_out.update_connections()?;
        exchange.commands_in.update_connections()?;
        exchange.reach(SlotState::Connected)?;
        exchange.state_out.update_connections()?;
        exchange.commands_in.update_connections()?;
        exchange.monitor.set_phase(Phase::Prepare);
        exchange.reach(SlotState::Prepared)?;
        exchange.monitor.set_phase(Phase::Run);
        Ok(exchange)
    }

    fn reach(&mut self, state: SlotState) -> Result<()> {
        let barrier = self.monitor.barrier();
        let reached = || (1..=PLANNERS).all(|slot| barrier.state(slot) == state);
        Ok(self.planners.wait(READY_WITHIN, reached)?)
    }

    fn tick(&mut self) -> Result<()> {
        let mut header = WorldHeader::default();
        header.stamp.tick = self.tick;
        self.state_out.send(header, &self.states)?;
        self.leader.post(self.tick);
        loop {
            match self.leader.wait(self.tick) {
                TickEnd::Complete => break,
                TickEnd::Idle => self.planners.check()?,
                TickEnd::Stop => return Err("stopped".into()),
            }
        }
        let mut commands = 0;
        while let Some(message) = self.commands_in.receive()? {
            commands += usize::from(message.header().stamp.tick == self.tick);
        }
        if commands != PLANNERS {
            return Err("robot/command: a message is missing".into());
        }
        self.tick += 1;
        Ok(())
    }
}

impl Drop for RuntimeExchange {
    fn drop(&mut self) {
        self.monitor.set_phase(Phase::Stop);
    }
}

fn run_config(root: &Path, prefix: &str) -> RunConfig {
    RunConfig {
        root: root.to_owned(),
        prefix: prefix.to_owned(),
        seed: 1,
        tick_period_ns: 50_000_000,
        clock: Clock::LockStep,
        processor: None,
        processes: PLANNERS as u32 + 1,
        events: 0,
        recorder_ticks: 2,
        topics: Vec::new(),
        capacities: BTreeMap::from([
            ("world/map".to_owned(), 1),
            ("perception/belief".to_owned(), 1),
        ]),
        robots: (0..PLANNERS)
            .map(|index| RobotInfo {
                name: format!("robot_{index}"),
                team: "police".into(),
                role: Role::Pursuer,
                opponents: Vec::new(),
                companions: Vec::new(),
                model: Preset::default().model(),
                beams: 0,
                start: Pose2::default(),
                goal: None,
            })
            .collect(),
        exits: Vec::new(),
        capture_radius: 0.0,
        log_level: "warn".into(),
    }
}

/// A planner that answers every state with a command.
struct TrivialPlanner {
    state: StateInput,
    commands: Publisher<Commands>,
    robot: u32,
}

impl ProcessKind for TrivialPlanner {
    const NAME: &'static str = RUNTIME_PLANNER;
    const SUMMARY: &'static str = "answers every state with a command";

    type Params = ();

    fn declare((): &()) -> Declaration {
        Declaration::default()
            .reads(Input::STATE)
            .writes(Output::new::<Commands>(1))
    }

    fn open(config: &ProcessConfig, (): &(), bus: &Bus) -> std::result::Result<Self, ProcessError> {
        Ok(Self {
            state: StateInput::open(bus, config.run.robots.len())?,
            commands: bus.publisher(PublisherOptions::new(config.index, 1))?,
            robot: config.robots.first().copied().unwrap_or(0),
        })
    }
}

impl Process for TrivialPlanner {
    fn connect(&mut self) -> std::result::Result<(), ProcessError> {
        self.state.connect()?;
        self.commands.update_connections()?;
        Ok(())
    }

    fn step(&mut self, tick: u64) -> std::result::Result<(), ProcessError> {
        self.state.update_to(tick)?;
        if self.state.header.stamp.tick != tick {
            return Err(ProcessError::Protocol(format!(
                "tick {tick} is posted, but the newest world/state is of tick {}",
                self.state.header.stamp.tick
            )));
        }
        let stamp = reply_stamp(&self.state.header, self.state.received_ns);
        let command = Command {
            v: 0.1,
            robot: self.robot,
            ..Command::default()
        };
        self.commands.send(PlainHeader { stamp }, &[command])?;
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
    }
}

/// Runs a trivial planner over the runtime to its end.
pub fn runtime_planner(config: &Path) -> ExitCode {
    runtime::run::<TrivialPlanner>(config)
}

/// The exchange over bare iceoryx2 and a bare futex barrier.
struct RawExchange {
    // Field order: these end before the ports of the barrier leader close.
    planners: ProcessGroup,
    leader: RawLeader,
    _space: RunDirectory,
}

impl RawExchange {
    fn start() -> Result<Self> {
        let space = RunDirectory::create()?;
        let leader = RawLeader::create(space.space())?;
        let configs: Vec<_> = (0..PLANNERS as u32)
            .map(|index| RawConfig {
                root: space.space().root().to_owned(),
                prefix: space.space().prefix().to_owned(),
                index,
            })
            .collect();
        let planners = start_planners(&space, RAW_PLANNER, &configs)?;
        let mut exchange = Self {
            leader,
            planners,
            _space: space,
        };
        exchange.reach(PLANNERS)?;
        exchange.leader.connect()?;
        exchange.reach(2 * PLANNERS)?;
        exchange.leader.connect()?;
        Ok(exchange)
    }

    fn reach(&mut self, count: usize) -> Result<()> {
        let leader = &self.leader;
        Ok(self
            .planners
            .wait(READY_WITHIN, || leader.ready_count() >= count)?)
    }

    fn tick(&mut self) -> Result<()> {
        let planners = &mut self.planners;
        self.leader.tick(|| Ok(planners.check()?))
    }
}

impl Drop for RawExchange {
    fn drop(&mut self) {
        self.leader.stop();
    }
}
