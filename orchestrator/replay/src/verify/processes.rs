//! The processes under test: separate processes, or members of this process.

use mcap_log::LogReadError;

use crate::ReplayError;
use mission::MissionError;
use mission::in_process::LocalProcesses;
use mission::stepped_processes::SteppedProcesses;

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

impl ProcessesUnderTest for SteppedProcesses {
    fn connect(&mut self) -> Result<(), ReplayError> {
        or_interrupted(SteppedProcesses::connect(self))
    }

    fn prepare(&mut self) -> Result<(), ReplayError> {
        or_interrupted(SteppedProcesses::prepare(self))
    }

    fn turn(&mut self, tick: u64) -> Result<(), ReplayError> {
        // The messages of the others after a failure are not in the log: it ends the test.
        or_interrupted(self.step(tick))
    }
}

/// Returns the error of an interrupted step.
pub(super) fn or_interrupted(done: Result<bool, MissionError>) -> Result<(), ReplayError> {
    if done? {
        Ok(())
    } else {
        Err(LogReadError::Interrupted.into())
    }
}
