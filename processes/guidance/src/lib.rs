//! Shared steering algorithms: what a planner sees, potential fields, feedback linearisation, and
//! the routing that takes potential fields out of their local minima; exact free space and shortest
//! paths for planners that search.
//!
//! Everything here is pure: values in, values out, the same bits on every machine. The planners
//! (`pursuer`, `evader_potential`, `evader_braitenberg`) are compositions of these parts:
//!
//! 1. a [`view::View`] of one tick and a [`map::PlannerMap`] come in;
//! 2. [`bearing`] says in which direction something lies, straight or along the streets
//!    ([`navigation`]);
//! 3. [`potential_field`] sums attraction, repulsion, obstacles and perturbation;
//! 4. [`feedback_linearisation`] turns the wanted velocity of a point ahead of the axle into
//!    forward speed and turning rate, within the robot's [`limits::Limits`];
//! 5. a [`steering::Steering`] goes out: the command, and what a viewer wants to see.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod bearing;
pub mod derived;
pub mod dominance;
pub mod feedback_linearisation;
pub mod free_space;
pub mod go_to;
pub mod limits;
pub mod map;
pub mod navigation;
pub mod path_tracking;
pub mod potential_field;
pub mod steering;
pub mod tangent_bug;
pub mod tangent_graph;
pub mod view;
pub mod wavefront;
pub mod waypoint;
pub mod waypoint_driver;
