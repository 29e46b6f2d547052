//! Repetition of the run in a log.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use mcap_log::LogReadError;
use mcap_log::ReadProgress;
use mcap_log::output::RUN_DIGEST;
use serde::{Serialize, Serializer};

use super::origin::{nothing_to_compare, refuse_external};
use super::recorded::{ProcessExit, Recorded};
use crate::ReplayError;
use crate::origin::scenario_of;
use log_tools::{Comparison, Difference, compare};
use mission::in_process::{self, InProcessOptions};
use mission::{self, MissionError, MissionOptions, MissionReport};
use platform::scratch::Scratch;
use scenario::ResolvedScenario;
use scenario::kind::Kind;

/// Options of a repetition.
#[derive(Debug, Clone, Copy, Default)]
pub struct RerunOptions {
    /// `true` to run all processes in this process.
    pub in_process: bool,
    /// `true` if external programs may be started.
    pub allow_external: bool,
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
    /// Comparison of the messages; absent for a log that is a part of another one.
    #[serde(
        skip_serializing_if = "Option::is_none",
        serialize_with = "differences_only"
    )]
    pub comparison: Option<Comparison>,
    /// Faults of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

/// Writes the number of equal messages and the first difference of each topic.
#[expect(clippy::ref_option, reason = "required by serde")]
fn differences_only<S: Serializer>(
    comparison: &Option<Comparison>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Summary<'a> {
        equal: u64,
        differences: BTreeMap<&'static str, &'a Difference>,
        last_tick: u64,
    }
    let summary = comparison.as_ref().map(|comparison| Summary {
        equal: comparison.equal(),
        differences: comparison.differences().collect(),
        last_tick: comparison.last_tick,
    });
    summary.serialize(serializer)
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
    let recorded = Recorded::read(log, |_| true, watch)?;
    let mut scenario = scenario_of(
        &recorded.origin,
        log,
        &[],
        "it cannot be repeated identically; runs in lock-step can",
        kinds,
    )?;
    refuse_external(log, &scenario, options.allow_external)?;
    // The repetition has no viewers.
    scenario.log.viewer_rate_hz = 0.0;
    let folder = Scratch::create().map_err(|source| MissionError::System {
        what: "cannot create a temporary directory".into(),
        source,
    })?;
    let again = folder.path().join("again.mcap");
    let report = run_again(
        &scenario,
        &again,
        recorded.last_needed(),
        options.in_process,
        watch,
    )?;
    if report.interrupted {
        return Err(LogReadError::Interrupted.into());
    }
    let digest = report.summary.digest;
    let has_failures = recorded.left.is_some();
    let has_end = recorded.over && recorded.result.contains_key("digest");
    let ended = has_end && recorded.condition.data && !has_failures;
    let (digest_logged, comparison) = if recorded.filtered {
        let digest = recorded.result.get(RUN_DIGEST);
        (digest.filter(|_| !has_failures), None)
    } else {
        let before = recorded.compared_before();
        let comparison = compare(log, &again, before, !ended, watch)?;
        let digest = recorded.result.get("digest");
        (digest.filter(|_| ended), Some(comparison))
    };
    let digests_agree = digest_logged.is_none_or(|logged| *logged == digest);
    if digest_logged.is_none() && comparison.as_ref().is_none_or(Comparison::is_empty) {
        return Err(nothing_to_compare(log).into());
    }
    let whole = ended || recorded.filtered && digest_logged.is_some();
    let same = digests_agree && comparison.as_ref().is_none_or(|c| c.first().is_none());
    Ok(Rerun {
        scenario: scenario.name,
        seed: scenario.run.seed,
        recorded_by: recorded.other_version(),
        whole: whole && recorded.condition.following_bytes == 0,
        digest_logged: digest_logged.cloned(),
        digest,
        left: recorded.left,
        same,
        ticks: report.summary.ticks,
        wall_time_s: report.wall_time_s,
        comparison,
        faults: recorded.condition.lines(),
    })
}

/// Runs a scenario with its log at `out`, up to this tick.
fn run_again(
    scenario: &ResolvedScenario,
    out: &Path,
    last_tick: u64,
    in_process: bool,
    watch: &ReadProgress,
) -> Result<MissionReport, MissionError> {
    let (out, interrupted) = (Some(out.to_owned()), Arc::clone(&watch.interrupted));
    if in_process {
        let options = InProcessOptions {
            out,
            last_tick: Some(last_tick),
            show: !watch.quiet,
            interrupted,
            libraries: true,
            ..InProcessOptions::default()
        };
        in_process::run(scenario, &options)
    } else {
        let options = MissionOptions {
            out,
            last_tick: Some(last_tick),
            quiet: watch.quiet,
            interrupted,
            ..MissionOptions::default()
        };
        mission::run(scenario, &options)
    }
}
