//! Path finding in the city and other places; one program, because linking four takes minutes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod classes;
mod dominance;
mod routes;
#[path = "../../../planner_view/tests/scenes/mod.rs"]
mod scenes;
mod shortest_path;
mod wavefront;
