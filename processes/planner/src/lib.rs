//! Planners as processes: one trait for steering algorithms, and the process that runs one per
//! robot.
//!
//! - [`Planner`]: the trait of an algorithm;
//! - [`PlannerError`]: the reason why there is none for a robot;
//! - [`main`]: the main function of a program that is a process of a planner;
//! - [`PlannerProcess`]: its process, which reads the state, the map, beliefs and scans, and sends
//!   commands, plans, trees and waypoints;
//! - [`TopicProcess`]: the process of a program that reads and writes topics by their names, a [`TopicProgram`];
//! - [`planner_map`], [`robot_views`], [`teams`], [`limits`]: conversions of messages to inputs of algorithms.

mod direct;
mod error;
mod main_function;
mod maps;
mod outputs;
mod planner;
mod process;
mod topic_process;
mod views;

pub use error::PlannerError;
pub use main_function::main;
pub use maps::planner_map;
pub use outputs::{MAX_PLAN_POINTS, PlannedPoint, headed_for};
pub use planner::{Planner, limits, planner_seed};
pub use process::PlannerProcess;
pub use topic_process::{RawOutput, TopicProcess, TopicProgram, planner_reads};
pub use views::{robot_views, teams};

pub use planner_view::limits::Limits;
pub use planner_view::map::PlannerMap;
pub use planner_view::steering::Steering;
pub use planner_view::view::View;
pub use runtime::config::RobotInfo;
pub use runtime::declaration::{Declaration, Input, Output};

// What planners outside the workspace use, so that they depend on this crate alone.
pub use {avoidance, control, geometry, nalgebra, parameters, planner_view, runtime};
