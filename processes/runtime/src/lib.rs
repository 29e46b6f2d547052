//! The runtime of a process: start-up, configuration, lock-step and real-time loops, heartbeat,
//! shutdown, and the inputs that processes share.
//!
//! A process is an algorithm (a pure library) and a [`ProcessKind`] that connects it to its topics.
//! [`life::run`] runs it. Steering planners implement the trait of crate `planner` instead.

pub mod config;
pub mod declaration;
pub mod error;
pub mod files;
pub mod grids;
pub mod guard;
pub mod inputs;
pub mod kind;
pub mod life;
pub mod link;
pub mod lockstep;
pub mod logging;
pub mod maps;
pub mod obstacle;
pub mod paced;
pub mod raw_inputs;
pub mod seed;
pub mod service_client;
pub mod shapes;
pub mod status;

pub use config::{Clock, ProcessConfig, RobotInfo, RunConfig};
pub use error::ProcessError;
pub use kind::{Process, ProcessKind};
pub use life::{Setup, follow, run, run_with};
