//! Tests of observers with driving robots; one program saves link time.

mod drive;
mod keys;
mod next_goal;
mod pieces;
mod process;
mod real_drives;
mod support;
