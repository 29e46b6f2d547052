//! The report of a completed run.

use viewer::LiveTotals;

use recorder::Summary;
use scenario::spec::Mode;

/// Result of a run.
#[derive(Debug, Clone)]
pub struct MissionReport {
    /// Summary of the log.
    pub summary: Summary,
    /// Real time from the first tick to the last one (s).
    pub wall_time_s: f64,
    /// Real time from the call to the first tick (s).
    pub start_up_s: f64,
    /// `true` if the caller ended the run.
    pub interrupted: bool,
    /// `true` if a process failed and the run continued.
    pub has_failures: bool,
    /// Totals of the live viewers, if the run served any.
    pub live: Option<LiveTotals>,
}

/// Returns the name of a mode in logs.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::LockStep => "lock_step",
        Mode::RealTime => "real_time",
    }
}
