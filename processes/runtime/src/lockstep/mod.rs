//! The turn: one small barrier of shared memory that says whose move it is.
//!
//! Data travels over the bus; the *turn* goes over a barrier of futex words, because the price of a
//! tick is its context switches. The simulator publishes the state of tick *k* and posts the tick;
//! every process in the loop waits for its upstream (the tick itself, or the processes whose output
//! for *k* it needs), steps, and marks itself done; the last one wakes the simulator.
//!
//! * [`barrier`]: the barrier and its words;
//! * [`BarrierMember`]: the turn as a process in the loop sees it;
//! * [`BarrierLeader`]: as the simulator sees it;
//! * [`BarrierMonitor`]: as the orchestrator and its recorder see it.

pub mod barrier;
mod leader;
mod member;
mod monitor;

pub use barrier::{BarrierError, Phase, SlotState, TickBarrier};
pub use leader::{BarrierLeader, TickEnd};
pub use member::{BarrierMember, TickWait};
pub use monitor::BarrierMonitor;

use std::time::Duration;

/// Longest sleep before a waiting process looks whether it shall stop. Only a process that was
/// never woken (its waker died) notices.
pub const POLL_INTERVAL: Duration = Duration::from_millis(100);
