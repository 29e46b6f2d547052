//! The processes under test, as whoever leads the loop sees them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ipc_types::bus::Bus;
use kit::lockstep::{Conductor, Overseer, Phase, SlotState, TurnEnd, TurnPage};

use super::stage::Stage;
use crate::in_process::Members;
use crate::mission::bridge::Bridge;
use crate::mission::children::{RunningProcess, end_all, sleep_until_exit};
use crate::mission::plan::{Launch, Plan};
use crate::mission::{MissionError, config_path, room, write_config};

/// Time that processes have to get ready.
const READY_WITHIN: Duration = Duration::from_secs(60);
/// Time that processes have to end by themselves.
const END_WITHIN: Duration = Duration::from_secs(3);

/// The processes under test. A false answer means: interrupted.
pub(super) trait Cast {
    /// Connects everybody.
    fn connect(&mut self) -> Result<bool, MissionError>;
    /// Lets everybody build what it needs of the map, which has been sent.
    fn prepare(&mut self) -> Result<bool, MissionError>;
    /// Gives everybody the turn of a tick and waits until it is done.
    fn turn(&mut self, tick: u64) -> Result<bool, MissionError>;
}

impl Cast for Members {
    fn connect(&mut self) -> Result<bool, MissionError> {
        Members::connect(self)?;
        Ok(true)
    }

    fn prepare(&mut self) -> Result<bool, MissionError> {
        Members::prepare(self)?;
        Ok(true)
    }

    fn turn(&mut self, tick: u64) -> Result<bool, MissionError> {
        self.step(tick)?;
        Ok(true)
    }
}

/// Real processes; they end when this is dropped.
pub(super) struct Processes<'a> {
    stage: &'a Stage,
    running: Vec<RunningProcess>,
    overseer: Overseer,
    conductor: Conductor,
    bridge: Option<Bridge>,
    hang_timeout: Duration,
    interrupted: Arc<AtomicBool>,
    /// Whether their lines are shown.
    echo: bool,
}

impl<'a> Processes<'a> {
    /// Starts these processes of a run, with nobody else at its page.
    pub(super) fn start(
        stage: &'a Stage,
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
            stage,
            running: Vec::new(),
            overseer,
            conductor: Conductor::new(page, 0, 1 << 20),
            bridge: Some(bridge),
            hang_timeout,
            interrupted,
            echo,
        };
        for launch in launches {
            room::check_start()?;
            write_config(stage.root(), &launch.config)?;
            started.launch(launch)?;
        }
        Ok(started)
    }

    /// Starts a process whose configuration is written.
    fn launch(&mut self, launch: &Launch) -> Result<(), MissionError> {
        let path = config_path(self.stage.root(), &launch.config);
        let slot = launch.config.index as usize;
        let name = &launch.config.name;
        let process = RunningProcess::start(name, slot, &launch.executable, &path, self.echo)?;
        self.running.push(process);
        Ok(())
    }

    fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    /// Whether somebody ended before its time; `when` says when.
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
    fn wait(&mut self, phase: Option<Phase>, behind: &[SlotState]) -> Result<bool, MissionError> {
        if let Some(phase) = phase {
            self.overseer.set_phase(phase);
        }
        let deadline = Instant::now() + READY_WITHIN;
        loop {
            self.check_exits("before it was ready")?;
            let page = self.overseer.page();
            let mut processes = self.running.iter();
            let Some(last) = processes.find(|p| behind.contains(&page.state(p.slot))) else {
                return Ok(true);
            };
            if self.interrupted() {
                return Ok(false);
            }
            if Instant::now() >= deadline {
                return Err(MissionError::NotReady {
                    name: last.name.clone(),
                    waited: READY_WITHIN,
                    last_words: last.last_words(),
                });
            }
            sleep_until_exit(&self.running, None, Duration::from_millis(2));
        }
    }

    /// Waits until everybody has opened its ports.
    pub(super) fn ready(&mut self) -> Result<bool, MissionError> {
        self.wait(None, &[SlotState::Starting])
    }
}

impl Cast for Processes<'_> {
    fn connect(&mut self) -> Result<bool, MissionError> {
        self.wait(
            Some(Phase::Connect),
            &[SlotState::Starting, SlotState::Ready],
        )
    }

    fn prepare(&mut self) -> Result<bool, MissionError> {
        let behind = [SlotState::Starting, SlotState::Ready, SlotState::Connected];
        let prepared = self.wait(Some(Phase::Prepare), &behind)?;
        if prepared {
            self.overseer.set_phase(Phase::Run);
        }
        Ok(prepared)
    }

    fn turn(&mut self, tick: u64) -> Result<bool, MissionError> {
        self.conductor.post(tick);
        let deadline = Instant::now() + self.hang_timeout;
        loop {
            match self.conductor.wait(tick) {
                TurnEnd::Complete => return Ok(true),
                TurnEnd::Stop => return Ok(false),
                TurnEnd::Idle => {
                    self.check_exits(&format!("at tick {tick}"))?;
                    if self.interrupted() {
                        return Ok(false);
                    }
                    let page = self.overseer.page();
                    let mut processes = self.running.iter();
                    let owing = processes.find(|p| page.ticks_done(p.slot) <= tick);
                    if let Some(owing) = owing
                        && Instant::now() >= deadline
                    {
                        return Err(MissionError::Hung {
                            name: owing.name.clone(),
                            tick,
                            waited: self.hang_timeout,
                            last_words: owing.last_words(),
                        });
                    }
                }
            }
        }
    }
}

impl Drop for Processes<'_> {
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

/// Opens the processes under test in this thread.
pub(super) fn within(launches: &[Launch], bus: &Bus) -> Result<Members, MissionError> {
    Ok(Members::open(launches, bus)?)
}
