//! Planners and processes in C and C++: shared libraries that `protean planner LIBRARY` loads as processes of a run.
//!
//! - `abi`: the interface, declared once in Rust; `c_types`: the declaration of C types;
//! - `library`: a loaded library, checked; `error`: faults of libraries;
//! - `start_functions`, `tick_functions`: the functions that a library calls;
//! - `robots`: the robots of a run in C; `topics`, `records`: its topics and their messages;
//! - [`LibraryPlanner`]: the planner of one robot as a [`planner::Planner`];
//! - [`LibraryProgram`]: a process with topics of its own as a [`planner::TopicProgram`];
//! - [`run`]: the main function; [`LibraryParams`]: the parameters.
//!
//! A library is trusted as code of this process: what it returns is checked, but it can break the process. The
//! orchestrator then acts as for any process that ends.

#[expect(clippy::doc_markdown, reason = "the comments are those of the header")]
mod abi;
mod c_types;
mod entry;
mod error;
mod library;
mod params;
mod process;
mod records;
mod robots;
mod start_functions;
mod tick_functions;
mod topic_process;
mod topics;

pub use entry::run;
pub use error::{TableError, Unexpected};
pub use library::{Library, LibraryError};
pub use params::LibraryParams;
pub use process::LibraryPlanner;
pub use topic_process::LibraryProgram;

#[cfg(test)]
mod tests;
