//! What the recorder needs of the run, and what it tells those who look on.

use std::time::Duration;

use ipc_types::messages::process::ProcessStatus;
use ipc_types::messages::world::{RobotState, WorldEvent, WorldHeader};
use ipc_types::stamp::Stamp;

/// The recorder's side of the machinery that drives a run.
pub trait Gate {
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

/// Sees the stream as it is written, in its order. Runs on the recorder's thread: be quick.
pub trait Observer {
    /// A world state was recorded.
    fn on_state(&mut self, header: &WorldHeader, robots: &[RobotState]) {
        let _ = (header, robots);
    }

    /// Something happened in the world at a simulated time [s].
    fn on_event(&mut self, time_s: f64, event: &WorldEvent) {
        let _ = (time_s, event);
    }

    /// A process told how it is.
    fn on_status(&mut self, stamp: &Stamp, status: &ProcessStatus) {
        let _ = (stamp, status);
    }
}

/// Looks at nothing.
impl Observer for () {}
