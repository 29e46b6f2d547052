//! Missions as tests: `protean test`.
//!
//! [`load`] reads test files, and scenarios with `[expect]`, into [`MissionTest`]s. [`fn@run`] executes their missions with
//! the engines of sweeps and judges them; what is expected of several missions is decided by its interval. The
//! [`SuiteReport`] is written as text, Markdown, `JUnit` XML, annotations or JSON; the JSON of an earlier run is the
//! [`Baseline`] of a later one. [`fn@update`] writes accepted digests and outcomes into the files.

mod baseline;
mod edit;
mod error;
mod evaluate;
mod expectation;
mod first_difference;
mod limit;
mod output;
mod report;
mod runner;
mod spec;
mod test_file;
mod update;

pub use baseline::{Baseline, ColumnChange, TestChange};
pub use error::TestError;
pub use output::{annotations, junit, markdown, text};
pub use report::{Finding, MissionRecord, SuiteReport, TestReport, Verdict};
pub use runner::{RunOptions, run};
pub use spec::schema;
pub use test_file::{MissionTest, load};
pub use update::update;
