//! Planners and other processes in Python: what they get, what they return, and how they run.

mod entry;
mod function;
mod messages;
mod own_topics;
mod params;
mod process;
mod robot;
mod sensors;
mod steering;
mod world;

pub use entry::serve;
pub use function::Function;
pub use own_topics::OwnTopics;
pub use params::PythonParams;
pub use process::PythonPlanner;
pub use robot::{Robot, go_to};
pub use sensors::{Belief, Scan};
pub use steering::PySteering;
pub use world::World;
