//! Repetition of the run in a log.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use diff::{Comparison, diff_before};
use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use serde::Serialize;

use super::origin::{nothing_to_compare, refuse_external};
use super::recorded::{ProcessExit, RecordedRun};
use crate::ReplayError;
use crate::lineage::{BranchPoint, branch_points, branches};
use crate::origin::scenario_of;
use mission::in_process::{self, Branch, InProcessOptions};
use mission::{self, MissionError, MissionOptions, MissionReport};
use platform::scratch::Scratch;
use scenario::ResolvedScenario;
use scenario::kind::Kind;

/// Options of a repetition.
#[derive(Debug, Clone, Copy, Default)]
pub struct RerunOptions {
    /// `true` to run all processes in this process, as a branch always does.
    pub in_process: bool,
    /// `true` if external programs may be started.
    pub allow_external: bool,
    /// `true` to repeat the failures of processes, with all processes in this process, and to compare what follows.
    pub failures: bool,
}

/// Result of repeating a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rerun {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: u64,
    /// Version that recorded the log, if it differs from this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// Digest of the run in the log; absent if the run did not reach its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest_logged: Option<String>,
    /// Digest of the new run; it means nothing without that of the log.
    pub digest: String,
    /// First process that failed in the recorded run; the comparison ends before the last tick that it has done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<ProcessExit>,
    /// `true` if the log contains the whole run, without a failure, and the file nothing else.
    pub whole: bool,
    /// `true` if the two runs are identical, up to the end of the log.
    pub same: bool,
    /// Last tick of the new run.
    pub ticks: u64,
    /// Real time of the new run (s).
    pub wall_time_s: f64,
    /// Comparison of the messages in the log with those of the new run.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Faults of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

/// Repeats the run in a log from its scenario with these kinds of processes, and compares the messages.
///
/// # Errors
/// [`ReplayError`] if the log is unreadable or its run cannot be repeated.
pub fn rerun(
    log: &Path,
    kinds: &[Kind],
    options: RerunOptions,
    watch: &mut ReadProgress,
) -> Result<Rerun, ReplayError> {
    let mut recorded = RecordedRun::read(log, |_| true, watch)?;
    let scenario = scenario_of(
        &recorded.origin,
        log,
        &[],
        "it cannot be repeated identically; runs in lock-step can",
        kinds,
    )?;
    refuse_external(log, &scenario, options.allow_external)?;
    let points = branch_points(&recorded.origin, log)?;
    let branches = branches(&points, &scenario, kinds)?;
    let mut failures = failures_of(&points);
    if options.failures {
        failures.append(&mut recorded.failures);
        recorded.left = None;
    }
    let folder = Scratch::create().map_err(|source| MissionError::System {
        what: "a temporary directory: cannot be created".into(),
        source,
    })?;
    let again = folder.path().join("again.mcap");
    let report = run_again(
        scenario.clone(),
        &again,
        Some(recorded.last_needed()),
        options.in_process,
        (branches, failures),
        watch,
    )?;
    if report.interrupted {
        return Err(LogReadError::Interrupted.into());
    }
    let digest = report.summary.digest;
    let difference = diff_before(log, &again, recorded.compared_before(), watch)?;
    let comparison = difference.comparison;
    let has_end = recorded.over && recorded.condition.data && recorded.left.is_none();
    let digest_logged = difference.a.digest.filter(|_| has_end);
    if digest_logged.is_none() && comparison.is_empty() {
        return Err(nothing_to_compare(log).into());
    }
    let digests_agree = digest_logged
        .as_ref()
        .is_none_or(|logged| *logged == digest);
    Ok(Rerun {
        scenario: scenario.name,
        seed: scenario.run.seed,
        recorded_by: recorded.other_version(),
        whole: digest_logged.is_some() && recorded.condition.following_bytes == 0,
        same: digests_agree && difference.same,
        digest_logged,
        digest,
        left: recorded.left,
        ticks: report.summary.ticks,
        wall_time_s: report.wall_time_s,
        comparison,
        faults: recorded.condition.lines(),
    })
}

/// Returns the processes that fail in the run of a log, by name, with the first tick without each; `points` are its branches.
///
/// # Errors
/// [`LogReadError`] if the log is unreadable.
pub fn failures(
    log: &Path,
    points: &[BranchPoint],
    watch: &mut ReadProgress,
) -> Result<BTreeMap<String, u64>, LogReadError> {
    let mut failures = failures_of(points);
    failures.append(&mut RecordedRun::read(log, |_| true, watch)?.failures);
    Ok(failures)
}

fn failures_of(points: &[BranchPoint]) -> BTreeMap<String, u64> {
    let failures = points.last().map(|point| point.failures.clone());
    failures.unwrap_or_default()
}

/// Runs a scenario for a comparison, up to this tick: its log at `out` has the history alone. With changes or failures of
/// processes, all of these run in this process.
///
/// # Errors
/// As [`mission::run`](fn@mission::run) and [`in_process::run`].
pub fn run_again(
    mut scenario: ResolvedScenario,
    out: &Path,
    last_tick: Option<u64>,
    in_process: bool,
    (branches, failures): (Vec<Branch>, BTreeMap<String, u64>),
    watch: &ReadProgress,
) -> Result<MissionReport, MissionError> {
    scenario.log.viewer_rate_hz = 0.0;
    let (out, interrupted) = (Some(out.to_owned()), Arc::clone(&watch.interrupted));
    if in_process || !branches.is_empty() || !failures.is_empty() {
        let options = InProcessOptions {
            out,
            last_tick,
            show: !watch.quiet,
            interrupted,
            external: true,
            branches,
            failures,
            ..InProcessOptions::default()
        };
        in_process::run(&scenario, &options)
    } else {
        let options = MissionOptions {
            out,
            last_tick,
            quiet: watch.quiet,
            interrupted,
            ..MissionOptions::default()
        };
        mission::run(&scenario, &options)
    }
}
