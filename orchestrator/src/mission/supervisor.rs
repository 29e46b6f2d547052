//! Supervision of the processes of a run: brings what happens to them before [`super::decide`], and takes the
//! actions that are decided there.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use ipc_types::messages::process::ProcessEvent;
use runtime::config::Clock;
use runtime::lockstep::{Overseer, Phase, SlotState};

use super::bridge::Bridge;
use super::children::{ChildError, RunningProcess, end_all};
use super::chronicle::Chronicle;
use super::decide::{Action, Event, Moment, Seen, State};
use super::error::MissionError;
use super::failure::Failure;
use super::gate::Calls;
use super::plan::Plan;
use super::room;
use super::run::{MissionOptions, config_path, write_config};
use super::spaces::OwnedSpace;

/// The processes of a run and what acts on them.
pub(super) struct Supervisor<'a> {
    plan: &'a Plan,
    space: &'a OwnedSpace,
    bus: &'a Bus,
    overseer: Overseer,
    chronicle: Chronicle,
    /// By their index in the run.
    pub(super) processes: Vec<RunningProcess>,
    state: State,
    recorder: Arc<Calls>,
    /// Whether the lines of the processes are shown.
    echo: bool,
}

impl<'a> Supervisor<'a> {
    /// Supervises the processes of this plan, once they are started.
    ///
    /// # Errors
    /// [`MissionError`] if the topics of process events and lines cannot be opened.
    pub(super) fn new(
        plan: &'a Plan,
        space: &'a OwnedSpace,
        bus: &'a Bus,
        overseer: Overseer,
        hang_timeout: Duration,
        recorder: Arc<Calls>,
        options: &MissionOptions,
    ) -> Result<Self, MissionError> {
        let chronicle = Chronicle::open(bus, plan.orchestrator_index(), plan.run.tick_period_ns)?;
        let in_lock_step = plan.run.clock == Clock::LockStep;
        Ok(Self {
            plan,
            space,
            bus,
            overseer,
            chronicle,
            processes: Vec::new(),
            state: State::new(plan, in_lock_step, hang_timeout),
            recorder,
            echo: !options.quiet,
        })
    }

    /// Starts all processes.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub(super) fn start(&mut self) -> Result<(), MissionError> {
        for (slot, launch) in self.plan.launches.iter().enumerate() {
            room::check_start()?;
            write_config(self.space.space().root(), &launch.config)?;
            let process = self.launch(slot)?;
            self.processes.push(process);
        }
        Ok(())
    }

    fn launch(&self, slot: usize) -> Result<RunningProcess, ChildError> {
        let launch = &self.plan.launches[slot];
        let config = config_path(self.space.space().root(), &launch.config);
        RunningProcess::start_heard(
            &launch.config.name,
            slot,
            &launch.executable,
            &config,
            self.echo,
            Some(self.chronicle.ear()),
        )
    }

    /// Connects to the recorder.
    ///
    /// # Errors
    /// [`MissionError`] if the bus refuses.
    pub(super) fn connect(&self) -> Result<(), MissionError> {
        self.chronicle.connect()
    }

    /// Time begins.
    pub(super) fn begin(&mut self) {
        self.state.begin(Instant::now());
    }

    /// Whether a process is to come back.
    pub(super) fn is_expecting(&self) -> bool {
        self.state.is_expecting()
    }

    /// Whether a process has failed and the run went on.
    pub(super) fn has_lost(&self) -> bool {
        self.state.has_lost()
    }

    /// Deals with the processes that have ended, and hands on what all have written.
    ///
    /// # Errors
    /// [`MissionError`] if one of them ends the run.
    pub(super) fn check_ends(&mut self) -> Result<(), MissionError> {
        self.chronicle.hand_on(self.tick());
        for slot in 0..self.processes.len() {
            if self.processes[slot].check_exit() {
                self.happened(slot, Event::Ended(self.how_it_ended(slot)))?;
            }
        }
        Ok(())
    }

    /// Deals with everything that has happened to the processes since time began.
    ///
    /// # Errors
    /// [`MissionError`] if one of them ends the run.
    pub(super) fn attend(&mut self, bridge: &Bridge) -> Result<(), MissionError> {
        self.check_ends()?;
        let page = self.overseer.page();
        let seen: Vec<Seen> = (0..self.processes.len())
            .map(|slot| Seen {
                is_prepared: page.state(slot) == SlotState::Prepared,
                takes_part: page.state(slot).takes_part(),
                done: page.ticks_done(slot),
                is_vacant: bridge.is_vacant(slot),
            })
            .collect();
        let processes = &self.processes;
        let is_stopped = |slot: usize| processes[slot].is_stopped();
        let (now, posted) = (Instant::now(), page.ticks_posted());
        for (slot, event) in self.state.look(now, posted, &seen, is_stopped) {
            self.happened(slot, event)?;
        }
        Ok(())
    }

    /// The process that is not yet this far in the hand-shake, and the time that it has for that.
    pub(super) fn behind(&self, wanted: SlotState) -> Option<(usize, Duration)> {
        let page = self.overseer.page();
        let slot = self.processes.iter().position(|process| {
            let state = page.state(process.slot);
            match wanted {
                SlotState::Ready => state == SlotState::Starting,
                SlotState::Connected => matches!(state, SlotState::Starting | SlotState::Ready),
                _ => state.is_alive() && state != SlotState::Prepared,
            }
        })?;
        Some((slot, self.state.ready_timeout(slot)))
    }

    /// Decides about an event and acts on it, and on what follows from that.
    ///
    /// # Errors
    /// [`MissionError`] if it ends the run.
    pub(super) fn happened(&mut self, slot: usize, event: Event) -> Result<(), MissionError> {
        let mut next = Some(event);
        while let Some(event) = next.take() {
            let page = self.overseer.page();
            let at = Moment {
                now: Instant::now(),
                posted: page.ticks_posted(),
                done: page.ticks_done(slot),
            };
            for action in self.state.decide(slot, event, at) {
                match action {
                    Action::Kill => {
                        self.processes[slot].kill();
                        next = Some(Event::Ended(self.how_it_ended(slot)));
                    }
                    Action::Stop => self.overseer.set_phase(Phase::Stop),
                    Action::FreeDead => {
                        self.recorder.call();
                        self.bus.clean_up_dead();
                    }
                    Action::MarkDead => self.overseer.bury(slot),
                    Action::Restart => {
                        self.overseer.reseat(slot);
                        match self.launch(slot) {
                            Ok(process) => self.processes[slot] = process,
                            Err(error) => next = Some(Event::NotStarted(error.of_it())),
                        }
                    }
                    Action::Tell {
                        kind,
                        tick,
                        failures,
                        reason,
                    } => self.tell(slot, kind, tick, failures, &reason),
                    Action::Warn(text) => {
                        tracing::warn!("process {} {text}", self.processes[slot].name);
                    }
                    Action::End { failure, when } => return Err(self.error(slot, failure, when)),
                }
            }
        }
        Ok(())
    }

    /// Ends all processes, and hands on what they wrote last.
    pub(super) fn end(&mut self, patience: Duration) {
        for name in end_all(&mut self.processes, patience) {
            tracing::warn!("process {name} did not end and was killed");
        }
        self.chronicle.hand_on(self.tick());
    }

    /// The last tick that was posted.
    fn tick(&self) -> u64 {
        self.overseer.page().ticks_posted().saturating_sub(1)
    }

    fn how_it_ended(&self, slot: usize) -> String {
        let exit = self.processes[slot].exit;
        exit.map_or_else(|| "ended".into(), room::exit_words)
    }

    fn tell(&self, slot: usize, kind: u32, tick: u64, failures: u32, reason: &str) {
        let mut event = ProcessEvent {
            tick,
            process: slot as u32,
            kind,
            failures,
            ..ProcessEvent::default()
        };
        event.set_reason(reason);
        self.chronicle.tell(self.tick(), event);
    }

    /// Why the run ends because of a process.
    fn error(&self, slot: usize, failure: Failure, when: String) -> MissionError {
        let process = &self.processes[slot];
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
