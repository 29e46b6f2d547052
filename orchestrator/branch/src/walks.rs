//! Continuations in copies of this process.
//!
//! A *walk* executes the run once with the random streams of one number, and with its branch prepared. At each wanted tick it
//! copies its process ([`platform::fork`]): in the copy the branch begins, and the walk goes on when the copy has ended. So
//! the state of every process at that tick is there without being written or executed again. Each walk is a copy itself, of
//! the process of the caller, and writes a line per continuation into a pipe. A copy has no children of its own: with external
//! programs each continuation has a walk of its own, which executes it from the start.

use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::io::{ErrorKind, PipeReader, PipeWriter, Read as _, Write as _, pipe};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use mcap_log::{LogReadError, ReadProgress};
use mission::MissionError;
use mission::in_process::{Cache, InProcessOptions, has_children};
use platform::fork::{ProcessCopy, end, fork, lead_group};
use platform::progress::Progress;
use replay::lineage::Change;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use serde::{Deserialize, Serialize};

use crate::error::BranchError;
use crate::parent::Parent;

/// Interval between checks for interruptions.
const POLL_INTERVAL: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};

/// Options of continuations.
#[derive(Debug, Clone, Default)]
pub struct ContinuationOptions {
    /// Number of continuations at once, > 0.
    pub jobs: usize,
    /// Folder for the logs of continuations from one moment, `SEED.mcap`; `None` writes none.
    pub logs: Option<PathBuf>,
    /// `true` if existing logs may be overwritten.
    pub force: bool,
}

/// Outcomes of all robots in each continuation, by index.
pub(crate) type Outcomes = Vec<Vec<String>>;

/// Continuations of a run with a change.
pub(crate) struct Continuations<'a> {
    pub(crate) parent: &'a Parent,
    pub(crate) change: &'a Change,
    options: ContinuationOptions,
    cache: Arc<Cache>,
    watch: &'a ReadProgress,
}

/// Line of a walk about a continuation.
#[derive(Serialize, Deserialize)]
struct Answer {
    tick: u64,
    outcomes: Vec<String>,
    /// Reason for the lack of outcomes.
    failure: Option<String>,
}

/// A walk in its process.
struct Walk {
    seed: u64,
    /// Ticks of the continuations that are still to come.
    ticks: VecDeque<u64>,
    copy: ProcessCopy,
    answers: PipeReader,
    /// The beginning of a line.
    text: Vec<u8>,
}

impl<'a> Continuations<'a> {
    /// Compares the whole run with the log, which computes the data that all copies share.
    ///
    /// # Errors
    /// As those of [`Parent::verify`].
    pub(crate) fn verified(
        parent: &'a Parent,
        change: &'a Change,
        options: ContinuationOptions,
        watch: &'a ReadProgress,
    ) -> Result<Self, BranchError> {
        let cache = Arc::default();
        parent.verify(change, &cache, watch)?;
        Ok(Self {
            parent,
            change,
            options,
            cache,
            watch,
        })
    }

    /// Runs the continuations of these ticks and numbers of random streams; returns their outcomes in the same order.
    ///
    /// # Errors
    /// [`BranchError`]: a continuation fails, or all are interrupted.
    pub(crate) fn outcomes(&self, tasks: &[(u64, u64)]) -> Result<Outcomes, BranchError> {
        let mut progress = Progress::new(tasks.len(), 0, self.watch.quiet, "continuations");
        let found = self.walk_all(tasks, &mut progress);
        progress.finish();
        let mut found = found?;
        let of = |task| found.remove(task).unwrap_or_default();
        Ok(tasks.iter().map(of).collect())
    }

    fn walk_all(
        &self,
        tasks: &[(u64, u64)],
        progress: &mut Progress,
    ) -> Result<BTreeMap<(u64, u64), Vec<String>>, BranchError> {
        let mut by_seed: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
        for (tick, seed) in tasks {
            by_seed.entry(*seed).or_default().push(*tick);
        }
        // With few seeds, each has several walks, so that there is one for every processor.
        let jobs = self.options.jobs.max(1);
        let parts = jobs.div_ceil(by_seed.len().max(1));
        let mut waiting: VecDeque<(u64, Vec<u64>)> = VecDeque::new();
        for (seed, mut ticks) in by_seed {
            ticks.sort_unstable();
            let size = if has_children(&self.parent.scenario) {
                1
            } else {
                ticks.len().div_ceil(parts)
            };
            let parts = ticks.chunks(size);
            waiting.extend(parts.map(|ticks| (seed, ticks.to_vec())));
        }
        let (mut walks, mut found) = (Vec::new(), BTreeMap::new());
        // On an error, the walks end with their list.
        loop {
            while walks.len() < jobs
                && let Some((seed, ticks)) = waiting.pop_front()
            {
                walks.push(self.start(seed, ticks)?);
            }
            if walks.is_empty() {
                return Ok(found);
            }
            for at in readable(&walks).into_iter().rev() {
                let walk = &mut walks[at];
                let is_over = !walk.read().map_err(BranchError::Copy)?;
                while let Some(answer) = walk.answer() {
                    walk.ticks.retain(|tick| *tick != answer.tick);
                    let seed = walk.seed;
                    if let Some(reason) = answer.failure {
                        return Err(self.without_outcome(seed, answer.tick, reason));
                    }
                    found.insert((answer.tick, seed), answer.outcomes);
                    progress.done(false, String::new);
                }
                if is_over {
                    let walk = walks.swap_remove(at);
                    walk.copy.wait().map_err(BranchError::Copy)?;
                    if let Some(tick) = walk.ticks.front()
                        && !self.watch.interrupted.load(Ordering::Relaxed)
                    {
                        let reason = "its process ended: expected enough memory, and no signal";
                        return Err(self.without_outcome(walk.seed, *tick, reason.to_owned()));
                    }
                }
            }
            if self.watch.interrupted.load(Ordering::Relaxed) {
                return Err(LogReadError::Interrupted.into());
            }
        }
    }

    fn without_outcome(&self, seed: u64, tick: u64, reason: String) -> BranchError {
        let at_s = tick as f64 * self.parent.scenario.run.dt;
        let at = recorder::time_text(at_s);
        BranchError::Continuation { seed, at, reason }
    }

    /// Starts a walk.
    fn start(&self, seed: u64, ticks: Vec<u64>) -> Result<Walk, BranchError> {
        let (answers, writing) = pipe().map_err(BranchError::Copy)?;
        let Some(copy) = fork().map_err(BranchError::Copy)? else {
            lead_group();
            if self.watch.interrupted.load(Ordering::Relaxed) {
                // The next signal, a second one, would end it at once, with its external programs.
                end(false);
            }
            let walk = || self.walk(seed, &ticks, writing);
            end(catch_unwind(AssertUnwindSafe(walk)).unwrap_or(false));
        };
        Ok(Walk {
            seed,
            ticks: ticks.into(),
            copy,
            answers,
            text: Vec::new(),
        })
    }

    /// Carries out a walk in its process, and each of its continuations but the last one in a copy of that. Returns `true` in
    /// each of these processes if its continuation has an outcome.
    fn walk(&self, seed: u64, ticks: &[u64], mut answers: PipeWriter) -> bool {
        let change = Change {
            seed,
            ..self.change.clone()
        };
        let at = Cell::new(0);
        let mut begins = |tick: u64| -> Result<bool, MissionError> {
            if ticks.get(at.get()) != Some(&tick) {
                return Ok(false);
            }
            if at.get() + 1 < ticks.len() {
                let copied = fork().and_then(|copy| copy.map(ProcessCopy::wait).transpose());
                match copied.map_err(|source| not_copied(tick, source))? {
                    None => return Ok(true),
                    // It wrote why, or was killed.
                    Some(false) => end(false),
                    Some(true) => at.set(at.get() + 1),
                }
                return Ok(false);
            }
            Ok(true)
        };
        let out = self.options.logs.as_ref();
        let out = out.map(|folder| folder.join(format!("{seed}.mcap")));
        // Of a single continuation the log names the tick; of several none begins by itself.
        let own = if let [tick] = ticks { *tick } else { u64::MAX };
        let options = InProcessOptions {
            cache: Arc::clone(&self.cache),
            interrupted: Arc::clone(&self.watch.interrupted),
            force: self.options.force,
            ..InProcessOptions::default()
        };
        let parent = self.parent;
        let done = parent.run(own, &change, out.as_deref(), options, &mut begins);
        let mut answer = Answer {
            tick: ticks.get(at.get()).copied().unwrap_or_default(),
            outcomes: Vec::new(),
            failure: None,
        };
        match done {
            Ok(report) => {
                let robots = report.summary.robots.into_iter();
                answer.outcomes = robots.map(|robot| robot.outcome).collect();
            }
            Err(error) => answer.failure = Some(error.to_string()),
        }
        let line = serde_json::json!(answer).to_string() + "\n";
        answers.write_all(line.as_bytes()).is_ok() && answer.failure.is_none()
    }
}

fn not_copied(tick: u64, source: std::io::Error) -> MissionError {
    MissionError::System {
        what: format!("a copy of the run at tick {tick}"),
        source,
    }
}

/// Waits until walks have written something or have ended, at most for [`POLL_INTERVAL`]; returns their indices.
fn readable(walks: &[Walk]) -> Vec<usize> {
    let answers = walks.iter().map(|walk| &walk.answers);
    let mut polled: Vec<PollFd<'_>> = answers.map(|fd| PollFd::new(fd, PollFlags::IN)).collect();
    // The only possible error is an interruption.
    let _ = poll(&mut polled, Some(&POLL_INTERVAL));
    let is_ready = |at: &usize| polled.get(*at).is_some_and(|fd| !fd.revents().is_empty());
    (0..walks.len()).filter(is_ready).collect()
}

impl Walk {
    /// Reads what it has written; returns `false` if it has ended.
    fn read(&mut self) -> std::io::Result<bool> {
        let mut buffer = [0; 4096];
        match self.answers.read(&mut buffer) {
            Ok(0) => Ok(false),
            Ok(read) => {
                self.text.extend_from_slice(&buffer[..read]);
                Ok(true)
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(true),
            Err(error) => Err(error),
        }
    }

    /// Takes the next whole line.
    fn answer(&mut self) -> Option<Answer> {
        let end = self.text.iter().position(|byte| *byte == b'\n')?;
        let line: Vec<u8> = self.text.drain(..=end).collect();
        serde_json::from_slice(&line).ok()
    }
}
