//! Replay of a log: its messages are sent once more, to any subscriber or to processes under test.

mod broadcast;
mod error;
mod played;
mod player;
mod publishers;
mod verify;

pub use error::ReplayError;
pub use played::{ReplayOptions, Replayed};
pub use player::replay;
pub use verify::{Verified, VerifyOptions, verify};

use ipc_types::bus::BusOptions;

use crate::mission::MissionError;
use crate::mission::resources::RunResources;
use crate::scenario::ResolvedScenario;

/// Creates the resources of a run that is replayed. A subscriber without room holds the publisher back, also where
/// the run itself would have dropped messages.
fn create_resources(scenario: &ResolvedScenario) -> Result<RunResources, MissionError> {
    RunResources::create(scenario, "warn", |bus| BusOptions {
        overflow: false,
        ..bus
    })
}
