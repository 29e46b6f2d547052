//! ROS 2 nodes as planners of a run, without a ROS installation: the process of kind `ros2_bridge`.
//!
//! The process publishes the state of its robots as ROS 2 topics over DDS, and sends the `cmd_vel` of each to the
//! simulator. In lock-step a tick ends when the command of every robot has arrived, so that a run with
//! unmodified nodes has the same history whatever the load.
//!
//! - [`convert`]: messages of a run as those of ROS 2; [`names`]: their topics and frames;
//! - [`data`]: the topics of a run and their publishers; [`named`]: those that are published as they are;
//! - [`session`]: participant, publishers and subscriptions;
//! - [`source`]: robots outside of the simulation;
//! - [`answers`]: the commands of a tick: each robot one, each in its tick;
//! - [`process`]: the process.

pub mod answers;
pub mod convert;
pub mod data;
pub mod error;
pub mod named;
pub mod names;
pub mod params;
pub mod process;
pub mod session;
pub mod source;

pub use params::Ros2BridgeParams;
pub use process::Ros2BridgeProcess;
