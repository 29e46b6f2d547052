//! One run, from the resolved scenario to the summary: processes started, supervised, recorded,
//! ended, and nothing left behind.

pub(crate) mod bridge;
mod changes;
pub mod children;
mod chronicle;
mod decide;
mod error;
mod failure;
mod gate;
mod log_path;
mod orphans;
pub mod plan;
pub(crate) mod progress;
pub(crate) mod recording;
pub mod report;
pub(crate) mod room;
mod run;
pub mod spaces;
mod supervisor;

pub use error::MissionError;
pub use room::NoRoom;
pub use run::{MissionOptions, MissionReport, run};
pub(crate) use run::{create_services, write_config};
