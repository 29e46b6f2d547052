//! Decisions about the processes of a run: an event goes in, the actions to take come out, in their order.
//!
//! Nothing here waits, asks the system or reads a clock: the executor sees what happens and takes the actions.

mod process;
#[cfg(test)]
mod tests;
mod timeouts;

use std::time::{Duration, Instant};

use ipc_types::messages::process::ProcessEvent;

use self::process::{Process, Standing};
pub(super) use self::timeouts::{Observation, StartStep};
use super::error::MissionError;
use super::plan::Launch;
use scenario::OnFailure;

/// Restarts of a process in one run; its next failure ends the run.
const MAX_RESTARTS: u32 = 5;
/// Real time between the failure of a process and its restart.
const RESTART_AFTER: Duration = Duration::from_millis(500);

/// Something that happened to a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Event {
    /// It has ended, by itself or by [`Action::Kill`]; how, in words.
    Ended(String),
    /// It does not answer, and the others wait for it or do without.
    Silent,
    /// It was not ready in time.
    NotReady,
    /// It can be started again.
    Due,
    /// It could not be started again; why, in words.
    NotStarted(String),
    /// It was started again and takes part.
    Back,
}

/// A failure of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Failure {
    /// It ended; how, in words.
    Exited(String),
    /// It did not answer for this long.
    Hung(Duration),
    /// It was not ready within this time.
    NotReady(Duration),
    /// It could not be started again; why, in words.
    NotStarted(String),
}

impl Failure {
    /// What happened to the process, as what follows its name.
    fn words(&self) -> String {
        match self {
            Self::Exited(how) | Self::NotStarted(how) => how.clone(),
            Self::Hung(waited) => format!("did not answer for {waited:?} and was killed"),
            Self::NotReady(waited) => format!("was not ready within {waited:?} and was killed"),
        }
    }

    /// The error of a run that ends because of it.
    pub(super) fn into_error(
        self,
        name: String,
        tick: u64,
        when: String,
        last_words: Vec<String>,
    ) -> MissionError {
        match self {
            Self::Exited(how) | Self::NotStarted(how) => MissionError::Exited {
                name,
                how,
                when,
                last_words,
            },
            Self::Hung(waited) => MissionError::Hung {
                name,
                tick,
                waited,
                last_words,
            },
            Self::NotReady(waited) => MissionError::NotReady {
                name,
                waited,
                last_words,
            },
        }
    }
}

/// The time at which an event is decided about.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// Real time.
    pub(super) now: Instant,
    /// Ticks that the simulator has posted.
    pub(super) posted: u64,
    /// Ticks that the process of the event has done. After its end nobody gets past the tick that it owes until
    /// it is marked dead.
    pub(super) done: u64,
}

impl Moment {
    fn tick(&self) -> u64 {
        self.posted.saturating_sub(1)
    }
}

/// What is to be done about a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Action {
    /// Kill it; [`Event::Ended`] follows.
    Kill,
    /// Stop the world: it must not go on without the process.
    Stop,
    /// Let the recorder take what the process has sent, then free what it holds on the bus. A sender with a full
    /// buffer towards it waits until then.
    FreeDead,
    /// Take it out of the count of those that are waited for.
    MarkDead,
    /// Start it again in its place; what its predecessor held must be free.
    Restart,
    /// Say so in the log.
    Tell {
        /// Kind of a [`ProcessEvent`].
        kind: u32,
        /// The tick that it is about.
        tick: u64,
        /// Failures of the process so far, this one included.
        failures: u32,
        /// Why, in words.
        reason: String,
    },
    /// Warn the user: what follows the name of the process.
    Warn(String),
    /// End the run because of it.
    End {
        /// How it failed.
        failure: Failure,
        /// The last tick that was posted.
        tick: u64,
        /// When, in words.
        when: String,
    },
}

/// Processes of a run and what has happened to them. They are known by their place in the list that they were
/// made of.
#[derive(Debug)]
pub(super) struct State {
    in_lock_step: bool,
    hang_timeout: Duration,
    processes: Vec<Process>,
    has_begun: bool,
    last_posted: u64,
    last_progress: Instant,
    has_lost: bool,
}

impl State {
    /// The state of these processes before time begins.
    pub(super) fn new(launches: &[Launch], in_lock_step: bool, hang_timeout: Duration) -> Self {
        let now = Instant::now();
        let processes = launches.iter();
        Self {
            in_lock_step,
            hang_timeout,
            processes: processes
                .map(|launch| Process::new(launch, launches, now))
                .collect(),
            has_begun: false,
            last_posted: 0,
            last_progress: now,
            has_lost: false,
        }
    }

    /// Time begins.
    pub(super) fn begin(&mut self, now: Instant) {
        self.has_begun = true;
        self.last_progress = now;
        for process in &mut self.processes {
            process.since = now;
        }
    }

    /// Whether a process has failed and the run went on.
    pub(super) fn has_lost(&self) -> bool {
        self.has_lost
    }

    /// Whether a process is to come back.
    pub(super) fn is_expecting(&self) -> bool {
        let mut all = self.processes.iter();
        all.any(|p| {
            matches!(
                p.standing,
                Standing::Away { .. } | Standing::Starting { .. }
            )
        })
    }

    /// Time that a process has to become ready.
    fn ready_timeout(&self, index: usize) -> Duration {
        self.processes[index].ready_timeout
    }

    /// Decides what to do about an event of a process.
    pub(super) fn decide(&mut self, index: usize, event: Event, at: Moment) -> Vec<Action> {
        let ready_timeout = self.ready_timeout(index);
        let has_left = matches!(
            self.processes[index].standing,
            Standing::Away { .. } | Standing::Gone
        );
        match event {
            // It was given up before, and took its time to end.
            Event::Ended(_) if has_left => Vec::new(),
            Event::Ended(how) => {
                let failure = self.processes[index].killed_for.take();
                self.fail(index, failure.unwrap_or(Failure::Exited(how)), true, at)
            }
            Event::NotStarted(why) => self.fail(index, Failure::NotStarted(why), true, at),
            Event::Silent => {
                let failure = Failure::Hung(self.hang_timeout);
                if self.policy(index) == OnFailure::Abort {
                    self.fail(index, failure, false, at)
                } else {
                    self.kill(index, failure)
                }
            }
            Event::NotReady => {
                let failure = Failure::NotReady(ready_timeout);
                if self.has_begun {
                    self.kill(index, failure)
                } else {
                    self.fail(index, failure, false, at)
                }
            }
            Event::Due => {
                let until = at.now + ready_timeout;
                self.processes[index].standing = Standing::Starting { until };
                vec![Action::FreeDead, Action::Restart]
            }
            Event::Back => {
                let process = &mut self.processes[index];
                process.standing = Standing::Present;
                (process.done, process.since) = (at.done, at.now);
                vec![
                    process.tell(ProcessEvent::BACK, at.posted, ""),
                    Action::Warn(format!("is back from tick {} on", at.posted)),
                ]
            }
        }
    }

    fn kill(&mut self, index: usize, failure: Failure) -> Vec<Action> {
        self.processes[index].killed_for = Some(failure);
        vec![Action::Kill]
    }

    /// Reaction to the next failure of a process.
    fn policy(&self, index: usize) -> OnFailure {
        let process = &self.processes[index];
        match process.on_failure {
            OnFailure::Restart if process.failures >= MAX_RESTARTS => OnFailure::Abort,
            policy => policy,
        }
    }

    fn fail(&mut self, index: usize, failure: Failure, is_dead: bool, at: Moment) -> Vec<Action> {
        let policy = self.policy(index);
        let process = &mut self.processes[index];
        let restarts = process.failures;
        process.failures += 1;
        let left = if self.in_lock_step && !process.is_simulator {
            at.done
        } else {
            at.tick()
        };
        let words = failure.words();
        let mut actions = Vec::new();
        if self.has_begun {
            actions.push(process.tell(ProcessEvent::LEFT, left, &words));
        }
        if !self.has_begun || policy == OnFailure::Abort {
            if is_dead {
                // Stopped first: nobody waits for the dead, and the world must not go on without.
                actions.extend([Action::Stop, Action::MarkDead, Action::FreeDead]);
            }
            let when = if self.has_begun {
                format!("at tick {}{}", at.tick(), after(restarts))
            } else {
                "before it was ready".to_owned()
            };
            let tick = at.tick();
            actions.push(Action::End {
                failure,
                tick,
                when,
            });
            return actions;
        }
        self.has_lost = true;
        // Before it is marked: a sender with a full buffer towards it must not go on waiting.
        actions.push(Action::FreeDead);
        let what_follows = if policy == OnFailure::Restart {
            process.standing = Standing::Away {
                due: at.now + RESTART_AFTER,
            };
            let failures = process.failures;
            format!("it is started again, restart {failures} of {MAX_RESTARTS}")
        } else {
            process.standing = Standing::Gone;
            let so = if process.drives_robots {
                "its robots stand still"
            } else {
                "the run goes on without it"
            };
            actions.push(process.tell(ProcessEvent::GIVEN_UP, left, so));
            so.to_owned()
        };
        let warning = format!("{words} at tick {left}; {what_follows}");
        actions.extend([Action::Warn(warning), Action::MarkDead]);
        actions
    }
}

/// How often a process had been restarted, in words.
fn after(restarts: u32) -> String {
    match restarts {
        0 => String::new(),
        1 => " after one restart".to_owned(),
        n => format!(" after {n} restarts"),
    }
}
