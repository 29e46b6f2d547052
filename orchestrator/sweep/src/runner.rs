//! Execution of missions, several at once.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use platform::progress::Progress;

use super::engine::{Call, processors, stay_on};
use super::error::SweepError;
use super::experiment::ExperimentOf;
use super::manifest::Manifest;
use super::mission_id::{MissionId, missions};
use super::results::Results;
use super::row::Record as _;
use super::shard::Shard;
use super::spec::LogPolicy;
use super::subject::{Ended, Pinning, Subject};

/// Interval between checks for interruptions and time-outs.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

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
struct Shared<'a, S: Subject> {
    experiment: &'a ExperimentOf<S>,
    engine: &'a S::Engine,
    options: &'a RunOptions,
    manifest: &'a Manifest,
    logs: PathBuf,
    open: &'a [MissionId],
    next: AtomicUsize,
    /// `true`: no further mission is started.
    stop: AtomicBool,
    /// Current mission of each worker.
    current: Vec<Mutex<Option<Current>>>,
}

/// A running mission.
struct Current {
    since: Instant,
    /// Set to end it in order.
    end: Arc<AtomicBool>,
}

/// A finished mission.
struct Done<R> {
    mission: MissionId,
    /// `None`: aborted because of an interruption.
    ended: Option<Ended<R>>,
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
    let jobs = options.jobs.clamp(1, open.len().max(1));
    let shared = Shared {
        experiment,
        engine,
        options,
        manifest: &experiment.manifest(),
        logs,
        open: &open,
        next: AtomicUsize::new(0),
        stop: AtomicBool::new(false),
        current: (0..jobs).map(|_| Mutex::new(None)).collect(),
    };
    let mut progress = Progress::new(open.len(), known, options.quiet, S::UNIT);
    let mut carried_out = 0;
    let (tell, done) = mpsc::channel::<Done<S::Row>>();
    let outcome = std::thread::scope(|scope| -> Result<(), SweepError> {
        for worker in 0..jobs {
            let (shared, tell) = (&shared, tell.clone());
            let spawned = std::thread::Builder::new()
                .name(format!("sweep-{worker}"))
                .spawn_scoped(scope, move || shared.work(worker, &tell));
            if let Err(source) = spawned {
                shared.stop.store(true, Ordering::SeqCst);
                return Err(SweepError::Resource {
                    what: format!("cannot start thread {worker}: {source}"),
                    help: "; choose fewer --jobs",
                });
            }
        }
        drop(tell);
        let kept = collect(&shared, results, &done, &mut progress, &mut carried_out);
        if kept.is_err() {
            shared.abort(None);
        }
        kept
    });
    progress.finish();
    outcome?;
    Ok(RunReport {
        carried_out,
        known,
        wall_time_s: start.elapsed().as_secs_f64(),
        interrupted: shared.is_interrupted(),
        missing: to_do(experiment, Some(results), options.shard, false).0,
    })
}

/// Records finished missions until all workers have ended.
fn collect<S: Subject>(
    shared: &Shared<'_, S>,
    results: &mut Results<S::Row>,
    done: &mpsc::Receiver<Done<S::Row>>,
    progress: &mut Progress,
    carried_out: &mut usize,
) -> Result<(), SweepError> {
    loop {
        match done.recv_timeout(POLL_INTERVAL) {
            Ok(Done {
                mission,
                ended: Some(Ended { row, cpu_ms }),
                wall_s,
            }) => {
                progress.done(row.is_failed(), || {
                    format!("{} failed: {}", results.describe(mission), row.error())
                });
                results.record_timed(mission, row, wall_s, cpu_ms)?;
                *carried_out += 1;
            }
            Ok(Done { ended: None, .. }) | Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if shared.is_interrupted() {
            shared.abort(None);
        } else {
            shared.abort(Some(shared.options.timeout));
        }
    }
}

impl<S: Subject> Shared<'_, S> {
    fn is_interrupted(&self) -> bool {
        self.options.interrupted.load(Ordering::SeqCst)
    }

    /// Ends the missions that have taken longer than this time. Without a time, ends all missions
    /// and starts no other.
    fn abort(&self, longer_than: Option<Duration>) {
        if longer_than.is_none() {
            self.stop.store(true, Ordering::SeqCst);
        }
        for slot in &self.current {
            let Ok(slot) = slot.lock() else { continue };
            if let Some(Current { since, end }) = slot.as_ref()
                && longer_than.is_none_or(|time| since.elapsed() > time)
            {
                end.store(true, Ordering::SeqCst);
            }
        }
    }

    /// Executes one mission after the other until none is left.
    fn work(&self, worker: usize, tell: &mpsc::Sender<Done<S::Row>>) {
        self.take_processor(worker);
        while !self.stop.load(Ordering::SeqCst) {
            let next = self.next.fetch_add(1, Ordering::SeqCst);
            let Some(&mission) = self.open.get(next) else {
                return;
            };
            let start = Instant::now();
            let ended = self.carry_out(worker, mission, start);
            let wall_s = start.elapsed().as_secs_f64();
            let told = tell.send(Done {
                mission,
                ended,
                wall_s,
            });
            if told.is_err() {
                return;
            }
        }
    }

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
        if pinning == Pinning::Always || self.current.len() >= processors.len() {
            // Other parts may run on this machine too.
            let turn = worker + self.options.shard.index() - 1;
            let own = turn.checked_rem(processors.len());
            if let Some(&processor) = own.and_then(|own| processors.get(own)) {
                stay_on(processor);
            }
        }
    }

    fn carry_out(
        &self,
        worker: usize,
        mission: MissionId,
        start: Instant,
    ) -> Option<Ended<S::Row>> {
        let cell = self.experiment.cells.get(mission.cell)?;
        let log = (self.options.log != LogPolicy::None)
            .then(|| self.logs.join(self.manifest.log_name(mission)));
        let call = Call {
            log: log.clone(),
            interrupted: Arc::default(),
        };
        let current = self.current.get(worker);
        if let Some(Ok(mut slot)) = current.map(Mutex::lock) {
            *slot = Some(Current {
                since: start,
                end: Arc::clone(&call.interrupted),
            });
        }
        // Another thread may have set `stop` before the entry above.
        if self.stop.load(Ordering::SeqCst) {
            return None;
        }
        let failed = |error| Ended {
            row: S::Row::failed(error),
            cpu_ms: None,
        };
        // A panic of a mission in this process must not end the other missions.
        let carried_out = catch_unwind(AssertUnwindSafe(|| {
            S::carry_out(cell, mission.seed, self.engine, &call)
        }));
        if let Some(Ok(mut slot)) = current.map(Mutex::lock) {
            *slot = None;
        }
        let interrupted = matches!(carried_out, Ok(None));
        let ended = match carried_out {
            Ok(Some(ended)) => ended,
            Ok(None) => {
                let limit = self.options.timeout.as_secs_f64();
                failed(format!("it did not end within {limit} s of real time"))
            }
            Err(panic) => failed(format!("it panicked: {}", panic_message(panic.as_ref()))),
        };
        // A failure after an interruption does not count.
        let stopped = self.stop.load(Ordering::SeqCst);
        if stopped && (interrupted || ended.row.is_failed()) {
            discard(log.as_deref());
            return None;
        }
        if self.options.log == LogPolicy::Failed && !ended.row.is_failed() {
            discard(log.as_deref());
        }
        Some(ended)
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
