//! Tests of observers with driving robots; one program saves link time.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod drive;
mod keys;
mod next_goal;
mod pieces;
mod process;
mod real_drives;
mod support;
