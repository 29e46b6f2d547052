//! The simulator process: drives `sim_backend::World` and owns the tick.
//!
//! * [`process`]: the loop, in lock-step and in real time;
//! * [`event_schedule`]: changes of the obstacles that depend on robots or on each other;
//! * [`commands`]: selection of each robot's command;
//! * [`outputs`]: the world as messages.

pub mod commands;
pub mod event_schedule;
mod obstacles;
pub mod outputs;
pub mod params;
pub mod process;

pub use params::SimulatorParams;

use ipc_types::topics::{
    Commands, Coverage, ObstacleEvents, Scan, WorldEvents, WorldMap, WorldShapes, WorldState,
};
use runtime::declaration::{Declaration, Flow, Input, Output, When};

/// The name of the simulator, as a process and as its kind.
pub const NAME: &str = "simulator";

/// Returns its inputs and outputs. The size of its messages follows from the world.
pub fn declaration() -> Declaration {
    let commands = Input::new(Flow::of::<Commands>(), When::NextTick);
    let changes = Input::new(Flow::of::<ObstacleEvents>(), When::Event);
    Declaration::default()
        .reads(commands)
        .reads(changes)
        .writes(Output::new::<WorldState>(0).at(When::ThisTick))
        .writes(Output::new::<Scan>(0).at(When::ThisTick))
        .writes(Output::new::<WorldMap>(0).at(When::Latched))
        .writes(Output::new::<WorldShapes>(0).at(When::Latched))
        .writes(Output::new::<WorldEvents>(0))
        .writes(Output::new::<Coverage>(0))
        .writes(Output::new::<ObstacleEvents>(1).at(When::Event))
}
