//! The protean command: runs, supervises and records missions of real processes.

pub mod bench;
pub mod cli;
pub mod mission;
pub mod picture;
pub mod recorder;
pub mod scenario;
