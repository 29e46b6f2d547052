//! Many continuations of a run from a moment, and their outcomes.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use mcap_log::ReadProgress;
use replay::lineage::Change;
use serde::Serialize;
use statistics::{Interval, wilson};

use crate::error::BranchError;
use crate::parent::Parent;
use crate::walks::{ContinuationOptions, Continuations};

/// Share of an outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutcomeShare {
    /// `active`, `caught`, `escaped`, `timed_out`, `goal_reached` or `disabled`.
    pub outcome: String,
    /// Number of continuations with it.
    pub count: u64,
    /// Number of the random streams of the first of them.
    pub stream: u64,
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

impl RobotShares {
    /// Returns the streams of the first continuations with the two most frequent outcomes, or with the only one.
    pub(crate) fn examples(&self) -> impl Iterator<Item = u64> {
        let mut outcomes: Vec<&OutcomeShare> = self.outcomes.iter().collect();
        outcomes.sort_by_key(|outcome| Reverse(outcome.count));
        outcomes.into_iter().take(2).map(|outcome| outcome.stream)
    }
}

/// Runs continuations with random streams 1 to `times` from a tick on, in copies of this process, which must have a single
/// thread; returns the outcomes of every robot.
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
    let all = Continuations::verified(parent, change, options.clone(), watch)?;
    let tasks: Vec<(u64, u64)> = (1..=times).map(|seed| (tick, seed)).collect();
    Ok(shares(parent, &all.outcomes(&tasks)?))
}

/// Returns the shares of the outcomes of every robot in the continuations with random streams 1, 2, ….
pub(crate) fn shares(parent: &Parent, outcomes: &[Vec<String>]) -> Vec<RobotShares> {
    let robots = parent.info.robots.iter().enumerate();
    let of_robot = |(index, robot): (usize, &recorder::RobotOutcome)| {
        let mut counts: BTreeMap<&String, (u64, u64)> = BTreeMap::new();
        let of_robot = outcomes.iter().map(|robots| robots.get(index));
        for (outcome, stream) in of_robot.zip(1..) {
            let Some(outcome) = outcome else { continue };
            counts.entry(outcome).or_insert((0, stream)).0 += 1;
        }
        let all = outcomes.len() as u64;
        let share = |(outcome, (count, stream)): (&String, (u64, u64))| OutcomeShare {
            outcome: outcome.clone(),
            count,
            stream,
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
