//! The processes under test, as whoever leads the loop sees them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use runtime::lockstep::{Conductor, Overseer, Phase, SlotState, TurnEnd, TurnPage};

use super::super::error::LogsError;
use super::stage::Stage;
use crate::in_process::Members;
use crate::mission::bridge::Bridge;
use crate::mission::children::{RunningProcess, end_all, sleep_until_exit};
use crate::mission::plan::{Launch, Plan};
use crate::mission::{MissionError, room, write_config};

/// Time that processes have to get ready.
const READY_WITHIN: Duration = Duration::from_secs(60);
/// Time that processes have to end by themselves.
const END_WITHIN: Duration = Duration::from_secs(3);

/// The processes under test.
pub(super) trait Cast {
    /// Connects everybody.
    fn connect(&mut self) -> Result<(), LogsError>;
    /// Lets everybody build what it needs of the map, which has been sent.
    fn prepare(&mut self) -> Result<(), LogsError>;
    /// Gives everybody the turn of a tick and waits until it is done.
    fn turn(&mut self, tick: u64) -> Result<(), LogsError>;
}

impl Cast for Members {
    fn connect(&mut self) -> Result<(), LogsError> {
        Ok(Members::connect(self).map_err(MissionError::from)?)
    }

    fn prepare(&mut self) -> Result<(), LogsError> {
        Ok(Members::prepare(self).map_err(MissionError::from)?)
    }

    fn turn(&mut self, tick: u64) -> Result<(), LogsError> {
        Ok(self.step(tick).map_err(MissionError::from)?)
    }
}

/// Real processes; they end when this is dropped.
pub(super) struct Processes {
    running: Vec<RunningProcess>,
    overseer: Overseer,
    conductor: Conductor,
    bridge: Option<Bridge>,
    hang_timeout: Duration,
    interrupted: Arc<AtomicBool>,
}

impl Processes {
    /// Starts these processes of a run, with nobody else at its page; with `echo` their lines are shown.
    pub(super) fn start(
        stage: &Stage,
        launches: &[Launch],
        hang_timeout: Duration,
        interrupted: Arc<AtomicBool>,
        echo: bool,
    ) -> Result<Self, MissionError> {
        let prefix = stage.space.space().prefix();
        let page = Arc::new(TurnPage::create(prefix, stage.plan.launches.len())?);
        let overseer = Overseer::new(Arc::clone(&page));
        for launch in launches {
            overseer.seat(launch.config.index as usize, true, launch.watched);
        }
        let tested = Plan {
            launches: launches.to_vec(),
            ..stage.plan.clone()
        };
        let bridge = Bridge::start(&tested, &stage.bus, &page)?;
        let mut started = Self {
            running: Vec::new(),
            overseer,
            conductor: Conductor::new(page, 0, 1 << 20),
            bridge: Some(bridge),
            hang_timeout,
            interrupted,
        };
        for launch in launches {
            room::check_start()?;
            let path = write_config(stage.root(), &launch.config)?;
            let slot = launch.config.index as usize;
            let name = &launch.config.name;
            let process = RunningProcess::start(name, slot, &launch.executable, &path, echo)?;
            started.running.push(process);
        }
        Ok(started)
    }

    /// An error if the test is interrupted.
    fn check_interrupt(&self) -> Result<(), LogsError> {
        if self.interrupted.load(Ordering::SeqCst) {
            return Err(LogsError::Interrupted);
        }
        Ok(())
    }

    /// An error if somebody ended before its time; `when` says when.
    fn check_exits(&mut self, when: &str) -> Result<(), MissionError> {
        match self
            .running
            .iter_mut()
            .find_map(|process| process.check_exit().then_some(process))
        {
            None => Ok(()),
            Some(process) => Err(MissionError::Exited {
                name: process.name.clone(),
                how: process
                    .exit
                    .map_or_else(|| "ended".into(), room::exit_words),
                when: when.to_owned(),
                last_words: process.last_words(),
            }),
        }
    }

    /// Waits until nobody is in one of these states any more.
    fn wait(&mut self, behind: &[SlotState]) -> Result<(), LogsError> {
        let deadline = Instant::now() + READY_WITHIN;
        loop {
            self.check_exits("before it was ready")?;
            let page = self.overseer.page();
            let mut processes = self.running.iter();
            let Some(last) = processes.find(|p| behind.contains(&page.state(p.slot))) else {
                return Ok(());
            };
            self.check_interrupt()?;
            if Instant::now() >= deadline {
                return Err(LogsError::Mission(MissionError::NotReady {
                    name: last.name.clone(),
                    waited: READY_WITHIN,
                    last_words: last.last_words(),
                }));
            }
            sleep_until_exit(&self.running, None, Duration::from_millis(2));
        }
    }

    /// Waits until everybody has opened its ports.
    pub(super) fn ready(&mut self) -> Result<(), LogsError> {
        self.wait(&[SlotState::Starting])
    }
}

impl Cast for Processes {
    fn connect(&mut self) -> Result<(), LogsError> {
        self.overseer.set_phase(Phase::Connect);
        self.wait(&[SlotState::Starting, SlotState::Ready])
    }

    fn prepare(&mut self) -> Result<(), LogsError> {
        self.overseer.set_phase(Phase::Prepare);
        self.wait(&[SlotState::Starting, SlotState::Ready, SlotState::Connected])?;
        self.overseer.set_phase(Phase::Run);
        Ok(())
    }

    fn turn(&mut self, tick: u64) -> Result<(), LogsError> {
        self.conductor.post(tick);
        let deadline = Instant::now() + self.hang_timeout;
        loop {
            match self.conductor.wait(tick) {
                TurnEnd::Complete => return Ok(()),
                TurnEnd::Stop => return Err(LogsError::Interrupted),
                TurnEnd::Idle => {}
            }
            self.check_exits(&format!("at tick {tick}"))?;
            self.check_interrupt()?;
            let page = self.overseer.page();
            let mut processes = self.running.iter();
            let owing = processes.find(|p| page.ticks_done(p.slot) <= tick);
            if let Some(owing) = owing.filter(|_| Instant::now() >= deadline) {
                return Err(LogsError::Mission(MissionError::Hung {
                    name: owing.name.clone(),
                    tick,
                    waited: self.hang_timeout,
                    last_words: owing.last_words(),
                }));
            }
        }
    }
}

impl Drop for Processes {
    fn drop(&mut self) {
        self.overseer.set_phase(Phase::Stop);
        for name in end_all(&mut self.running, END_WITHIN) {
            tracing::warn!("process {name} did not end and was killed");
        }
        if let Some(bridge) = self.bridge.take()
            && let Err(error) = bridge.finish()
        {
            tracing::warn!("bridge to external processes: {error}");
        }
    }
}
