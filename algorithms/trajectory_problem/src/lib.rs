//! Minimum-time problems of a differential-drive robot among obstacles, and options of their plans.
//!
//! Planner, clients and files describe a problem with these types. No solver: a client that sends
//! requests links none. The check of plans has types of its own, since it shares no code with a planner.

mod limits;
mod method;
pub mod options;
pub mod problem;

pub use limits::{RobotLimits, Wheels};
pub use method::{Constraints, Guess, Method};
pub use options::Options;
pub use problem::{Problem, ProblemError};
