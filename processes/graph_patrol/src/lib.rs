//! The planner of robots that patrol a graph together.
//!
//! [`GraphPatrol`] decides and drives for one robot: [`patrol_graph`] has the strategies, the waypoint driver of `avoidance`
//! drives. [`process`] connects it to its topics, and exchanges intentions within the team.

mod chain;
mod messages;
mod params;
mod patrol;
pub mod process;

pub use messages::{Intention, Intentions};
pub use params::GraphPatrolParams;
pub use patrol::GraphPatrol;
