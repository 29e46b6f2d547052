//! Decisions about the processes of a run: maps an event to an ordered list of actions.
//!
//! This module does not wait, call the system or read a clock. The executor detects events and takes the actions.

mod process;
mod silence;
#[cfg(test)]
mod tests;
mod timeouts;

use std::time::{Duration, Instant};

use ipc_types::messages::process::ProcessEvent;

use self::process::{Participation, Process};
pub(super) use self::silence::Activity;
use self::silence::Silence;
pub(super) use self::timeouts::{Observation, StartStep};
use super::error::MissionError;
use super::plan::Launch;
use scenario::OnFailure;

/// Maximum number of restarts of a process in one run; the next failure ends the run.
const MAX_RESTARTS: u32 = 5;
/// Real time between the failure of a process and its restart.
const RESTART_DELAY: Duration = Duration::from_millis(500);

/// Event of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Event {
    /// The process has ended, by itself or by [`Action::Kill`]; contains the description.
    Ended(String),
    /// The process does not answer.
    Silent,
    /// It was not ready in time.
    NotReady,
    /// The time of its restart has come.
    RestartDue,
    /// Its program could not be started; contains the reason.
    NotStarted(String),
    /// The process was restarted and takes part again.
    Rejoined,
}

/// Failure of a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Failure {
    /// It ended; contains the description.
    Exited(String),
    /// It did not answer for this long.
    Hung(Duration),
    /// It was not ready within this time.
    NotReady(Duration),
    /// Its program could not be started; contains the reason.
    NotStarted(String),
}

impl Failure {
    /// Describes the failure in the words that follow the name of the process.
    fn describe(&self) -> String {
        match self {
            Self::Exited(how) | Self::NotStarted(how) => how.clone(),
            Self::Hung(waited) => format!("did not answer for {waited:?} and was killed"),
            Self::NotReady(waited) => format!("was not ready within {waited:?} and was killed"),
        }
    }

    /// Returns the error of a run that this failure ends.
    pub(super) fn into_error(
        self,
        name: String,
        tick: Option<u64>,
        when: String,
        last_lines: Vec<String>,
    ) -> MissionError {
        match self {
            Self::NotStarted(how) if tick.is_none() => MissionError::NotStarted { name, how },
            Self::Exited(how) | Self::NotStarted(how) => MissionError::Exited {
                name,
                how,
                when,
                last_lines,
            },
            Self::Hung(waited) => MissionError::Hung {
                name,
                tick: tick.unwrap_or_default(),
                waited,
                last_lines,
            },
            Self::NotReady(waited) => MissionError::NotReady {
                name,
                waited,
                last_lines,
            },
        }
    }
}

/// Time and progress at which an event is handled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// Real time.
    pub(super) now: Instant,
    /// Ticks that the simulator has posted.
    pub(super) posted: u64,
    /// Ticks that the process of the event has done. After its end, no process proceeds past the tick that it
    /// owes until it is marked dead.
    pub(super) done: u64,
}

impl Moment {
    fn tick(&self) -> u64 {
        self.posted.saturating_sub(1)
    }
}

/// Action on a process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Action {
    /// Kill the process; [`Event::Ended`] follows.
    Kill,
    /// Stop the world: it must not continue without the process.
    Stop,
    /// Let the recorder receive all messages that the process has sent, then free its bus resources. A sender
    /// with a full buffer towards it waits until then.
    FreeDead,
    /// Exclude it from the barrier, so that no process waits for it.
    MarkDead,
    /// Start it again in its slot; the resources of its predecessor must be free.
    Restart,
    /// Write a process event to the log.
    Log {
        /// Kind of a [`ProcessEvent`].
        kind: u32,
        /// Tick of the event.
        tick: u64,
        /// Number of failures of the process, including this one.
        failures: u32,
        /// Reason, in words.
        reason: String,
    },
    /// Warn the user; contains the words that follow the name of the process.
    Warn(String),
    /// End the run because of the process.
    End {
        /// Failure of the process.
        failure: Failure,
        /// The last tick that was posted; `None` before the first one.
        tick: Option<u64>,
        /// Time of the failure, in words.
        when: String,
    },
}

/// States of the processes of a run, and of its supervision. A process is identified by its index in the list of
/// launches.
#[derive(Debug)]
pub(super) struct State {
    in_lock_step: bool,
    hang_timeout: Duration,
    processes: Vec<Process>,
    has_begun: bool,
    silence: Silence,
    has_failures: bool,
}

impl State {
    /// Creates the state of these processes before the first tick.
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
            silence: Silence::new(now),
            has_failures: false,
        }
    }

    /// Starts to measure time, at the first tick.
    pub(super) fn begin(&mut self, now: Instant) {
        self.has_begun = true;
        self.silence.restart(now);
        for process in &mut self.processes {
            process.since = now;
        }
    }

    /// Returns `true` if a process has failed and the run continued.
    pub(super) fn has_failures(&self) -> bool {
        self.has_failures
    }

    /// Returns `true` if a process is being restarted.
    pub(super) fn is_restarting(&self) -> bool {
        let mut all = self.processes.iter();
        all.any(|p| {
            matches!(
                p.participation,
                Participation::Failed { .. } | Participation::Starting { .. }
            )
        })
    }

    /// Returns the time within which a process must become ready.
    fn ready_timeout(&self, index: usize) -> Duration {
        self.processes[index].ready_timeout
    }

    /// Decides which actions an event of a process requires.
    pub(super) fn decide(&mut self, index: usize, event: Event, at: Moment) -> Vec<Action> {
        let ready_timeout = self.ready_timeout(index);
        let has_left = matches!(
            self.processes[index].participation,
            Participation::Failed { .. } | Participation::GivenUp
        );
        match event {
            // The process was given up before it ended.
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
            Event::RestartDue => {
                let until = at.now + ready_timeout;
                self.processes[index].participation = Participation::Starting { until };
                vec![Action::FreeDead, Action::Restart]
            }
            Event::Rejoined => {
                let process = &mut self.processes[index];
                process.participation = Participation::Active;
                (process.done, process.since) = (at.done, at.now);
                vec![
                    process.log_event(ProcessEvent::BACK, at.posted, ""),
                    Action::Warn(format!("rejoined the run at tick {}", at.posted)),
                ]
            }
        }
    }

    fn kill(&mut self, index: usize, failure: Failure) -> Vec<Action> {
        self.processes[index].killed_for = Some(failure);
        vec![Action::Kill]
    }

    /// Returns the reaction to the next failure of a process.
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
        let words = failure.describe();
        let mut actions = Vec::new();
        if self.has_begun {
            actions.push(process.log_event(ProcessEvent::LEFT, left, &words));
        }
        if !self.has_begun || policy == OnFailure::Abort {
            if is_dead {
                // Stop first: no process waits for a dead one, and the world must not continue without it.
                actions.extend([Action::Stop, Action::MarkDead, Action::FreeDead]);
            }
            let when = if self.has_begun {
                format!("at tick {}{}", at.tick(), restart_count(restarts))
            } else {
                "before it was ready".to_owned()
            };
            let tick = self.has_begun.then(|| at.tick());
            actions.push(Action::End {
                failure,
                tick,
                when,
            });
            return actions;
        }
        self.has_failures = true;
        // Must precede the mark: a sender with a full buffer towards it must not keep waiting.
        actions.push(Action::FreeDead);
        let reaction = if policy == OnFailure::Restart {
            process.participation = Participation::Failed {
                due: at.now + RESTART_DELAY,
            };
            let failures = process.failures;
            format!("it is started again, restart {failures} of {MAX_RESTARTS}")
        } else {
            process.participation = Participation::GivenUp;
            let consequence = if process.drives_robots {
                "its robots stop"
            } else {
                "the run continues without it"
            };
            actions.push(process.log_event(ProcessEvent::GIVEN_UP, left, consequence));
            consequence.to_owned()
        };
        let warning = format!("{words} at tick {left}; {reaction}");
        actions.extend([Action::Warn(warning), Action::MarkDead]);
        actions
    }
}

/// Describes in words how often a process was restarted.
fn restart_count(restarts: u32) -> String {
    match restarts {
        0 => String::new(),
        1 => " after one restart".to_owned(),
        n => format!(" after {n} restarts"),
    }
}
