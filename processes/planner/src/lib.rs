//! Planners as processes: one trait for steering algorithms, and the process that runs one per
//! robot.
//!
//! - [`Planner`]: the trait of an algorithm;
//! - [`PlannerProcess`]: its process, which reads the state, the map, beliefs and scans, and sends
//!   commands, plans, trees and waypoints;
//! - [`planner_map`], [`robot_views`], [`limits`]: conversions of messages to inputs of algorithms.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod maps;
mod outputs;
mod planner;
mod process;
mod views;

pub use maps::planner_map;
pub use outputs::{MAX_PLAN_POINTS, PlannedPoint, headed_for};
pub use planner::{Planner, PlannerInputs, limits, planner_seed};
pub use process::PlannerProcess;
pub use views::robot_views;
