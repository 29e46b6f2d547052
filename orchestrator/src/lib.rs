//! The protean command: runs, supervises and records missions of real processes.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

// First, so that its `eprintln!` holds in all others.
#[macro_use]
mod terminal;

pub mod atomic_file;
pub mod chaos;
pub mod cli;
pub mod descriptors;
pub mod eyes;
pub mod figures;
pub mod in_process;
pub mod latency;
pub mod live;
pub mod logs;
pub mod mission;
mod palette;
pub mod picture;
pub mod planning;
mod proc;
pub mod program;
mod progress;
pub mod recorder;
pub mod report_page;
pub mod routes;
pub mod scenario;
mod shell;
pub mod signals;
pub mod statistics;
mod storage;
pub mod sweep;
pub mod tables;
pub mod wirings;
