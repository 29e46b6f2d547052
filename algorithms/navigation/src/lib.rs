//! Path finding on the maps of planners.
//!
//! - [`tangent_graph`]: exact shortest paths of a disc among convex pieces;
//! - [`shortest_paths`]: these on the map of a planner;
//! - [`routes`]: paths along the streets of a grid, to all places at once;
//! - [`bearing`]: direction to a point, straight or along the streets;
//! - [`wavefront`]: first arrival times;
//! - [`dominance`]: places that each team reaches first.
//!
//! All functions are pure: equal inputs give equal bits on every machine.

pub mod bearing;
pub mod dominance;
pub mod routes;
pub mod shortest_paths;
pub mod tangent_graph;
pub mod wavefront;
