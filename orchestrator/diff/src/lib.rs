//! The first difference of two recorded histories: tick, topic, process, field, both values, and the processes that
//! caused it; scenario keys, outcomes and events that differ.
//!
//! * `history` reads the simulated history of a log tick by tick, in memory that does not grow with the log;
//! * [`Comparison`] compares two histories, also those that do not come from a log;
//! * `message` compares two messages, of different versions by the names of their fields;
//! * `cause` tells the processes that differ by themselves from those that only received other inputs;
//! * `facts` compares scenarios, results and events.
//!
//! ```no_run
//! use std::path::Path;
//!
//! let mut watch = mcap_log::ReadProgress::default();
//! let report = diff::diff(Path::new("a.mcap"), Path::new("b.mcap"), &mut watch)?;
//! for cause in report.comparison.first.iter().flat_map(|first| &first.causes) {
//!     println!("tick {}: {} {}", cause.tick, cause.process, cause.field);
//! }
//! # Ok::<(), mcap_log::LogReadError>(())
//! ```

mod cause;
mod comparison;
mod deviation;
mod facts;
mod history;
mod message;
mod report;

#[cfg(test)]
mod tests;

pub use comparison::{Comparison, Difference, FirstDifference, TopicComparison, or_none};
pub use deviation::Deviation;
pub use facts::{EventChange, ValueChange};
pub use message::Message;
pub use report::{DiffReport, LogFacts, diff, diff_before};
