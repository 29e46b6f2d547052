//! Logs after the run: what is in them, what can be saved of a damaged one, parts of them, tables
//! of them, and the run in them once more.
//!
//! Everything here reads a log from its beginning to its end (`reader`), believes
//! no length in it, keeps no more in memory than a chunk, and goes as far as a damaged or foreign
//! file allows; what could not be read is in the [`Condition`].

mod compare;
mod condition;
pub(crate) mod derived;
mod deviation;
mod error;
mod export;
mod fields;
mod filter;
mod info;
mod info_text;
pub(crate) mod known;
mod newest_state;
pub(crate) mod origin;
pub(crate) mod output;
mod pattern;
pub(crate) mod reader;
mod recorded;
mod recover;
mod replay;
mod rerun;
mod ros2;
mod source;
pub(crate) mod states;
mod watch;

#[cfg(test)]
mod tests;

pub use compare::{Comparison, Difference, TopicComparison};
pub use condition::{Chunks, Condition, Fault};
pub use deviation::Deviation;
pub use error::LogsError;
pub use export::{ExportOptions, Exported, Table, export};
pub use filter::{FilterOptions, Filtered, filter};
pub use info::{LogInfo, TopicInfo};
pub use info_text::text as info_text;
pub use newest_state::newest_state;
pub use pattern::Topics;
pub use recorded::Left;
pub use recover::{Recovered, recover};
pub use replay::{ReplayOptions, Replayed, Verified, VerifyOptions, replay, verify};
pub use rerun::{Rerun, RerunOptions, rerun};
pub use tables::Format;
pub use watch::Watch;

/// Seconds of nanoseconds.
fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 * 1e-9
}
