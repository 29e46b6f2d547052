//! Effects on the processes of a run: looks at them, and takes the actions that are decided about them.

use std::os::fd::BorrowedFd;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::messages::process::ProcessEvent;
use runtime::lockstep::{BarrierMonitor, Phase};

use super::child_process::{ChildError, RunningProcess};
use super::decide::{Action, Event, Moment, Observation};
use super::error::MissionError;
use super::external_bridge::ExternalBridge;
use super::plan::Launch;
use super::process_group::{ProcessGroup, config_path, write_config};
use super::process_log::ProcessEventLog;
use super::resources::RunResources;
use super::shm_usage;

/// Processes of a run and everything that acts on them. They are known by their place among their launches.
pub(super) struct Executor<'a> {
    resources: &'a RunResources,
    launches: &'a [Launch],
    monitor: BarrierMonitor,
    bridge: Option<ExternalBridge>,
    processes: ProcessGroup,
    /// Where events and lines go, if anywhere.
    pub(super) log: Option<ProcessEventLog>,
    /// Whether the lines of the processes are shown.
    echo: bool,
}

impl<'a> Executor<'a> {
    /// Gives each of these processes its slot at the barrier.
    ///
    /// # Errors
    /// [`MissionError`] if the turns of external programs cannot be bridged.
    pub(super) fn new(
        resources: &'a RunResources,
        launches: &'a [Launch],
        echo: bool,
    ) -> Result<Self, MissionError> {
        let monitor = BarrierMonitor::new(Arc::clone(&resources.barrier));
        for launch in launches {
            let slot = launch.config.index as usize;
            monitor.assign_slot(slot, slot != 0, launch.watched);
        }
        let bridge = ExternalBridge::start(launches, &resources.bus, &resources.barrier)?;
        Ok(Self {
            resources,
            launches,
            monitor,
            bridge: Some(bridge),
            processes: ProcessGroup::default(),
            log: None,
            echo,
        })
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

    /// Moves the run on.
    pub(super) fn enter(&self, phase: Phase) {
        self.monitor.set_phase(phase);
    }

    /// The processes as they are now.
    pub(super) fn see(&self) -> Vec<Observation> {
        let barrier = self.monitor.barrier();
        let bridge = self.bridge.as_ref();
        let see = |process: &RunningProcess| Observation {
            state: barrier.state(process.slot),
            done: barrier.ticks_done(process.slot),
            is_vacant: bridge.is_none_or(|bridge| bridge.is_vacant(process.slot)),
        };
        self.processes.iter().map(see).collect()
    }

    /// The processes that have ended since the last look. What all have written by now goes to the log.
    pub(super) fn ends(&mut self) -> Vec<(usize, Event)> {
        self.forward_lines();
        let ended = |(index, process): (usize, &mut RunningProcess)| {
            let has_ended = process.check_exit();
            has_ended.then(|| (index, Event::Ended(how_it_ended(process))))
        };
        let processes = self.processes.iter_mut().enumerate();
        processes.filter_map(ended).collect()
    }

    /// Whether a process stands still by a signal or under a debugger.
    pub(super) fn is_stopped(&self, index: usize) -> bool {
        self.processes[index].is_stopped()
    }

    /// Ticks that have been posted.
    pub(super) fn ticks_posted(&self) -> u64 {
        self.monitor.barrier().ticks_posted()
    }

    /// Now, as a process sees it.
    pub(super) fn moment(&self, index: usize) -> Moment {
        let barrier = self.monitor.barrier();
        Moment {
            now: Instant::now(),
            posted: self.ticks_posted(),
            done: barrier.ticks_done(self.processes[index].slot),
        }
    }

    /// Sleeps until a process has ended or `wake` is readable, at most for `timeout`.
    pub(super) fn sleep(&self, wake: Option<BorrowedFd<'_>>, timeout: Duration) {
        self.processes.sleep(wake, timeout);
    }

    /// Takes an action about a process; the event that follows from it at once.
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
                return Ok(Some(Event::Ended(how_it_ended(process))));
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
                    Err(error) => return Ok(Some(Event::NotStarted(error.of_it()))),
                }
            }
            Action::Tell {
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
                let (name, last_words) = (process.name.clone(), process.last_words());
                return Err(failure.into_error(name, tick, when, last_words));
            }
        }
        Ok(None)
    }

    /// Ends all processes, and hands on what they wrote last.
    pub(super) fn stop(&mut self) {
        self.monitor.set_phase(Phase::Stop);
        for name in self.processes.end() {
            tracing::warn!("process {name} did not end and was killed");
        }
        self.forward_lines();
        if let Some(bridge) = self.bridge.take()
            && let Err(error) = bridge.finish()
        {
            tracing::warn!("bridge to external processes: {error}");
        }
    }

    fn forward_lines(&self) {
        if let Some(log) = &self.log {
            log.forward_lines(self.tick());
        }
    }

    /// The last tick that was posted.
    fn tick(&self) -> u64 {
        self.ticks_posted().saturating_sub(1)
    }
}

fn how_it_ended(process: &RunningProcess) -> String {
    process
        .exit
        .map_or_else(|| "ended".into(), shm_usage::explain_exit)
}
