//! Tools for logs: [`LogInfo`] summarises a log, [`cat`](cat()) lists its messages as JSON, [`events`](events()) its
//! events, [`recover`](recover()) repairs a truncated or damaged one,
//! [`export`](export()) writes tables, [`TopicColumns`] are a table in memory, and [`ros2bag`](ros2bag()) writes
//! a ROS 2 bag.

mod belief_rows;
mod cat;
mod events;
mod export;
mod info;
mod info_text;
mod layout;
mod measured;
mod measurement;
mod message_json;
mod patrol_rows;
mod recover;
mod time_span;
mod topic_columns;
mod topic_table;

#[cfg(test)]
mod tests;

pub use cat::{CatOptions, cat};
pub use events::events;
pub use export::{ExportOptions, ExportReport, Ros2Bag, Table, export, ros2bag};
pub use info::{LogInfo, TopicInfo};
pub use info_text::text as info_text;
pub use measured::Measured;
pub use recover::{RecoveryReport, recover};
pub use time_span::nanoseconds;
pub use topic_columns::TopicColumns;
