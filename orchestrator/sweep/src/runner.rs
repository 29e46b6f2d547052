//! Execution of missions, several at once.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use platform::progress::Progress;

use super::engine::{Call, processors, stay_on};
use super::error::SweepError;
use super::experiment::ExperimentOf;
use super::manifest::Manifest;
use super::mission_id::{MissionId, missions};
use super::pool::{Pool, Turn};
use super::results::Results;
use super::row::Record as _;
use super::shard::Shard;
use super::spec::LogPolicy;
use super::subject::{MissionResult, Pinning, Subject};

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct RunOptions {
    /// Number of parallel missions, > 0.
    pub jobs: usize,
    /// Part of the experiment.
    pub shard: Shard,
    /// `true` if missions that failed before are executed again.
    pub retry_failed: bool,
    /// Missions whose logs are kept.
    pub log: LogPolicy,
    /// Real time after which a mission is aborted.
    pub timeout: Duration,
    /// `true` if no progress is shown.
    pub quiet: bool,
    /// Set by the caller (Ctrl-C): running missions are aborted, finished ones are kept.
    pub interrupted: Arc<AtomicBool>,
}

/// Result of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct RunReport {
    /// Number of missions executed now.
    pub carried_out: usize,
    /// Number of missions that were finished before.
    pub known: usize,
    /// Real time (s).
    pub wall_time_s: f64,
    /// `true` if it was interrupted.
    pub interrupted: bool,
    /// Missions that were not executed because of an interruption.
    pub missing: Vec<MissionId>,
}

/// Returns the missions of a shard that are still to be executed, in the order of the results, and
/// the number of finished ones.
pub fn to_do<S: Subject>(
    experiment: &ExperimentOf<S>,
    results: Option<&Results<S::Row>>,
    shard: Shard,
    retry_failed: bool,
) -> (Vec<MissionId>, usize) {
    let mut known = 0;
    let open = missions(experiment.cells.len(), &experiment.seeds)
        .enumerate()
        .filter(|&(number, _)| shard.has(number))
        .map(|(_, mission)| mission)
        .filter(|&mission| {
            let row = results.and_then(|results| results.row(mission));
            let done = row.is_some_and(|row| !(retry_failed && row.is_failed()));
            known += usize::from(done);
            !done
        })
        .collect();
    (open, known)
}

/// Data that the workers share.
struct WorkerContext<'a, S: Subject> {
    experiment: &'a ExperimentOf<S>,
    engine: &'a S::Engine,
    options: &'a RunOptions,
    manifest: &'a Manifest,
    logs: PathBuf,
    open: &'a [MissionId],
}

/// A finished mission.
struct FinishedMission<R> {
    mission: MissionId,
    ended: MissionResult<R>,
    wall_s: f64,
}

/// Executes the missions that are not finished and records each as soon as it ends.
///
/// The order is seed by seed: every cell has its first mission before any has its second, so that the rate so far
/// predicts the time left, and an interrupted sweep has rows of all cells.
///
/// # Errors
/// [`SweepError`] if the results cannot be stored; everything recorded before is kept.
pub fn run<S: Subject>(
    experiment: &ExperimentOf<S>,
    results: &mut Results<S::Row>,
    engine: &S::Engine,
    options: &RunOptions,
) -> Result<RunReport, SweepError> {
    let start = Instant::now();
    let (mut open, known) = to_do(
        experiment,
        Some(results),
        options.shard,
        options.retry_failed,
    );
    open.sort_by_key(|mission| (mission.seed, mission.cell));
    let logs = results.logs();
    if options.log != LogPolicy::None {
        std::fs::create_dir_all(&logs).map_err(SweepError::io(&logs, "cannot be created"))?;
    }
    let shared = WorkerContext {
        experiment,
        engine,
        options,
        manifest: &experiment.manifest(),
        logs,
        open: &open,
    };
    let pool = Pool {
        jobs: options.jobs,
        timeout: options.timeout,
        interrupted: &options.interrupted,
    };
    let mut progress = Progress::new(open.len(), known, options.quiet, S::UNIT);
    let mut carried_out = 0;
    let outcome = pool.run(
        open.len(),
        |thread| shared.take_processor(thread),
        |turn| shared.carry_out(turn),
        |done| {
            let Some(FinishedMission {
                mission,
                ended: MissionResult { row, cpu_ms },
                wall_s,
            }) = done
            else {
                return Ok(());
            };
            progress.done(row.is_failed(), || {
                format!("{} failed: {}", results.describe(mission), row.error())
            });
            carried_out += 1;
            results.record_timed(mission, row, wall_s, cpu_ms)
        },
    );
    progress.finish();
    outcome?;
    Ok(RunReport {
        carried_out,
        known,
        wall_time_s: start.elapsed().as_secs_f64(),
        interrupted: options.interrupted.load(Ordering::SeqCst),
        missing: to_do(experiment, Some(results), options.shard, false).0,
    })
}

impl<S: Subject> WorkerContext<'_, S> {
    /// Pins this worker to a processor if its missions need one.
    fn take_processor(&self, worker: usize) {
        let first = self.open.first();
        let cell = first.and_then(|mission| self.experiment.cells.get(mission.cell));
        let pinning = cell.map_or(Pinning::Never, |cell| S::pinning(cell, self.engine));
        if pinning == Pinning::Never {
            return;
        }
        let processors = processors();
        // With spare processors, missions may spread over several.
        if pinning == Pinning::Always || self.options.jobs.min(self.open.len()) >= processors.len()
        {
            // Other parts may run on this machine too.
            let turn = worker + self.options.shard.index() - 1;
            let own = turn.checked_rem(processors.len());
            if let Some(&processor) = own.and_then(|own| processors.get(own)) {
                stay_on(processor);
            }
        }
    }

    /// Executes a mission; returns `None` if it was aborted because of an interruption.
    fn carry_out(&self, turn: &Turn<'_>) -> Option<FinishedMission<S::Row>> {
        let start = Instant::now();
        let mission = *self.open.get(turn.mission)?;
        let cell = self.experiment.cells.get(mission.cell)?;
        let log = (self.options.log != LogPolicy::None)
            .then(|| self.logs.join(self.manifest.log_name(mission)));
        let call = Call {
            log: log.clone(),
            interrupted: Arc::clone(&turn.end),
        };
        let failed = |error| MissionResult {
            row: S::Row::failed(error),
            cpu_ms: None,
        };
        // A panic of a mission in this process must not end the other missions.
        let carried_out = catch_unwind(AssertUnwindSafe(|| {
            S::carry_out(cell, mission.seed, self.engine, &call)
        }));
        let ended = match carried_out {
            Ok(Some(ended)) => ended,
            Ok(None) => {
                let limit = self.options.timeout.as_secs_f64();
                failed(format!("it did not end within {limit} s of real time"))
            }
            Err(panic) => failed(format!("it panicked: {}", panic_message(panic.as_ref()))),
        };
        let is_failed = ended.row.is_failed();
        // A failure after an interruption does not count.
        if is_failed && turn.is_stopped() {
            discard(log.as_deref());
            return None;
        }
        if !self.options.log.keeps(is_failed) {
            discard(log.as_deref());
        }
        Some(FinishedMission {
            mission,
            ended,
            wall_s: start.elapsed().as_secs_f64(),
        })
    }
}

fn discard(log: Option<&Path>) {
    if let Some(log) = log {
        // There may be no log.
        let _ = std::fs::remove_file(log);
    }
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "without a message".to_owned())
}
