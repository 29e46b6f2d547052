//! One run, from the resolved scenario to the summary: processes started, supervised, recorded,
//! ended, and nothing left behind.

pub(crate) mod bridge;
mod changes;
pub mod child_process;
mod chronicle;
mod decide;
mod error;
mod failure;
mod gate;
mod log_path;
mod orphans;
pub mod plan;
pub mod process_group;
pub(crate) mod progress;
pub(crate) mod recording;
pub mod report;
pub(crate) mod resources;
pub(crate) mod room;
mod run;
pub mod spaces;
mod stderr_lines;
pub(crate) mod supervisor;

pub use error::MissionError;
pub use room::NoRoom;
pub use run::{MissionOptions, MissionReport, run};
