//! Path finding in the city and other places; one program, because linking four takes minutes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../../planner_view/tests/scenes/mod.rs"]
mod scenes;
#[path = "../../../planner_view/tests/support/mod.rs"]
mod support;

mod classes;
mod dominance;
mod routes;
mod shortest_path;
mod wavefront;
