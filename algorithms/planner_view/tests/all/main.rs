//! Maps and free space from outside; one program, because linking two takes time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../scenes/mod.rs"]
mod scenes;

mod free_space;
mod sight_lines;
