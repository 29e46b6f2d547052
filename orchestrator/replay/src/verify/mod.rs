//! Verification of one or several processes of a recorded run against the messages that they received.
//!
//! In each tick, this module publishes the logged messages of the processes that are not under test. The processes
//! under test step as in the run: after the messages of the world and of the processes that they wait for. Other
//! messages of a tick follow their step, because in the run they were not guaranteed to arrive before it.

mod capture;
mod processes;
mod test_bus;
mod test_selection;

use std::path::Path;
use std::rc::Rc;
use std::time::Duration;

use diff::Comparison;
use ipc_types::bus::Bus;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::source::Source;
use serde::Serialize;

use self::processes::or_interrupted;
use self::test_bus::TestBus;
use self::test_selection::TestSelection;
use super::create_resources;
use crate::ReplayError;
use crate::origin::{nothing_to_compare, scenario_of};
use crate::recorded::{ProcessExit, RecordedRun};
use log_tools::nanoseconds;
use mission::MissionError;
use mission::in_process::LocalProcesses;
use mission::plan::Plan;
use mission::stepped_processes::SteppedProcesses;
use recorder::RunInfo;
use scenario::kind::Kind;

/// Options of a verification.
#[derive(Debug, Clone, Default)]
pub struct VerifyOptions {
    /// Names of the processes under test.
    pub processes: Vec<String>,
    /// Changes to the scenario in the log, in the form of `--set`.
    pub changes: Vec<String>,
    /// End of the tested time, included (s).
    pub end_s: Option<f64>,
    /// `true` to run the processes inside this one.
    pub in_process: bool,
    /// `true` if external programs may be started.
    pub allow_external: bool,
    /// `true` to hide the output of the processes.
    pub quiet: bool,
}

/// Result of a verification.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct VerificationReport {
    /// Name of the scenario.
    pub scenario: String,
    /// The processes under test.
    pub processes: Vec<String>,
    /// Processes that were also started, because their answers are not logged.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub helpers: Vec<String>,
    /// Version that recorded the log, if it differs from this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// Changes to the scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// Number of ticks executed.
    pub ticks: u64,
    /// `true` if every message is identical.
    pub identical: bool,
    /// `true` if the log contains all requested ticks.
    pub whole: bool,
    /// First process under test that failed in the recorded run; only messages before it are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<ProcessExit>,
    /// Comparison of the messages of the log and of the test.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Real time from the first tick to the last (s).
    pub wall_time_s: f64,
    /// Faults of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

/// Runs processes of a recorded run with the messages that they received, and compares the messages that they send.
///
/// # Errors
/// [`ReplayError`] if the log is unreadable, the processes cannot be tested with it, or one fails.
pub fn verify(
    log: &Path,
    kinds: &[Kind],
    options: &VerifyOptions,
    watch: &mut ReadProgress,
) -> Result<VerificationReport, ReplayError> {
    let to = nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX);
    let is_tested = |name: &str| {
        options
            .processes
            .iter()
            .any(|test_selection| test_selection == name)
    };
    let recorded = RecordedRun::read(log, is_tested, watch)?;
    let scenario = scenario_of(
        &recorded.origin,
        log,
        &options.changes,
        "a process cannot receive the same again; `protean replay` without --test plays it",
        kinds,
    )?;
    let before = to.saturating_add(1).min(recorded.compared_before());
    let mut source = Source::open(log, &Topics::default(), before, false)?;
    let mut done = VerificationReport {
        scenario: scenario.name.clone(),
        processes: options.processes.clone(),
        changes: options.changes.clone(),
        recorded_by: recorded.other_version(),
        comparison: Comparison::with_fields(
            &RunInfo::from_log(&recorded.origin).unwrap_or_default(),
        ),
        ..VerificationReport::default()
    };
    if options.in_process {
        let plan = Plan::new(&scenario, "warn").map_err(MissionError::from)?;
        let test_selection = TestSelection::new(&plan, &recorded.origin, options)?;
        let bus = Bus::local(plan.run.bus_options());
        let mut test_bus = TestBus::open(&bus, &plan, &test_selection, &mut source, watch)?;
        let mut members =
            LocalProcesses::open(&test_selection.launches, &bus).map_err(MissionError::from)?;
        test_bus.run(&mut members, &mut source, watch, &mut done)?;
        done.helpers = test_selection.helpers;
    } else {
        let resources = Rc::new(create_resources(&scenario)?);
        let test_selection = TestSelection::new(&resources.plan, &recorded.origin, options)?;
        let mut test_bus = TestBus::open(
            &resources.bus,
            &resources.plan,
            &test_selection,
            &mut source,
            watch,
        )?;
        let hang_timeout = Duration::from_secs_f64(scenario.run.hang_timeout_s);
        let mut processes = SteppedProcesses::start(
            &resources,
            test_selection.launches.clone(),
            hang_timeout,
            !options.quiet,
            &watch.interrupted,
        )?;
        or_interrupted(processes.open())?;
        test_bus.run(&mut processes, &mut source, watch, &mut done)?;
        drop((processes, test_bus));
        done.helpers = test_selection.helpers;
    }
    if done.comparison.is_empty() {
        return Err(nothing_to_compare(log).into());
    }
    done.whole &= recorded.left.is_none() && recorded.condition.following_bytes == 0;
    done.left = recorded.left;
    done.faults = recorded.condition.lines();
    done.identical = done.comparison.first.is_none();
    Ok(done)
}
