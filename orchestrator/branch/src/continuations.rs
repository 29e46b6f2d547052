//! Many continuations of a run from a moment, and their outcomes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use mcap_log::ReadProgress;
use mission::in_process::Cache;
use replay::lineage::Change;
use serde::Serialize;
use statistics::{Interval, wilson};
use sweep::pool::Pool;

use crate::error::BranchError;
use crate::parent::{Parent, shared};

/// Options of continuations.
#[derive(Debug, Clone, Default)]
pub struct ContinuationOptions {
    /// Number of threads, > 0.
    pub jobs: usize,
    /// Folder for the logs, `SEED.mcap`; `None` writes none.
    pub logs: Option<PathBuf>,
    /// `true` if existing logs may be overwritten.
    pub force: bool,
}

/// Share of an outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutcomeShare {
    /// `active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.
    pub outcome: String,
    /// Number of continuations with it.
    pub count: u64,
    /// Share of the continuations.
    pub share: f64,
    /// Wilson's 95 % interval of its probability.
    pub interval: Interval,
}

/// Outcomes of a robot in continuations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotShares {
    /// Name of the robot.
    pub robot: String,
    /// Outcome in the recorded run.
    pub recorded: String,
    /// Outcomes in the continuations, by name.
    pub outcomes: Vec<OutcomeShare>,
}

/// Outcomes of all robots in each continuation, by index.
pub(crate) type Outcomes = Vec<Vec<String>>;

/// Runs continuations with random streams 1 to `times` from a tick on, in several threads; returns the outcomes of every
/// robot.
///
/// # Errors
/// [`BranchError`]: the change is refused, or a run fails or is interrupted.
pub fn continuations(
    parent: &Parent,
    tick: u64,
    change: &Change,
    times: u64,
    options: &ContinuationOptions,
    watch: &ReadProgress,
) -> Result<Vec<RobotShares>, BranchError> {
    let tasks: Vec<(u64, u64)> = (1..=times).map(|seed| (tick, seed)).collect();
    let outcomes = run_all(parent, &tasks, change, options, &Arc::default(), watch)?;
    Ok(shares(parent, &outcomes))
}

/// Runs the continuations of these ticks and numbers of random streams; returns their outcomes in the same order.
pub(crate) fn run_all(
    parent: &Parent,
    tasks: &[(u64, u64)],
    change: &Change,
    options: &ContinuationOptions,
    cache: &Arc<Cache>,
    watch: &ReadProgress,
) -> Result<Outcomes, BranchError> {
    let pool = Pool {
        jobs: options.jobs,
        timeout: Duration::MAX,
        interrupted: &watch.interrupted,
    };
    let has_failed = AtomicBool::new(false);
    let run = |mission: usize, end: &Arc<AtomicBool>| {
        let (tick, seed) = *tasks.get(mission)?;
        if has_failed.load(Ordering::Relaxed) {
            return None;
        }
        let change = Change {
            seed,
            ..change.clone()
        };
        let out = options.logs.as_ref();
        let out = out.map(|folder| folder.join(format!("{seed}.mcap")));
        let mut run = shared(cache, end);
        run.force = options.force;
        let report = parent.run(tick, &change, out.as_deref(), run);
        has_failed.fetch_or(report.is_err(), Ordering::Relaxed);
        Some(report.map(|report| {
            let robots = report.summary.robots.into_iter();
            robots.map(|robot| robot.outcome).collect()
        }))
    };
    let mut done = BTreeMap::new();
    pool.run(
        tasks.len(),
        |_| (),
        |turn| (turn.mission, run(turn.mission, &turn.end)),
        |(mission, outcome)| {
            done.extend(outcome.map(|outcome| (mission, outcome)));
            Ok(())
        },
    )?;
    let outcomes: Outcomes = done.into_values().collect::<Result<_, _>>()?;
    if outcomes.len() < tasks.len() {
        return Err(mcap_log::LogReadError::Interrupted.into());
    }
    Ok(outcomes)
}

/// Returns the shares of the outcomes of every robot.
pub(crate) fn shares(parent: &Parent, outcomes: &[Vec<String>]) -> Vec<RobotShares> {
    let robots = parent.info.robots.iter().enumerate();
    let of_robot = |(index, robot): (usize, &recorder::RobotOutcome)| {
        let mut counts: BTreeMap<&String, u64> = BTreeMap::new();
        for outcome in outcomes.iter().filter_map(|robots| robots.get(index)) {
            *counts.entry(outcome).or_default() += 1;
        }
        let all = outcomes.len() as u64;
        let share = |(outcome, count): (&String, u64)| OutcomeShare {
            outcome: outcome.clone(),
            count,
            share: count as f64 / all.max(1) as f64,
            interval: wilson(count, all),
        };
        RobotShares {
            robot: robot.name.clone(),
            recorded: robot.outcome.clone(),
            outcomes: counts.into_iter().map(share).collect(),
        }
    };
    robots.map(of_robot).collect()
}
