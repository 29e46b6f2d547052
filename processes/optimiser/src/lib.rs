//! Minimum-time trajectories of a differential-drive robot among obstacles.
pub mod bound;
pub mod ground;
pub mod guide;
pub mod options;
pub mod path;
pub mod plan;
pub mod planner;
pub mod problem;
pub mod tangent;
pub mod timing;
pub mod trajectory;
pub mod turning;
pub use options::Options;
pub use plan::{Method, Plan, PlanError, Sample, Status};
pub use planner::plan;
pub use problem::{Problem, ProblemError, RobotLimits, Wheels};
