//! The turn: one small page of shared memory that says whose move it is.
//!
//! Data travels over the bus; the *turn* goes over a page of futex words, because the price of a
//! tick is its context switches. The simulator publishes the state of tick *k* and posts the tick;
//! every process in the loop waits for its upstream (the tick itself, or the processes whose output
//! for *k* it needs), steps, and marks itself done; the last one wakes the simulator.
//!
//! * [`page`]: the page and its words;
//! * [`Participant`]: the turn as a process in the loop sees it;
//! * [`Conductor`]: as the simulator sees it;
//! * [`Overseer`]: as the orchestrator and its recorder see it.

mod conductor;
mod overseer;
pub mod page;
mod participant;

pub use conductor::{Conductor, TurnEnd};
pub use overseer::Overseer;
pub use page::{PageError, Phase, SlotState, TurnPage};
pub use participant::{Participant, Turn};

use std::time::Duration;

/// Longest sleep before a waiting process looks whether it shall stop. Only a process that was
/// never woken (its waker died) notices.
pub const LOOK_UP: Duration = Duration::from_millis(100);
