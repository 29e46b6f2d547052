//! The turn as a process in the loop sees it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use super::POLL_INTERVAL;
use super::barrier::{Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// What a wait ended with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TickWait {
    /// This tick is to be done now.
    Tick(u64),
    /// Nothing yet within the time; look after the heartbeat and wait again.
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
    /// Takes the slot; `upstream` are the slots whose output of a tick must be there before this
    /// process steps it (empty: only the simulator's state).
    pub fn new(barrier: Arc<TickBarrier>, slot: usize, upstream: Vec<usize>) -> Self {
        Self {
            barrier,
            slot,
            upstream,
        }
    }

    /// Says how this process is, and wakes whoever waits for that.
    pub fn set_state(&self, state: SlotState) {
        // Who was dead stays so: a bridge may speak for a process that is gone.
        let alive = |now| (now != SlotState::Dead as u32).then_some(state as u32);
        let word = &self.barrier.slot(self.slot).state;
        let _ = word.fetch_update(Ordering::SeqCst, Ordering::SeqCst, alive);
        // The orchestrator looks at the states on its own send if due; the simulator sleeps on arrivals.
        wake_all(&self.barrier.words().arrived.0);
        wake_all(&self.barrier.slot(self.slot).done);
    }

    /// Whether this process starts in the middle of a run, as the successor of one that failed
    /// (real time). Ask before the process is ready: time does not start without it.
    pub fn joins_late(&self) -> bool {
        self.barrier.phase() == Phase::Run
    }

    /// In the middle of a run: sleeps until the simulator has connected to the ports of this process
    /// and so handed out its map; false if the run stops first or `keep_going` says no.
    pub fn join(&self, keep_going: impl Fn() -> bool) -> bool {
        let words = self.barrier.words();
        let mine = words.joins.0.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        loop {
            let joined = words.joined.0.load(Ordering::SeqCst);
            // Wrapping comparison: others may ask too.
            if (joined.wrapping_sub(mine) as i32) >= 0 {
                return true;
            }
            if self.barrier.phase() == Phase::Stop || !keep_going() {
                return false;
            }
            sleep_while(&words.joined.0, joined, POLL_INTERVAL);
        }
    }

    /// Ticks posted so far: the first tick that one who joins late can do.
    pub fn ticks_posted(&self) -> u64 {
        self.barrier.ticks_posted()
    }

    /// Sleeps until the run has reached `phase`; false if it stops first or `keep_going` says no.
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

    /// Waits for the turn of tick `next` (lock-step): until the simulator has posted it and
    /// everybody upstream has done it or is gone. Returns [`TickWait::Idle`] after [`POLL_INTERVAL`].
    pub fn wait_tick(&self, next: u64) -> TickWait {
        let wanted = (next + 1) as u32;
        for &slot in &self.upstream {
            let gone = || !self.barrier.state(slot).is_alive();
            match self.wait_word(&self.barrier.slot(slot).done, wanted, next, gone) {
                TickWait::Tick(_) => {}
                other => return other,
            }
        }
        // An upstream that is gone does not tell whether the tick was posted at all.
        self.wait_word(&self.barrier.words().tick.0, wanted, next, || false)
    }

    /// Waits for tick `next` or any after it (real time): the newest one posted. Those upstream get
    /// `patience` to finish theirs.
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

    /// Marks tick `tick` as done by this process and wakes whom that concerns.
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
        // Wrapping comparison: the counter runs for ever.
        if (arrived.wrapping_sub(target) as i32) >= 0 {
            wake_all(&words.arrived.0);
        }
    }
}
