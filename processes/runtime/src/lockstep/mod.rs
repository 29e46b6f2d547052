//! Tick barrier: the page of shared memory that coordinates the ticks of a run.
//!
//! Data travels over the bus; ticks go over a barrier of futex words, because context switches
//! dominate the cost of a tick. The simulator publishes the state of tick *k* and posts the tick.
//! Every process in the loop waits for its upstream (the tick itself, or the processes whose output
//! for *k* it needs), steps, and marks the tick as done. The last one wakes the simulator.
//!
//! * [`barrier`]: the barrier and its words;
//! * [`BarrierMember`]: the side of a process in the loop;
//! * [`BarrierLeader`]: the side of the simulator;
//! * [`BarrierMonitor`]: the side of the orchestrator and its recorder.

pub mod barrier;
mod leader;
mod member;
mod monitor;

pub use barrier::{BarrierError, Phase, SlotState, TickBarrier};
pub use leader::{BarrierLeader, Pacing, TickEnd};
pub use member::{BarrierMember, TickWait};
pub use monitor::BarrierMonitor;

use std::time::Duration;

/// Maximum sleep before a waiting process checks for a stop. It only matters to a process that was
/// never woken (because its waker died).
pub const POLL_INTERVAL: Duration = Duration::from_millis(100);
