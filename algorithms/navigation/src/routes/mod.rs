//! Shortest routes through the arena, fast enough for queries in each tick.
//!
//! A potential field has local minima; the distance travelled along the shortest path has none (it
//! is a *navigation function*). [`NavGrid`] is a coarse graph of places where the robot fits.
//! [`RouteTree`] holds the shortest routes from one place to all others. [`RouteFinder`] keeps
//! trees between ticks and renews them only when their root moves to another node, or the map
//! changes.

mod lengths;
mod nav_grid;
mod route_finder;
mod route_tree;
mod route_trees;

pub use lengths::{Lengths, LengthsFrom, RouteEnd};
pub use nav_grid::{Edge, MARGIN, NavGrid};
pub use route_finder::{ExitRoute, RouteFinder};
pub use route_tree::{RouteLeg, RouteTree, Routes, Threat};
