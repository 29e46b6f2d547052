//! Tools for logs: what is in one ([`LogInfo`]), what can be saved of a damaged one ([`recover`](recover())), parts
//! of one ([`filter`](filter())), tables of one ([`export`](export())), and two compared ([`compare`](compare())).

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod compare;
mod deviation;
mod export;
mod filter;
mod info;
mod info_text;
mod recover;

#[cfg(test)]
mod tests;

pub use compare::{Comparison, Difference, TopicComparison, compare};
pub use deviation::Deviation;
pub use export::{ExportOptions, Exported, Table, export};
pub use filter::{FilterOptions, Filtered, filter, nanoseconds};
pub use info::{LogInfo, TopicInfo};
pub use info_text::text as info_text;
pub use recover::{Recovered, recover};
