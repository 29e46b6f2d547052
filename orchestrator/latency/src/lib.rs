//! `protean latency`: the latency from a world state to its commands, hop by hop.
//!
//! * [`of_log()`] reads the stamps in a log: hops, steps, parts of steps, and the stages of every
//!   tick;
//! * [`run`](mission::run) runs a mission in real time for such a log;
//! * [`Report`] is the result as a table and as JSON.

mod error;
pub mod mission;
mod of_log;
mod report;
mod text;

pub use error::LatencyError;
pub use of_log::{RunLatencies, Sizes, of_log};
pub use report::{Report, Run, load};
pub use text::text;

pub use recorder::chain::{Answers, Passage, REACTION, Stage, TICK_JITTER, WHOLE};
