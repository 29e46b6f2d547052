//! The turn as a process in the loop sees it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use super::LOOK_UP;
use super::page::{Phase, SlotState, TurnPage, sleep_while, wake_all};

/// What a wait ended with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// This tick is to be done now.
    Tick(u64),
    /// Nothing yet within the time; look after the heartbeat and wait again.
    Idle,
    /// The run ends.
    Stop,
}

/// A process's seat at the page.
#[derive(Debug)]
pub struct Participant {
    page: Arc<TurnPage>,
    slot: usize,
    upstream: Vec<usize>,
}

impl Participant {
    /// Takes the seat; `upstream` are the slots whose output of a tick must be there before this
    /// process steps it (empty: only the simulator's state).
    pub fn new(page: Arc<TurnPage>, slot: usize, upstream: Vec<usize>) -> Self {
        Self {
            page,
            slot,
            upstream,
        }
    }

    /// Says how this process is, and wakes whoever waits for that.
    pub fn set_state(&self, state: SlotState) {
        // Who was buried stays so: a bridge may speak for a process that is gone.
        let alive = |now| (now != SlotState::Dead as u32).then_some(state as u32);
        let word = &self.page.slot(self.slot).state;
        let _ = word.fetch_update(Ordering::SeqCst, Ordering::SeqCst, alive);
        // The orchestrator looks at the states on its own beat; the simulator sleeps on arrivals.
        wake_all(&self.page.words().arrived.0);
        wake_all(&self.page.slot(self.slot).done);
    }

    /// Whether this process starts in the middle of a run, as the successor of one that failed
    /// (real time). Ask before the process is ready: time does not start without it.
    pub fn joins_late(&self) -> bool {
        self.page.phase() == Phase::Run
    }

    /// In the middle of a run: sleeps until the simulator has connected to the ports of this process
    /// and so handed out its map; false if the run stops first or `keep_going` says no.
    pub fn join(&self, keep_going: impl Fn() -> bool) -> bool {
        let words = self.page.words();
        let mine = words.joins.0.fetch_add(1, Ordering::SeqCst).wrapping_add(1);
        loop {
            let joined = words.joined.0.load(Ordering::SeqCst);
            // Wrapping comparison: others may ask too.
            if (joined.wrapping_sub(mine) as i32) >= 0 {
                return true;
            }
            if self.page.phase() == Phase::Stop || !keep_going() {
                return false;
            }
            sleep_while(&words.joined.0, joined, LOOK_UP);
        }
    }

    /// Ticks posted so far: the first tick that one who joins late can do.
    pub fn ticks_posted(&self) -> u64 {
        self.page.ticks_posted()
    }

    /// Sleeps until the run has reached `phase`; false if it stops first or `keep_going` says no.
    pub fn wait_for_phase(&self, phase: Phase, keep_going: impl Fn() -> bool) -> bool {
        loop {
            let now = self.page.phase();
            if now == Phase::Stop || !keep_going() {
                return false;
            }
            if now >= phase {
                return true;
            }
            sleep_while(&self.page.words().phase.0, now as u32, LOOK_UP);
        }
    }

    /// Waits for the turn of tick `next` (lock-step): until the simulator has posted it and
    /// everybody upstream has done it or is gone. Returns [`Turn::Idle`] after [`LOOK_UP`].
    pub fn wait_turn(&self, next: u64) -> Turn {
        let wanted = (next + 1) as u32;
        for &slot in &self.upstream {
            let gone = || !self.page.state(slot).is_alive();
            match self.wait_word(&self.page.slot(slot).done, wanted, next, gone) {
                Turn::Tick(_) => {}
                other => return other,
            }
        }
        // An upstream that is gone does not tell whether the tick was posted at all.
        self.wait_word(&self.page.words().tick.0, wanted, next, || false)
    }

    /// Waits for tick `next` or any after it (real time): the newest one posted. Those upstream get
    /// `patience` to finish theirs.
    pub fn wait_newest(&self, next: u64, patience: Duration) -> Turn {
        let turn = self.wait_word(&self.page.words().tick.0, (next + 1) as u32, next, || false);
        let Turn::Tick(_) = turn else { return turn };
        let newest = self.page.ticks_posted().saturating_sub(1);
        for &slot in &self.upstream {
            let done = &self.page.slot(slot).done;
            let seen = done.load(Ordering::SeqCst);
            if u64::from(seen) <= newest && self.page.state(slot).is_alive() {
                sleep_while(done, seen, patience);
            }
        }
        Turn::Tick(newest)
    }

    fn wait_word(&self, word: &AtomicU32, wanted: u32, tick: u64, gone: impl Fn() -> bool) -> Turn {
        let mut slept = false;
        loop {
            let seen = word.load(Ordering::SeqCst);
            if seen >= wanted || gone() {
                return Turn::Tick(tick);
            }
            if self.page.phase() == Phase::Stop {
                return Turn::Stop;
            }
            if slept {
                return Turn::Idle;
            }
            sleep_while(word, seen, LOOK_UP);
            slept = word.load(Ordering::SeqCst) == seen;
        }
    }

    /// Marks tick `tick` as done by this process and wakes whom that concerns.
    pub fn done(&self, tick: u64) {
        let words = self.page.words();
        let own = self.page.slot(self.slot);
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
