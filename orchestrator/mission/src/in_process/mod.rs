//! A run in one thread of this process, for sweeps of very many runs.
//!
//! It executes the code of the separate processes over a bus in memory, in the order of lock-step. The simulator
//! publishes the state of a tick; every process steps after those it waits for; the simulator takes the commands and
//! steps the world. All messages are identical: digest, outcome and metrics are those of a run with processes. There
//! are no clocks and therefore no latencies. A crash is not contained, except that of an external program: it is a child
//! (`hosted`).
//!
//! Runs share only the data of their maps in [`InProcessOptions::cache`], so that each run may have its own
//! thread.

mod branches;
mod direct;
mod hosted;
mod libraries;
mod local_run;
pub mod placement;
mod processes;
mod stepped;
mod tracks;

pub use branches::{Branch, GivenCommand, GivenPlace};
pub use direct::DirectRun;
pub use libraries::has_children;
pub use processes::LocalProcesses;
pub use stepped::SteppedRun;
pub use tracks::Track;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::bus::{Bus, Publisher, PublisherOptions};
use ipc_types::stamp::Stamp;
use ipc_types::topics::{ObstacleEvents, ProcessLog};
use platform::output_lines::MAX_TEXT_BYTES;
use runtime::maps::Maps;

use self::branches::prepared;
use self::hosted::Host;
use self::local_run::LocalRun;
use super::error::{InProcessError, MissionError};
use super::plan::Plan;
use super::process_log::{line_header, remark_lines};
use super::progress::{EventPrinter, Progress};
use super::recording::{self, LogFile};
use super::report::MissionReport;
use super::team_colours;
use recorder::{DigestPrefixes, Recorder};
use scenario::kind::ConfiguredKind;
use scenario::spec::Mode;
use scenario::{ResolvedScenario, ScenarioRemark};

/// Ticks between two updates of the progress display.
const DISPLAY_INTERVAL: u64 = 256;

/// Options of a run in one process.
#[derive(Debug, Clone, Default)]
pub struct InProcessOptions {
    /// Path of the log; `None` writes no log.
    pub out: Option<PathBuf>,
    /// `true` if an existing log may be overwritten.
    pub force: bool,
    /// `true` to show progress and events.
    pub show: bool,
    /// Remarks for the log ([`ResolvedScenario::remarks`]).
    pub remarks: Vec<ScenarioRemark>,
    /// Last tick of the run, if it is not over earlier.
    pub last_tick: Option<u64>,
    /// Set by the caller (Ctrl-C) to end the run in order.
    pub interrupted: Arc<AtomicBool>,
    /// Kinds that run in the place of those of the scenario, external programs among them, by the name of the process.
    /// Each is the same planner as the one that it replaces, so that the digest is that of a run with processes.
    pub programs: BTreeMap<String, ConfiguredKind>,
    /// `true` if the external programs that the scenario names may run: libraries in this program, others as its children.
    pub external: bool,
    /// Processes that fail, by name, with the first tick without each; the run goes on.
    pub failures: BTreeMap<String, u64>,
    /// Changes in the course of the run; their ticks ascend.
    pub branches: Vec<Branch>,
    /// Robots that follow a recording.
    pub tracks: Vec<Track>,
    /// Key and text for the log on what the run has beside its scenario: [`mcap_log::Origin::BRANCHES`],
    /// [`mcap_log::Origin::IMPORTED`].
    pub source: Option<(&'static str, String)>,
    /// Data that runs share; pass the same cache to all runs of a sweep, in any scenario and thread.
    pub cache: Arc<Cache>,
}

/// Data that runs in one process share, because it depends only on their maps and takes longer to compute than a
/// run. Results do not depend on it.
#[derive(Debug, Default)]
pub struct Cache {
    maps: Arc<Maps>,
    digest_prefixes: Arc<DigestPrefixes>,
}

impl Cache {
    /// Returns the digest prefixes of the maps' messages, for the recorder.
    fn digest_prefixes(&self) -> Arc<DigestPrefixes> {
        Arc::clone(&self.digest_prefixes)
    }
}

/// Runs a scenario to its end in this thread.
///
/// # Errors
/// [`MissionError::InProcess`] if the scenario has real-time mode, or external programs without
/// [`InProcessOptions::external`], or if a process fails;
/// others as for [`mission::run`](fn@crate::run).
///
/// ```
/// use mission::in_process::{InProcessOptions, run};
///
/// let seed = Some(1);
/// let scenario = scenario::Loader::new(kinds::KINDS).load("hello", &[], seed)?;
/// let report = run(&scenario, &InProcessOptions::default())?;
/// assert!(report.summary.ticks > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(
    scenario: &ResolvedScenario,
    options: &InProcessOptions,
) -> Result<MissionReport, MissionError> {
    run_until(scenario, options, &mut |_| Ok(false))
}

/// Runs a scenario as [`run`]; the last of its branches begins at the first tick for which `begins`, called before every
/// tick, returns `true`, or at its own.
///
/// # Errors
/// As [`run`]; those of `begins`.
pub fn run_until(
    scenario: &ResolvedScenario,
    options: &InProcessOptions,
    begins: &mut dyn FnMut(u64) -> Result<bool, MissionError>,
) -> Result<MissionReport, MissionError> {
    if scenario.run.mode == Mode::RealTime {
        return Err(InProcessError::RealTime.into());
    }
    let mut programs = options.programs.clone();
    let mut external = scenario.external_commands();
    if options.external {
        libraries::load(scenario, &mut programs)?;
    } else if let Some(process) = external.find(|process| !programs.contains_key(&process.name)) {
        let name = process.name.clone();
        return Err(InProcessError::External { name }.into());
    }
    // In a run with processes, a panic ends one of them, and the run reports which. Here it must not end a whole
    // sweep. Only the cache outlives the run, and it contains only complete values.
    let run = AssertUnwindSafe(|| execute(scenario, options, &programs, begins));
    catch_unwind(run).unwrap_or_else(|panic| {
        let text = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied());
        let message = text.unwrap_or("no message").to_owned();
        Err(InProcessError::Panicked { message }.into())
    })
}

fn execute(
    scenario: &ResolvedScenario,
    options: &InProcessOptions,
    programs: &BTreeMap<String, ConfiguredKind>,
    begins: &mut dyn FnMut(u64) -> Result<bool, MissionError>,
) -> Result<MissionReport, MissionError> {
    let start = Instant::now();
    let plan = Plan::new(scenario, "warn")?;
    let mut bus_options = plan.run.bus_options();
    // A changed process has its ports beside the one whose place it will take.
    bus_options.size.processes *= options.branches.len() + 1;
    bus_options.size.robots *= options.branches.len() + 1;
    let bus = Bus::local(bus_options);
    // The recorder's subscriptions must exist before the first message is sent.
    let log = options.out.as_deref().map(|path| LogFile {
        path: Some(path),
        force: options.force,
        quiet: !options.show,
        source: options.source.as_ref(),
    });
    let digest_prefixes = options.cache.digest_prefixes();
    let recording = recording::create(scenario, &plan, log, digest_prefixes, None)?;
    let mut recorder = Recorder::open(&bus, recording)?;
    let obstacles: Publisher<ObstacleEvents> =
        bus.publisher(PublisherOptions::new(plan.orchestrator_index(), 1))?;
    let lines: Publisher<ProcessLog> = bus.publisher(PublisherOptions::new(
        plan.orchestrator_index(),
        MAX_TEXT_BYTES,
    ))?;
    let maps = &options.cache.maps;
    let host = options.external.then(|| Host {
        hang_timeout: Duration::from_secs_f64(scenario.run.hang_timeout_s),
        echo: options.show,
        interrupted: Arc::clone(&options.interrupted),
    });
    let begin = || {
        let mut processes = LocalRun::open_with(&plan, programs, &bus, maps, host.as_ref())?;
        let branches = &options.branches;
        processes.branches = prepared(&plan, branches, programs, &bus, maps, host.as_ref())?;
        processes.connect()?;
        plan.send_obstacle_changes(&obstacles)?;
        for line in remark_lines(&plan, &options.remarks) {
            let header = line_header(Stamp::default(), &line);
            lines.send(header, line.text.as_bytes())?;
        }
        processes.prepare()?;
        Ok(processes)
    };
    let begun: Result<LocalRun, MissionError> = begin();
    let mut processes = begun.inspect_err(|_| {
        if let Some(log) = &options.out {
            // It has no tick.
            let _ = std::fs::remove_file(log);
        }
    })?;

    let mut show = options.show.then(|| ProgressDisplay::new(scenario, &plan));
    let first_tick = Instant::now();
    processes.follow(&options.tracks, 0);
    let mut has_begun = false;
    let interrupted = loop {
        if !options.failures.is_empty() {
            processes.fail(&options.failures);
        }
        if !has_begun && begins(processes.tick())? {
            processes.begin_last();
            has_begun = true;
        }
        let over = processes.turn()?;
        let tick = processes.tick();
        match &mut show {
            Some(show) => {
                recorder.take(tick, &mut show.events)?;
                if tick.is_multiple_of(DISPLAY_INTERVAL) {
                    show.progress.at(tick as f64 * plan.run.tick_period());
                }
            }
            None => recorder.take(tick, &mut ())?,
        }
        if over || options.last_tick.is_some_and(|last| tick >= last) {
            break false;
        }
        if options.interrupted.load(Ordering::Relaxed) {
            break true;
        }
        processes.follow(&options.tracks, tick + 1);
        processes.advance();
    };
    let wall_time_s = first_tick.elapsed().as_secs_f64();
    let summary = match &mut show {
        Some(show) => {
            let summary = recorder.finish(&mut show.events);
            show.progress.finish();
            summary?
        }
        None => recorder.finish(&mut ())?,
    };
    Ok(MissionReport {
        summary,
        wall_time_s,
        start_up_s: (first_tick - start).as_secs_f64(),
        interrupted,
        has_failures: false,
        live: None,
    })
}

/// Display of a run's progress.
struct ProgressDisplay {
    progress: Progress,
    events: EventPrinter,
}

impl ProgressDisplay {
    fn new(scenario: &ResolvedScenario, plan: &Plan) -> Self {
        let progress = Progress::new(scenario.world.rules.time_limit, false);
        let names = recording::run_info(scenario, plan).event_names();
        let events = progress.events(names, team_colours(scenario), false);
        Self { progress, events }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinds::load;

    fn game(seed: u64) -> ResolvedScenario {
        let set = ["rules.time_limit=8".to_owned()];
        load("chase_exact", &set, Some(seed)).unwrap()
    }

    #[test]
    fn runs_that_share_a_cache_equal_runs_without() {
        let alone: Vec<String> = (1..=4)
            .map(|seed| {
                let report = run(&game(seed), &InProcessOptions::default()).unwrap();
                assert_eq!(report.summary.ticks, 160);
                report.summary.digest
            })
            .collect();
        let options = InProcessOptions::default();
        // The second pass finds everything in the cache.
        for _ in 0..2 {
            let together: Vec<String> = std::thread::scope(|scope| {
                let threads: Vec<_> = (1..=4)
                    .map(|seed| {
                        let options = &options;
                        scope.spawn(move || run(&game(seed), options).unwrap().summary.digest)
                    })
                    .collect();
                threads.into_iter().map(|t| t.join().unwrap()).collect()
            });
            assert_eq!(together, alone);
        }
    }

    #[test]
    fn an_interrupted_run_ends_in_order_and_says_so() {
        let options = InProcessOptions::default();
        options.interrupted.store(true, Ordering::SeqCst);
        let report = run(&game(1), &options).unwrap();
        assert!(report.interrupted);
        assert_eq!(report.summary.ticks, 0);
        assert_eq!(report.summary.robots.len(), 6);
    }

    #[test]
    fn real_time_and_external_programs_are_refused_with_their_field() {
        let mut scenario = game(1);
        scenario.run.mode = Mode::RealTime;
        let error = run(&scenario, &InProcessOptions::default()).unwrap_err();
        assert!(error.to_string().contains("run.mode"), "{error}");
        let mut scenario = game(1);
        scenario.processes[0].program = scenario::Program::Command {
            words: vec!["./mine".into()],
            folder: "/".into(),
            params: serde_json::Value::Null,
            declared: scenario::ProgramDeclaration::Nothing,
        };
        let error = run(&scenario, &InProcessOptions::default()).unwrap_err();
        let field = format!("processes.{}.command", scenario.processes[0].name);
        assert!(error.to_string().contains(&field), "{error}");
    }
}
