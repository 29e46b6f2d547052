//! Tests of the crate as its users see it.

mod division;
mod random_map;
mod tables;
mod walks;
