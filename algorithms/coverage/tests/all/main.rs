//! Tests of the public interface of the crate.

mod c_library;
mod division;
mod planners;
mod random_map;
mod tables;
mod walks;
