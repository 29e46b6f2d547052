//! Planners in Python: what they get, what they return, and their process.

mod entry;
mod function;
mod params;
mod process;
mod robot;
mod sensors;
mod steering;
mod world;

pub use entry::serve;
pub use function::Function;
pub use params::PythonParams;
pub use process::PythonPlanner;
pub use robot::{Robot, go_to};
pub use sensors::{Belief, Scan};
pub use steering::PySteering;
pub use world::World;
