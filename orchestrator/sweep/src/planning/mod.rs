//! Experiments whose missions are plans of minimum-time trajectories: `kind = "planning"`.
//!
//! They share cases, parameters, seeds, shards, journal and table with experiments of robots. A
//! mission is one problem, generated from the seed ([`Recipe`](plan::Recipe)) and planned once. Its
//! row depends only on the experiment; its CPU time does not, and has a separate table.

mod row;
mod subject;
pub mod summary;

#[cfg(test)]
mod tests;

pub use crate::task::Task;
pub use row::PlanRow;
pub use subject::{PlanExperiment, is_planning};

use super::results::Results;

/// Results of an experiment of plans.
pub type PlanResults = Results<PlanRow>;
