//! Life cycle of a process: start-up, handshake, loop, heartbeat, end.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::config::{self, Clock, ProcessConfig};
use crate::error::ProcessError;
use crate::guard;
use crate::kind::{Process, ProcessKind};
use crate::lockstep::{BarrierMember, Phase, SlotState, TickBarrier, TickWait};
use crate::logging;
use crate::paced;
use crate::status::Heartbeat;

/// Resources that every process opens first and keeps to its end.
#[derive(Debug)]
pub struct Setup {
    /// Set when the process shall end: by SIGTERM, or because its orchestrator has gone.
    pub stop: Arc<AtomicBool>,
    /// The bus of the run.
    pub bus: Bus,
    /// The tick barrier of the run.
    pub barrier: Arc<TickBarrier>,
    /// The heartbeat.
    pub heartbeat: Heartbeat,
}

impl Setup {
    /// Installs signal handlers, watches the orchestrator and joins the run.
    ///
    /// # Errors
    /// [`ProcessError`] names the step that failed.
    pub fn new(config: &ProcessConfig) -> Result<Self, ProcessError> {
        let stop = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(signal_hook::consts::SIGTERM, Arc::clone(&stop))
            .map_err(|e| ProcessError::system("cannot handle SIGTERM", e))?;
        // Ctrl-C in a terminal reaches the whole foreground group; the orchestrator decides then.
        signal_hook::flag::register(
            signal_hook::consts::SIGINT,
            Arc::new(AtomicBool::new(false)),
        )
        .map_err(|e| ProcessError::system("cannot handle SIGINT", e))?;
        guard::watch_parent(Arc::clone(&stop))
            .map_err(|e| ProcessError::system("cannot start the parent guard", e))?;
        if let Some(processor) = config.run.processor {
            let mut set = rustix::thread::CpuSet::new();
            set.set(processor as usize);
            rustix::thread::sched_setaffinity(None, &set)
                .map_err(|e| ProcessError::system("cannot pin to the configured processor", e))?;
        }
        let barrier = Arc::new(TickBarrier::open(&config.run.prefix)?);
        if config.index as usize >= barrier.processes() {
            return Err(ProcessError::Protocol(format!(
                "process index {} in a run of {} processes",
                config.index,
                barrier.processes()
            )));
        }
        let bus = Bus::join(&config.run.space()?, config.run.bus_options(), &config.name)?;
        let heartbeat = Heartbeat::open(&bus, config.index, config.run.tick_period_ns)?;
        Ok(Self {
            stop,
            bus,
            barrier,
            heartbeat,
        })
    }

    /// The slot of a process in the loop.
    pub fn member(&self, config: &ProcessConfig) -> BarrierMember {
        BarrierMember::new(
            Arc::clone(&self.barrier),
            config.index as usize,
            config.upstream.iter().map(|&u| u as usize).collect(),
        )
    }
}

/// Runs a process with the configuration in a file to its end; returns its exit code. Errors go to
/// stderr, to the heartbeat and to the tick barrier.
///
/// ```
/// use std::path::Path;
/// use std::process::ExitCode;
///
/// use ipc_types::bus::Bus;
/// use runtime::declaration::Declaration;
/// use runtime::{Process, ProcessConfig, ProcessError, ProcessKind};
///
/// /// A process that counts the ticks of its run.
/// struct Counter {
///     ticks: u64,
/// }
///
/// impl Process for Counter {
///     fn connect(&mut self) -> Result<(), ProcessError> {
///         Ok(())
///     }
///
///     fn step(&mut self, _tick: u64) -> Result<(), ProcessError> {
///         self.ticks += 1;
///         Ok(())
///     }
/// }
///
/// impl ProcessKind for Counter {
///     const NAME: &'static str = "counter";
///     const SUMMARY: &'static str = "counts ticks";
///     type Params = ();
///
///     fn declare((): &()) -> Declaration {
///         Declaration::default()
///     }
///
///     fn open(_: &ProcessConfig, (): &(), _: &Bus) -> Result<Self, ProcessError> {
///         Ok(Self { ticks: 0 })
///     }
/// }
///
/// // A run gives the path of the configuration; without it the process ends at once.
/// let code = runtime::run::<Counter>(Path::new("/nonexistent/counter.json"));
/// assert_eq!(format!("{code:?}"), format!("{:?}", ExitCode::FAILURE));
/// ```
pub fn run<K: ProcessKind>(config: &Path) -> ExitCode {
    run_with(config, K::presets(), follow::<K>)
}

/// Runs a process of this kind with its configuration and parameters to its end: the body of [`run`].
///
/// # Errors
/// [`ProcessError`] names the step that failed.
pub fn follow<K: ProcessKind>(
    config: &ProcessConfig,
    params: &K::Params,
) -> Result<(), ProcessError> {
    let setup = Setup::new(config)?;
    // An external program alone knows its kind.
    let config = &ProcessConfig {
        kind: K::NAME.to_owned(),
        ..config.clone()
    };
    live(config, setup, &|bus| paced::start::<K>(config, params, bus))
}

/// Like [`run`], with these presets of parameters and another body (the simulator leads the loop instead of following
/// it).
pub fn run_with<P: DeserializeOwned + Serialize>(
    config: &Path,
    presets: Vec<(&'static str, P)>,
    body: impl FnOnce(&ProcessConfig, &P) -> Result<(), ProcessError>,
) -> ExitCode {
    let (config, params) = match config::load(config, presets) {
        Ok(loaded) => loaded,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    logging::start(&config.run.log_level);
    name_process(&config.name);
    match body(&config, &params) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tracing::error!("{error}");
            if let Ok(barrier) = TickBarrier::open(&config.run.prefix) {
                let barrier = Arc::new(barrier);
                let slot = config.index as usize;
                BarrierMember::new(barrier, slot, Vec::new()).set_state(SlotState::Failed);
            }
            ExitCode::FAILURE
        }
    }
}

/// Sets the name of the process in `ps` and `top` (the kernel keeps 15 bytes).
fn name_process(name: &str) {
    if let Ok(name) = std::ffi::CString::new(name.as_bytes()) {
        let _ = rustix::thread::set_name(&name);
    }
}

/// Opens the ports of a process and sets up its algorithm.
type OpenFunction<'a> = &'a dyn Fn(&Bus) -> Result<Box<dyn Process>, ProcessError>;

fn live(
    config: &ProcessConfig,
    mut setup: Setup,
    open: OpenFunction<'_>,
) -> Result<(), ProcessError> {
    let member = setup.member(config);
    let joins_late = member.joins_late();
    let mut process = open(&setup.bus)?;
    member.set_state(SlotState::Ready);
    let keep_going = || !setup.stop.load(Ordering::Relaxed);
    if !member.wait_for_phase(Phase::Connect, keep_going) {
        member.set_state(SlotState::Stopped);
        return Ok(());
    }
    process.connect()?;
    setup.heartbeat.connect()?;
    setup.heartbeat.send_if_due(0, 2, None)?;
    // The other processes opened their ports long before, and sent the map.
    if joins_late && !member.join(keep_going) {
        member.set_state(SlotState::Stopped);
        return Ok(());
    }
    member.set_state(SlotState::Connected);
    if member.wait_for_phase(Phase::Prepare, keep_going) {
        process.prepare()?;
        member.set_state(SlotState::Prepared);
    }

    let mut next = if joins_late { member.ticks_posted() } else { 0 };
    let mut overruns = 0;
    loop {
        if setup.stop.load(Ordering::Relaxed) {
            break;
        }
        let turn = match config.run.clock {
            Clock::LockStep => member.wait_tick(next),
            Clock::RealTime { factor, .. } => {
                let period = config.run.tick_period() / factor.max(1e-3);
                member.wait_newest(next, Duration::from_secs_f64((period * 0.5).min(1.0)))
            }
        };
        match turn {
            TickWait::Stop => break,
            TickWait::Idle => {
                if setup.heartbeat.is_due() {
                    setup.heartbeat.send_if_due(next, 3, None)?;
                }
            }
            TickWait::Tick(tick) => {
                overruns += tick - next;
                setup.bus.begin_turn();
                let start = Instant::now();
                if let Err(error) = process.step(tick) {
                    let _ = setup
                        .heartbeat
                        .send_if_due(tick, 5, Some(&error.to_string()));
                    return Err(error);
                }
                let end = Instant::now();
                let took = u64::try_from((end - start).as_nanos()).unwrap_or(u64::MAX);
                setup.heartbeat.stepped(took, overruns, process.rejected());
                if setup.heartbeat.is_due_at(end) {
                    setup.heartbeat.send_if_due(tick, 3, None)?;
                }
                member.done(tick);
                next = tick + 1;
            }
        }
    }
    // The ports close with `process` and `setup`; the slot is released last.
    drop(process);
    member.set_state(SlotState::Stopped);
    Ok(())
}
