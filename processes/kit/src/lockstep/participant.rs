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
    spin: bool,
}

impl Participant {
    /// Takes the seat; `upstream` are the slots whose output of a tick must be there before this
    /// process steps it (empty: only the simulator's state).
    pub fn new(page: Arc<TurnPage>, slot: usize, upstream: Vec<usize>, spin: bool) -> Self {
        Self {
            page,
            slot,
            upstream,
            spin,
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
        if self.page.held_before().is_some() {
            self.page.call_simulator();
        }
    }

    /// In the middle of a run: asks the others, who know nothing of these ports yet, to connect to
    /// them, and sleeps until the simulator has, which hands out its map; false if the run stops
    /// first or `keep_going` says no.
    pub fn ask_to_connect(&self, keep_going: impl Fn() -> bool) -> bool {
        let own = self.page.slot(self.slot);
        let me = own.taken.load(Ordering::SeqCst);
        own.asks.store(me, Ordering::SeqCst);
        self.page.call_simulator();
        loop {
            let answered = own.answered.load(Ordering::SeqCst);
            if answered == me {
                return true;
            }
            if self.page.phase() == Phase::Stop || !keep_going() {
                return false;
            }
            sleep_while(&own.answered, answered, LOOK_UP);
        }
    }

    /// The first tick that may be this process's: the one at which time is held for it, or any.
    pub fn first_tick(&self) -> u64 {
        let back_at = self.page.slot(self.slot).back_at.load(Ordering::SeqCst);
        u64::from(back_at).saturating_sub(1)
    }

    /// Whether somebody else had this seat before.
    pub fn is_successor(&self) -> bool {
        self.page.times_taken(self.slot) > 1
    }

    /// Notes the first tick of this process.
    pub fn begins(&self, tick: u64) {
        let first = &self.page.slot(self.slot).first;
        first.store((tick + 1) as u32, Ordering::SeqCst);
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
        if self.upstream.is_empty() {
            return self.wait_word(&self.page.words().tick.0, wanted, next, || false);
        }
        loop {
            for &slot in &self.upstream {
                let gone = || !self.page.state(slot).is_alive();
                match self.wait_word(&self.page.slot(slot).done, wanted, next, gone) {
                    Turn::Tick(_) => {}
                    other => return other,
                }
            }
            // An upstream that is gone does not tell whether the tick was posted at all.
            match self.wait_word(&self.page.words().tick.0, wanted, next, || false) {
                Turn::Tick(_) => {}
                other => return other,
            }
            // Who was gone may be back: time was held for it before this tick was posted, so it is
            // seen here.
            let owes = |&slot: &usize| {
                self.page.state(slot).is_alive()
                    && self.page.slot(slot).done.load(Ordering::SeqCst) < wanted
            };
            if !self.upstream.iter().any(owes) {
                return Turn::Tick(next);
            }
        }
    }

    /// Waits for any tick newer than `last` (real time; `None`: the first one): the newest one
    /// posted. Those upstream get `patience` to finish theirs.
    pub fn wait_newest(&self, last: Option<u64>, patience: Duration) -> Turn {
        let next = last.map_or(0, |tick| tick + 1);
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
            if self.spin {
                std::thread::yield_now();
            } else if slept {
                return Turn::Idle;
            } else {
                sleep_while(word, seen, LOOK_UP);
                slept = word.load(Ordering::SeqCst) == seen;
            }
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
