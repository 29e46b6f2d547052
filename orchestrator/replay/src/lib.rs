//! Repetition of a recorded run: [`replay()`] sends the messages of a log to any subscriber, [`verify()`] sends them to
//! processes under test, and [`rerun()`] executes its scenario again, with its [branches](lineage). The latter two compare the result
//! with the log. [`import()`](import::import) makes a log of a recording of ROS 2.

mod bag_fault;
mod error;
pub mod import;
pub mod lineage;
mod live_replay;
pub mod origin;
mod player;
mod publishers;
mod recorded;
mod replay_report;
mod rerun;
mod verify;

#[cfg(test)]
mod tests;

pub use error::ReplayError;
pub use player::replay;
pub use recorded::ProcessExit;
pub use replay_report::{ReplayOptions, ReplayReport};
pub use rerun::{Rerun, RerunOptions, failures, rerun, run_again};
pub use verify::{VerificationReport, VerifyOptions, verify};

use ipc_types::bus::{BusOptions, LOOP_TICKS};

use mission::MissionError;
use mission::resources::RunResources;
use scenario::ResolvedScenario;

/// Creates the resources of a replayed run. A subscriber without room blocks the publisher, also where the run itself
/// would have dropped messages. Nothing lags like a recorder, and buffers of publishers that grow take much memory.
fn create_resources(scenario: &ResolvedScenario) -> Result<RunResources, MissionError> {
    RunResources::create(scenario, "warn", |bus| BusOptions {
        overflow: false,
        recorder_ticks: LOOP_TICKS,
        ..bus
    })
}
