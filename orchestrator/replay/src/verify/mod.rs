//! Processes of a recorded run, one or several, against what they heard then.
//!
//! Everybody who is not under test says in each tick what the log says; those under test take their
//! turns as in the run: when the world and those they wait for have spoken. What others say of a
//! tick comes after their turn, because in the run nobody could count on hearing it earlier.

mod capture;
mod processes;
mod test_bus;
mod test_selection;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use ipc_types::bus::Bus;
use mcap_log::ReadProgress;
use mcap_log::Topics;
use mcap_log::source::Source;
use serde::Serialize;

use self::processes::Processes;
use self::test_bus::TestBus;
use self::test_selection::TestSelection;
use super::create_resources;
use crate::ReplayError;
use crate::origin::scenario_of;
use crate::recorded::{ProcessExit, Recorded};
use log_tools::nanoseconds;
use log_tools::{Comparison, Difference};
use mission::MissionError;
use mission::in_process::LocalProcesses;
use mission::plan::Plan;
use mission::supervisor::Supervisor;
use scenario::kind::Kind;

/// What is under test, and how.
#[derive(Debug, Clone, Default)]
pub struct VerifyOptions {
    /// Names of the processes under test.
    pub processes: Vec<String>,
    /// Changes to the scenario in the log, as `--set` takes them.
    pub changes: Vec<String>,
    /// Up to and with this simulated time (s).
    pub end_s: Option<f64>,
    /// Whether in this process.
    pub in_process: bool,
    /// Whether programs that are not ours may be started.
    pub allow_external: bool,
    /// Whether what the processes say on stderr is kept back.
    pub quiet: bool,
}

/// How the processes compare with themselves in the log.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Verified {
    /// The scenario.
    pub scenario: String,
    /// The processes under test.
    pub processes: Vec<String>,
    /// Those that were started too, because what they answer is in no log.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub helpers: Vec<String>,
    /// The version that recorded the log, if it is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded_by: Option<String>,
    /// What was changed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<String>,
    /// Ticks that were done.
    pub ticks: u64,
    /// Whether every message is the same.
    pub identical: bool,
    /// Whether the log holds all that was asked for.
    pub whole: bool,
    /// The first of them that failed in the run of the log: only what was said before is compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<ProcessExit>,
    /// What they said, then and now.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Real time from the first tick to the last (s).
    pub wall_time_s: f64,
    /// What was wrong with the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
}

impl Verified {
    /// The earliest difference, and its topic.
    pub fn first(&self) -> Option<(&'static str, &Difference)> {
        self.comparison.first()
    }
}

/// Runs processes of the run in a log against what they heard, and compares what they say.
///
/// # Errors
/// [`ReplayError`]: the log cannot be read, the processes cannot be under test against it, or one fails.
pub fn verify(
    log: &Path,
    kinds: &[Kind],
    options: &VerifyOptions,
    watch: &mut ReadProgress,
) -> Result<Verified, ReplayError> {
    let to = nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX);
    let is_tested = |name: &str| {
        options
            .processes
            .iter()
            .any(|test_selection| test_selection == name)
    };
    let recorded = Recorded::read(log, is_tested, watch)?;
    let scenario = scenario_of(
        &recorded.origin,
        log,
        &options.changes,
        "a process cannot be given the same once more; `protean replay` without --test plays it",
        kinds,
    )?;
    let before = to.saturating_add(1).min(recorded.compared_before());
    let mut source = Source::open(log, &Topics::default(), before, false)?;
    let mut done = Verified {
        scenario: scenario.name.clone(),
        processes: options.processes.clone(),
        changes: options.changes.clone(),
        recorded_by: recorded.other_version(),
        ..Verified::default()
    };
    if options.in_process {
        let plan = Plan::new(&scenario, Path::new(""), "", "warn").map_err(MissionError::from)?;
        let test_selection = TestSelection::new(&plan, &recorded.origin, options)?;
        let bus = Bus::local(plan.run.bus_options(), None);
        let mut test_bus = TestBus::open(&bus, &plan, &test_selection, &mut source, watch)?;
        let mut members =
            LocalProcesses::open(&test_selection.launches, &bus).map_err(MissionError::from)?;
        test_bus.run(&mut members, &mut source, watch, &mut done)?;
        done.helpers = test_selection.helpers;
    } else {
        let resources = create_resources(&scenario)?;
        let test_selection = TestSelection::new(&resources.plan, &recorded.origin, options)?;
        let mut test_bus = TestBus::open(
            &resources.bus,
            &resources.plan,
            &test_selection,
            &mut source,
            watch,
        )?;
        let hang_timeout = Duration::from_secs_f64(scenario.run.hang_timeout_s);
        let supervisor = Supervisor::new(
            &resources,
            &test_selection.launches,
            hang_timeout,
            !options.quiet,
        )?;
        let interrupted = Arc::clone(&watch.interrupted);
        let mut processes = Processes::start(&resources, supervisor, &interrupted)?;
        test_bus.run(&mut processes, &mut source, watch, &mut done)?;
        drop((processes, test_bus));
        done.helpers = test_selection.helpers;
    }
    done.whole &= recorded.left.is_none();
    done.left = recorded.left;
    done.faults = source.faults();
    done.identical = done.first().is_none();
    Ok(done)
}
