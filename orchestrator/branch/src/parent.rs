//! The run of which branches are made.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use diff::{Comparison, diff_before};
use log_tools::LogInfo;
use mcap_log::{LogReadError, Origin, ReadProgress};
use mission::in_process::{self, Cache, InProcessOptions};
use mission::{MissionError, MissionReport};
use platform::presence;
use recorder::RobotOutcome;
use replay::lineage::{BranchPoint, Change, branch_points, branches};
use replay::origin::{refuse_external, scenario_of};
use replay::{RerunOptions, rerun};
use scenario::ResolvedScenario;
use scenario::kind::Kind;
use serde::Serialize;

use crate::error::BranchError;

/// The run in a log.
#[derive(Debug)]
pub struct Parent {
    log: PathBuf,
    kinds: Vec<Kind>,
    pub(crate) scenario: ResolvedScenario,
    points: Vec<BranchPoint>,
    failures: BTreeMap<String, u64>,
    pub(crate) info: LogInfo,
    /// Last tick of the log.
    pub(crate) last: u64,
}

/// A recorded branch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BranchReport {
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of the run.
    pub seed: u64,
    /// Log of the branch; removed if it differs from its parent before the moment.
    pub log: PathBuf,
    /// Its beginning and its change.
    #[serde(flatten)]
    pub point: BranchPoint,
    /// `true` if its history before the moment is that of the parent.
    pub same: bool,
    /// Number of messages of that history.
    pub messages: u64,
    /// The first difference before the moment.
    #[serde(skip)]
    pub comparison: Comparison,
    /// Digest of the branch.
    pub branch_digest: String,
    /// Last tick of the branch.
    pub ticks: u64,
    /// Outcomes of the robots.
    pub robots: Vec<RobotOutcome>,
    /// Real time of the new run (s).
    pub wall_time_s: f64,
}

impl Parent {
    /// Reads the log of a run in lock-step. `kinds` are the kinds of this program.
    ///
    /// # Errors
    /// [`BranchError`]: the log cannot be read, or its run cannot be executed again.
    pub fn read(
        log: &Path,
        kinds: &[Kind],
        allow_external: bool,
        watch: &mut ReadProgress,
    ) -> Result<Self, BranchError> {
        let origin = Origin::read(log)?;
        let so = "it cannot be repeated identically; runs in lock-step can";
        let scenario = scenario_of(&origin, log, &[], so, kinds)?;
        refuse_external(log, &scenario, allow_external)?;
        let points = branch_points(&origin, log)?;
        let failures = replay::failures(log, &points, watch)?;
        let info = LogInfo::read(log, watch)?;
        let last = (info.end_s / scenario.run.dt).round() as u64;
        Ok(Self {
            log: log.to_owned(),
            kinds: kinds.to_vec(),
            scenario,
            points,
            failures,
            info,
            last,
        })
    }

    /// Returns the first tick at which it can be branched: that of the last branch that it is.
    pub(crate) fn first(&self) -> u64 {
        self.points.last().map_or(0, |point| point.tick)
    }

    /// Returns the tick of a moment (s).
    ///
    /// # Errors
    /// [`BranchError`]: it is not a tick of the run, or precedes a branch that the run itself is.
    pub fn tick(&self, at_s: f64) -> Result<u64, BranchError> {
        let dt = self.scenario.run.dt;
        let (first, tick) = (self.first(), (at_s / dt).round());
        let is_tick = (at_s / dt - tick).abs() < 1e-6 && tick >= first as f64;
        if is_tick && (tick as u64) < self.last {
            return Ok(tick as u64);
        }
        Err(LogReadError::Argument(format!(
            "--at is {at_s}: expected a multiple of {dt} s from {} to before the end at {} s",
            recorder::time_text(first as f64 * dt),
            recorder::time_text(self.info.end_s)
        ))
        .into())
    }

    /// Executes the run in this program to its end, with the processes that a change concerns beside it, and compares it
    /// with the log. Afterwards `cache` has all that runs share.
    ///
    /// # Errors
    /// [`BranchError::Different`]; the change is refused; others as those of [`rerun`].
    pub(crate) fn verify(
        &self,
        change: &Change,
        cache: &Arc<Cache>,
        watch: &ReadProgress,
    ) -> Result<(), BranchError> {
        let options = InProcessOptions {
            cache: Arc::clone(cache),
            interrupted: Arc::clone(&watch.interrupted),
            ..InProcessOptions::default()
        };
        let report = self.run(u64::MAX, change, None, options, &mut |_| Ok(false))?;
        if self.info.digest == Some(report.summary.digest) {
            return Ok(());
        }
        // The log is not whole, or the first difference is to be named.
        let options = RerunOptions {
            in_process: true,
            allow_external: true,
            failures: true,
        };
        // Without the events of the run, which it repeats.
        let mut quiet = ReadProgress::new(Arc::clone(&watch.interrupted), true);
        let done = rerun(&self.log, &self.kinds, options, &mut quiet)?;
        if done.same {
            return Ok(());
        }
        let first = done.comparison.first;
        Err(BranchError::Different {
            log: self.log.clone(),
            tick: first.map_or(0, |first| first.tick()),
        })
    }

    fn points(&self, tick: u64, change: &Change) -> Vec<BranchPoint> {
        let name = self.log.file_name().unwrap_or_default();
        let point = BranchPoint {
            parent: name.to_string_lossy().into_owned(),
            digest: self.info.digest.clone(),
            tick,
            at_s: tick as f64 * self.scenario.run.dt,
            change: change.clone(),
            failures: self.failures.clone(),
        };
        self.points.iter().cloned().chain([point]).collect()
    }

    /// Runs the branch of a tick to its end; it begins earlier at the first tick for which `begins` returns `true`.
    ///
    /// # Errors
    /// [`BranchError`]: the change is refused, or the run fails or is interrupted.
    pub(crate) fn run(
        &self,
        tick: u64,
        change: &Change,
        out: Option<&Path>,
        options: InProcessOptions,
        begins: &mut dyn FnMut(u64) -> Result<bool, MissionError>,
    ) -> Result<MissionReport, BranchError> {
        let points = self.points(tick, change);
        let options = InProcessOptions {
            out: out.map(Path::to_owned),
            external: true,
            failures: self.failures.clone(),
            branches: branches(&points, &self.scenario, &self.kinds)?,
            source: serde_json::to_string(&points)
                .ok()
                .map(|text| (Origin::BRANCHES, text)),
            ..options
        };
        let report = in_process::run_until(&self.scenario, &options, begins)?;
        if report.interrupted {
            return Err(LogReadError::Interrupted.into());
        }
        Ok(report)
    }

    /// Records the branch of a tick, and compares its history before the tick with the log. `None` selects a free name
    /// beside the log: `NAME-branch-T.mcap`.
    ///
    /// # Errors
    /// [`BranchError`]: the change is refused, the run fails, or its log cannot be written.
    pub fn branch(
        &self,
        tick: u64,
        change: &Change,
        out: Option<&Path>,
        force: bool,
        watch: &mut ReadProgress,
    ) -> Result<BranchReport, BranchError> {
        let out = out.map_or_else(|| self.free_name(tick), |out| Ok(out.to_owned()))?;
        if presence::is_same(&out, &self.log).unwrap_or(false) {
            let text = format!("{}: is the parent: expected another file", out.display());
            return Err(LogReadError::Argument(text).into());
        }
        let options = InProcessOptions {
            force,
            interrupted: Arc::clone(&watch.interrupted),
            ..InProcessOptions::default()
        };
        let report = self.run(tick, change, Some(&out), options, &mut |_| Ok(false));
        let report = report.inspect_err(|error| {
            if error.is_misplaced() {
                // It has the history up to the refusal.
                let _ = std::fs::remove_file(&out);
            }
        })?;
        let tick_ns = (self.scenario.run.dt * 1e9).round() as u64;
        let comparison =
            diff_before(&self.log, &out, tick.saturating_mul(tick_ns), watch)?.comparison;
        let same = comparison.first.is_none();
        if !same {
            // What it shows is no continuation of the parent.
            let _ = std::fs::remove_file(&out);
        }
        let mut points = self.points(tick, change);
        Ok(BranchReport {
            scenario: self.scenario.name.clone(),
            seed: self.scenario.run.seed,
            log: out,
            point: points.remove(points.len() - 1),
            same,
            messages: comparison.equal(),
            comparison,
            branch_digest: report.summary.digest,
            ticks: report.summary.ticks,
            robots: report.summary.robots,
            wall_time_s: report.wall_time_s,
        })
    }

    fn free_name(&self, tick: u64) -> Result<PathBuf, BranchError> {
        let stem = self.log.file_stem().unwrap_or_default().to_string_lossy();
        let at = recorder::time_text(tick as f64 * self.scenario.run.dt);
        for n in 1_u32.. {
            let number = if n == 1 {
                String::new()
            } else {
                format!("-{n}")
            };
            let path = self
                .log
                .with_file_name(format!("{stem}-branch-{at}{number}.mcap"));
            if presence::entry(&path)
                .map_err(MissionError::LogDirectory)?
                .is_none()
            {
                return Ok(path);
            }
        }
        Ok(self.log.with_extension("branch.mcap"))
    }
}
