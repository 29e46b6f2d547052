//! Maps and free space from outside; one program, because linking two takes time.

#[path = "../scenes/mod.rs"]
mod scenes;

mod free_space;
mod sight_lines;
