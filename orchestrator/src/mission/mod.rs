//! One run, from the resolved scenario to the summary: processes are started, supervised, recorded and ended, and
//! nothing is left behind.
//!
//! * [`plan`], `obstacle_schedule`: what every process is told;
//! * [`run_directory`], `resources`, `shm_usage`, `orphans`: what a run uses, and what is found of others;
//! * [`child_process`], `stderr_lines`, [`process_group`], `external_bridge`: processes and their turns;
//! * `supervisor`, `decide`, `executor`, `process_log`: what happens to them, and what is done about it;
//! * `recording`, `recorder_thread`, `progress`, [`report`]: log, display and summary;
//! * `run`: all of it.

pub mod child_process;
mod decide;
mod error;
mod executor;
mod external_bridge;
mod obstacle_schedule;
mod orphans;
pub mod plan;
pub mod process_group;
mod process_log;
pub(crate) mod progress;
mod recorder_thread;
pub(crate) mod recording;
pub mod report;
pub(crate) mod resources;
mod run;
pub mod run_directory;
mod shm_usage;
mod stderr_lines;
pub(crate) mod supervisor;

pub use error::MissionError;
pub use run::{MissionOptions, MissionReport, run};
pub use shm_usage::ShmFull;
