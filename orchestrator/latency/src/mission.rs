//! A mission in real time, for its stamps.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use mcap_log::ReadProgress;

use super::error::LatencyError;
use super::of_log::{Measured, of_log};
use mission::{self, MissionOptions};
use scenario::ResolvedScenario;
use scenario::kind::Kind;

/// How a mission is run.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Keep the log in this file.
    pub log: Option<PathBuf>,
    /// Whether the log may replace a file.
    pub force: bool,
    /// Whether nothing but errors is shown.
    pub quiet: bool,
    /// Set from outside (Ctrl-C) to end it in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Runs a scenario, which says how, and reads the stamps in its log, whose scenario has these kinds of
/// processes; whether it was interrupted.
///
/// # Errors
/// [`LatencyError`]: the mission failed, or ended before anything could be measured.
pub fn run(
    scenario: &ResolvedScenario,
    kinds: &[Kind],
    options: &RunOptions,
) -> Result<(Measured, bool), LatencyError> {
    let folder = tempfile::Builder::new()
        .prefix("protean-latency-")
        .tempdir()
        .map_err(|source| LatencyError::System {
            what: "cannot make a temporary folder".to_owned(),
            source,
        })?;
    let log = options.log.clone();
    let log = log.unwrap_or_else(|| Path::join(folder.path(), "run.mcap"));
    let report = mission::run(
        scenario,
        &MissionOptions {
            out: Some(log.clone()),
            force: options.force,
            quiet: options.quiet,
            interrupted: Arc::clone(&options.interrupted),
            ..MissionOptions::default()
        },
    )?;
    // Ctrl-C has ended the mission; what it has left is read all the same.
    let mut watch = ReadProgress::new(Arc::default(), options.quiet);
    Ok((of_log(&log, kinds, &mut watch)?, report.interrupted))
}
