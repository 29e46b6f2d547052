//! Sources of scenarios: the scenarios and maps compiled into the program, and the files that a scenario may read.

pub mod builtin;
pub mod files;
