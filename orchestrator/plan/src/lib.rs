//! Minimum-time plans of many problems: `protean plan`.
//!
//! [`file::read`] reads problems from a file, [`generate`] makes them up from seeds, [`solve`]
//! plans one of them and has the plan checked against the problem as it was given, and
//! [`batch::solve_all`] does so for many of them at once.

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

pub mod answer;
pub mod batch;
pub mod field;
pub mod file;
pub mod generate;
pub mod instance;
pub mod loose;
pub mod options;
pub mod routes;
pub mod summary;

#[cfg(test)]
mod tests;

pub use answer::{Answer, Outcome, solve};
pub use field::FieldError;
pub use file::{Element, FileError, FileProblem, read};
pub use generate::{Kind, Recipe};
pub use instance::{Body, Instance};
pub use options::PlanOptions;
