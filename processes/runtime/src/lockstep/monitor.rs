//! The side of the tick barrier of the orchestrator and its recorder.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use super::barrier::{MAX_SLOTS, Phase, SlotState, TickBarrier, sleep_while, wake_all};

/// The orchestrator's access to the barrier; the recorder's thread uses a clone.
#[derive(Debug, Clone)]
pub struct BarrierMonitor {
    barrier: Arc<TickBarrier>,
}

impl BarrierMonitor {
    /// Wraps the barrier.
    pub fn new(barrier: Arc<TickBarrier>) -> Self {
        Self { barrier }
    }

    /// Returns the barrier, for reading.
    pub fn barrier(&self) -> &TickBarrier {
        &self.barrier
    }

    /// Assigns a slot to a process that is about to start. `in_loop`: the simulator waits for it at
    /// every tick; `watched`: other processes wait for it.
    pub fn assign_slot(&self, slot: usize, in_loop: bool, watched: bool) {
        let words = self.barrier.slot(slot.min(MAX_SLOTS - 1));
        words.in_loop.store(u32::from(in_loop), Ordering::SeqCst);
        words.watched.store(u32::from(watched), Ordering::SeqCst);
        self.reset_slot(slot);
    }

    /// Assigns a slot to the successor of a dead process, which is about to start; only in real
    /// time.
    pub fn reset_slot(&self, slot: usize) {
        let state = &self.barrier.slot(slot.min(MAX_SLOTS - 1)).state;
        state.store(SlotState::Starting as u32, Ordering::SeqCst);
    }

    /// Sets the phase of the run and wakes all processes.
    pub fn set_phase(&self, phase: Phase) {
        let words = self.barrier.words();
        words.phase.0.store(phase as u32, Ordering::SeqCst);
        wake_all(&words.phase.0);
        if phase == Phase::Stop {
            self.wake_members();
        }
    }

    /// Sets the pace of the world in lock-step (simulated s per s; not finite: as fast as possible). While `is_held`, it
    /// goes on by single steps only, of which `steps` have been asked for so far.
    pub fn pace(&self, pace: f64, is_held: bool, steps: u32) {
        let words = self.barrier.words();
        let pace = if pace.is_finite() { pace as f32 } else { 0.0 };
        words.pace.0.store(pace.to_bits(), Ordering::SeqCst);
        let hold = (steps << 1) | u32::from(is_held);
        words.hold.0.store(hold, Ordering::SeqCst);
        // The simulator sleeps on it between two ticks.
        wake_all(&words.phase.0);
    }

    /// Removes a dead process from the count, so that no process waits for it.
    pub fn mark_dead(&self, slot: usize) {
        self.barrier
            .slot(slot)
            .state
            .store(SlotState::Dead as u32, Ordering::SeqCst);
        // The simulator may be between its last check of the states and its sleep: a change of the
        // word that it sleeps on keeps it awake. An extra arrival costs one needless wake-up at
        // most.
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

    /// Sleeps until the simulator wakes the recorder, at most for `timeout`.
    pub fn wait_for_records(&self, timeout: Duration) {
        let words = self.barrier.words();
        let due = words.record_due.0.load(Ordering::SeqCst);
        let pending = words.completed.0.load(Ordering::SeqCst)
            > words.recorded.0.load(Ordering::SeqCst).saturating_add(31);
        if !pending {
            sleep_while(&words.record_due.0, due, timeout);
        }
    }

    /// Returns the newest tick whose messages have all been sent; `None` before the first.
    pub fn completed_tick(&self) -> Option<u64> {
        u64::from(self.barrier.words().completed.0.load(Ordering::SeqCst)).checked_sub(1)
    }

    /// Reports to the simulator that all ticks up to `tick` are in the log.
    pub fn recorded(&self, tick: u64) {
        let recorded = &self.barrier.words().recorded.0;
        recorded.store((tick + 1) as u32, Ordering::SeqCst);
        wake_all(recorded);
    }
}
