//! Small logs, whole and broken.

mod assurance;
mod broken;
mod foreign;
mod lz4;
mod still;
mod tables;

// Each including crate uses only parts of them.
#[allow(dead_code)]
#[path = "../../../recorder/src/tests/made_up.rs"]
mod made_up;
#[allow(dead_code)]
mod support;

use std::path::Path;

use recorder::{DerivedTopics, Summary};
use viewer::{ViewerOptions, viewer_topics};

/// Viewer topics of the test run.
fn pictures() -> Option<Box<dyn DerivedTopics>> {
    viewer_topics(&made_up::run_info(), &ViewerOptions::default())
}

/// Records the test run, with viewer topics, for this many ticks.
fn record_run(path: &Path, ticks: u64) -> Summary {
    made_up::record_run(path, ticks, 4_000, pictures(), |_, _| {})
}
