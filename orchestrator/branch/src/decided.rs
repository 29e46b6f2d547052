//! The moment from which on an outcome was settled.
//!
//! At each moment the run continues several times with other random streams. An outcome is decided from the moment on from
//! which its share stays at or above a threshold. Bisection brackets that moment to [`WIDTH_S`]; at each point the number
//! of continuations doubles until Wilson's 95 % interval of the share excludes the threshold, at most [`MAX_FACTOR`] times the
//! given one.

use std::collections::{BTreeMap, BTreeSet};

use mcap_log::{LogReadError, ReadProgress};
use replay::lineage::Change;
use serde::Serialize;
use statistics::wilson;

use crate::continuations::{RobotShares, shares};
use crate::error::BranchError;
use crate::parent::Parent;
use crate::walks::{ContinuationOptions, Continuations, Outcomes};

/// Width of a bracket at which the bisection ends (s).
const WIDTH_S: f64 = 1.0;
/// Maximum number of continuations at a moment, as a multiple of the given one.
const MAX_FACTOR: u64 = 16;

/// Maximum number of moments with examples of their continuations.
const EXAMPLE_MOMENTS: usize = 40;

/// Options of the search for the moment of decision.
#[derive(Debug, Clone)]
pub struct DecidedOptions {
    /// Number of moments, evenly from the start, 2 or more.
    pub moments: u64,
    /// Number of continuations at each, > 0.
    pub times: u64,
    /// Share of an outcome from which on it is decided, above 0 and below 1.
    pub threshold: f64,
    /// The change, with the streams that vary.
    pub change: Change,
    /// Number of continuations at once, > 0.
    pub jobs: usize,
}

/// Outcomes of the continuations from a moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moment {
    /// Its simulated time (s).
    pub time_s: f64,
    /// Number of continuations.
    pub continuations: u64,
    /// Outcomes of every robot.
    pub robots: Vec<RobotShares>,
}

/// The moment at which the outcome of a robot was decided.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Decision {
    /// Name of the robot.
    pub robot: String,
    /// Its outcome in the recorded run.
    pub outcome: String,
    /// Time of the outcome (s).
    pub time_s: f64,
    /// Simulated times between which it was decided (s); absent if it was not decided before it happened.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub between_s: Option<[f64; 2]>,
    /// `true` if the intervals of the shares at both times exclude the threshold.
    pub certain: bool,
}

/// Outcomes against the time of branching.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DecidedReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: u64,
    /// The change, with the streams that varied.
    pub change: Change,
    /// Share of an outcome from which on it is decided.
    pub threshold: f64,
    /// Number of continuations in all.
    pub continuations: u64,
    /// The moments, by time.
    pub moments: Vec<Moment>,
    /// Decisions about the robots with an outcome.
    pub decisions: Vec<Decision>,
}

impl DecidedReport {
    /// Returns examples of continuations, as their moments (s) and streams: of every moment before a decision the first with
    /// the two most frequent outcomes of its robot. Of more than 40 moments, 40 have some.
    pub fn examples(&self) -> Vec<(f64, u64)> {
        let shown = self.moments.len().min(EXAMPLE_MOMENTS);
        let nth = |n: usize| self.moments.get(n * self.moments.len() / shown);
        let of_moment = |moment: &Moment| {
            let before = self.decisions.iter();
            let before = before.filter(|decision| moment.time_s <= decision.time_s);
            let robots: BTreeSet<&str> = before.map(|decision| &*decision.robot).collect();
            let robots = moment
                .robots
                .iter()
                .filter(|robot| robots.contains(&*robot.robot));
            let streams: BTreeSet<u64> = robots.flat_map(RobotShares::examples).collect();
            let time_s = moment.time_s;
            streams.into_iter().map(move |stream| (time_s, stream))
        };
        (0..shown).filter_map(nth).flat_map(of_moment).collect()
    }
}

struct Search<'a> {
    options: &'a DecidedOptions,
    continuations: Continuations<'a>,
    samples: BTreeMap<u64, Outcomes>,
}

impl Search<'_> {
    /// Samples these ticks until each has a number of continuations.
    fn sample(&mut self, ticks: impl Iterator<Item = u64>, times: u64) -> Result<(), BranchError> {
        let missing = ticks.flat_map(|tick| {
            let known = self.samples.get(&tick).map_or(0, Vec::len) as u64;
            (known + 1..=times).map(move |seed| (tick, seed))
        });
        let tasks: Vec<(u64, u64)> = missing.collect();
        let found = self.continuations.outcomes(&tasks)?;
        for ((tick, _), outcomes) in tasks.into_iter().zip(found) {
            self.samples.entry(tick).or_default().push(outcomes);
        }
        Ok(())
    }

    /// Returns the share of an outcome of a robot at a sampled tick, and whether its interval excludes the threshold.
    fn share(&self, tick: u64, robot: usize, outcome: &str) -> (f64, bool) {
        let samples = self.samples.get(&tick).map_or(&[][..], Vec::as_slice);
        let of_robot = samples.iter().filter_map(|robots| robots.get(robot));
        let hits = of_robot.filter(|found| *found == outcome).count() as u64;
        let all = samples.len() as u64;
        let is_certain = !wilson(hits, all).contains(self.options.threshold);
        (hits as f64 / all.max(1) as f64, is_certain)
    }

    /// Returns `true` if an outcome has the threshold's share at a tick, and whether that is certain.
    fn is_decided(
        &mut self,
        tick: u64,
        robot: usize,
        outcome: &str,
    ) -> Result<(bool, bool), BranchError> {
        let mut times = self.options.times;
        loop {
            self.sample([tick].into_iter(), times)?;
            let (share, is_certain) = self.share(tick, robot, outcome);
            times *= 2;
            if is_certain || times > MAX_FACTOR * self.options.times {
                return Ok((share >= self.options.threshold, is_certain));
            }
        }
    }

    /// Finds the ticks between which an outcome was decided that happened at tick `end`; `None`: not before.
    fn bracket(
        &mut self,
        robot: usize,
        outcome: &str,
        end: u64,
    ) -> Result<(Option<[u64; 2]>, bool), BranchError> {
        let width = (WIDTH_S / self.continuations.parent.scenario.run.dt)
            .round()
            .max(1.0) as u64;
        let known: Vec<u64> = self
            .samples
            .keys()
            .copied()
            .filter(|tick| *tick < end)
            .collect();
        let (mut low, mut high) = (None, end);
        // The threshold's share at the end: the outcome itself.
        let mut are_certain = [true, true];
        for tick in known.into_iter().rev() {
            let (is_decided, is_certain) = self.is_decided(tick, robot, outcome)?;
            if !is_decided {
                (low, are_certain[0]) = (Some(tick), is_certain);
                break;
            }
            (high, are_certain[1]) = (tick, is_certain);
        }
        let Some(mut low) = low else {
            return Ok((Some([high, high]), are_certain[1]));
        };
        while high - low > width {
            let middle = low + (high - low) / 2;
            let (is_decided, is_certain) = self.is_decided(middle, robot, outcome)?;
            if is_decided {
                (high, are_certain[1]) = (middle, is_certain);
            } else {
                (low, are_certain[0]) = (middle, is_certain);
            }
        }
        let is_before = high < end;
        Ok((
            is_before.then_some([low, high]),
            are_certain == [true, true],
        ))
    }
}

/// Continues a run from many moments, and finds for each robot with an outcome when that was decided. Continuations run in
/// copies of this process, which must have a single thread.
///
/// # Errors
/// [`BranchError`]: an option is out of its range, the change is refused, or a run fails or is interrupted.
pub fn decided(
    parent: &Parent,
    options: &DecidedOptions,
    watch: &ReadProgress,
) -> Result<DecidedReport, BranchError> {
    let first = parent.first();
    let span = parent.last.saturating_sub(first).max(1);
    for (option, value, most) in [
        ("--moments", options.moments, span),
        ("--times", options.times, 100_000),
    ] {
        if !(1..=most).contains(&value) {
            let text = format!("{option} is {value}: expected a number from 1 to {most}");
            return Err(LogReadError::Argument(text).into());
        }
    }
    if !(options.threshold > 0.0 && options.threshold < 1.0) {
        let text = format!(
            "--share is {}: expected a share above 0 and below 1",
            options.threshold
        );
        return Err(LogReadError::Argument(text).into());
    }
    let run = ContinuationOptions {
        jobs: options.jobs,
        ..ContinuationOptions::default()
    };
    let mut search = Search {
        options,
        continuations: Continuations::verified(parent, &options.change, run, watch)?,
        samples: BTreeMap::new(),
    };
    let moments: BTreeSet<u64> = (0..options.moments)
        .map(|n| first + n * span / options.moments)
        .collect();
    search.sample(moments.into_iter(), options.times)?;
    let dt = parent.scenario.run.dt;
    let mut decisions = Vec::new();
    for (index, robot) in parent.info.robots.iter().enumerate() {
        if robot.outcome == "active" {
            continue;
        }
        let end = ((robot.time_s / dt).round() as u64).min(parent.last);
        let (between, certain) = search.bracket(index, &robot.outcome, end)?;
        decisions.push(Decision {
            robot: robot.name.clone(),
            outcome: robot.outcome.clone(),
            time_s: robot.time_s,
            between_s: between.map(|ticks| ticks.map(|tick| tick as f64 * dt)),
            certain,
        });
    }
    let moment = |(tick, outcomes): (u64, Outcomes)| Moment {
        time_s: tick as f64 * dt,
        continuations: outcomes.len() as u64,
        robots: shares(parent, &outcomes),
    };
    let moments: Vec<Moment> = search.samples.into_iter().map(moment).collect();
    Ok(DecidedReport {
        scenario: parent.scenario.name.clone(),
        seed: parent.scenario.run.seed,
        change: options.change.clone(),
        threshold: options.threshold,
        continuations: moments.iter().map(|m| m.continuations).sum(),
        moments,
        decisions,
    })
}
