//! Sources of scenarios: the scenarios and maps compiled into the program, the files that a scenario may read, and former names in
//! scenarios.

pub mod builtin;
pub mod files;
pub mod renamed;
