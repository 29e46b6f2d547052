//! Shortest ways through the arena, fast enough to be asked for in every tick.
//!
//! A potential field has local minima; the distance travelled along the shortest way has none
//! (it is a *navigation function*). [`NavGrid`] is a coarse graph of places where the robot fits,
//! [`RouteTree`] the shortest ways from one place to all others, and [`Wayfinder`] keeps trees
//! between ticks and renews them only when their root comes to another node, or the map changes.

mod nav_grid;
mod route_tree;
mod wayfinder;
mod ways;

pub use nav_grid::{Edge, MARGIN, NavGrid};
pub use route_tree::{RouteLeg, RouteTree, Routes, Threat};
pub use wayfinder::{WayOut, Wayfinder};
