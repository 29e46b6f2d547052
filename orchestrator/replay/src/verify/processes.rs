//! The processes under test: separate processes, or members of this process.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use mcap_log::LogReadError;
use runtime::lockstep::{BarrierLeader, TickEnd};

use crate::ReplayError;
use mission::MissionError;
use mission::in_process::LocalProcesses;
use mission::resources::RunResources;
use mission::supervisor::Supervisor;

/// Processes that execute ticks on request.
pub(super) trait ProcessesUnderTest {
    /// Lets them connect their ports.
    fn connect(&mut self) -> Result<(), ReplayError>;
    /// Lets them build their data of the map, which has been sent.
    fn prepare(&mut self) -> Result<(), ReplayError>;
    /// Lets them step in a tick and waits until they have.
    fn turn(&mut self, tick: u64) -> Result<(), ReplayError>;
}

impl ProcessesUnderTest for LocalProcesses {
    fn connect(&mut self) -> Result<(), ReplayError> {
        Ok(LocalProcesses::connect(self).map_err(MissionError::from)?)
    }

    fn prepare(&mut self) -> Result<(), ReplayError> {
        Ok(LocalProcesses::prepare(self).map_err(MissionError::from)?)
    }

    fn turn(&mut self, tick: u64) -> Result<(), ReplayError> {
        Ok(self.step(tick).map_err(MissionError::from)?)
    }
}

/// Separate processes; this process posts the ticks in place of the simulator.
pub(super) struct Processes<'a> {
    supervisor: Supervisor<'a>,
    leader: BarrierLeader,
    interrupted: &'a AtomicBool,
}

impl<'a> Processes<'a> {
    /// Starts the processes of a supervisor and waits until their ports are open.
    pub(super) fn start(
        resources: &RunResources,
        supervisor: Supervisor<'a>,
        interrupted: &'a AtomicBool,
    ) -> Result<Self, ReplayError> {
        let mut processes = Self {
            supervisor,
            leader: BarrierLeader::new(Arc::clone(&resources.barrier), 0, 1 << 20),
            interrupted,
        };
        or_interrupted(processes.supervisor.start(interrupted))?;
        Ok(processes)
    }
}

impl ProcessesUnderTest for Processes<'_> {
    fn connect(&mut self) -> Result<(), ReplayError> {
        or_interrupted(self.supervisor.connect(self.interrupted))
    }

    fn prepare(&mut self) -> Result<(), ReplayError> {
        or_interrupted(self.supervisor.prepare(self.interrupted))?;
        self.supervisor.begin();
        Ok(())
    }

    fn turn(&mut self, tick: u64) -> Result<(), ReplayError> {
        self.leader.post(tick);
        loop {
            match self.leader.wait(tick) {
                TickEnd::Complete => return Ok(()),
                TickEnd::Stop => return Err(LogReadError::Interrupted.into()),
                TickEnd::Idle => self.supervisor.handle_events()?,
            }
            if self.interrupted.load(Ordering::SeqCst) {
                return Err(LogReadError::Interrupted.into());
            }
        }
    }
}

/// Returns the error of an interrupted step.
fn or_interrupted(done: Result<bool, MissionError>) -> Result<(), ReplayError> {
    if done? {
        Ok(())
    } else {
        Err(LogReadError::Interrupted.into())
    }
}
