//! Experiments: many missions from one file, and one table of results.
//!
//! [`Experiment::load`] reads a file that names a scenario, what is varied of it, and seeds, and
//! checks every scenario that comes of it. [`run`](runner::run) carries out the missions that are
//! not done yet, several at once, and appends each to the journal of a [`Results`] directory as
//! soon as it is over; [`Results::write_tables`] writes them in an order that depends on nothing but
//! the experiment. What a sweep results in is a function of the experiment alone: not of how many
//! missions run at once, of who carries them out, of interruptions, or of how it was shared out
//! ([`shard`], [`merge`]).

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used))]
#![cfg_attr(not(test), warn(clippy::panic, clippy::unreachable))]

mod assignments;
mod build;
mod cases;
mod cell;
mod columns;
mod directory;
pub mod engine;
mod error;
mod experiment;
pub mod figures;
mod grid;
mod journal;
mod manifest;
pub mod merge;
mod metrics;
mod mission;
mod parameters;
mod parts;
pub mod planning;
mod reader;
mod results;
mod row;
pub mod runner;
mod seeds;
pub mod shard;
pub mod spec;
mod subject;
pub mod summary;
mod table;

#[cfg(test)]
mod tests;

pub use build::describe;
pub use cell::{Cell, Value};
pub use columns::ResultColumn;
pub use directory::kind_of;
pub use error::SweepError;
pub use experiment::{Case, Column, Experiment, ExperimentOf, LoadOptions};
pub use manifest::{FORMAT, Kind, Manifest, ManifestCell};
pub use metrics::Metric;
pub use mission::Mission;
pub use results::{MissionId, Results};
pub use row::{Outcome, Record, Row};
pub use seeds::Seeds;
pub use subject::Subject;
