//! Supervision of the processes of a run: passes their events to `decide`, and the resulting actions to `executor`.

use std::os::fd::BorrowedFd;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use runtime::config::Clock;
use runtime::lockstep::{Phase, SlotState};

use super::decide::{Event, StartStep, State};
use super::error::MissionError;
use super::executor::Executor;
use super::plan::Launch;
use super::process_log::ProcessEventLog;
use super::resources::RunResources;
use super::shm_usage;

/// Interval between two checks while a process is awaited, at the start or after a failure. Processes publish their
/// progress at the barrier; a few milliseconds are short compared with the start of a process.
const SHORT_POLL_INTERVAL: Duration = Duration::from_millis(2);
/// Interval between two checks at other times. The end of a process wakes the supervisor at once.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Supervisor of the processes of a run: starts, observes and stops them, at the latest when it is dropped.
pub struct Supervisor {
    executor: Executor,
    state: State,
}

impl Supervisor {
    /// Assigns each of these processes its slot at the barrier; with `echo`, their output is shown.
    pub fn new(
        resources: Rc<RunResources>,
        launches: Vec<Launch>,
        hang_timeout: Duration,
        echo: bool,
    ) -> Self {
        let in_lock_step = resources.plan.run.clock == Clock::LockStep;
        Self {
            state: State::new(&launches, in_lock_step, hang_timeout),
            executor: Executor::new(resources, launches, echo),
        }
    }

    /// Sends the events and output lines of the processes to the log.
    pub(super) fn with_log(mut self, log: ProcessEventLog) -> Self {
        self.executor.log = Some(log);
        self
    }

    /// Starts all processes.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub(super) fn start(&mut self) -> Result<(), MissionError> {
        self.executor.start()
    }

    /// Waits until the ports of all processes are open. Returns `false` if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub(super) fn open(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.reach(SlotState::Ready, interrupted)
    }

    /// Lets the processes connect their ports and waits until they have. Returns `false` if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub fn connect(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.executor.enter(Phase::Connect);
        let connected = self.reach(SlotState::Connected, interrupted)?;
        if let Some(log) = &self.executor.log {
            log.connect()?;
        }
        Ok(connected)
    }

    /// Lets the processes build their data of the map, which has been sent, and waits until they have. Returns `false`
    /// if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub fn prepare(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.executor.enter(Phase::Prepare);
        self.reach(SlotState::Prepared, interrupted)
    }

    /// Starts the first tick.
    pub fn begin(&mut self) {
        self.state.begin(Instant::now());
        self.executor.enter(Phase::Run);
    }

    /// Waits until every process is in this state or a later one. Returns `false` if `interrupted` before.
    fn reach(&mut self, wanted: SlotState, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        let start = Instant::now();
        loop {
            let seen = self.executor.observe();
            // Checked first: full shared memory is then the cause of a process's end.
            shm_usage::check_start()?;
            self.check_ends()?;
            match self.state.start_step(wanted, start.elapsed(), &seen) {
                StartStep::Done => return Ok(true),
                _ if interrupted.load(Ordering::SeqCst) => return Ok(false),
                StartStep::Late(index) => self.handle(index, Event::NotReady)?,
                StartStep::Waiting => {}
            }
            self.executor.sleep(None, SHORT_POLL_INTERVAL);
        }
    }

    /// Handles the processes that have ended.
    fn check_ends(&mut self) -> Result<(), MissionError> {
        let ends = self.executor.take_exits();
        ends.into_iter()
            .try_for_each(|(index, end)| self.handle(index, end))
    }

    /// Handles all events of the processes since the last call.
    ///
    /// # Errors
    /// [`MissionError`] if one of them ends the run.
    pub fn handle_events(&mut self) -> Result<(), MissionError> {
        self.check_ends()?;
        let (seen, posted) = (self.executor.observe(), self.executor.ticks_posted());
        let look = |index| self.executor.activity(index);
        let events = self.state.timed_events(Instant::now(), posted, &seen, look);
        events
            .into_iter()
            .try_for_each(|(index, event)| self.handle(index, event))
    }

    /// Decides about an event, takes the actions, and handles the events that they cause.
    fn handle(&mut self, index: usize, event: Event) -> Result<(), MissionError> {
        let mut next = Some(event);
        while let Some(event) = next.take() {
            let moment = self.executor.moment(index);
            for action in self.state.decide(index, event, moment) {
                if let Some(event) = self.executor.act(index, action)? {
                    next = Some(event);
                }
            }
        }
        Ok(())
    }

    /// Sleeps until the next check is due, a process has ended, or `wake` is readable.
    pub(super) fn sleep(&self, wake: BorrowedFd<'_>) {
        let is_awaited = self.state.is_restarting();
        let poll_interval = if is_awaited {
            SHORT_POLL_INTERVAL
        } else {
            POLL_INTERVAL
        };
        self.executor.sleep(Some(wake), poll_interval);
    }

    /// Returns `true` if a process has failed and the run continued.
    pub(super) fn has_failures(&self) -> bool {
        self.state.has_failures()
    }

    /// Ends all processes and forwards their last output lines.
    pub fn stop(&mut self) {
        self.executor.stop();
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.stop();
    }
}
