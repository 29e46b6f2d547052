//! Tools for logs: [`LogInfo`] summarises a log, [`cat`](cat()) lists its messages as JSON,
//! [`recover`](recover()) repairs a truncated or damaged one, [`filter`](filter()) cuts it, [`export`](export())
//! writes tables, [`ros2bag`](ros2bag()) a ROS 2 bag, and [`compare`](compare()) compares two.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod cat;
mod compare;
mod deviation;
mod export;
mod filter;
mod info;
mod info_text;
mod message_json;
mod recover;
mod time_span;

#[cfg(test)]
mod tests;

pub use cat::{CatOptions, cat};
pub use compare::{Comparison, Difference, TopicComparison, compare};
pub use deviation::Deviation;
pub use export::{ExportOptions, Exported, Ros2Bag, Table, export, ros2bag};
pub use filter::{FilterOptions, Filtered, filter};
pub use info::{LogInfo, TopicInfo};
pub use info_text::text as info_text;
pub use recover::{Recovered, recover};
pub use time_span::nanoseconds;
