//! Events caused by the passing of time: hangs, due or completed restarts, and timeouts.

use std::time::{Duration, Instant};

use runtime::lockstep::SlotState;

use super::silence::Activity;
use super::{Event, Participation, Process, State};

/// Observed state of a process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Observation {
    /// State of its slot at the barrier.
    pub(crate) state: SlotState,
    /// Ticks that it has done.
    pub(crate) done: u64,
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

    /// Returns the events up to `now` and tick `posted`, except the ends of processes. `look` returns what the
    /// system reports about a process, or about this one for the index after the last; it is called when the run
    /// makes no progress.
    pub(crate) fn timed_events(
        &mut self,
        now: Instant,
        posted: u64,
        seen: &[Observation],
        look: impl Fn(usize) -> Activity,
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
                Participation::Failed { due } if now >= due => {
                    events.push((index, Event::RestartDue));
                }
                _ => {}
            }
        }
        let silent = self.silent(now, posted, seen, look);
        events.extend(silent.into_iter().map(|index| (index, Event::Silent)));
        events
    }

    /// Returns the processes without progress, each once per hang timeout.
    fn silent(
        &mut self,
        now: Instant,
        posted: u64,
        seen: &[Observation],
        look: impl Fn(usize) -> Activity,
    ) -> Vec<usize> {
        if let Some(index) = self.blocks_the_run(now, posted, seen, look) {
            self.silence.restart(now);
            return vec![index];
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

    /// Returns the process for which the whole run has waited for longer than the hang timeout. The time for which
    /// that process, or the recorder in this one, waited for a core does not count: on a busy machine it may be long.
    fn blocks_the_run(
        &mut self,
        now: Instant,
        posted: u64,
        seen: &[Observation],
        look: impl Fn(usize) -> Activity,
    ) -> Option<usize> {
        // In lock-step every step that ends is progress; in real time the world goes on by itself.
        let done = seen.iter().filter(|_| self.in_lock_step);
        let progress = done.fold(posted, |sum, seen| sum.wrapping_add(seen.done));
        let lasts = self.silence.lasts(progress, now);
        let begins = !self.silence.has_begun() && lasts >= self.hang_timeout / 10;
        if !begins && lasts < self.hang_timeout {
            return None;
        }
        let own = self.processes.len();
        let activities: Vec<Activity> = (0..=own).map(look).collect();
        if begins {
            self.silence.begin(now, &activities);
        }
        let tick = posted.saturating_sub(1);
        let blocking = self
            .in_lock_step
            .then(|| self.blocking_process(tick, seen, now, &activities));
        let simulator = || self.processes.iter().position(|p| p.is_simulator);
        let index = blocking.flatten().or_else(simulator)?;
        let waited = |index: usize| self.silence.waited(index, &activities);
        let counts = lasts.saturating_sub(waited(index).max(waited(own)));
        (counts >= self.hang_timeout).then_some(index)
    }

    /// Returns the process for which all others wait in this tick. A stopped process takes precedence, then one that
    /// computes, then one that others wait for. A process that makes plans may owe one after its own step.
    fn blocking_process(
        &self,
        tick: u64,
        seen: &[Observation],
        now: Instant,
        activities: &[Activity],
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
        first(&|index, _| activities.get(index).is_some_and(|of| of.is_stopped))
            .or_else(|| first(&|index, _| self.silence.is_busy(index, now, activities)))
            .or_else(|| first(&|_, process| process.makes_plans))
            .or_else(|| first(&|_, process| !process.upstream.iter().any(|&up| owes(up))))
    }
}
