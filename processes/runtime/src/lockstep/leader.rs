//! The turn as the simulator sees it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::POLL_INTERVAL;
use super::barrier::{Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// How often the recorder is woken at the least (ticks): waking it costs a context switch, so it
/// works in batches.
const RECORD_BATCH: u32 = 32;

/// What the wait for a tick ended with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TickEnd {
    /// Everybody alive has done the tick.
    Complete,
    /// Not yet; look after the heartbeat and wait again.
    Idle,
    /// The run ends.
    Stop,
}

/// The simulator's slot: posts ticks and waits for everybody.
#[derive(Debug)]
pub struct BarrierLeader {
    barrier: Arc<TickBarrier>,
    slot: usize,
    lag: u32,
}

impl BarrierLeader {
    /// Takes the slot. The simulator may run at most `lag` ticks ahead of the recorder.
    pub fn new(barrier: Arc<TickBarrier>, slot: usize, lag: usize) -> Self {
        Self {
            barrier,
            slot,
            lag: lag.max(1) as u32,
        }
    }

    /// The slots that take part in tick barriers, in order.
    fn members(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.barrier.processes()).filter(|&slot| {
            slot != self.slot && self.barrier.slot(slot).in_loop.load(Ordering::Relaxed) != 0
        })
    }

    /// How many members have not done this many ticks. A member that has ended counts until the
    /// orchestrator has dead it or stopped the run: otherwise the world would go on without it for
    /// as long as that takes, a different time in every run.
    fn waiting_for(&self, wanted: u32) -> u32 {
        self.members()
            .filter(|&slot| {
                let state = self.barrier.state(slot);
                (state.takes_part() || matches!(state, SlotState::Stopped | SlotState::Failed))
                    && self.barrier.slot(slot).done.load(Ordering::SeqCst) < wanted
            })
            .count() as u32
    }

    /// Has `connect` connect every port if a process has joined in the middle of the run since the
    /// last call (real time).
    ///
    /// # Errors
    /// Those of `connect`.
    pub fn admit<E>(&self, connect: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
        let words = self.barrier.words();
        let joins = words.joins.0.load(Ordering::SeqCst);
        if joins != words.joined.0.load(Ordering::SeqCst) {
            connect()?;
            words.joined.0.store(joins, Ordering::SeqCst);
            wake_all(&words.joined.0);
        }
        Ok(())
    }

    /// Posts tick `tick`: its state has been published, everybody may step it.
    pub fn post(&self, tick: u64) {
        let words = self.barrier.words();
        let wanted = (tick + 1) as u32;
        self.retarget(wanted);
        words.tick.0.store(wanted, Ordering::SeqCst);
        wake_all(&words.tick.0);
    }

    /// Lets the last of those still missing wake the simulator.
    fn retarget(&self, wanted: u32) {
        let words = self.barrier.words();
        // A member stores `done` before it raises the counter, and the counter is read here before
        // the members are: whoever is counted as arrived is never counted as missing too. So the
        // target may come out too small (a member between its two stores: one needless wake-up),
        // never too large (nobody would wake us).
        let arrived = words.arrived.0.load(Ordering::SeqCst);
        let missing = self.waiting_for(wanted);
        words
            .target
            .0
            .store(arrived.wrapping_add(missing), Ordering::SeqCst);
    }

    /// Waits until everybody alive has done tick `tick`; returns [`TickEnd::Idle`] after
    /// [`POLL_INTERVAL`] without progress.
    pub fn wait(&self, tick: u64) -> TickEnd {
        let words = self.barrier.words();
        let wanted = (tick + 1) as u32;
        let mut slept = false;
        loop {
            let seen = words.arrived.0.load(Ordering::SeqCst);
            let missing = self.waiting_for(wanted);
            // Asked last: when a run stops its members leave, and that nobody is missing any more
            // does not mean that the tick was done.
            if self.barrier.phase() == Phase::Stop {
                return TickEnd::Stop;
            }
            if missing == 0 {
                return TickEnd::Complete;
            }
            if slept {
                return TickEnd::Idle;
            }
            let target = words.target.0.load(Ordering::SeqCst);
            if (seen.wrapping_sub(target) as i32) >= 0 {
                // The target is behind (a member died and the others are still at work): without a
                // new one nobody would wake us.
                self.retarget(wanted);
                continue;
            }
            sleep_while(&words.arrived.0, seen, POLL_INTERVAL);
            slept = words.arrived.0.load(Ordering::SeqCst) == seen && self.waiting_for(wanted) != 0;
            if self.waiting_for(wanted) != 0 {
                // Somebody may have died since: the number to wait for has changed.
                self.retarget(wanted);
            }
        }
    }

    /// Says that every message of tick `tick` has been sent, wakes the recorder when a batch is
    /// due, and sleeps while the recorder is too far behind. False if the run stops meanwhile.
    pub fn complete(&self, tick: u64) -> bool {
        let words = self.barrier.words();
        let completed = self.complete_without_waiting(tick);
        loop {
            let recorded = words.recorded.0.load(Ordering::SeqCst);
            if completed.saturating_sub(recorded) < self.lag {
                return true;
            }
            if self.barrier.phase() == Phase::Stop {
                return false;
            }
            self.wake_recorder();
            sleep_while(&words.recorded.0, recorded, POLL_INTERVAL);
        }
    }

    /// As [`BarrierLeader::complete`], in real time: the recorder never holds the world back.
    /// Returns the number of completed ticks.
    pub fn complete_without_waiting(&self, tick: u64) -> u32 {
        let completed = (tick + 1) as u32;
        self.barrier
            .words()
            .completed
            .0
            .store(completed, Ordering::SeqCst);
        if completed.is_multiple_of(RECORD_BATCH) {
            self.wake_recorder();
        }
        completed
    }

    /// Says that the game is over: after the completed ticks there will be no more.
    pub fn finish(&self) {
        let words = self.barrier.words();
        words.over.0.store(1, Ordering::SeqCst);
        self.wake_recorder();
    }

    fn wake_recorder(&self) {
        let due = &self.barrier.words().record_due.0;
        due.fetch_add(1, Ordering::SeqCst);
        wake_all(due);
    }

    /// Whether the run is to end.
    pub fn stopping(&self) -> bool {
        self.barrier.phase() == Phase::Stop
    }

    /// Posts tick `tick` in real time: nobody is waited for.
    pub fn post_without_waiting(&self, tick: u64) {
        let words = self.barrier.words();
        words.tick.0.store((tick + 1) as u32, Ordering::SeqCst);
        wake_all(&words.tick.0);
    }

    /// Sleeps for `time` or until the run stops; true if it goes on.
    pub fn sleep(&self, time: Duration) -> bool {
        let end = std::time::Instant::now() + time;
        loop {
            let phase = self.barrier.phase();
            if phase == Phase::Stop {
                return false;
            }
            let left = end.saturating_duration_since(std::time::Instant::now());
            if left.is_zero() {
                return true;
            }
            sleep_while(&self.barrier.words().phase.0, phase as u32, left);
        }
    }
}
