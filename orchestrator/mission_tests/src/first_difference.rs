//! Logs of missions, and the first difference of a changed mission from the accepted one.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use diff::diff;
use mcap_log::ReadProgress;
use recorder::time_text;

use crate::test_file::MissionTest;

/// Paths of the logs of a mission.
pub struct Logs {
    /// Log of the mission when it last passed.
    pub accepted: PathBuf,
    /// Log when it last failed.
    pub failed: PathBuf,
    /// Log while it runs.
    pub new: PathBuf,
}

impl Logs {
    pub fn new(folder: &Path, test: &MissionTest, seed: u64) -> Self {
        let is_special = |c: char| !c.is_alphanumeric() && !"_-+".contains(c);
        let name = test.name.replace(is_special, "-");
        let path = |end: &str| folder.join(format!("{}-{seed}{end}.mcap", name.trim_matches('-')));
        Self {
            accepted: path(""),
            failed: path("-failed"),
            new: path("-new"),
        }
    }

    /// Keeps the new log, or removes it; returns its path if it is kept.
    pub fn settle(&self, failed: bool, keep: bool) -> Option<PathBuf> {
        let kept = if failed { &self.failed } else { &self.accepted };
        if keep {
            return fs::rename(&self.new, kept).ok().map(|()| kept.clone());
        }
        // There may be no log.
        let _ = fs::remove_file(&self.new);
        None
    }
}

/// Describes the first difference of the new log from the accepted one; `None` if that is not the log of the digest, or
/// none is found.
pub fn describe(logs: &Logs, digest: &str, interrupted: &Arc<AtomicBool>) -> Option<String> {
    let mut watch = ReadProgress::new(Arc::clone(interrupted), true);
    let report = diff(&logs.accepted, &logs.new, &mut watch).ok()?;
    if report.a.digest.as_deref() != Some(digest) {
        return None;
    }
    let first = report.comparison.first?;
    let change = first.causes.first().or(first.effects.first())?;
    let (tick, time) = (change.tick, time_text(first.time_s));
    Some(format!("tick {tick} ({time} s): {change}"))
}
