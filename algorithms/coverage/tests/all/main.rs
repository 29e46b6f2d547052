//! Tests of the public interface of the crate.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod c_library;
mod division;
mod planners;
mod random_map;
mod tables;
mod walks;
