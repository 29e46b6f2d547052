//! The protean command: runs, supervises and records missions of real processes.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod chaos;
pub mod cli;
pub mod eyes;
pub mod kinds;
pub mod latency;
pub mod logs;
pub mod mission;
pub mod picture;
pub mod planning;
pub mod recorder;
pub mod report_page;
pub mod routes;
pub mod scenario;
pub mod sweep;
