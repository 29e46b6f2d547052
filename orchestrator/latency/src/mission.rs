//! A mission in real time whose stamps are measured.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use mcap_log::ReadProgress;

use super::error::LatencyError;
use super::of_log::{RunLatencies, of_log};
use mission::{self, MissionOptions};
use platform::scratch::Scratch;
use scenario::ResolvedScenario;

/// Options of a mission.
#[derive(Debug, Clone, Default)]
pub struct RunOptions {
    /// Path of the log; `None`: the log is deleted.
    pub log: Option<PathBuf>,
    /// `true` if the log may replace a file.
    pub force: bool,
    /// `true` if only errors are shown.
    pub quiet: bool,
    /// Set by the caller (Ctrl-C) to end it in order.
    pub interrupted: Arc<AtomicBool>,
}

/// Runs a scenario in its own mode, and reads the stamps in its log.
/// Also returns `true` if the run was interrupted.
///
/// # Errors
/// [`LatencyError`]: the mission failed, or ended before any measurement.
pub fn run(
    scenario: &ResolvedScenario,
    options: &RunOptions,
) -> Result<(RunLatencies, bool), LatencyError> {
    let folder = Scratch::create().map_err(|source| LatencyError::System {
        what: "a temporary directory: cannot be created".to_owned(),
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
    // After Ctrl-C, the log up to the interruption is read.
    let mut watch = ReadProgress::new(Arc::default(), options.quiet);
    Ok((of_log(&log, &mut watch)?, report.interrupted))
}
