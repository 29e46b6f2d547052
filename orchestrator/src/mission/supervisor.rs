//! Supervision of the processes of a run: brings what happens to them before [`super::decide`], and takes the
//! actions that are decided there.

use std::os::fd::BorrowedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::messages::process::ProcessEvent;
use runtime::config::Clock;
use runtime::lockstep::{Overseer, Phase, SlotState};

use super::child_process::{ChildError, RunningProcess};
use super::decide::{Action, Event, Failure, Moment, Seen, State};
use super::error::MissionError;
use super::external_bridge::ExternalBridge;
use super::plan::Launch;
use super::process_group::{ProcessGroup, config_path, write_config};
use super::process_log::ProcessEventLog;
use super::resources::RunResources;
use super::shm_usage;

/// Time between two looks while a process is awaited, at the start or after a failure. Processes say how far they
/// are on the page; a few milliseconds are nothing against what starting a process takes.
const QUICK_BEAT: Duration = Duration::from_millis(2);
/// Time between two looks at other times. The end of a process wakes at once.
const BEAT: Duration = Duration::from_millis(10);

/// Processes of a run: started, supervised, and stopped at the latest when this is dropped.
pub(crate) struct Supervisor<'a> {
    resources: &'a RunResources,
    launches: &'a [Launch],
    overseer: Overseer,
    bridge: Option<ExternalBridge>,
    /// In the order of their launches.
    processes: ProcessGroup,
    state: State,
    log: Option<ProcessEventLog>,
    /// Whether the lines of the processes are shown.
    echo: bool,
}

impl<'a> Supervisor<'a> {
    /// Takes up these processes of the run, each of which gets its slot at the page; with `echo` their stderr is
    /// shown.
    ///
    /// # Errors
    /// [`MissionError`] if the turns of external programs cannot be bridged.
    pub(crate) fn new(
        resources: &'a RunResources,
        launches: &'a [Launch],
        hang_timeout: Duration,
        echo: bool,
    ) -> Result<Self, MissionError> {
        let overseer = Overseer::new(Arc::clone(&resources.page));
        for launch in launches {
            let slot = launch.config.index as usize;
            overseer.seat(slot, slot != 0, launch.watched);
        }
        let in_lock_step = resources.plan.run.clock == Clock::LockStep;
        Ok(Self {
            resources,
            launches,
            overseer,
            bridge: Some(ExternalBridge::start(
                launches,
                &resources.bus,
                &resources.page,
            )?),
            processes: ProcessGroup::default(),
            state: State::new(launches, in_lock_step, hang_timeout),
            log: None,
            echo,
        })
    }

    /// Has what happens to the processes and what they write go to the log.
    pub(super) fn with_log(mut self, log: ProcessEventLog) -> Self {
        self.log = Some(log);
        self
    }

    /// Starts all processes and waits until their ports are open; false if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub(crate) fn start(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        for (index, launch) in self.launches.iter().enumerate() {
            shm_usage::check_start()?;
            let config = &launch.config;
            let slot = config.index as usize;
            write_config(self.resources.root(), &config.name, slot, launch)?;
            let process = self.launch(index)?;
            self.processes.push(process);
        }
        self.reach(SlotState::Ready, interrupted)
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
            self.log.as_ref().map(|log| log.line_sender()),
        )
    }

    /// Has the processes connect their ports and waits until they have; false if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub(crate) fn connect(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.overseer.set_phase(Phase::Connect);
        let connected = self.reach(SlotState::Connected, interrupted)?;
        if let Some(log) = &self.log {
            log.connect()?;
        }
        Ok(connected)
    }

    /// Has the processes build what they need of the map, which has been sent, and waits until they have; false
    /// if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub(crate) fn prepare(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.overseer.set_phase(Phase::Prepare);
        self.reach(SlotState::Prepared, interrupted)
    }

    /// Lets time begin.
    pub(crate) fn begin(&mut self) {
        self.state.begin(Instant::now());
        self.overseer.set_phase(Phase::Run);
    }

    /// Waits until every process is at least this far in the start; false if `interrupted` before.
    fn reach(&mut self, wanted: SlotState, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        let start = Instant::now();
        loop {
            let behind = self.behind(wanted);
            // First: a process that has died of it is not to blame.
            shm_usage::check_start()?;
            self.check_ends()?;
            let Some(index) = behind else {
                return Ok(true);
            };
            if interrupted.load(Ordering::SeqCst) {
                return Ok(false);
            }
            if start.elapsed() >= self.state.ready_timeout(index) {
                self.happened(index, Event::NotReady)?;
            }
            self.processes.sleep(None, QUICK_BEAT);
        }
    }

    /// The first process that is not yet this far in the start.
    fn behind(&self, wanted: SlotState) -> Option<usize> {
        let page = self.overseer.page();
        self.processes.iter().position(|process| {
            let state = page.state(process.slot);
            match wanted {
                SlotState::Ready => state == SlotState::Starting,
                SlotState::Connected => matches!(state, SlotState::Starting | SlotState::Ready),
                _ => state.is_alive() && state != SlotState::Prepared,
            }
        })
    }

    /// Sleeps until it is time to look at the processes again, one has ended, or `wake` is readable.
    pub(super) fn sleep(&self, wake: BorrowedFd<'_>) {
        let is_awaited = self.state.is_expecting();
        let beat = if is_awaited { QUICK_BEAT } else { BEAT };
        self.processes.sleep(Some(wake), beat);
    }

    /// Whether a process has failed and the run went on.
    pub(super) fn has_lost(&self) -> bool {
        self.state.has_lost()
    }

    /// Deals with the processes that have ended, and hands on what all have written.
    fn check_ends(&mut self) -> Result<(), MissionError> {
        self.forward_lines();
        for index in 0..self.processes.len() {
            if self.processes[index].check_exit() {
                self.happened(index, Event::Ended(self.how_it_ended(index)))?;
            }
        }
        Ok(())
    }

    /// Deals with everything that has happened to the processes since time began.
    ///
    /// # Errors
    /// [`MissionError`] if one of them ends the run.
    pub(crate) fn attend(&mut self) -> Result<(), MissionError> {
        self.check_ends()?;
        let page = self.overseer.page();
        let see = |process: &RunningProcess| Seen {
            is_prepared: page.state(process.slot) == SlotState::Prepared,
            takes_part: page.state(process.slot).takes_part(),
            done: page.ticks_done(process.slot),
            is_vacant: self
                .bridge
                .as_ref()
                .is_none_or(|bridge| bridge.is_vacant(process.slot)),
        };
        let seen: Vec<Seen> = self.processes.iter().map(see).collect();
        let processes = &self.processes;
        let is_stopped = |index: usize| processes[index].is_stopped();
        let (now, posted) = (Instant::now(), page.ticks_posted());
        for (index, event) in self.state.look(now, posted, &seen, is_stopped) {
            self.happened(index, event)?;
        }
        Ok(())
    }

    /// Decides about an event and acts on it, and on what follows from that.
    fn happened(&mut self, index: usize, event: Event) -> Result<(), MissionError> {
        let mut next = Some(event);
        while let Some(event) = next.take() {
            let page = self.overseer.page();
            let at = Moment {
                now: Instant::now(),
                posted: page.ticks_posted(),
                done: page.ticks_done(self.processes[index].slot),
            };
            for action in self.state.decide(index, event, at) {
                if let Some(event) = self.act(index, action)? {
                    next = Some(event);
                }
            }
        }
        Ok(())
    }

    /// Takes an action; the event that follows from it at once.
    fn act(&mut self, index: usize, action: Action) -> Result<Option<Event>, MissionError> {
        let process = &mut self.processes[index];
        let slot = process.slot;
        match action {
            Action::Kill => {
                process.kill();
                return Ok(Some(Event::Ended(self.how_it_ended(index))));
            }
            Action::Stop => self.overseer.set_phase(Phase::Stop),
            Action::FreeDead => {
                if let Some(log) = &self.log {
                    log.drain();
                }
                self.resources.bus.clean_up_dead();
            }
            Action::MarkDead => self.overseer.bury(slot),
            Action::Restart => {
                self.overseer.reseat(slot);
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
            } => self.tell(slot, kind, tick, failures, &reason),
            Action::Warn(text) => tracing::warn!("process {} {text}", process.name),
            Action::End { failure, when } => return Err(self.error(index, failure, when)),
        }
        Ok(None)
    }

    /// Ends all processes, and hands on what they wrote last.
    pub(crate) fn stop(&mut self) {
        self.overseer.set_phase(Phase::Stop);
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
        self.overseer.page().ticks_posted().saturating_sub(1)
    }

    fn how_it_ended(&self, index: usize) -> String {
        let exit = self.processes[index].exit;
        exit.map_or_else(|| "ended".into(), shm_usage::exit_words)
    }

    fn tell(&self, slot: usize, kind: u32, tick: u64, failures: u32, reason: &str) {
        let Some(log) = &self.log else { return };
        let mut event = ProcessEvent {
            tick,
            process: slot as u32,
            kind,
            failures,
            ..ProcessEvent::default()
        };
        event.set_reason(reason);
        log.publish_event(self.tick(), event);
    }

    /// Why the run ends because of a process.
    fn error(&self, index: usize, failure: Failure, when: String) -> MissionError {
        let process = &self.processes[index];
        let (name, last_words) = (process.name.clone(), process.last_words());
        match failure {
            Failure::Exited(how) | Failure::NotStarted(how) => MissionError::Exited {
                name,
                how,
                when,
                last_words,
            },
            Failure::Hung(waited) => MissionError::Hung {
                name,
                tick: self.tick(),
                waited,
                last_words,
            },
            Failure::NotReady(waited) => MissionError::NotReady {
                name,
                waited,
                last_words,
            },
        }
    }
}

impl Drop for Supervisor<'_> {
    fn drop(&mut self) {
        self.stop();
    }
}
