//! Observers of robots that drive; one program, to be linked once.

mod drive;
mod keys;
mod next_goal;
mod pieces;
mod process;
mod real_drives;
mod support;
