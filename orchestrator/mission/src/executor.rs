//! Execution of the supervisor's actions, and observation of the processes.

use std::os::fd::BorrowedFd;
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::messages::process::ProcessEvent;
use platform::proc;
use runtime::lockstep::{BarrierMonitor, Phase};

use super::child_process::{ChildError, RunningProcess};
use super::decide::{Action, Activity, Event, Moment, Observation};
use super::error::MissionError;
use super::plan::Launch;
use super::process_group::{ProcessGroup, config_path, write_config};
use super::process_log::ProcessEventLog;
use super::resources::RunResources;
use super::shm_usage;

/// Processes of a run and the resources that control them. A process is identified by its index among the launches.
pub(super) struct Executor {
    resources: Rc<RunResources>,
    launches: Vec<Launch>,
    monitor: BarrierMonitor,
    processes: ProcessGroup,
    /// Destination of process events and output lines, if any.
    pub(super) log: Option<ProcessEventLog>,
    /// `true` to show the output lines of the processes.
    echo: bool,
}

impl Executor {
    /// Assigns each of these processes its slot at the barrier.
    pub(super) fn new(resources: Rc<RunResources>, launches: Vec<Launch>, echo: bool) -> Self {
        let monitor = BarrierMonitor::new(Arc::clone(&resources.barrier));
        for launch in &launches {
            let slot = launch.config.index as usize;
            monitor.assign_slot(slot, slot != 0, launch.is_awaited());
        }
        Self {
            resources,
            launches,
            monitor,
            processes: ProcessGroup::default(),
            log: None,
            echo,
        }
    }

    /// Starts all processes.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub(super) fn start(&mut self) -> Result<(), MissionError> {
        for (index, launch) in self.launches.iter().enumerate() {
            shm_usage::check_start()?;
            let config = &launch.config;
            let slot = config.index as usize;
            write_config(self.resources.root(), &config.name, slot, launch)?;
            let process = self.launch(index)?;
            self.processes.push(process);
        }
        Ok(())
    }

    fn launch(&self, index: usize) -> Result<RunningProcess, ChildError> {
        let launch = &self.launches[index];
        let slot = launch.config.index as usize;
        RunningProcess::start(
            &launch.config.name,
            slot,
            &launch.executable(),
            &config_path(self.resources.root(), slot),
            self.echo,
            self.log.as_ref().map(ProcessEventLog::line_sender),
        )
    }

    /// Moves the run to its next phase.
    pub(super) fn enter(&self, phase: Phase) {
        self.monitor.set_phase(phase);
    }

    /// Observes the current state of the processes.
    pub(super) fn observe(&self) -> Vec<Observation> {
        let barrier = self.monitor.barrier();
        let observe = |process: &RunningProcess| Observation {
            state: barrier.state(process.slot),
            done: barrier.ticks_done(process.slot),
        };
        self.processes.iter().map(observe).collect()
    }

    /// Returns the processes that have ended since the last call, and forwards all output lines to the log.
    pub(super) fn take_exits(&mut self) -> Vec<(usize, Event)> {
        self.forward_lines();
        let ended = |(index, process): (usize, &mut RunningProcess)| {
            let has_ended = process.check_exit();
            has_ended.then(|| (index, end_of(process)))
        };
        let processes = self.processes.iter_mut().enumerate();
        processes.filter_map(ended).collect()
    }

    /// Returns what the system reports about a process, or about this one for the index after the last. Processor time
    /// that is unknown is zero: all time without progress then counts as a hang.
    pub(super) fn activity(&self, index: usize) -> Activity {
        let process = self.processes.get(index);
        let own = rustix::process::getpid().as_raw_nonzero().get();
        let pid = process.map_or(own, RunningProcess::pid);
        Activity {
            // It only selects which of several late processes is named.
            is_stopped: proc::stat(pid)
                .is_ok_and(|stat| stat.is_some_and(|stat| stat.is_stopped())),
            cpu: proc::cpu_time(pid).ok().flatten().unwrap_or_default(),
        }
    }

    /// Returns the number of posted ticks.
    pub(super) fn ticks_posted(&self) -> u64 {
        self.monitor.barrier().ticks_posted()
    }

    /// Returns the current time and the progress of a process.
    pub(super) fn moment(&self, index: usize) -> Moment {
        let barrier = self.monitor.barrier();
        Moment {
            now: Instant::now(),
            posted: self.ticks_posted(),
            done: barrier.ticks_done(self.processes[index].slot),
        }
    }

    /// Sleeps until a process has ended or `wake` is readable, for `timeout` at most.
    pub(super) fn sleep(&self, wake: Option<BorrowedFd<'_>>, timeout: Duration) {
        self.processes.sleep(wake, timeout);
    }

    /// Takes an action on a process. Returns the event that it causes, if any.
    ///
    /// # Errors
    /// [`Action::End`] is the error that ends the run.
    pub(super) fn act(
        &mut self,
        index: usize,
        action: Action,
    ) -> Result<Option<Event>, MissionError> {
        let process = &mut self.processes[index];
        match action {
            Action::Kill => {
                process.kill();
                return Ok(Some(Event::Ended(describe_end(process))));
            }
            Action::Stop => self.monitor.set_phase(Phase::Stop),
            Action::FreeDead => {
                if let Some(log) = &self.log {
                    log.drain();
                }
                self.resources.bus.clean_up_dead();
            }
            Action::MarkDead => self.monitor.mark_dead(process.slot),
            Action::Restart => {
                self.monitor.reset_slot(process.slot);
                match self.launch(index) {
                    Ok(process) => self.processes[index] = process,
                    Err(error) => return Ok(Some(Event::NotStarted(error.reason()))),
                }
            }
            Action::Log {
                kind,
                tick,
                failures,
                reason,
            } => {
                let mut event = ProcessEvent {
                    tick,
                    process: process.slot as u32,
                    kind,
                    failures,
                    ..ProcessEvent::default()
                };
                event.set_reason(&reason);
                if let Some(log) = &self.log {
                    log.publish_event(self.tick(), event);
                }
            }
            Action::Warn(text) => tracing::warn!("process {} {text}", process.name),
            Action::End {
                failure,
                tick,
                when,
            } => {
                let (name, last_lines) = (process.name.clone(), process.last_lines());
                return Err(failure.into_error(name, tick, when, last_lines));
            }
        }
        Ok(None)
    }

    /// Ends all processes and forwards their last output lines.
    pub(super) fn stop(&mut self) {
        self.monitor.set_phase(Phase::Stop);
        for name in self.processes.end() {
            tracing::warn!("process {name} did not end and was killed");
        }
        self.forward_lines();
    }

    fn forward_lines(&self) {
        if let Some(log) = &self.log {
            log.forward_lines(self.tick());
        }
    }

    /// Returns the last posted tick.
    fn tick(&self) -> u64 {
        self.ticks_posted().saturating_sub(1)
    }
}

/// Returns the event of a process that has ended by itself.
fn end_of(process: &mut RunningProcess) -> Event {
    match process.start_error() {
        Some(error) => Event::NotStarted(format!(
            "cannot be started: {}: {error}: expected an executable program",
            process.program
        )),
        None => Event::Ended(describe_end(process)),
    }
}

fn describe_end(process: &RunningProcess) -> String {
    process
        .exit
        .map_or_else(|| "ended".into(), shm_usage::explain_exit)
}
