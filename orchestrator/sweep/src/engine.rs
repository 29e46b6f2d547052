//! Engines: ways to execute a single mission.

use core::error::Error;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

use mission::in_process::{self, InProcessOptions};
use mission::{self, MissionError, MissionOptions, MissionReport};
use scenario::ResolvedScenario;
use scenario::kind::ConfiguredKind;

/// Interval at which a waiting mission checks for an interruption.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// Options of an engine beside the scenario.
#[derive(Debug, Clone, Default)]
pub struct Call {
    /// Path of the log; `None`: no log.
    pub log: Option<PathBuf>,
    /// Set by the caller to end the mission in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Failure of a mission.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The limit of open files is too low.
    #[error("this mission needs about {wanted} open files, the limit is {limit} (`ulimit -n`)")]
    Files {
        /// Files of the mission.
        wanted: u64,
        /// The limit.
        limit: u64,
    },
    /// The caller ended the mission before its start.
    #[error("interrupted")]
    Interrupted,
    /// Programs of the mission have no kind in their place.
    #[error(transparent)]
    Programs(Box<dyn Error + Send + Sync>),
    /// The run failed.
    #[error(transparent)]
    Mission(#[from] MissionError),
}

/// Executes single missions; called from several threads at once.
pub trait Engine: Sync {
    /// Executes a mission to its end.
    ///
    /// # Errors
    /// [`EngineError`] if the mission does not run to its end.
    fn execute(
        &self,
        scenario: &ResolvedScenario,
        call: &Call,
    ) -> Result<MissionReport, EngineError>;

    /// Returns `true` if a thread that calls it should be pinned to one processor.
    fn needs_pinning(&self) -> bool;
}

/// Engine that runs every mission as separate OS processes, in lock-step. A mission waits until the limit of open files
/// has room for it.
#[derive(Debug)]
pub struct Processes {
    /// Descriptors that no mission uses.
    free: Mutex<u64>,
    freed: Condvar,
    limit: u64,
}

impl Processes {
    /// Creates the engine; `limit` is the number of files that this process may have open.
    pub fn new(limit: u64) -> Self {
        Self {
            free: Mutex::new(limit),
            freed: Condvar::new(),
            limit,
        }
    }

    /// Waits for the descriptors of a mission.
    fn reserve(
        &self,
        wanted: u64,
        interrupted: &AtomicBool,
    ) -> Result<DescriptorReservation<'_>, EngineError> {
        if wanted > self.limit {
            let limit = self.limit;
            return Err(EngineError::Files { wanted, limit });
        }
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free < wanted {
            if interrupted.load(Ordering::Relaxed) {
                return Err(EngineError::Interrupted);
            }
            let waited = self.freed.wait_timeout(free, CHECK_INTERVAL);
            free = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        *free -= wanted;
        Ok(DescriptorReservation {
            of: self,
            descriptors: wanted,
        })
    }
}

/// Descriptors of a mission, until this is dropped.
struct DescriptorReservation<'a> {
    of: &'a Processes,
    descriptors: u64,
}

impl Drop for DescriptorReservation<'_> {
    fn drop(&mut self) {
        *self.of.free.lock().unwrap_or_else(PoisonError::into_inner) += self.descriptors;
        self.of.freed.notify_all();
    }
}

/// Returns the number of descriptors that a mission uses at most in this process: measured 165, and 10 for each process.
fn descriptors(scenario: &ResolvedScenario) -> u64 {
    let processes = scenario.processes.len() as u64 + 1;
    200 + 16 * processes
}

impl Engine for Processes {
    fn execute(
        &self,
        scenario: &ResolvedScenario,
        call: &Call,
    ) -> Result<MissionReport, EngineError> {
        let _reserved = self.reserve(descriptors(scenario), &call.interrupted)?;
        let options = MissionOptions {
            out: call.log.clone(),
            force: true,
            without_log: call.log.is_none(),
            quiet: true,
            log_level: "error".to_owned(),
            interrupted: Arc::clone(&call.interrupted),
            ..MissionOptions::default()
        };
        Ok(mission::run(scenario, &options)?)
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

impl InProcess {
    /// Executes a mission with kinds in the place of external programs, by the name of the process.
    ///
    /// # Errors
    /// [`EngineError`] if the mission does not run to its end.
    pub fn execute_with(
        &self,
        programs: BTreeMap<String, ConfiguredKind>,
        scenario: &ResolvedScenario,
        call: &Call,
    ) -> Result<MissionReport, EngineError> {
        let options = InProcessOptions {
            out: call.log.clone(),
            force: true,
            interrupted: Arc::clone(&call.interrupted),
            programs,
            cache: Arc::clone(&self.cache),
            ..InProcessOptions::default()
        };
        Ok(in_process::run(scenario, &options)?)
    }
}

impl Engine for InProcess {
    fn execute(
        &self,
        scenario: &ResolvedScenario,
        call: &Call,
    ) -> Result<MissionReport, EngineError> {
        self.execute_with(BTreeMap::new(), scenario, call)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missions_wait_for_descriptors_and_impossible_ones_are_refused() {
        let engine = Processes::new(100);
        let interrupted = AtomicBool::new(false);
        let refused = engine.reserve(101, &interrupted).err().unwrap().to_string();
        assert!(
            refused.contains("101") && refused.contains("`ulimit -n`"),
            "{refused}"
        );
        let first = engine.reserve(60, &interrupted).unwrap();
        std::thread::scope(|scope| {
            let second = scope.spawn(|| engine.reserve(60, &interrupted).is_ok());
            drop(first);
            assert!(second.join().unwrap());
        });
        let held = engine.reserve(60, &interrupted).unwrap();
        interrupted.store(true, Ordering::Relaxed);
        assert!(engine.reserve(60, &interrupted).is_err());
        drop(held);
    }
}
