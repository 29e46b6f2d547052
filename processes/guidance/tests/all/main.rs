//! The library in the city and other places; one program, because linking seven costs minutes.

#[path = "../scenes/mod.rs"]
mod scenes;
#[path = "../support/mod.rs"]
mod support;

mod avoidance;
mod dominance;
mod field_goldens;
mod free_space;
mod navigation;
mod shortest_path;
mod sight_lines;
mod walls_and_bodies;
mod wavefront;
