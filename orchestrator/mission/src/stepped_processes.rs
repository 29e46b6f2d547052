//! Processes of the operating system that execute ticks on request.

use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use runtime::lockstep::{BarrierLeader, TickEnd};

use super::error::MissionError;
use super::plan::Launch;
use super::resources::RunResources;
use super::supervisor::Supervisor;
use scenario::OnFailure;

/// Separate processes whose ticks this process posts in place of the simulator. The failure of any is an error; dropping
/// them ends them.
pub struct SteppedProcesses {
    supervisor: Supervisor,
    leader: BarrierLeader,
    interrupted: Arc<AtomicBool>,
}

impl SteppedProcesses {
    /// Starts processes, without waiting for them; with `echo`, their output is shown.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub fn start(
        resources: &Rc<RunResources>,
        mut launches: Vec<Launch>,
        hang_timeout: Duration,
        echo: bool,
        interrupted: &Arc<AtomicBool>,
    ) -> Result<Self, MissionError> {
        for launch in &mut launches {
            launch.supervision.on_failure = OnFailure::Abort;
        }
        let mut supervisor = Supervisor::new(Rc::clone(resources), launches, hang_timeout, echo);
        supervisor.start()?;
        Ok(Self {
            supervisor,
            leader: BarrierLeader::new(Arc::clone(&resources.barrier), 0, 1 << 20),
            interrupted: Arc::clone(interrupted),
        })
    }

    /// Waits until their ports are open. Returns `false` if interrupted before, as the following functions do.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub fn open(&mut self) -> Result<bool, MissionError> {
        self.supervisor.open(&self.interrupted)
    }

    /// Lets them connect their ports.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn connect(&mut self) -> Result<bool, MissionError> {
        self.supervisor.connect(&self.interrupted)
    }

    /// Lets them build their data of the map, which has been sent.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn prepare(&mut self) -> Result<bool, MissionError> {
        let are_prepared = self.supervisor.prepare(&self.interrupted)?;
        self.supervisor.begin();
        Ok(are_prepared)
    }

    /// Lets them step in a tick and waits until they have.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn step(&mut self, tick: u64) -> Result<bool, MissionError> {
        self.leader.post(tick);
        loop {
            match self.leader.wait(tick) {
                TickEnd::Complete => return Ok(true),
                TickEnd::Stop => return Ok(false),
                TickEnd::Idle => self.supervisor.handle_events()?,
            }
            if self.interrupted.load(Ordering::SeqCst) {
                return Ok(false);
            }
        }
    }
}
