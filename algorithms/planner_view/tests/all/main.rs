//! Maps and free space from outside; one program, because linking two costs.

#[path = "../scenes/mod.rs"]
mod scenes;

mod free_space;
mod sight_lines;
