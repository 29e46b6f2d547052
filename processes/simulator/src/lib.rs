//! The simulator process: drives `sim_backend::World` and owns the tick.
//!
//! * [`process`]: the loop, in lock-step and in real time;
//! * [`event_schedule`]: changes of the obstacles that depend on robots or on each other;
//! * [`commands`]: selection of each robot's command;
//! * `measured`: robots outside of the simulation;
//! * [`outputs`]: the world as messages.

pub mod commands;
pub mod event_schedule;
mod measured;
mod obstacles;
pub mod outputs;
pub mod params;
pub mod process;

pub use params::SimulatorParams;

/// The name of the simulator, as a process and as its kind.
pub const NAME: &str = "simulator";
