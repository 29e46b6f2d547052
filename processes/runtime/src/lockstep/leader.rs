//! The simulator's side of the tick barrier.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::POLL_INTERVAL;
use super::barrier::{Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// Maximum period of wake-ups of the recorder (ticks). A wake-up costs a context switch, so the
/// recorder works in batches.
const RECORD_BATCH: u32 = 32;

/// Result of the wait for a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TickEnd {
    /// All live members have done the tick.
    Complete,
    /// Not complete yet; send a heartbeat if due and wait again.
    Idle,
    /// The run ends.
    Stop,
}

/// Times of the ticks in lock-step, at the pace of the orchestrator.
#[derive(Debug)]
pub struct Pacing {
    tick_period: Duration,
    /// Time from which on the next tick is due one period later.
    since: Instant,
    /// Single steps taken.
    steps: u32,
}

impl Pacing {
    /// Begins now; `tick_period` is in simulated time.
    pub fn new(tick_period: Duration) -> Self {
        Self {
            tick_period,
            since: Instant::now(),
            steps: 0,
        }
    }
}

/// Slot of the simulator: posts ticks and waits for all members.
#[derive(Debug)]
pub struct BarrierLeader {
    barrier: Arc<TickBarrier>,
    slot: usize,
    lag: u32,
}

impl BarrierLeader {
    /// Opens the slot. The simulator may be at most `lag` ticks ahead of the recorder.
    pub fn new(barrier: Arc<TickBarrier>, slot: usize, lag: usize) -> Self {
        Self {
            barrier,
            slot,
            lag: lag.max(1) as u32,
        }
    }

    /// Returns the slots that take part in ticks, in order.
    fn members(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.barrier.processes()).filter(|&slot| {
            slot != self.slot && self.barrier.slot(slot).in_loop.load(Ordering::Relaxed) != 0
        })
    }

    /// Returns the number of members that have not done this many ticks. A member that has ended
    /// counts until the orchestrator has marked it as dead or stopped the run. Otherwise the world
    /// would continue without it for that time, which differs between runs.
    fn waiting_for(&self, wanted: u32) -> u32 {
        self.members()
            .filter(|&slot| {
                let state = self.barrier.state(slot);
                (state.takes_part() || matches!(state, SlotState::Stopped | SlotState::Failed))
                    && self.barrier.slot(slot).done.load(Ordering::SeqCst) < wanted
            })
            .count() as u32
    }

    /// Calls `connect` to connect every port if a process has joined in the middle of the run since
    /// the last call (real time).
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

    /// Posts tick `tick`: its state has been published, all members may step it.
    pub fn post(&self, tick: u64) {
        let words = self.barrier.words();
        let wanted = (tick + 1) as u32;
        self.retarget(wanted);
        words.tick.0.store(wanted, Ordering::SeqCst);
        wake_all(&words.tick.0);
    }

    /// Sets the arrival count at which the last missing member wakes the simulator.
    fn retarget(&self, wanted: u32) {
        let words = self.barrier.words();
        // A member stores `done` before it raises the counter, and this function reads the counter
        // before it reads the members. A member that is counted as arrived is therefore never
        // counted as missing, too. The target may be too small (a member between its two stores:
        // one needless wake-up), but never too large (no member would wake the simulator).
        let arrived = words.arrived.0.load(Ordering::SeqCst);
        let missing = self.waiting_for(wanted);
        words
            .target
            .0
            .store(arrived.wrapping_add(missing), Ordering::SeqCst);
    }

    /// Waits until all live members have done tick `tick`; returns [`TickEnd::Idle`] after
    /// [`POLL_INTERVAL`] without progress.
    pub fn wait(&self, tick: u64) -> TickEnd {
        let words = self.barrier.words();
        let wanted = (tick + 1) as u32;
        let mut slept = false;
        loop {
            let seen = words.arrived.0.load(Ordering::SeqCst);
            let missing = self.waiting_for(wanted);
            // Checked last: when a run stops its members leave. That no member is missing then does
            // not mean that the tick was done.
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
                // The target is too low (a member died and the others still compute): without a new
                // one no member would wake the simulator.
                self.retarget(wanted);
                continue;
            }
            sleep_while(&words.arrived.0, seen, POLL_INTERVAL);
            slept = words.arrived.0.load(Ordering::SeqCst) == seen && self.waiting_for(wanted) != 0;
            if self.waiting_for(wanted) != 0 {
                // A member may have died since: the number to wait for has changed.
                self.retarget(wanted);
            }
        }
    }

    /// Marks every message of tick `tick` as sent, wakes the recorder when a batch is due, and
    /// sleeps while the recorder is too far behind. Returns `false` if the run stops meanwhile.
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

    /// Like [`BarrierLeader::complete`], in real time: the recorder never delays the world. Returns
    /// the number of completed ticks.
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

    /// Marks the game as over: no ticks follow the completed ones.
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

    /// Returns `true` if the run is about to end.
    pub fn stopping(&self) -> bool {
        self.barrier.phase() == Phase::Stop
    }

    /// Posts tick `tick` in real time, without a wait.
    pub fn post_without_waiting(&self, tick: u64) {
        let words = self.barrier.words();
        words.tick.0.store((tick + 1) as u32, Ordering::SeqCst);
        wake_all(&words.tick.0);
    }

    /// Waits until the next tick may begin: when it is due at the pace of the orchestrator, or one step at a time while it
    /// holds the world. A late tick shifts the later ones, so that the world does not race to catch up. Returns `false` if
    /// the run stops, or without `running`.
    pub fn wait_until_due(&self, pacing: &mut Pacing, running: impl Fn() -> bool) -> bool {
        let words = self.barrier.words();
        let mut earliest = Instant::now();
        loop {
            let phase = self.barrier.phase();
            if phase == Phase::Stop || !running() {
                return false;
            }
            let hold = words.hold.0.load(Ordering::SeqCst);
            let (is_held, steps) = (hold & 1 != 0, hold >> 1);
            let pace = f32::from_bits(words.pace.0.load(Ordering::SeqCst));
            let mut due = pacing.since;
            let left = if is_held {
                earliest = Instant::now();
                POLL_INTERVAL * u32::from(steps == pacing.steps)
            } else {
                if pace > 0.0 {
                    due += pacing.tick_period.div_f64(f64::from(pace));
                }
                due.saturating_duration_since(Instant::now())
            };
            if left.is_zero() {
                pacing.steps = if is_held { pacing.steps + 1 } else { steps };
                pacing.since = due.max(earliest);
                return true;
            }
            // The orchestrator sees that it does not hang.
            let waits = &self.barrier.slot(self.slot).done;
            waits.fetch_add(1, Ordering::SeqCst);
            sleep_while(&words.phase.0, phase as u32, left.min(POLL_INTERVAL));
        }
    }

    /// Sleeps for `time` or until the run stops; returns `true` if the run continues.
    pub fn sleep(&self, time: Duration) -> bool {
        let end = Instant::now() + time;
        loop {
            let phase = self.barrier.phase();
            if phase == Phase::Stop {
                return false;
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return true;
            }
            sleep_while(&self.barrier.words().phase.0, phase as u32, left);
        }
    }
}
