//! Processes of a recorded run, one or several, against what they heard then.
//!
//! Everybody who is not under test says in each tick what the log says; those under test take their
//! turns as in the run: when the world and those they wait for have spoken. What others say of a
//! tick comes after their turn, because in the run nobody could count on hearing it earlier.

mod tested;
mod trial;
mod verdict;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use ipc_types::bus::Bus;

use self::tested::Tested;
use self::trial::Trial;
pub use self::verdict::{TopicVerdict, Verified};
use super::super::error::LogsError;
use super::super::failures::first_failure;
use super::super::filter::nanoseconds;
use super::super::pattern::Topics;
use super::super::watch::Watch;
use super::cast::{Processes, within};
use super::source::Source;
use super::stage::Stage;
use crate::mission::MissionError;
use crate::mission::plan::Plan;

/// What is tested, and how.
#[derive(Debug, Clone, Default)]
pub struct VerifyOptions {
    /// Names of the processes under test.
    pub processes: Vec<String>,
    /// Changes to the scenario in the log, as `--set` takes them.
    pub changes: Vec<String>,
    /// Up to and with this simulated time [s].
    pub end_s: Option<f64>,
    /// Whether in this process.
    pub in_process: bool,
    /// Whether programs that are not ours may be started.
    pub allow_external: bool,
    /// Whether what the processes say on stderr is kept back.
    pub quiet: bool,
}

/// Runs processes of the run in a log against what they heard, and compares what they say.
///
/// # Errors
/// [`LogsError`]: the log cannot be read, the processes cannot be tested against it, or one fails.
pub fn verify(
    log: &Path,
    options: &VerifyOptions,
    watch: &mut Watch,
) -> Result<Verified, LogsError> {
    let mut to = nanoseconds("--end", options.end_s)?.unwrap_or(u64::MAX);
    let so =
        "a process cannot be given the same once more; `protean replay` without --test plays it";
    let tested = |name: &str| options.processes.iter().any(|tested| tested == name);
    let left = first_failure(log, tested, watch)?;
    if let Some(left) = &left {
        let source = Source::open(log, &Topics::default(), 0, false)?;
        let period = source.origin().manifest.get("tick_period_ns");
        let period_ns: Option<u64> = period.and_then(|text| text.parse().ok());
        let before = left.tick.saturating_mul(period_ns.unwrap_or(1));
        to = to.min(before.saturating_sub(1));
    }
    let mut source = Source::open(log, &Topics::default(), to, false)?;
    let scenario = source.origin().scenario(log, &options.changes, so)?;
    let manifest = &source.origin().manifest;
    let mut done = Verified {
        scenario: scenario.name.clone(),
        processes: options.processes.clone(),
        changes: options.changes.clone(),
        recorded_by: manifest
            .get("version")
            .filter(|version| *version != env!("CARGO_PKG_VERSION"))
            .cloned(),
        ..Verified::default()
    };
    if options.in_process {
        let plan = Plan::new(&scenario, Path::new(""), "", "warn").map_err(MissionError::from)?;
        let tested = Tested::new(&plan, &source, options)?;
        let bus = Bus::local(plan.run.bus_options(), None);
        let mut trial = Trial::open(&bus, &plan, &tested, &mut source, watch)?;
        let mut cast = within(&tested.launches, &bus)?;
        trial.run(&mut cast, &mut source, watch, &mut done)?;
        done.helpers = tested.helpers;
    } else {
        let stage = Stage::build(&scenario)?;
        let tested = Tested::new(&stage.plan, &source, options)?;
        let mut trial = Trial::open(&stage.bus, &stage.plan, &tested, &mut source, watch)?;
        let mut cast = Processes::start(
            &stage,
            &tested.launches,
            Duration::from_secs_f64(scenario.run.hang_timeout_s),
            Arc::clone(&watch.interrupted),
            !options.quiet,
        )?;
        if !cast.ready()? {
            return Err(LogsError::Interrupted);
        }
        trial.run(&mut cast, &mut source, watch, &mut done)?;
        done.helpers = tested.helpers;
    }
    done.whole &= left.is_none();
    done.left = left;
    done.faults = source.faults();
    done.identical = done.topics.values().all(|topic| topic.first.is_none());
    Ok(done)
}
