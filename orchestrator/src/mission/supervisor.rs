//! Looks after the processes of a run that is in the air: notices who ended or no longer answers,
//! and does what the scenario wants done then.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use ipc_types::messages::process::ProcessEvent;
use kit::config::Clock;
use kit::lockstep::{Overseer, Phase, SlotState};

use super::bridge::Bridge;
use super::charge::{Charge, Standing};
use super::children::{ChildError, RunningProcess, end_all};
use super::chronicle::Chronicle;
use super::error::MissionError;
use super::failure::Failure;
use super::gate::Calls;
use super::plan::Plan;
use super::room;
use super::run::{MissionOptions, config_path, write_config};
use super::spaces::OwnedSpace;
use crate::scenario::OnFailure;
use crate::scenario::kinds::{KINDS, Product, find};

/// Restarts of a process in one run; its next failure ends the run.
const MAX_RESTARTS: u32 = 5;
/// Real time between the failure of a process and its restart.
const RESTART_AFTER: Duration = Duration::from_millis(500);

/// The processes of a run, and how they are.
pub(super) struct Supervisor<'a> {
    plan: &'a Plan,
    space: &'a OwnedSpace,
    bus: &'a Bus,
    overseer: Overseer,
    chronicle: Chronicle,
    /// By their index in the run.
    pub(super) processes: Vec<RunningProcess>,
    charges: Vec<Charge>,
    hang_timeout: Duration,
    recorder: Arc<Calls>,
    /// Whether the lines of the processes are shown.
    echo: bool,
    last_tick: u64,
    last_progress: Instant,
    /// Whether a process has failed and the run went on.
    pub(super) has_lost: bool,
}

impl<'a> Supervisor<'a> {
    /// Looks after the processes of this plan, once they are started.
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
        let now = Instant::now();
        Ok(Self {
            plan,
            space,
            bus,
            overseer,
            chronicle,
            processes: Vec::new(),
            charges: Vec::new(),
            hang_timeout,
            recorder,
            echo: !options.quiet,
            last_tick: 0,
            last_progress: now,
            has_lost: false,
        })
    }

    /// Starts all processes.
    pub(super) fn start(&mut self) -> Result<(), MissionError> {
        for (slot, launch) in self.plan.launches.iter().enumerate() {
            room::check_start()?;
            write_config(self.space.space().root(), &launch.config)?;
            let process = self.launch(slot)?;
            self.processes.push(process);
            self.charges.push(Charge {
                standing: Standing::Present,
                failures: 0,
                done: 0,
                since: self.last_progress,
            });
        }
        Ok(())
    }

    /// Whether somebody is to come back.
    pub(super) fn is_expecting(&self) -> bool {
        self.charges.iter().any(|charge| {
            matches!(
                charge.standing,
                Standing::Away { .. } | Standing::Starting { .. }
            )
        })
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
    pub(super) fn connect(&self) -> Result<(), MissionError> {
        self.chronicle.connect()
    }

    /// Before time starts nobody is replaced: whoever ends then ends the run.
    pub(super) fn check_start_up(&mut self) -> Result<(), MissionError> {
        self.chronicle.hand_on(0);
        let ended = self
            .processes
            .iter_mut()
            .position(RunningProcess::check_exit);
        ended.map_or(Ok(()), |slot| {
            let how = self.how_it_ended(slot);
            Err(self.abort(slot, &Failure::Exited(how), "before it was ready"))
        })
    }

    /// The time starts.
    pub(super) fn begin(&mut self) {
        let now = Instant::now();
        self.last_progress = now;
        for charge in &mut self.charges {
            charge.since = now;
        }
    }

    /// Looks after everybody, with this many ticks posted.
    pub(super) fn attend(&mut self, ticks: u64, bridge: &Bridge) -> Result<(), MissionError> {
        let now_tick = ticks.saturating_sub(1);
        self.chronicle.hand_on(now_tick);
        for slot in 0..self.processes.len() {
            if self.processes[slot].check_exit() {
                let how = self.how_it_ended(slot);
                self.fail(slot, &Failure::Exited(how))?;
            }
        }
        self.check_starts()?;
        self.check_silence(ticks)?;
        self.start_the_due(bridge)
    }

    fn how_it_ended(&self, slot: usize) -> String {
        let exit = self.processes[slot].exit;
        exit.map_or_else(|| "ended".into(), room::exit_words)
    }

    /// Whoever was started again may be back, or take too long.
    fn check_starts(&mut self) -> Result<(), MissionError> {
        for slot in 0..self.charges.len() {
            let Standing::Starting { until } = self.charges[slot].standing else {
                continue;
            };
            let page = self.overseer.page();
            if page.state(slot) == SlotState::Prepared {
                let (tick, done) = (page.ticks_posted(), page.ticks_done(slot));
                let charge = &mut self.charges[slot];
                charge.standing = Standing::Present;
                charge.done = done;
                charge.since = Instant::now();
                let failures = charge.failures;
                self.tell(slot, ProcessEvent::BACK, tick, failures, "");
                let name = &self.plan.launches[slot].config.name;
                tracing::warn!("process {name} is back from tick {tick} on");
            } else if Instant::now() >= until {
                let waited = self.ready_timeout(slot);
                self.processes[slot].kill();
                self.fail(slot, &Failure::NotReady(waited))?;
            }
        }
        Ok(())
    }

    fn ready_timeout(&self, slot: usize) -> Duration {
        Duration::from_secs_f64(self.plan.launches[slot].supervision.ready_timeout_s)
    }

    /// Whoever is alive but does nothing is killed.
    fn check_silence(&mut self, ticks: u64) -> Result<(), MissionError> {
        let now = Instant::now();
        if ticks != self.last_tick {
            (self.last_tick, self.last_progress) = (ticks, now);
        } else if now - self.last_progress >= self.hang_timeout {
            self.last_progress = now;
            let slot = match self.plan.run.clock {
                Clock::LockStep => self.who_holds_up(ticks.saturating_sub(1)),
                Clock::RealTime { .. } => 0,
            };
            return self.hang(slot);
        }
        if self.plan.run.clock == Clock::LockStep {
            return Ok(());
        }
        // By the clock the world goes on without those who do not answer.
        for slot in 1..self.charges.len() {
            let done = self.overseer.page().ticks_done(slot);
            let takes_part = self.overseer.page().state(slot).takes_part();
            let charge = &mut self.charges[slot];
            if charge.standing != Standing::Present || !takes_part {
                continue;
            }
            if done != charge.done || done >= ticks {
                (charge.done, charge.since) = (done, now);
            } else if now - charge.since >= self.hang_timeout {
                charge.since = now;
                self.hang(slot)?;
            }
        }
        Ok(())
    }

    fn hang(&mut self, slot: usize) -> Result<(), MissionError> {
        if self.policy(slot) != OnFailure::Abort {
            self.processes[slot].kill();
        }
        self.fail(slot, &Failure::Hung)
    }

    /// Who owes the tick that everybody waits for: rather one that stands still or that others wait
    /// for than one that may be waiting.
    fn who_holds_up(&self, tick: u64) -> usize {
        let page = self.overseer.page();
        let owes = |slot: usize| page.state(slot).takes_part() && page.ticks_done(slot) <= tick;
        let owing: Vec<usize> = (1..self.processes.len())
            .filter(|&slot| owes(slot))
            .collect();
        let waits = |slot: usize| {
            let upstream = &self.plan.launches[slot].config.upstream;
            upstream.iter().any(|&up| owes(up as usize))
        };
        let makes_plans = |slot: usize| {
            let kind = find(KINDS, &self.plan.launches[slot].config.kind);
            kind.is_some_and(|kind| kind.makes(Product::Plans))
        };
        let mut of = owing.iter().copied();
        of.clone()
            .find(|&slot| self.processes[slot].is_stopped())
            .or_else(|| of.clone().find(|&slot| makes_plans(slot)))
            .or_else(|| of.find(|&slot| !waits(slot)))
            .unwrap_or(0)
    }

    /// Starts those whose time has come.
    fn start_the_due(&mut self, bridge: &Bridge) -> Result<(), MissionError> {
        for slot in 0..self.charges.len() {
            let Standing::Away { due } = self.charges[slot].standing else {
                continue;
            };
            if Instant::now() < due || !bridge.is_vacant(slot) {
                continue;
            }
            // Whatever its predecessor has left takes up its place.
            self.clean_up_dead();
            self.overseer.reseat(slot);
            self.charges[slot].standing = Standing::Starting {
                until: Instant::now() + self.ready_timeout(slot),
            };
            match self.launch(slot) {
                Ok(process) => self.processes[slot] = process,
                Err(error) => self.fail(slot, &Failure::NotStarted(error.of_it()))?,
            }
        }
        Ok(())
    }

    /// What is to be done about the next failure of a process.
    fn policy(&self, slot: usize) -> OnFailure {
        match self.plan.launches[slot].supervision.on_failure {
            _ if slot == 0 => OnFailure::Abort,
            OnFailure::Restart if self.charges[slot].failures >= MAX_RESTARTS => OnFailure::Abort,
            policy => policy,
        }
    }

    /// Does what is to be done about a process that has ended, or that ends the run.
    fn fail(&mut self, slot: usize, failure: &Failure) -> Result<(), MissionError> {
        let page = self.overseer.page();
        let posted = page.ticks_posted();
        // Asked only now, when the process is known to be dead, and before it is buried: in between
        // nobody gets past the tick that it owes.
        let left = match self.plan.run.clock {
            Clock::LockStep if slot != 0 => page.ticks_done(slot),
            _ => posted.saturating_sub(1),
        };
        let policy = self.policy(slot);
        let words = failure.words(self.hang_timeout);
        let failures = self.charges[slot].failures + 1;
        self.tell(slot, ProcessEvent::LEFT, left, failures, &words);
        if policy == OnFailure::Abort {
            return Err(self.abort(
                slot,
                failure,
                &format!("at tick {}", posted.saturating_sub(1)),
            ));
        }
        self.has_lost = true;
        let config = &self.plan.launches[slot].config;
        let name = &config.name;
        // Before it is buried: a sender with a full buffer towards it must not go on waiting.
        self.clean_up_dead();
        self.charges[slot].standing = if policy == OnFailure::Restart {
            tracing::warn!(
                "process {name} {words} at tick {left}; it is started again, restart {failures} of \
                 {MAX_RESTARTS}"
            );
            Standing::Away {
                due: Instant::now() + RESTART_AFTER,
            }
        } else {
            let so = if config.robots.is_empty() {
                "the run goes on without it"
            } else {
                "its robots stand still"
            };
            self.tell(slot, ProcessEvent::GIVEN_UP, left, failures, so);
            tracing::warn!("process {name} {words} at tick {left}; {so}");
            Standing::Gone
        };
        self.charges[slot].failures = failures;
        self.overseer.bury(slot);
        Ok(())
    }

    /// Frees what the dead have left, once the recorder has taken what they had said.
    fn clean_up_dead(&self) {
        self.recorder.call();
        self.bus.clean_up_dead();
    }

    /// Ends the run because of a process.
    fn abort(&mut self, slot: usize, failure: &Failure, when: &str) -> MissionError {
        let process = &self.processes[slot];
        if process.exit.is_some() {
            // Stopped first: nobody waits for the buried, and the world must not go on without.
            self.overseer.set_phase(Phase::Stop);
            self.overseer.bury(slot);
            self.clean_up_dead();
        }
        let (name, last_words) = (process.name.clone(), process.last_words());
        let restarts = self.charges.get(slot).map_or(0, |charge| charge.failures);
        let again = match restarts {
            0 => String::new(),
            1 => " after one restart".to_owned(),
            n => format!(" after {n} restarts"),
        };
        match failure {
            Failure::Exited(how) | Failure::NotStarted(how) => MissionError::Exited {
                name,
                how: how.clone(),
                when: format!("{when}{again}"),
                last_words,
            },
            Failure::Hung => MissionError::Hung {
                name,
                tick: self.overseer.page().ticks_posted().saturating_sub(1),
                waited: self.hang_timeout,
                last_words,
            },
            Failure::NotReady(waited) => MissionError::NotReady {
                name,
                waited: *waited,
                last_words,
            },
        }
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
        let now = self.overseer.page().ticks_posted().saturating_sub(1);
        self.chronicle.tell(now, event);
    }

    /// Who is not yet this far in the hand-shake, and since when its time is over.
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
        Some((slot, self.ready_timeout(slot)))
    }

    /// The run ends because a process was not ready in time.
    pub(super) fn not_ready(&mut self, slot: usize, waited: Duration) -> MissionError {
        self.abort(slot, &Failure::NotReady(waited), "")
    }

    /// Ends everybody, and hands on what they said last.
    pub(super) fn end(&mut self, patience: Duration) {
        for name in end_all(&mut self.processes, patience) {
            tracing::warn!("process {name} did not end and was killed");
        }
        self.chronicle
            .hand_on(self.overseer.page().ticks_posted().saturating_sub(1));
    }
}
