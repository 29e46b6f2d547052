//! The report of a run that has ended.

use viewer::LiveTotals;

use recorder::Summary;
use scenario::spec::Mode;

/// How a run went.
#[derive(Debug, Clone)]
pub struct MissionReport {
    /// What the log holds.
    pub summary: Summary,
    /// Real time from the first tick to the last (s).
    pub wall_time_s: f64,
    /// Real time from the call to the first tick (s).
    pub start_up_s: f64,
    /// Whether it was ended from outside.
    pub interrupted: bool,
    /// Whether a process failed and the run went on.
    pub has_lost: bool,
    /// What live viewers got, if they were served.
    pub live: Option<LiveTotals>,
}

/// Name of a mode in logs.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::LockStep => "lock_step",
        Mode::RealTime => "real_time",
    }
}
