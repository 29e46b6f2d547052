//! The turn as the orchestrator and its recorder see it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::barrier::{MAX_SLOTS, Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// The orchestrator's hand on the barrier; clone it for the recorder's thread.
#[derive(Debug, Clone)]
pub struct BarrierMonitor {
    barrier: Arc<TickBarrier>,
}

impl BarrierMonitor {
    /// Takes the barrier into hand.
    pub fn new(barrier: Arc<TickBarrier>) -> Self {
        Self { barrier }
    }

    /// The barrier, to look at.
    pub fn barrier(&self) -> &TickBarrier {
        &self.barrier
    }

    /// Gives a slot to a process that is about to start: whether the simulator waits for it at
    /// every tick, and whether other processes do.
    pub fn assign_slot(&self, slot: usize, in_loop: bool, watched: bool) {
        let words = self.barrier.slot(slot.min(MAX_SLOTS - 1));
        words.in_loop.store(u32::from(in_loop), Ordering::SeqCst);
        words.watched.store(u32::from(watched), Ordering::SeqCst);
        self.reset_slot(slot);
    }

    /// Gives a slot to the successor of a process that has been dead, which is about to start;
    /// only in real time.
    pub fn reset_slot(&self, slot: usize) {
        let state = &self.barrier.slot(slot.min(MAX_SLOTS - 1)).state;
        state.store(SlotState::Starting as u32, Ordering::SeqCst);
    }

    /// Moves the run on and wakes everybody.
    pub fn set_phase(&self, phase: Phase) {
        let words = self.barrier.words();
        words.phase.0.store(phase as u32, Ordering::SeqCst);
        wake_all(&words.phase.0);
        if phase == Phase::Stop {
            self.wake_members();
        }
    }

    /// Takes a dead process out of the count, so that nobody waits for it.
    pub fn mark_dead(&self, slot: usize) {
        self.barrier
            .slot(slot)
            .state
            .store(SlotState::Dead as u32, Ordering::SeqCst);
        // The simulator may be between its last look at the states and its sleep: a change of the
        // word that it sleeps on keeps it awake. An arrival too many costs a needless look at most.
        self.barrier
            .words()
            .arrived
            .0
            .fetch_add(1, Ordering::SeqCst);
        self.wake_members();
    }

    fn wake_members(&self) {
        let words = self.barrier.words();
        for word in [
            &words.tick,
            &words.arrived,
            &words.recorded,
            &words.record_due,
            &words.joined,
        ] {
            wake_all(&word.0);
        }
        for slot in 0..self.barrier.processes() {
            wake_all(&self.barrier.slot(slot).done);
        }
    }

    /// Sleeps until the simulator calls for the recorder, at most for `timeout`.
    pub fn wait_for_records(&self, timeout: Duration) {
        let words = self.barrier.words();
        let due = words.record_due.0.load(Ordering::SeqCst);
        let pending = words.completed.0.load(Ordering::SeqCst)
            > words.recorded.0.load(Ordering::SeqCst).saturating_add(31);
        if !pending {
            sleep_while(&words.record_due.0, due, timeout);
        }
    }

    /// The newest tick of which every message has been sent; `None` before the first.
    pub fn completed_tick(&self) -> Option<u64> {
        u64::from(self.barrier.words().completed.0.load(Ordering::SeqCst)).checked_sub(1)
    }

    /// Tells the simulator that everything up to `tick` is in the log.
    pub fn recorded(&self, tick: u64) {
        let recorded = &self.barrier.words().recorded.0;
        recorded.store((tick + 1) as u32, Ordering::SeqCst);
        wake_all(recorded);
    }
}
