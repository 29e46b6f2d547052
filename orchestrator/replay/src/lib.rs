//! The run of a log once more: [`replay()`] sends its messages to any subscriber, [`verify()`] to processes under
//! test, and [`rerun()`] plays its scenario again; the latter two compare the result with the log.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod error;
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
pub use replay_report::{ReplayOptions, Replayed};
pub use rerun::{Rerun, RerunOptions, rerun};
pub use verify::{Verified, VerifyOptions, verify};

use ipc_types::bus::BusOptions;

use mission::MissionError;
use mission::resources::RunResources;
use scenario::ResolvedScenario;

/// Creates the resources of a run that is replayed. A subscriber without room holds the publisher back, also where
/// the run itself would have dropped messages.
fn create_resources(scenario: &ResolvedScenario) -> Result<RunResources, MissionError> {
    RunResources::create(scenario, "warn", |bus| BusOptions {
        overflow: false,
        ..bus
    })
}
