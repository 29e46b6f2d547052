//! The side of the tick barrier of a process in the loop.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use super::POLL_INTERVAL;
use super::barrier::{Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// Result of a wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TickWait {
    /// Tick to do now.
    Tick(u64),
    /// No tick within the time; send a heartbeat if due and wait again.
    Idle,
    /// The run ends.
    Stop,
}

/// A process's slot at the barrier.
#[derive(Debug)]
pub struct BarrierMember {
    barrier: Arc<TickBarrier>,
    slot: usize,
    upstream: Vec<usize>,
}

impl BarrierMember {
    /// Opens the slot. `upstream` are the slots whose output of a tick must be complete before this
    /// process steps it (empty: only the simulator's state).
    pub fn new(barrier: Arc<TickBarrier>, slot: usize, upstream: Vec<usize>) -> Self {
        Self {
            barrier,
            slot,
            upstream,
        }
    }

    /// Sets the state of this process and wakes those that wait for it.
    pub fn set_state(&self, state: SlotState) {
        // A dead process stays dead, whatever it reports last.
        let alive = |now| (now != SlotState::Dead as u32).then_some(state as u32);
        let word = &self.barrier.slot(self.slot).state;
        let _ = word.fetch_update(Ordering::SeqCst, Ordering::SeqCst, alive);
        // The orchestrator polls the states with its heartbeats; the simulator sleeps on arrivals.
        wake_all(&self.barrier.words().arrived.0);
        wake_all(&self.barrier.slot(self.slot).done);
    }

    /// Returns `true` if this process starts in the middle of a run, as the successor of a failed
    /// one (real time). Call it before the process is ready: time does not start without it.
    pub fn joins_late(&self) -> bool {
        self.barrier.phase() == Phase::Run
    }

    /// Joins a run in the middle: sleeps until the simulator has connected to the ports of this
    /// process and so sent its map. Returns `false` if the run stops first or `keep_going` returns
    /// `false`.
    pub fn join(&self, keep_going: impl Fn() -> bool) -> bool {
        let words = self.barrier.words();
        let mine = words.joins.0.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        loop {
            let joined = words.joined.0.load(Ordering::SeqCst);
            // Wrapping comparison: other processes may join at the same time.
            if (joined.wrapping_sub(mine) as i32) >= 0 {
                return true;
            }
            if self.barrier.phase() == Phase::Stop || !keep_going() {
                return false;
            }
            sleep_while(&words.joined.0, joined, POLL_INTERVAL);
        }
    }

    /// Returns the number of posted ticks: the first tick that a late joiner can do.
    pub fn ticks_posted(&self) -> u64 {
        self.barrier.ticks_posted()
    }

    /// Sleeps until the run has reached `phase`; returns `false` if it stops first or `keep_going`
    /// returns `false`.
    pub fn wait_for_phase(&self, phase: Phase, keep_going: impl Fn() -> bool) -> bool {
        loop {
            let now = self.barrier.phase();
            if now == Phase::Stop || !keep_going() {
                return false;
            }
            if now >= phase {
                return true;
            }
            sleep_while(&self.barrier.words().phase.0, now as u32, POLL_INTERVAL);
        }
    }

    /// Waits for tick `next` (lock-step): until the simulator has posted it and every process
    /// upstream has done it or has ended. Returns [`TickWait::Idle`] after [`POLL_INTERVAL`].
    pub fn wait_tick(&self, next: u64) -> TickWait {
        let wanted = (next + 1) as u32;
        for &slot in &self.upstream {
            let gone = || !self.barrier.state(slot).is_alive();
            match self.wait_word(&self.barrier.slot(slot).done, wanted, next, gone) {
                TickWait::Tick(_) => {}
                other => return other,
            }
        }
        // The end of a process upstream does not imply that the tick was posted.
        self.wait_word(&self.barrier.words().tick.0, wanted, next, || false)
    }

    /// Waits for tick `next` or a later one (real time): the newest one posted. The processes
    /// upstream get `patience` to finish theirs.
    pub fn wait_newest(&self, next: u64, patience: Duration) -> TickWait {
        let turn = self.wait_word(
            &self.barrier.words().tick.0,
            (next + 1) as u32,
            next,
            || false,
        );
        let TickWait::Tick(_) = turn else { return turn };
        let newest = self.barrier.ticks_posted().saturating_sub(1);
        for &slot in &self.upstream {
            let done = &self.barrier.slot(slot).done;
            let seen = done.load(Ordering::SeqCst);
            if u64::from(seen) <= newest && self.barrier.state(slot).is_alive() {
                sleep_while(done, seen, patience);
            }
        }
        TickWait::Tick(newest)
    }

    fn wait_word(
        &self,
        word: &AtomicU32,
        wanted: u32,
        tick: u64,
        gone: impl Fn() -> bool,
    ) -> TickWait {
        let mut slept = false;
        loop {
            let seen = word.load(Ordering::SeqCst);
            if seen >= wanted || gone() {
                return TickWait::Tick(tick);
            }
            if self.barrier.phase() == Phase::Stop {
                return TickWait::Stop;
            }
            if slept {
                return TickWait::Idle;
            }
            sleep_while(word, seen, POLL_INTERVAL);
            slept = word.load(Ordering::SeqCst) == seen;
        }
    }

    /// Marks tick `tick` as done by this process and wakes the processes that wait for it.
    pub fn done(&self, tick: u64) {
        let words = self.barrier.words();
        let own = self.barrier.slot(self.slot);
        own.done.store((tick + 1) as u32, Ordering::SeqCst);
        if own.watched.load(Ordering::Relaxed) != 0 {
            wake_all(&own.done);
        }
        if own.in_loop.load(Ordering::Relaxed) == 0 {
            return;
        }
        let arrived = words
            .arrived
            .0
            .fetch_add(1, Ordering::SeqCst)
            .wrapping_add(1);
        let target = words.target.0.load(Ordering::SeqCst);
        // Wrapping comparison: the counter overflows.
        if (arrived.wrapping_sub(target) as i32) >= 0 {
            wake_all(&words.arrived.0);
        }
    }
}
