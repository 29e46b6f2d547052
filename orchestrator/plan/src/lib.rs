//! Minimum-time plans of many problems: `protean plan`.
//!
//! [`file::read`] reads problems from a file; [`generate`] generates them from seeds. [`solve`] plans one problem and
//! checks the plan against the problem as given; [`batch::solve_all`] does so for many problems in parallel.

pub mod answer;
pub mod batch;
pub mod field;
pub mod file;
pub mod generate;
pub mod instance;
pub mod loose;
pub mod routes;
pub mod summary;

#[cfg(test)]
mod tests;

pub use answer::{Answer, Outcome, solve};
pub use field::FieldError;
pub use file::{Element, FileError, FileProblem, read};
pub use generate::{Kind, Recipe};
pub use instance::{Body, Instance};
pub use trajectory_problem::Options;
