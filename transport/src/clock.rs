//! The monotonic clock of the stamps.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Current time of the monotonic clock of the machine (ns), comparable between processes.
///
/// For measurements only; no control code reads it.
pub fn monotonic_ns() -> u64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    // Seconds since boot and nanoseconds below 10^9: neither is negative.
    (now.tv_sec as u64) * 1_000_000_000 + now.tv_nsec as u64
}

/// Nanoseconds since `start`, saturating.
pub fn elapsed_ns(start: Instant) -> u64 {
    u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)
}

/// The clock of a run's stamps: the machine's, or one that stands at 0. A run in one thread has no
/// latencies, and reading a clock for every message costs as much as the message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StampClock {
    runs: bool,
}

impl StampClock {
    /// The clock of the machine.
    pub const MONOTONIC: Self = Self { runs: true };
    /// Always 0.
    pub const STANDING: Self = Self { runs: false };

    /// Current time (ns).
    pub fn now_ns(self) -> u64 {
        if self.runs { monotonic_ns() } else { 0 }
    }
}

/// Begin of the current step of a process, for the stamps of all messages of the step. Clones share
/// the value.
#[derive(Debug, Clone, Default)]
pub struct StepStart(Arc<AtomicU64>);

impl StepStart {
    /// Sets the begin of the step (ns).
    pub fn set(&self, now_ns: u64) {
        self.0.store(now_ns, Ordering::Relaxed);
    }

    /// The begin of the step (ns); 0 before the first.
    pub fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}
