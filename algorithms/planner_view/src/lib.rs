//! Inputs and outputs of a planner in each tick.
//!
//! - [`view::View`]: robots, beliefs, scan and time of one tick;
//! - [`map::PlannerMap`]: the map as grids, with what planners [derive](derived::DerivedValues) from it;
//!   [`free_space::FreeSpace`]: its exact pieces, for planners that search;
//! - [`limits::Limits`]: limits of the robot;
//! - [`steering::Steering`]: the command, and data for display;
//! - [`stay::Stay`]: when a team does without a robot;
//! - [`waypoint`]: waypoints and their outcomes; [`event`]: other reports.

pub mod derived;
pub mod event;
pub mod free_space;
pub mod limits;
pub mod map;
pub mod of_world;
pub mod stay;
pub mod steering;
pub mod view;
pub mod waypoint;
