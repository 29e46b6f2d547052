//! What the recorder needs of the run.

use std::time::Duration;

/// The recorder's side of the machinery that drives a run.
pub trait Wakeup {
    /// Sleeps until the time is over; returns earlier when the run ended or when the simulator is
    /// about to be held back because too much is unrecorded. (To return at every tick is correct,
    /// but wakes the recorder's thread, and perhaps another core, per tick instead of per batch.)
    fn wait(&self, timeout: Duration);

    /// The last complete tick: every message of it and of those before has been sent. `None`
    /// before the first, and in real time, where nothing says so.
    fn completed_tick(&self) -> Option<u64>;

    /// Tells the simulator that everything up to this complete tick is in the log (back-pressure).
    fn recorded(&self, tick: u64);

    /// How often somebody has asked the recorder to take what has been sent by then.
    fn calls(&self) -> u64 {
        0
    }

    /// Tells those who asked, the last of them by this call, that it has been taken.
    fn answer(&self, calls: u64) {
        let _ = calls;
    }

    /// Whether no message will be sent any more that is not in the buffers already.
    fn ended(&self) -> bool;
}
