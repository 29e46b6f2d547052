//! Logs after the run: what is in them, what can be saved of a damaged one, parts of them, tables
//! of them, and the run in them once more.
//!
//! What reads and writes the files is the crate [`mcap_log`].

mod compare;
mod deviation;
mod export;
mod filter;
mod info;
mod info_text;
pub(crate) mod origin;
mod recorded;
mod recover;
mod replay;
mod rerun;

#[cfg(test)]
mod tests;

pub use compare::{Comparison, Difference, TopicComparison};
pub use deviation::Deviation;
pub use export::{ExportOptions, Exported, Table, export};
pub use filter::{FilterOptions, Filtered, filter};
pub use info::{LogInfo, TopicInfo};
pub use info_text::text as info_text;
pub use recorded::Left;
pub use recover::{Recovered, recover};
pub use replay::{ReplayError, ReplayOptions, Replayed, Verified, VerifyOptions, replay, verify};
pub use rerun::{Rerun, RerunOptions, rerun};
