//! Checks of the guarantees of a run after a fault.

use std::path::Path;
use std::time::{Duration, Instant};

use mcap_log::{DerivedError, ReadProgress};
use serde_json::Value as Json;

use super::faulty_run::{self, Baseline, Ended, Mission};
use super::{ChaosError, FaultKind, Outcome};
use log_tools::{LogInfo, recover};
use mission::child_process::describe_exit;
use scenario::ResolvedScenario;
use scenario::spec::Mode;

/// Time limit of a mission with a fault: a multiple of the time of a mission without faults, and an
/// additional time (s), besides the time of failure detection. The margin allows for a busy
/// machine.
const PATIENCE: (f64, f64) = (5.0, 40.0);
/// Time limit for the processes of a run to exit after the death of their orchestrator: their grace
/// period, and a margin for a busy machine.
const GONE_WITHIN: Duration = Duration::from_secs(8);
/// Maximum real time before the death of the orchestrator that may be missing in the log (s).
const LOST_S: f64 = 1.0;

/// Runs a mission, injects the fault, and checks every guarantee.
pub(super) fn inject(
    scenario: &ResolvedScenario,
    outcome: &mut Outcome,
    baseline: &Baseline,
) -> Result<(), ChaosError> {
    let (times, more) = PATIENCE;
    let noticed = scenario.run.hang_timeout_s + scenario.run.ready_timeout_s;
    let patience = Duration::from_secs_f64(times * baseline.lasted_s + more + noticed);
    let mut mission = Mission::start(scenario)?;
    let moment = Duration::from_secs_f64(outcome.moment * baseline.lasted_s);
    let injected = mission.inject(outcome, moment);
    let listed = |source| faulty_run::system("a mission cannot be examined")(source);
    let runs = mission.runs().map_err(listed)?;
    let ended = mission.end(patience);
    if let Some(at) = injected {
        outcome.injected = true;
        outcome.over_after_s = at.elapsed().as_secs_f64();
    }
    let killed = injected.filter(|_| outcome.kind == FaultKind::KillOrchestrator);
    let mut check = Check {
        outcome,
        baseline,
        is_real_time: scenario.run.mode == Mode::RealTime,
    };
    check.end(&ended);
    check
        .nothing_is_left(&mission, &runs, killed.is_some())
        .map_err(listed)?;
    check.log(&mission, killed);
    if let Some(last) = outcome.broken.last_mut() {
        mission.keep();
        *last += &format!("; log and output are in {}", mission.path().display());
    }
    Ok(())
}

struct Check<'a> {
    outcome: &'a mut Outcome,
    baseline: &'a Baseline,
    is_real_time: bool,
}

impl Check<'_> {
    fn violated(&mut self, what: impl Into<String>) {
        self.outcome.broken.push(what.into());
    }

    /// Checks that the run ended, named the failed process, and has the reference digest if it
    /// succeeded.
    fn end(&mut self, ended: &Ended) {
        let Some(status) = ended.status else {
            return self.violated("the run did not end");
        };
        let Outcome {
            kind,
            target,
            injected,
            ..
        } = &*self.outcome;
        let is_failure = *injected && matches!(kind, FaultKind::Kill | FaultKind::Hang);
        let is_killed = *injected && *kind == FaultKind::KillOrchestrator;
        let processes = ended.summary["processes"].as_array();
        let is_listed = processes.is_some_and(|all| all.iter().any(|p| p["name"] == *target));
        match status.code() {
            // The game may have been over when the process failed.
            Some(0) if !is_listed => self.same_history(&ended.summary),
            Some(1) if is_failure && ended.stderr.contains(target) => {}
            Some(3) if is_failure && is_listed => {}
            // In real time messages may be lost, and are counted.
            Some(3) if self.is_real_time => {}
            None if is_killed => {}
            _ => {
                let (how, words) = (describe_exit(status), ended.stderr.trim());
                self.violated(format!("the orchestrator {how}: {words}"));
            }
        }
    }

    fn same_history(&mut self, summary: &Json) {
        let digest = &summary["digest"];
        if let Some(expected) = &self.baseline.digest
            && digest != expected
        {
            self.violated(format!("digest {digest}, but {expected} without faults"));
        }
    }

    /// Checks that no process, shared memory or file remains; after a killed orchestrator, once
    /// `clean` has run.
    fn nothing_is_left(
        &mut self,
        mission: &Mission,
        runs: &[String],
        is_killed: bool,
    ) -> std::io::Result<()> {
        let deadline = Instant::now() + GONE_WITHIN;
        let mut living = mission.living()?;
        while !living.is_empty() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(10));
            living = mission.living()?;
        }
        for config in living {
            self.violated(format!("the process of {} still runs", config.display()));
        }
        if is_killed {
            mission.clean();
        }
        for run in mission.runs()? {
            self.violated(format!("the directory of run {run} remains"));
        }
        for run in runs {
            let segments = faulty_run::names(Path::new("/dev/shm"), &faulty_run::prefix(run))?;
            if let Some(first) = segments.first() {
                let count = segments.len();
                self.violated(format!(
                    "{count} shared-memory objects remain, for example /dev/shm/{first}"
                ));
            }
        }
        Ok(())
    }

    /// Checks that the log is complete, or can be recovered and lacks at most the last second.
    fn log(&mut self, mission: &Mission, killed: Option<Instant>) {
        let log = mission.path().join(faulty_run::LOG);
        let mut kept = 0;
        if !matches!(log.try_exists(), Ok(false)) {
            let recovered = mission.path().join("recovered.mcap");
            let mut read = || -> Result<LogInfo, DerivedError> {
                if killed.is_none() {
                    return Ok(LogInfo::read(&log, &mut watch())?);
                }
                recover(&log, &recovered, true, &mut watch())?;
                let newest = mcap_log::newest_state(&recovered, &mut watch())?;
                kept = newest.map_or(0, |tick| tick + 1);
                Ok(LogInfo::read(&recovered, &mut watch())?)
            };
            match read() {
                Ok(info) if info.condition.is_whole() => {}
                Ok(info) => {
                    let faults = info.condition.lines().join("; ");
                    self.violated(format!("the log is damaged: {faults}"));
                }
                Err(error) => self.violated(format!("the log cannot be read: {error}")),
            }
        }
        let lost_s = killed.map(|at| mission.age_beyond(kept, at));
        if let Some(lost_s) = lost_s.filter(|&lost_s| lost_s > LOST_S) {
            self.violated(format!("the log lacks the last {lost_s:.3} s"));
        }
        self.outcome.lost_s = lost_s;
    }
}

fn watch() -> ReadProgress {
    ReadProgress::new(std::sync::Arc::default(), true)
}
