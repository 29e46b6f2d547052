//! Robots as simulator, planners and scenarios know them: body, limits, sensors, teams.
//!
//! - [`spec`]: the specification of a robot, as a table of a scenario, and its model;
//! - [`team`]: roles of teams, and which teams are hostile;
//! - [`drive`]: the limits of a drive, and the motion of a robot that keeps its speeds.
//!
//! No world and no rules: a planner for a real robot needs no simulator.

pub mod drive;
pub mod spec;
pub mod team;
