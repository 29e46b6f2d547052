//! Execution of one run, from the resolved scenario to the summary: starts, supervises, records and ends its
//! processes, and removes all its resources.
//!
//! * [`plan`], `launch`, `obstacle_schedule`: configuration of every process;
//! * [`run_directory`], `resources`, `shm_usage`, `orphans`: resources of a run, and of abandoned runs;
//! * [`child_process`], [`process_group`], [`stepped_processes`]: processes and their turns;
//! * `supervisor`, `decide`, `executor`, `process_log`: events of processes and the reactions;
//! * `recording`, `fields_of_view`, `recorder_thread`, `progress`, `team_colours`, [`report`]: log, display and summary;
//! * `run`: a run with operating-system processes; [`in_process`]: a run in one thread of this process.

pub mod child_process;
mod decide;
mod error;
mod executor;
mod fields_of_view;
pub mod in_process;
mod launch;
mod obstacle_schedule;
mod orphans;
pub mod plan;
pub mod process_group;
mod process_log;
mod program_declarations;
mod progress;
mod recorder_thread;
mod recording;
pub mod report;
pub mod resources;
mod run;
pub mod run_directory;
mod shm_usage;
pub mod stepped_processes;
mod supervisor;
mod team_colours;

pub use error::{InProcessError, MissionError};
pub use program_declarations::{AskError, AskFault, ask};
pub use report::MissionReport;
pub use run::{MissionOptions, run};
pub use shm_usage::ShmFull;
pub use team_colours::team_colours;
