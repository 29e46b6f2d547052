//! Planners in C and C++: shared libraries that `protean planner LIBRARY` loads as processes of a run.
//!
//! - `abi`: the interface, declared once in Rust; `c_types`: the declaration of C types; `c_structure`: their text;
//! - [`header`]: the interface as the header `protean_planner.h`;
//! - `library`: a loaded library, checked;
//! - `start_functions`, `tick_functions`: the functions that a library calls;
//! - `robots`: the robots of a run in C;
//! - `process`: the planner of one robot as a [`planner::Planner`];
//! - [`run`]: the main function.
//!
//! A library is trusted as code of this process: what it returns is checked, but it can break the process. The
//! orchestrator then acts as for any process that ends.

#[expect(clippy::doc_markdown, reason = "the comments are those of the header")]
mod abi;
mod c_structure;
mod c_types;
pub mod header;
mod library;
mod process;
mod robots;
mod start_functions;
mod tick_functions;

pub use library::{Library, LibraryError};
pub use process::run;

#[cfg(test)]
mod tests;
