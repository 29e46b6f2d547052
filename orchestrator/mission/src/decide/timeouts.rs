//! Events caused by the passing of time: hangs, due or completed restarts, and timeouts.

use std::time::{Duration, Instant};

use runtime::lockstep::SlotState;

use super::{Event, Participation, Process, State};

/// Observed state of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Observation {
    /// State of its slot at the barrier.
    pub(crate) state: SlotState,
    /// Ticks that it has done.
    pub(crate) done: u64,
    /// `true` if no resource of its predecessor prevents its start.
    pub(crate) is_vacant: bool,
}

/// Progress of the processes in a step of their start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StartStep {
    /// All processes have completed it.
    Done,
    /// At least one process has not completed it and still has time.
    Waiting,
    /// The process with this index exceeded its time.
    Late(usize),
}

impl State {
    /// Returns the progress of the start step that leads to `wanted` and has taken this long. The first process
    /// that has not completed it counts.
    pub(crate) fn start_step(
        &self,
        wanted: SlotState,
        taken: Duration,
        seen: &[Observation],
    ) -> StartStep {
        let is_behind = |seen: &Observation| match wanted {
            SlotState::Ready => seen.state == SlotState::Starting,
            SlotState::Connected => {
                matches!(seen.state, SlotState::Starting | SlotState::Ready)
            }
            _ => seen.state.is_alive() && seen.state != SlotState::Prepared,
        };
        match seen.iter().position(is_behind) {
            None => StartStep::Done,
            Some(index) if taken >= self.ready_timeout(index) => StartStep::Late(index),
            Some(_) => StartStep::Waiting,
        }
    }

    /// Returns the events up to `now` and tick `posted`, except the ends of processes. `is_stopped` returns
    /// `true` for a process stopped by a signal.
    pub(crate) fn timed_events(
        &mut self,
        now: Instant,
        posted: u64,
        seen: &[Observation],
        is_stopped: impl Fn(usize) -> bool,
    ) -> Vec<(usize, Event)> {
        let mut events = Vec::new();
        for (index, (process, seen)) in self.processes.iter().zip(seen).enumerate() {
            match process.participation {
                Participation::Starting { .. } if seen.state == SlotState::Prepared => {
                    events.push((index, Event::Rejoined));
                }
                Participation::Starting { until } if now >= until => {
                    events.push((index, Event::NotReady));
                }
                Participation::Failed { due } if now >= due && seen.is_vacant => {
                    events.push((index, Event::RestartDue));
                }
                _ => {}
            }
        }
        let silent = self.silent(now, posted, seen, is_stopped);
        events.extend(silent.into_iter().map(|index| (index, Event::Silent)));
        events
    }

    /// Returns the processes without progress, each once per hang timeout.
    fn silent(
        &mut self,
        now: Instant,
        posted: u64,
        seen: &[Observation],
        is_stopped: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        if posted != self.last_posted {
            (self.last_posted, self.last_progress) = (posted, now);
        } else if now - self.last_progress >= self.hang_timeout {
            self.last_progress = now;
            let owing = self.in_lock_step.then(|| {
                let tick = posted.saturating_sub(1);
                self.blocking_process(tick, seen, is_stopped)
            });
            let simulator = || self.processes.iter().position(|p| p.is_simulator);
            return owing.flatten().or_else(simulator).into_iter().collect();
        }
        if self.in_lock_step {
            return Vec::new();
        }
        // In real-time mode the world continues without processes that do not answer.
        let mut silent = Vec::new();
        for (index, (process, seen)) in self.processes.iter_mut().zip(seen).enumerate() {
            let is_present =
                process.participation == Participation::Active && seen.state.takes_part();
            if process.is_simulator || !is_present {
                continue;
            }
            if seen.done != process.done || seen.done >= posted {
                (process.done, process.since) = (seen.done, now);
            } else if now - process.since >= self.hang_timeout {
                process.since = now;
                silent.push(index);
            }
        }
        silent
    }

    /// Returns the process for which all others wait in this tick. A stopped process, or one that others wait for,
    /// takes precedence over one that may be waiting itself. A process that makes plans may owe one after its own
    /// step.
    fn blocking_process(
        &self,
        tick: u64,
        seen: &[Observation],
        is_stopped: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let owes = |index: usize| {
            let seen = seen.get(index);
            seen.is_some_and(|seen| seen.state.takes_part() && seen.done <= tick)
        };
        let processes = || self.processes.iter().enumerate();
        let is_plan_due = processes().any(|(index, process)| process.needs_plans && owes(index));
        let may_owe_plan = |index: usize, process: &Process| {
            let seen = seen.get(index);
            is_plan_due && process.makes_plans && seen.is_some_and(|seen| seen.state.takes_part())
        };
        let owing: Vec<(usize, &Process)> = processes()
            .filter(|(_, process)| !process.is_simulator)
            .filter(|(index, process)| owes(*index) || may_owe_plan(*index, process))
            .collect();
        let first = |is_it: &dyn Fn(usize, &Process) -> bool| {
            let mut owing = owing.iter();
            owing
                .find(|(index, process)| is_it(*index, process))
                .map(|(index, _)| *index)
        };
        first(&|index, _| is_stopped(index))
            .or_else(|| first(&|_, process| process.makes_plans))
            .or_else(|| first(&|_, process| !process.upstream.iter().any(|&up| owes(up))))
    }
}
