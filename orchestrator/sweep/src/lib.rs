//! Experiments: many missions from one file, and one table of results.
//!
//! [`Experiment::load`] reads a file that names a scenario, varied parameters, and seeds, and
//! validates every resulting scenario. [`run`](runner::run) executes the missions that are not
//! finished, several at once, and appends each to the journal of a [`Results`] directory when it
//! ends. [`Results::write_tables`] writes them in an order that depends only on the experiment. The
//! results of a sweep are a function of the experiment alone. They do not depend on the number of
//! parallel missions, the engine, interruptions, or the division into parts ([`shard`], [`merge`]).
//!
//! Modules from the lowest to the highest; each uses only those before it:
//!
//! | modules | content |
//! |---|---|
//! | `cell`, `kind`, `columns`, `row`, `long_tables`, `metrics` | cells, rows of results, their tables, and names of metrics |
//! | [`spec`], `seeds`, `mission_id`, `options` | the keys of the file, and options beside it |
//! | `manifest`, `table`, `directory`, `journal`, `results`, [`merge`] | the directory of results |
//! | `reader`, `assignments`, `parameters`, `grid`, `parts`, `cases` | parts of the file during reading |
//! | [`engine`], [`pool`], `subject`, `experiment`, [`shard`], [`runner`] | experiments of any kind, and their execution |
//! | `worst`, [`summary`], [`published`] | summaries of results; published points beside them |
//! | `missions`, [`planning`] | the kinds of missions: of robots, of plans |

mod assignments;
mod cases;
mod cell;
mod columns;
mod directory;
pub mod engine;
mod error;
mod experiment;
mod grid;
mod journal;
mod kind;
mod long_tables;
mod manifest;
pub mod merge;
mod metrics;
mod mission_id;
mod missions;
mod options;
mod parameters;
mod parts;
pub mod planning;
pub mod pool;
pub mod published;
mod reader;
mod results;
mod row;
pub mod runner;
pub mod schema;
mod seeds;
pub mod shard;
pub mod spec;
mod subject;
pub mod summary;
mod table;
mod task;
mod worst;

#[cfg(test)]
mod tests;

pub use assignments::{Assignment, read as read_overrides};
pub use cases::Case;
pub use cell::{Cell, Value};
pub use columns::{Part, ResultColumn, ResultTable};
pub use directory::kind_of;
pub use error::SweepError;
pub use experiment::{Column, ExperimentOf};
pub use kind::Kind;
pub use manifest::{FORMAT, Manifest, ManifestCell};
pub use metrics::Metric;
pub use mission_id::MissionId;
pub use missions::{Experiment, Mission, template};
pub use options::LoadOptions;
pub use reader::Reader;
pub use results::Results;
pub use row::{Outcome, Record, Row};
pub use seeds::Seeds;
pub use subject::Subject;
pub use worst::{Measure, MeasureError};
