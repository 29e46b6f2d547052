//! Who carries out a single mission.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

use mission::in_process::{self, InProcessOptions};
use mission::{self, MissionOptions, MissionReport};
use scenario::ResolvedScenario;

/// What an engine is told beside the scenario.
#[derive(Debug, Clone, Default)]
pub struct Call {
    /// Where the log goes; none is written if not said.
    pub log: Option<PathBuf>,
    /// Set from outside to end the mission in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Carries out single missions; called from several threads at once.
pub trait Engine: Sync {
    /// Carries out a mission to its end.
    ///
    /// # Errors
    /// Why it failed, in words.
    fn fly(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String>;

    /// Whether a thread that calls it should stay on one processor.
    fn wants_own_processor(&self) -> bool;
}

/// Every mission as operating-system processes of its own, in lock-step.
#[derive(Debug, Clone, Copy)]
pub struct Processes;

impl Engine for Processes {
    fn fly(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String> {
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

    /// The processes of a mission inherit the processor of the thread that starts them. They take
    /// turns, so that waking each other on one processor costs less than across several; and a
    /// scenario with `run.pin = "one_core"` takes the first processor that its orchestrator may use,
    /// which must not be the same for all missions.
    fn wants_own_processor(&self) -> bool {
        true
    }
}

/// Every mission in one thread of this process: the same results, many times faster. Programs of the
/// user's own cannot take part.
#[derive(Debug, Clone, Default)]
pub struct InProcess {
    /// What missions keep for each other.
    cache: Arc<in_process::Cache>,
}

impl Engine for InProcess {
    fn fly(&self, scenario: &ResolvedScenario, call: &Call) -> Result<MissionReport, String> {
        let options = InProcessOptions {
            out: call.log.clone(),
            force: true,
            show: false,
            interrupted: Arc::clone(&call.interrupted),
            cache: Arc::clone(&self.cache),
        };
        in_process::run(scenario, &options).map_err(|error| error.to_string())
    }

    fn wants_own_processor(&self) -> bool {
        false
    }
}

/// The processors that this process may use.
pub(super) fn processors() -> Vec<usize> {
    match sched_getaffinity(None) {
        Ok(set) => (0..CpuSet::MAX_CPU)
            .filter(|&cpu| set.is_set(cpu))
            .collect(),
        Err(_) => Vec::new(),
    }
}

/// Keeps the calling thread, and what it starts, on one processor. Failing to is no error: it only
/// costs time.
pub(super) fn stay_on(processor: usize) {
    let mut set = CpuSet::new();
    set.set(processor);
    let _ = sched_setaffinity(None, &set);
}
