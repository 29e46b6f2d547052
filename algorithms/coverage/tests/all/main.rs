//! Tests of the crate as its users see it.

mod c_library;
mod division;
mod planners;
mod random_map;
mod tables;
mod walks;
