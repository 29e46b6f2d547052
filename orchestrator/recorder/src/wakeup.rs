//! Interface of the recorder to the run.

use std::time::Duration;

/// Synchronisation of the recorder with the run.
pub trait Wakeup {
    /// Sleeps for `timeout`; returns earlier if the run ends or if the simulator is about to wait because too
    /// many messages are unrecorded. (Returning at every tick is correct, but wakes the recorder thread per
    /// tick instead of per batch.)
    fn wait(&self, timeout: Duration);

    /// Returns the last complete tick: all its messages and those of earlier ticks have been sent. `None`
    /// before the first one and in real time, where ticks are not marked as complete.
    fn completed_tick(&self) -> Option<u64>;

    /// Reports to the simulator that the log contains everything up to this complete tick (back-pressure).
    fn recorded(&self, tick: u64);

    /// Returns the number of requests so far to take all sent messages.
    fn calls(&self) -> u64 {
        0
    }

    /// Reports that the requests up to number `calls` are done.
    fn answer(&self, calls: u64) {
        let _ = calls;
    }

    /// Returns `true` if all messages of the run have been sent.
    fn ended(&self) -> bool;
}
