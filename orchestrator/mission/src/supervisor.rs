//! Supervision of the processes of a run: what happens to them goes to `decide`, and the actions from there to
//! `executor`.

use std::os::fd::BorrowedFd;
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

/// Time between two looks while a process is awaited, at the start or after a failure. Processes say how far they
/// are on the barrier; a few milliseconds are nothing against what starting a process takes.
const SHORT_POLL_INTERVAL: Duration = Duration::from_millis(2);
/// Time between two looks at other times. The end of a process wakes at once.
const POLL_INTERVAL: Duration = Duration::from_millis(10);

/// Processes of a run: started, supervised, and stopped at the latest when this is dropped.
pub struct Supervisor<'a> {
    executor: Executor<'a>,
    state: State,
}

impl<'a> Supervisor<'a> {
    /// Takes up these processes of the run, each of which gets its slot at the barrier; with `echo` their stderr is
    /// shown.
    ///
    /// # Errors
    /// [`MissionError`] if the turns of external programs cannot be bridged.
    pub fn new(
        resources: &'a RunResources,
        launches: &'a [Launch],
        hang_timeout: Duration,
        echo: bool,
    ) -> Result<Self, MissionError> {
        let in_lock_step = resources.plan.run.clock == Clock::LockStep;
        Ok(Self {
            executor: Executor::new(resources, launches, echo)?,
            state: State::new(launches, in_lock_step, hang_timeout),
        })
    }

    /// Has what happens to the processes and what they write go to the log.
    pub(super) fn with_log(mut self, log: ProcessEventLog) -> Self {
        self.executor.log = Some(log);
        self
    }

    /// Starts all processes and waits until their ports are open; false if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that cannot be started.
    pub fn start(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.executor.start()?;
        self.reach(SlotState::Ready, interrupted)
    }

    /// Has the processes connect their ports and waits until they have; false if `interrupted` before.
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

    /// Has the processes build what they need of the map, which has been sent, and waits until they have; false
    /// if `interrupted` before.
    ///
    /// # Errors
    /// [`MissionError`] names the process that fails or takes too long.
    pub fn prepare(&mut self, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        self.executor.enter(Phase::Prepare);
        self.reach(SlotState::Prepared, interrupted)
    }

    /// Lets time begin.
    pub fn begin(&mut self) {
        self.state.begin(Instant::now());
        self.executor.enter(Phase::Run);
    }

    /// Waits until every process is at least this far in the start; false if `interrupted` before.
    fn reach(&mut self, wanted: SlotState, interrupted: &AtomicBool) -> Result<bool, MissionError> {
        let start = Instant::now();
        loop {
            let seen = self.executor.see();
            // First: a process that has died of it is not to blame.
            shm_usage::check_start()?;
            self.check_ends()?;
            match self.state.start_step(wanted, start.elapsed(), &seen) {
                StartStep::Done => return Ok(true),
                _ if interrupted.load(Ordering::SeqCst) => return Ok(false),
                StartStep::Late(index) => self.happened(index, Event::NotReady)?,
                StartStep::Waiting => {}
            }
            self.executor.sleep(None, SHORT_POLL_INTERVAL);
        }
    }

    /// Deals with the processes that have ended.
    fn check_ends(&mut self) -> Result<(), MissionError> {
        let ends = self.executor.ends();
        ends.into_iter()
            .try_for_each(|(index, end)| self.happened(index, end))
    }

    /// Deals with everything that has happened to the processes since time began.
    ///
    /// # Errors
    /// [`MissionError`] if one of them ends the run.
    pub fn attend(&mut self) -> Result<(), MissionError> {
        self.check_ends()?;
        let (seen, posted) = (self.executor.see(), self.executor.ticks_posted());
        let is_stopped = |index| self.executor.is_stopped(index);
        let events = self.state.look(Instant::now(), posted, &seen, is_stopped);
        events
            .into_iter()
            .try_for_each(|(index, event)| self.happened(index, event))
    }

    /// Decides about an event and takes the actions, and those about what follows from them.
    fn happened(&mut self, index: usize, event: Event) -> Result<(), MissionError> {
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

    /// Sleeps until it is time to look at the processes again, one has ended, or `wake` is readable.
    pub(super) fn sleep(&self, wake: BorrowedFd<'_>) {
        let is_awaited = self.state.is_expecting();
        let poll_interval = if is_awaited {
            SHORT_POLL_INTERVAL
        } else {
            POLL_INTERVAL
        };
        self.executor.sleep(Some(wake), poll_interval);
    }

    /// Whether a process has failed and the run went on.
    pub(super) fn has_lost(&self) -> bool {
        self.state.has_lost()
    }

    /// Ends all processes, and hands on what they wrote last.
    pub fn stop(&mut self) {
        self.executor.stop();
    }
}

impl Drop for Supervisor<'_> {
    fn drop(&mut self) {
        self.stop();
    }
}
