//! Experiments whose missions are plans of minimum-time trajectories: `kind = "planning"`.
//!
//! They share everything with experiments of robots but what a mission is: cases, parameters, seeds,
//! shards, the journal, the table. A mission is one problem, made up from the seed
//! ([`Recipe`](plan::Recipe)) and planned once. Its row follows from the experiment alone;
//! the CPU time that it took does not, and stands in a table of its own.

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
