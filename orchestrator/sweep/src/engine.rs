//! Engines: ways to execute a single mission.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

use mission::in_process::{self, InProcessOptions};
use mission::{self, MissionOptions, MissionReport};
use scenario::ResolvedScenario;

/// Options of an engine beside the scenario.
#[derive(Debug, Clone, Default)]
pub struct Call {
    /// Path of the log; `None`: no log.
    pub log: Option<PathBuf>,
    /// Set by the caller to end the mission in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Executes single missions; called from several threads at once.
pub trait Engine: Sync {
    /// Executes a mission to its end.
    ///
    /// # Errors
    /// The reason of the failure, as text.
    fn execute(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String>;

    /// Returns `true` if a thread that calls it should be pinned to one processor.
    fn needs_pinning(&self) -> bool;
}

/// Engine that runs every mission as separate OS processes, in lock-step.
#[derive(Debug, Clone, Copy)]
pub struct Processes;

impl Engine for Processes {
    fn execute(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String> {
        let options = MissionOptions {
            out: call.log.clone(),
            force: true,
            without_log: call.log.is_none(),
            quiet: true,
            log_level: "error".to_owned(),
            interrupted: Arc::clone(&call.interrupted),
            ..MissionOptions::default()
        };
        mission::run(scenario, &options).map_err(|error| error.to_string())
    }

    /// The processes of a mission inherit the processor of the thread that starts them. They run
    /// one after another, so waking each other on one processor is cheaper than across several. A
    /// scenario with `run.pin = "one_core"` takes the first processor that its orchestrator may
    /// use, which must differ between missions.
    fn needs_pinning(&self) -> bool {
        true
    }
}

/// Engine that runs every mission in one thread of this process: the same results, many times
/// faster. It supports no external programs.
#[derive(Debug, Clone, Default)]
pub struct InProcess {
    /// Cache that missions share.
    cache: Arc<in_process::Cache>,
}

impl Engine for InProcess {
    fn execute(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String> {
        let options = InProcessOptions {
            out: call.log.clone(),
            force: true,
            show: false,
            interrupted: Arc::clone(&call.interrupted),
            cache: Arc::clone(&self.cache),
            ..InProcessOptions::default()
        };
        in_process::run(scenario, &options).map_err(|error| error.to_string())
    }

    fn needs_pinning(&self) -> bool {
        false
    }
}

/// Returns the processors that this process may use.
pub(super) fn processors() -> Vec<usize> {
    match sched_getaffinity(None) {
        Ok(set) => (0..CpuSet::MAX_CPU)
            .filter(|&cpu| set.is_set(cpu))
            .collect(),
        Err(_) => Vec::new(),
    }
}

/// Pins the calling thread, and processes that it starts, to one processor. A failure is ignored:
/// it only costs time.
pub(super) fn stay_on(processor: usize) {
    let mut set = CpuSet::new();
    set.set(processor);
    let _ = sched_setaffinity(None, &set);
}
